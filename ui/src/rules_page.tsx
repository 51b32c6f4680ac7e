// The rule builder: a form and a text editor of the same file. Each shows the changes of the other.
import { computed, effect, signal } from '@preact/signals'
import { useEffect, useRef, useState } from 'preact/hooks'
import { call, hasToken, Refusal } from './api'
import { type Editor, type Found, makeEditor } from './editor'
import { byTheClock } from './clock'
import { isReachable } from './freshness'
import { draftOf, keepDraft, type Draft } from './drafts'
import { diff, merged } from './line_changes'
import { Hindsight, hindsightFollows } from './hindsight'
import { act, tell } from './notices'
import { accept, ask, type Edit, form, isNewest, onUndo, refusedFields, take } from './rule_edits'
import { follow } from './live_names'
import { authorName } from './order'
import { relations, RuleConflicts } from './rule_conflicts'
import { RuleForm } from './rule_form'
import { RuleGraphView } from './rule_graph_view'
import type { RuleDocument } from './rule_document'
import { can } from './store'

interface File {
  path: string
  text: string
  version: string
  can_save: boolean
}

const file = signal<File | null>(null) // as it was opened, or saved last
const text = signal('')
effect(() => hindsightFollows(text.value))
const checked = signal<Found[] | null>(null) // nothing before the first check
const found = computed(() => checked.value ?? [])
const unchecked = signal('') // why the newest text was not checked
const unreadable = signal<Refusal | null>(null) // why there is no form of the text
const restored = signal<Draft | null>(null) // brought back after a reload
const theirs = signal<File | null>(null) // saved by another client meanwhile

// The form of the text.
async function readForm(): Promise<void> {
  const mine = ask()
  const read = text.value
  try {
    const document = await call<RuleDocument>('POST', '/api/rules/json', { text: read })
    if (!isNewest(mine)) return
    accept(document, read)
    unreadable.value = null
  } catch (error) {
    if (isNewest(mine)) unreadable.value = error as Refusal
  }
}

// Keeps the unsaved text, with the version that it is based on.
function keep(): void {
  if (!file.value) return
  const { path, text: saved, version } = file.value
  const isSame = saved === text.value
  keepDraft(path, isSame ? null : { text: text.value, base: { text: saved, version }, at: Date.now() })
}

async function openFile(): Promise<void> {
  const now = await call<File>('GET', '/api/rules')
  const draft = draftOf(now.path)
  if (!draft || draft.text === now.text) {
    file.value = now
    text.value = now.text
    return
  }
  restored.value = draft
  text.value = draft.text
  if (draft.base.version !== now.version) theirs.value = now
  file.value = { ...now, ...draft.base }
}

const canReload = () => can('post', '/api/rules/reload')
const reload = () =>
  act('Reloading the rules', () => call('POST', '/api/rules/reload', { author: authorName() }))

function Difference({ before, after }: { before: string; after: string }) {
  return (
    <pre class="diff" tabIndex={0}>
      {diff(before, after).map((line) => (
        <div class={line.sign === '+' ? 'added' : line.sign === '-' ? 'removed' : ''}>
          {line.sign} {line.text}
        </div>
      ))}
    </pre>
  )
}

// Drafts from before a reload, and versions that another client saved meanwhile. The page never discards one unasked.
function Restored({ write }: { write: (text: string) => void }) {
  const draft = restored.value
  const other = theirs.value
  if (!file.value || (!draft && !other)) return null
  const take = (next: string) => {
    if (other) file.value = other
    theirs.value = restored.value = null
    write(next)
    keep()
  }
  if (!other)
    return (
      <section class="banner" role="status" aria-label="Draft">
        <p>Your unsaved text of {byTheClock(draft!.at / 1000)} is restored.</p>
        <div class="bar">
          <button type="button" onClick={() => (restored.value = null)}>
            Keep it
          </button>
          <button type="button" onClick={() => take(file.value!.text)}>
            Discard it
          </button>
        </div>
      </section>
    )
  const both = merged(file.value.text, text.value, other.text)
  return (
    <section class="banner" role="alert" aria-label="Conflict">
      <p>
        <b>{other.path} was changed by another program meanwhile.</b> Your text was not saved. The other changes:
      </p>
      <Difference before={file.value.text} after={other.text} />
      <div class="bar">
        {both !== null && (
          <button type="button" class="primary" onClick={() => take(both)}>
            Merge both
          </button>
        )}
        <button type="button" onClick={() => take(text.value)}>
          Keep mine
        </button>
        <button type="button" onClick={() => take(other.text)}>
          Take theirs
        </button>
      </div>
      {both === null && <p class="muted">Both changed the same lines, so they cannot be merged.</p>}
    </section>
  )
}

