// The fields of the rule form: each is one member of one statement.
import { useEffect, useRef, useState } from 'preact/hooks'
import type { FieldKind } from './declarations'
import { tell } from './notices'
import type { Parameter } from './reuse'
import { setRefused, type Take, undo } from './rule_edits'
import { type RuleDocument, withMember } from './rule_document'

export interface Props {
  document: RuleDocument
  change: Take
}

const kBetween: Record<FieldKind, string> = { text: '', names: ' ', number: '', hold: '/', list: ' ', pair: ' ', range: '..', arguments: ', ', parameters: ', ' }
function shown(value: unknown, kind: FieldKind): string {
  if (value === undefined) return ''
  if (!Array.isArray(value)) return String(value)
  const each = (part: unknown) => {
    if (kind === 'parameters' && typeof part === 'object') return `${(part as Parameter).name} = ${quoted((part as Parameter).usual!)}`
    return kind === 'arguments' ? quoted(String(part)) : String(part)
  }
  return value.map(each).join(kBetween[kind])
}
const quoted = (text: string) => (/[\s,]/.test(text) && !text.startsWith('"') ? `"${text}"` : text)

const kTwo: Partial<Record<FieldKind, string>> = { hold: 'two numbers such as 3/5', range: 'two numbers such as 0..1', pair: 'two names such as docker slam' }

const kArgument = /(?:"[^"]*"|[^,"])+/g
const kHole = /^\{\w+\}$/ // a parameter of the template that it stands in
function parameterOf(text: string): string | Parameter {
  const [name, ...usual] = text.split('=').map((part) => part.trim())
  return usual.length > 0 ? { name, usual: usual.join('=') } : name
}

// The entered value of the member; undefined removes the member.
function valueOf(entered: string, kind: FieldKind, isOptional: boolean): unknown {
  if (entered === '' && (kind === 'arguments' || kind === 'parameters')) return []
  if (entered === '') return isOptional ? undefined : new Error('a value is required')
  if (kind === 'text') return entered
  if (kind === 'names') return /\s/.test(entered) ? entered.split(/\s+/) : entered
  if (kind === 'list') return entered.split(/[\s,]+/)
  if (kind === 'arguments' || kind === 'parameters') {
    const each = (entered.match(kArgument) ?? []).map((part) => part.trim())
    return kind === 'arguments' ? each : each.map(parameterOf)
  }
  if (kind === 'number' && kHole.test(entered)) return entered
  const parts = entered.split(kind === 'pair' ? /\s+/ : kBetween[kind] || '\n').map((part) => part.trim())
  if (kTwo[kind] && parts.length !== 2) return new Error(kTwo[kind])
  if (kind === 'pair') return parts
  const numbers = parts.map(Number)
  if (parts.includes('') || numbers.some(Number.isNaN)) return new Error(kTwo[kind] ?? 'a number is required')
  return kind === 'number' ? numbers[0] : numbers
}

// Changes count when the field is left or Enter is pressed: while one is typed, the file would be wrong most of the time.
export function Field(
  props: Props & {
    place: number
    member: string
    label: string
    kind?: FieldKind
    optional?: boolean
    wide?: boolean // a line of its own
    wider?: boolean
    list?: string
  }
) {
  const { document, change, place, member, kind = 'text' } = props
  const value = document.statements[place][member]
  const [draft, setDraft] = useState<string | null>(null) // what is being typed, or was not taken
  const [why, setWhy] = useState<string | null>(null) // it was not taken
  const field = useRef({})
  const settle = (reason: string | null) => {
    setWhy(reason)
    setRefused(field.current, reason !== null)
    if (reason === null) setDraft(null)
  }
  useEffect(() => () => setRefused(field.current, false), [])
  const take = async (entered: string) => {
    const trimmed = entered.trim()
    if (trimmed === shown(value, kind)) return settle(null)
    const next = valueOf(trimmed, kind, !!props.optional)
    if (next instanceof Error) return settle(next.message)
    settle(await change((d) => withMember(d, place, member, next)))
  }
  return (
    <label class={`field ${props.wide ? 'wide' : props.wider ? 'wider' : kind === 'number' || kind === 'hold' ? 'short' : ''}`}>
      <span>{props.label}</span>
      <input
        type="text"
        inputMode={kind === 'number' ? 'decimal' : 'text'}
        value={draft ?? shown(value, kind)}
        list={props.list}
        spellcheck={false}
        aria-invalid={why !== null}
        onInput={(e) => setDraft(e.currentTarget.value)}
        onChange={(e) => void take(e.currentTarget.value)}
        onKeyDown={(e) => {
          if (e.key === 'Escape') settle(null)
        }}
      />
      {why !== null && (
        <small class="ERROR" role="alert">
          ◆ Not taken: {why}
          <button type="button" onClick={() => settle(null)}>
            Back to “{shown(value, kind)}”
          </button>
        </small>
      )}
    </label>
  )
}

export function Choice(props: { label: string; value: string; of: string[]; take: (v: string) => void }) {
  return (
    <label class="field choice">
      <span>{props.label}</span>
      <select aria-label={props.label} value={props.value} onChange={(e) => props.take(e.currentTarget.value)}>
        {!props.of.includes(props.value) && <option>{props.value}</option>}
        {props.of.map((o) => (
          <option>{o}</option>
        ))}
      </select>
    </label>
  )
}

// `without`: a member that makes no sense without this one.
export function Check({ document, change, place, member, label, without }: Props & { place: number; member: string; label: string; without?: string }) {
  return (
    <label class="check">
      <input
        type="checkbox"
        checked={document.statements[place][member] === true}
        onChange={(e) => {
          const isOn = e.currentTarget.checked
          void change((d) => withMember(isOn || !without ? d : withMember(d, place, without, undefined), place, member, isOn || undefined))
        }}
      />{' '}
      {label}
    </label>
  )
}

// The possible additions to a statement, one choice at a time.
export function More({ words, of, add }: { words: string; of: string[]; add: (chosen: string) => void }) {
  if (of.length === 0) return null
  return (
    <label class="field choice">
      <span>{words}</span>
      <select
        aria-label={words}
        value=""
        onChange={(e) => {
          if (e.currentTarget.value) add(e.currentTarget.value)
          e.currentTarget.value = ''
        }}
      >
        <option value="">…</option>
        {of.map((each) => (
          <option>{each}</option>
        ))}
      </select>
    </label>
  )
}

// The notice and Undo bring a removed statement back.
export function Remove({ what, onClick }: { what: string; onClick: () => Promise<string | null> }) {
  const remove = async () => {
    const why = await onClick()
    if (why === null) tell({ text: `Removed ${what}.`, undo })
    else tell({ text: `Not removed: ${why}`, isTrouble: true })
  }
  return (
    <button type="button" class="remove" aria-label={`Remove ${what}`} title={`Remove ${what}`} onClick={() => void remove()}>
      ✕
    </button>
  )
}
