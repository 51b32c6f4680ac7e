// The rule builder: a form and a text editor of the same file. What one changes, the other shows.
import { signal } from '@preact/signals'
import { useEffect, useRef, useState } from 'preact/hooks'
import { call, hasToken, Refusal } from './api'
import { diff } from './diff'
import { type Editor, type Found, makeEditor } from './editor'
import { act } from './faults'
import { follow } from './live_names'
import { authorName } from './order'
import { relations, RuleConflicts } from './rule_conflicts'
import { RuleForm } from './rule_form'
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
const found = signal<Found[]>([])
const form = signal<RuleDocument | null>(null)
const unreadable = signal('') // why there is no form of the text

// Form and text follow one another by the server. Whichever was changed last counts: answers to what was asked
// before it are dropped, or a slow one would take back what was entered since.
let asked = 0

// The form of the text.
async function readForm(): Promise<void> {
  const mine = ++asked
  try {
    const document = await call<RuleDocument>('POST', '/api/rules/json', { text: text.value })
    if (mine !== asked) return
    form.value = document
    unreadable.value = ''
  } catch (error) {
    if (mine === asked) unreadable.value = (error as Refusal).message
  }
}

const canReload = () => can('post', '/api/rules/reload')
const reload = () =>
  act('Reloading the rules', () => call('POST', '/api/rules/reload', { author: authorName() }))

function Save({ onClose }: { onClose: () => void }) {
  const dialog = useRef<HTMLDialogElement>(null)
  useEffect(() => dialog.current!.showModal(), [])
  const errors = found.value.filter((f) => f.isError).length
  const save = async () => {
    const sent = text.value
    const saved = await act(`Saving ${file.value!.path}`, async () => {
      const { version } = await call<{ version: string }>('PUT', '/api/rules', {
        text: sent,
        version: file.value!.version,
      })
      file.value = { ...file.value!, text: sent, version }
    })
    if (saved) onClose()
    return saved
  }
  return (
    <dialog ref={dialog} onClose={onClose} aria-label="Save the rules">
      <h2>Save {file.value!.path}?</h2>
      {errors > 0 && (
        <p class="sick">
          ◆ The file has {errors} {errors > 1 ? 'errors' : 'error'}: culprit will not run it like this.
        </p>
      )}
      <pre class="diff" tabIndex={0}>
        {diff(file.value!.text, text.value).map((line) => (
          <div class={line.sign === '+' ? 'added' : line.sign === '-' ? 'removed' : ''}>
            {line.sign} {line.text}
          </div>
        ))}
      </pre>
      {canReload() && (
        <p class="muted">
          The manager that runs goes on with the rules it has until they are reloaded: what it has learned and
          what is under way stay.
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

export function RulesPage() {
  const place = useRef<HTMLDivElement>(null)
  const editor = useRef<Editor | null>(null)
  const [isSaving, setSaving] = useState(false)

  useEffect(() => {
    let isGone = false
    const open = async () => {
      if (!file.value) {
        file.value = await call<File>('GET', '/api/rules')
        text.value = file.value.text
      }
      if (isGone) return
      editor.current = makeEditor(
        place.current!,
        text.value,
        (next) => {
          text.value = next
          void readForm()
        },
        (list) => (found.value = list)
      )
      await readForm()
    }
    void act('Opening the rules', open)
    const stopLooking = follow(() => text.value)
    return () => {
      stopLooking()
      isGone = true
      editor.current?.view.destroy()
    }
  }, [])

  const change = async (document: RuleDocument) => {
    form.value = document
    const mine = ++asked
    try {
      const reply = await call<{ text: string }>('POST', '/api/rules/text', document)
      if (mine !== asked) return
      editor.current?.setText(reply.text)
      unreadable.value = ''
    } catch (error) {
      if (mine === asked) unreadable.value = (error as Refusal).message
    }
  }
  const format = () =>
    act('Laying out', async () => {
      const reply = await call<{ result: { newText: string }[] | null }>('POST', '/api/rules/ask', {
        text: text.value,
        method: 'textDocument/formatting',
      })
      if (reply.result?.[0]) editor.current?.setText(reply.result[0].newText)
    })

  const isChanged = !!file.value && file.value.text !== text.value
  const errors = found.value.filter((f) => f.isError).length
  return (
    <main class="rules">
      <div class="bar">
        <b>{file.value?.path}</b>
        <span class="muted">{isChanged ? 'changed' : 'as saved'}</span>
        <span class={errors > 0 ? 'sick' : 'well'} role="status">
          {errors > 0
            ? `◆ ${errors} ${errors > 1 ? 'errors' : 'error'}`
            : `✓ no errors, ${found.value.length} ${found.value.length === 1 ? 'warning' : 'warnings'}`}
        </span>
        <button type="button" disabled={!hasToken} onClick={() => void format()}>
          Lay out
        </button>
        <button
          type="button"
          class="primary"
          disabled={!hasToken || !isChanged || !file.value?.can_save}
          title={file.value?.can_save === false ? 'these rules are part of the program' : ''}
          onClick={() => setSaving(true)}
        >
          Save …
        </button>
        {canReload() && (
          <button
            type="button"
            disabled={!hasToken || isChanged || errors > 0}
            title={isChanged ? 'save first: what is reloaded is the file' : ''}
            onClick={() => void reload()}
          >
            Reload
          </button>
        )}
      </div>
      <section class="form" aria-label="Form">
        {unreadable.value && (
          <pre class="sick unreadable" role="alert">
            {unreadable.value}
          </pre>
        )}
        {form.value && <RuleConflicts list={relations(form.value, text.value, found.value)} />}
        {form.value && <RuleForm document={form.value} change={(d) => void change(d)} />}
      </section>
      <section class="text" aria-label="Text">
        <div class="editor" ref={place} />
        <ul class="found" aria-label="What the check says">
          {found.value.map((f) => (
            <li>
              <button type="button" onClick={() => editor.current?.goTo(f.from)}>
                <span class={f.isError ? 'ERROR' : 'WARNING'}>
                  {f.isError ? '◆' : '▲'} line {f.line}
                </span>{' '}
                {f.message} <small>{f.code}</small>
              </button>
            </li>
          ))}
        </ul>
      </section>
      {isSaving && <Save onClose={() => setSaving(false)} />}
    </main>
  )
}