function Save({ onClose }: { onClose: () => void }) {
  const dialog = useRef<HTMLDialogElement>(null)
  useEffect(() => dialog.current!.showModal(), [])
  const errors = found.value.filter((f) => f.isError).length
  const [why, setWhy] = useState('')
  // Shows errors here: the notices are behind the dialog.
  const save = async () => {
    const sent = text.value
    setWhy('')
    try {
      const body = { text: sent, version: file.value!.version }
      const { version } = await call<{ version: string }>('PUT', '/api/rules', body)
      file.value = { ...file.value!, text: sent, version }
      keep()
      tell({ text: `Saving ${file.value.path}: done` })
      onClose()
      return true
    } catch (error) {
      if ((error as Refusal).status === 409) {
        theirs.value = await call<File>('GET', '/api/rules').catch(() => null)
        if (theirs.value) onClose() // what both have changed is shown on the page
        else setWhy((error as Refusal).message)
      } else setWhy(`${(error as Refusal).message}. Your text is kept in this browser.`)
      return false
    }
  }
  return (
    <dialog ref={dialog} onClose={onClose} aria-label="Save the rules">
      <h2>Save {file.value!.path}?</h2>
      {errors > 0 && (
        <p class="sick">
          ◆ The file has {errors} {errors > 1 ? 'errors' : 'error'}: culprit refuses to run it.
        </p>
      )}
      {why && (
        <p class="sick" role="alert">
          ◆ Not saved: {why}
        </p>
      )}
      <Difference before={file.value!.text} after={text.value} />
      {canReload() && (
        <p class="muted">
          The running culprit keeps its old rules until you reload. A reload keeps learned values and the strategy
          under way.
        </p>
      )}
      <div class="bar">
        <button type="button" class="primary" onClick={() => void save()}>
          Save
        </button>
        {canReload() && (
          <button type="button" disabled={errors > 0} onClick={() => void save().then((saved) => saved && reload())}>
            Save and reload
          </button>
        )}
        <button type="button" onClick={() => dialog.current!.close()}>
          Cancel
        </button>
      </div>
    </dialog>
  )
}

function whyNotSave(): string {
  if (file.value?.can_save === false) return 'these rules are built into the program'
  if (refusedFields() > 0) return 'a field of the form has an invalid value: correct it, or press Escape in it'
  return theirs.value ? 'the file has changed meanwhile: choose a version above' : ''
}

