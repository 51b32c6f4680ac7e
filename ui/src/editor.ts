// The text editor of rule files: CodeMirror, with what culprit's language server knows.
import { autocompletion, type CompletionContext, type CompletionResult } from '@codemirror/autocomplete'
import { defaultKeymap, history, historyKeymap, redo, undo } from '@codemirror/commands'
import { HighlightStyle, StreamLanguage, syntaxHighlighting } from '@codemirror/language'
import { type Diagnostic, lintGutter, linter } from '@codemirror/lint'
import { EditorState, StateEffect, type Text } from '@codemirror/state'
import { EditorView, drawSelection, highlightActiveLine, hoverTooltip, keymap, lineNumbers } from '@codemirror/view'
import { tags } from '@lezer/highlight'
import { call, Refusal } from './api'

interface Position {
  line: number
  character: number
}
interface LspDiagnostic {
  range: { start: Position; end: Position }
  severity: number
  code: string
  message: string
}
interface LspAction {
  title: string
  diagnostics: LspDiagnostic[]
  edit: { changes: Record<string, { range: LspDiagnostic['range']; newText: string }[]> }
}
interface Reply<T> {
  diagnostics: LspDiagnostic[]
  result: T
}

const kKeywords =
  /^(ROBOT|CYCLE|CONST|COMPONENT|NODE|LAUNCH|ENV|SETUP|CWD|UNIT|USER|CONTAINER|HOST|IN|PLUGIN|PACKAGE|PARAMETERS|REMAP|RESPAWNED|REQUIRED|READY|LIFECYCLE|DEPENDENCY|GROUP|MANAGER|ON|IGNORE|INTERLOCK|ABORT|DRILL|LASTRESORT|WITHIN|TOPIC|SIGNAL|DIAGNOSTIC|KEY|FIELD|PARAMETER|STALE|RANGE|RULE|POLICIES|FROM|FOR|HOLD|COOLDOWN|ATTEMPTS|ON_CHANGE|REPORT|TRIGGER|STRATEGY|WHEN|ADAPTATION|THEN|INCLUDE|TEMPLATE|END|USE|ERROR|WARNING|NON_CRITICAL|OK|DEGRADED|FAILURE)\b/

const language = StreamLanguage.define<null>({
  startState: () => null,
  token(stream) {
    if (stream.match(/^(#|\/\/).*/)) return 'comment'
    if (stream.match(/^"(\\.|[^"\\])*"?/)) return 'string'
    if (stream.match(kKeywords)) return 'keyword'
    if (stream.match(/^\d[\d.]*(e[+-]?\d+)?(ns|us|ms|s|min|h)?\b/)) return 'number'
    if (stream.match(/^\/[\w/]+/)) return 'link'
    if (stream.match(/^\w+/)) return 'variableName'
    stream.next()
    return null
  },
  languageData: { commentTokens: { line: '#' } },
})

const colours = HighlightStyle.define([
  { tag: tags.keyword, class: 'code-keyword' },
  { tag: tags.comment, class: 'code-comment' },
  { tag: tags.string, class: 'code-string' },
  { tag: tags.number, class: 'code-number' },
  { tag: tags.link, class: 'code-topic' },
])

const theme = EditorView.theme({
  '&': { height: '100%', backgroundColor: 'var(--surface)', color: 'var(--text)', fontSize: '14px' },
  '&:focus-within': { outline: '3px solid var(--accent)', outlineOffset: '-3px' },
  '.cm-gutters': { backgroundColor: 'var(--raised)', color: 'var(--muted)', borderRight: '1px solid var(--faint)' },
  '.cm-activeLine': { backgroundColor: 'var(--raised)' },
  '.cm-cursor': { borderLeftColor: 'var(--text)' },
  '.cm-tooltip': { backgroundColor: 'var(--raised)', color: 'var(--text)', border: '1px solid var(--line)' },
  '&.cm-focused .cm-selectionBackground, .cm-selectionBackground': { backgroundColor: 'var(--faint) !important' },
  '.cm-diagnostic': { whiteSpace: 'pre-wrap' },
})

// LSP counts lines from 0 and UTF-16 code units within them, as CodeMirror does.
const offset = (doc: Text, at: Position) => {
  const line = doc.line(Math.min(at.line + 1, doc.lines))
  return Math.min(line.from + at.character, line.to)
}
const position = (doc: Text, at: number): Position => {
  const line = doc.lineAt(at)
  return { line: line.number - 1, character: at - line.from }
}

async function complete(context: CompletionContext): Promise<CompletionResult | null> {
  const word = context.matchBefore(/[\w/.]*/)
  if (!context.explicit && (!word || word.from === word.to)) return null
  const { doc } = context.state
  const reply = await call<Reply<{ label: string; detail?: string }[] | { items: { label: string; detail?: string }[] } | null>>(
    'POST',
    '/api/rules/ask',
    {
      text: doc.toString(),
      method: 'textDocument/completion',
      params: { position: position(doc, context.pos) },
    }
  ).catch(() => null)
  const items = Array.isArray(reply?.result) ? reply.result : (reply?.result?.items ?? [])
  return { from: word?.from ?? context.pos, options: items.map((i) => ({ label: i.label, detail: i.detail })) }
}

const hover = hoverTooltip(async (view, pos) => {
  const { doc } = view.state
  const reply = await call<Reply<{ contents: { value: string } } | null>>('POST', '/api/rules/ask', {
    text: doc.toString(),
    method: 'textDocument/hover',
    params: { position: position(doc, pos) },
  }).catch(() => null)
  const text = reply?.result?.contents?.value
  if (!text) return null
  return {
    pos,
    create() {
      const dom = document.createElement('div')
      dom.className = 'hover'
      dom.textContent = text
      return { dom }
    },
  }
})

// As the language server offers it.
export interface Fix {
  title: string
  from: number
  to: number
  was: string
  text: string
}
export interface Found {
  line: number
  from: number
  isError: boolean
  code: string
  message: string
  fix?: Fix
}

export interface Editor {
  view: EditorView
  check(): void // anew, though the text is the same
  fix(all: Fix[]): void
  setText(text: string): void
  undo(): void
  redo(): void
  goTo(at: number): void
  goToLine(line: number): void
}

// CodeMirror writes its styles into a document by a style element, which the content security policy
// forbids, but into a shadow root by the object model, which it allows. There, those of the page have to
// be given too.
function shadowRoot(parent: HTMLElement): ShadowRoot {
  const host = document.createElement('div')
  parent.append(host)
  const root = host.attachShadow({ mode: 'open' })
  const sheet = new CSSStyleSheet()
  const rules = [...document.styleSheets].flatMap((s) => [...s.cssRules])
  sheet.replaceSync(rules.map((r) => r.cssText).join('\n'))
  root.adoptedStyleSheets = [sheet]
  return root
}

function fixOf(doc: Text, mistake: LspDiagnostic, actions: LspAction[]): Fix | undefined {
  const key = (d: LspDiagnostic) => JSON.stringify([d.code, d.range.start, d.range.end])
  const action = actions.find((a) => a.diagnostics.some((d) => key(d) === key(mistake)))
  const [edit] = action ? Object.values(action.edit.changes).flat() : []
  if (!edit) return undefined
  const [from, to] = [offset(doc, edit.range.start), offset(doc, edit.range.end)]
  return { title: action!.title, from, to, was: doc.sliceString(from, to), text: edit.newText }
}
// As one step for Undo. One that overlaps an earlier one, or whose text has changed, waits for the next check.
function applyAll(view: EditorView, all: Fix[]): void {
  const apart: Fix[] = []
  for (const fix of [...all].sort((a, b) => a.from - b.from)) {
    const isAsItWas = view.state.doc.sliceString(fix.from, fix.to) === fix.was
    if (isAsItWas && (apart.length === 0 || fix.from >= apart[apart.length - 1].to)) apart.push(fix)
  }
  view.dispatch({ changes: apart.map(({ from, to, text }) => ({ from, to, insert: text })) })
  view.focus()
}

const checkAnew = StateEffect.define<null>()

// `onText` is called with each new text, `onFound` with the check's findings about the newest, `onCheck` after each check: with the
// reason if there was none.
export function makeEditor(
  parent: HTMLElement,
  text: string,
  onText: (text: string) => void,
  onFound: (found: Found[]) => void,
  onCheck: (whyNot: string) => void
): Editor {
  let found: Found[] = []
  const check = linter(
    async (view): Promise<Diagnostic[]> => {
      const { doc } = view.state
      const whole = { start: position(doc, 0), end: position(doc, doc.length) }
      const params = { range: whole, context: { diagnostics: [] } }
      const reply = await call<Reply<LspAction[] | null>>('POST', '/api/rules/ask', { text: doc.toString(), method: 'textDocument/codeAction', params }).catch((error: unknown) => {
        if (!(error instanceof Refusal)) throw error
        onCheck(error.message)
        return null
      })
      // Answers may overtake one another: findings about an older text are dropped.
      if (!reply || !view.state.doc.eq(doc)) return []
      onCheck('')
      const list = reply.diagnostics.map((d): Found & { to: number } => {
        const from = offset(doc, d.range.start)
        return {
          line: d.range.start.line + 1,
          from,
          to: Math.max(from, offset(doc, d.range.end)),
          isError: d.severity === 1,
          code: d.code,
          message: d.message,
          fix: fixOf(doc, d, reply.result ?? []),
        }
      })
      onFound((found = list))
      return list.map(({ from, to, isError, code, message, fix }, place): Diagnostic => ({
        from,
        to,
        severity: isError ? 'error' : 'warning',
        source: code,
        message,
        actions: fix && [{ name: fix.title, apply: () => applyAll(view, [found[place]?.fix ?? fix]) }],
      }))
    },
    { delay: 150, needsRefresh: ({ transactions }) => transactions.some(({ effects }) => effects.some((each) => each.is(checkAnew))) }
  )
  const root = shadowRoot(parent)
  const view = new EditorView({
    parent: root,
    root,
    state: EditorState.create({
      doc: text,
      extensions: [
        lineNumbers(),
        history(),
        drawSelection(),
        highlightActiveLine(),
        language,
        theme,
        syntaxHighlighting(colours),
        lintGutter(),
        check,
        autocompletion({ override: [complete] }),
        hover,
        keymap.of([...defaultKeymap, ...historyKeymap]), // the Tab key leaves, as everywhere
        EditorView.contentAttributes.of({ 'aria-label': 'Rule file', tabindex: '0' }),
        EditorView.updateListener.of((update) => {
          if (!update.docChanged) return
          // Until the next check, findings move with their text.
          const { changes, state } = update
          found = found.map((f) => {
            const from = changes.mapPos(f.from)
            const fix = f.fix && { ...f.fix, from: changes.mapPos(f.fix.from, 1), to: changes.mapPos(f.fix.to, -1) }
            return { ...f, from, line: state.doc.lineAt(from).number, fix }
          })
          onFound(found)
          onText(state.doc.toString())
        }),
      ],
    }),
  })
  const goTo = (at: number) => {
    view.dispatch({ selection: { anchor: at }, scrollIntoView: true })
    view.focus()
  }
  return {
    view,
    check: () => view.dispatch({ effects: checkAnew.of(null) }),
    setText(next) {
      if (next === view.state.doc.toString()) return
      view.dispatch({ changes: { from: 0, to: view.state.doc.length, insert: next } })
    },
    fix: (all) => applyAll(view, all),
    undo: () => void undo(view),
    redo: () => void redo(view),
    goTo,
    goToLine: (line) => goTo(view.state.doc.line(Math.min(line, view.state.doc.lines)).from),
  }
}