export function RulesPage() {
  const place = useRef<HTMLDivElement>(null)
  const editor = useRef<Editor | null>(null)
  const [isSaving, setSaving] = useState(false)

  useEffect(() => {
    let isGone = false
    const open = async () => {
      if (!file.value) await openFile()
      if (isGone) return
      editor.current = makeEditor(
        place.current!,
        text.value,
        (next) => {
          text.value = next
          keep()
          void readForm()
        },
        (list) => (checked.value = list),
        (whyNot) => (unchecked.value = whyNot)
      )
      await readForm()
    }
    open().catch((error: Error) => tell({ text: `Opening the rules: ${error.message}`, isTrouble: true }))
    // Once culprit is back, the page reads and checks the text again, where it failed before.
    const stopReturning = effect(() => {
      if (!isReachable.value || !editor.current) return
      if (unchecked.peek()) editor.current.check()
      if (unreadable.peek()?.status === 0) void readForm()
    })
    const stopLooking = follow(() => text.value)
    onUndo(() => editor.current?.undo())
    addEventListener('keydown', takeBack)
    return () => {
      removeEventListener('keydown', takeBack)
      stopLooking()
      stopReturning()
      isGone = true
      editor.current?.view.destroy()
    }
  }, [])

  // As in an editor, wherever one is on the page. A field that is typed into takes back its own typing.
  function takeBack(e: KeyboardEvent): void {
    const isTyping = (e.target as Element).closest('input, textarea, [contenteditable="true"]') !== null
    if (!(e.ctrlKey || e.metaKey) || e.altKey || isTyping || document.querySelector('dialog[open]')) return
    const key = e.key.toLowerCase()
    if (key !== 'z' && key !== 'y') return
    e.preventDefault()
    if (key === 'y' || e.shiftKey) editor.current?.redo()
    else editor.current?.undo()
  }

  const change = (edit: Edit) => take(edit, (next) => editor.current?.setText(next))
  const format = () =>
    act('Formatting', async () => {
      const reply = await call<{ result: { newText: string }[] | null }>('POST', '/api/rules/ask', {
        text: text.value,
        method: 'textDocument/formatting',
      })
      if (reply.result?.[0]) editor.current?.setText(reply.result[0].newText)
    })

  const isChanged = !!file.value && file.value.text !== text.value
  const errors = found.value.filter((f) => f.isError).length
  const fixes = found.value.flatMap((f) => f.fix ?? [])
  return (
    <main class="rules">
      <div class="bar">
        <b>{file.value?.path}</b>
        <span class="muted">{isChanged ? 'changed' : 'as saved'}</span>
        {refusedFields() > 0 && (
          <span class="sick" role="status">
            ◆ {refusedFields() === 1 ? 'one field is' : `${refusedFields()} fields are`} not in the text
          </span>
        )}
        <span class={errors > 0 || unchecked.value ? 'sick' : checked.value ? 'well' : 'muted'} role="status">
          {unchecked.value
            ? `? not checked: ${unchecked.value}`
            : errors > 0
              ? `◆ ${errors} ${errors > 1 ? 'errors' : 'error'}`
              : !checked.value
                ? '… being checked'
                : `✓ no errors, ${found.value.length} ${found.value.length === 1 ? 'warning' : 'warnings'}`}
        </span>
        <button type="button" aria-keyshortcuts="Control+Z" title="Ctrl-Z, also outside of the text" onClick={() => editor.current?.undo()}>
          Undo
        </button>
        <button type="button" aria-keyshortcuts="Control+Shift+Z Control+Y" title="Ctrl-Shift-Z or Ctrl-Y" onClick={() => editor.current?.redo()}>
          Redo
        </button>
        <button type="button" disabled={!hasToken} onClick={() => void format()}>
          Format
        </button>
        <button
          type="button"
          class="primary"
          disabled={!hasToken || !isChanged || !file.value?.can_save || refusedFields() > 0 || !!theirs.value}
          title={whyNotSave()}
          onClick={() => setSaving(true)}
        >
          Save …
        </button>
        {canReload() && (
          <button
            type="button"
            disabled={!hasToken || isChanged || errors > 0}
            title={isChanged ? 'save first: Reload reads the file' : ''}
            onClick={() => void reload()}
          >
            Reload
          </button>
        )}
      </div>
      <Restored write={(next) => editor.current?.setText(next)} />
      {unreadable.value && (
        <pre class="sick unreadable" role="alert">
          {unreadable.value.status === 0
            ? `The form is off: ${unreadable.value.message}`
            : `The form is off until the text can be parsed${errors > 0 ? '; the errors are listed below the text.' : `: ${unreadable.value.message}`}`}
        </pre>
      )}
      <div class="sides">
        <div class="beside">
          <RuleGraphView text={() => text.value} onLine={(line) => editor.current?.goToLine(line)} />
          <section class="form" aria-label="Form" inert={!!unreadable.value}>
            {form.value && <RuleConflicts list={relations(form.value, text.value, found.value)} />}
            {form.value && <RuleForm document={form.value} change={change} />}
            {form.value && <Hindsight document={form.value} hasErrors={errors > 0} />}
          </section>
        </div>
        <section class="text" aria-label="Text">
          <div class="editor" ref={place} />
          {fixes.length > 1 && (
            <button type="button" class="fix-all" onClick={() => editor.current?.fix(fixes)}>
              Apply all {fixes.length} fixes
            </button>
          )}
          <ul class="found" aria-label="Findings of the check">
            {found.value.map((f) => (
              <li>
                <button type="button" class="finding" onClick={() => editor.current?.goTo(f.from)}>
                  <span class={f.isError ? 'ERROR' : 'WARNING'}>
                    {f.isError ? '◆' : '▲'} line {f.line}
                  </span>{' '}
                  {f.message} <small>{f.code}</small>
                </button>
                {f.fix && (
                  <button type="button" onClick={() => editor.current?.fix([f.fix!])}>
                    {f.fix.title}
                  </button>
                )}
              </li>
            ))}
          </ul>
        </section>
      </div>
      {isSaving && <Save onClose={() => setSaving(false)} />}
    </main>
  )
}
