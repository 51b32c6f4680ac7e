// Rules, strategies and adaptations as a form over the statements of the file.
import type { ComponentChildren } from 'preact'
import { useState } from 'preact/hooks'
import {
  endOf,
  freeName,
  kAdaptations,
  newAdaptation,
  newRule,
  newStrategy,
  replaced,
  type RuleDocument,
  type Statement,
  withMember,
} from './rule_document'
import { names, ownName, parametersOf } from './live_names'
import { graph, robot } from './store'

interface Props {
  document: RuleDocument
  change: (document: RuleDocument) => void
}

const shown = (value: unknown): string =>
  value === undefined ? '' : Array.isArray(value) ? value.join('/') : String(value)

// The names to offer for a member of an adaptation of `component`.
const listOf = (member: string, component: string) =>
  ({ topic: 'topics', service: 'services', parameter: `parameters of ${component}` })[member]

// One member of a statement. Changes count when the field is left or Enter is pressed: while one is
// typed, the file would be wrong most of the time.
function Field(
  props: Props & {
    place: number
    member: string
    label: string
    kind?: 'text' | 'number' | 'hold'
    optional?: boolean
    wide?: boolean // a line of its own
    wider?: boolean
    list?: string
  }
) {
  const { document, change, place, member, kind = 'text' } = props
  const value = document.statements[place][member]
  const [draft, setDraft] = useState<string | null>(null) // what is being typed
  const take = (entered: string) => {
    const trimmed = entered.trim()
    if (trimmed === shown(value)) return
    if (trimmed === '' && props.optional) return change(withMember(document, place, member, undefined))
    const number = Number(trimmed)
    let next: unknown = trimmed
    if (kind === 'number' && trimmed !== '' && !Number.isNaN(number)) next = number
    if (kind === 'hold') next = trimmed.split('/').map(Number)
    change(withMember(document, place, member, next))
  }
  return (
    <label class={`field ${props.wide ? 'wide' : props.wider ? 'wider' : kind === 'text' ? '' : 'short'}`}>
      <span>{props.label}</span>
      <input
        type="text"
        inputMode={kind === 'number' ? 'decimal' : 'text'}
        value={draft ?? shown(value)}
        list={props.list}
        spellcheck={false}
        onInput={(e) => setDraft(e.currentTarget.value)}
        onChange={(e) => {
          setDraft(null)
          take(e.currentTarget.value)
        }}
      />
    </label>
  )
}

function Choice(props: { label: string; value: string; of: string[]; take: (v: string) => void }) {
  return (
    <label class="field choice">
      <span>{props.label}</span>
      <select value={props.value} onChange={(e) => props.take(e.currentTarget.value)}>
        {!props.of.includes(props.value) && <option>{props.value}</option>}
        {props.of.map((o) => (
          <option>{o}</option>
        ))}
      </select>
    </label>
  )
}

function Remove({ what, onClick }: { what: string; onClick: () => void }) {
  return (
    <button type="button" class="remove" aria-label={`Remove ${what}`} title={`Remove ${what}`} onClick={onClick}>
      ✕
    </button>
  )
}

function AdaptationForm({ document, change, place }: Props & { place: number }) {
  const statement = document.statements[place]
  const type = String(statement.type)
  const field = (member: string) => (
    <Field {...{ document, change, place, member }} label={member} list={listOf(member, String(statement.component))} />
  )
  return (
    <div class="adaptation" role="group" aria-label="Adaptation">
      <Field {...{ document, change, place }} member="component" label="component" list="components" />
      <Choice
        label="type"
        value={type}
        of={Object.keys(kAdaptations)}
        take={(t) => change(replaced(document, place, 1, newAdaptation(t, statement)))}
      />
      {(kAdaptations[type] ?? []).map(field)}
      <Field {...{ document, change, place }} member="impact" label="impact" kind="number" />
      <Remove what="adaptation" onClick={() => change(replaced(document, place, 1))} />
    </div>
  )
}

function StrategyForm({ document, change, place }: Props & { place: number }) {
  const end = endOf(document, place)
  const adaptations: number[] = []
  for (let i = place + 1; i < end; ++i) {
    if (document.statements[i].statement === 'ADAPTATION') adaptations.push(i)
  }
  const props = { document, change, place }
  const name = String(document.statements[place].name)
  return (
    <fieldset class="strategy">
      <legend>Strategy {name}</legend>
      <div class="row">
        <Field {...props} member="name" label="name" wider />
        <Field {...props} member="probability" label="helps in %" kind="number" />
        <Field {...props} member="confidence" label="confidence" kind="number" />
        <Field {...props} member="when" label="only when" optional />
        <Remove what={`strategy ${name}`} onClick={() => change(replaced(document, place, end - place))} />
      </div>
      {adaptations.map((i) => (
        <AdaptationForm key={i} {...{ document, change }} place={i} />
      ))}
      <button type="button" onClick={() => change(replaced(document, end, 0, newAdaptation('set_parameter')))}>
        + Adaptation
      </button>
    </fieldset>
  )
}

function RuleCard({ document, change, place }: Props & { place: number }) {
  const end = endOf(document, place)
  const within: [Statement, number][] = []
  for (let i = place + 1; i < end; ++i) within.push([document.statements[i], i])
  const at = (keyword: string) => within.find(([s]) => s.statement === keyword)?.[1]
  const policies = at('POLICIES')
  const trigger = at('TRIGGER')
  const name = String(document.statements[place].name)
  const props = { document, change }
  return (
    <details class="rule" open>
      <summary>{name}</summary>
      <div class="row">
        <Field {...props} place={place} member="name" label="rule" wider />
        {policies !== undefined && (
          <>
            <Choice
              label="criticality"
              value={String(document.statements[policies].criticality)}
              of={['NON_CRITICAL', 'WARNING', 'ERROR']}
              take={(c) => change(withMember(document, policies, 'criticality', c))}
            />
            <Field {...props} place={policies} member="for" label="for" optional />
            <Field {...props} place={policies} member="hold" label="hold n/k" kind="hold" optional />
            <Field {...props} place={policies} member="cooldown" label="cooldown" optional />
            <Field {...props} place={policies} member="attempts" label="attempts" kind="number" optional />
          </>
        )}
        <Remove what={`rule ${name}`} onClick={() => change(replaced(document, place, end - place))} />
      </div>
      {trigger !== undefined && <Field {...props} place={trigger} member="expression" label="trigger" wide />}
      {within
        .filter(([s]) => s.statement === 'STRATEGY')
        .map(([, i]) => (
          <StrategyForm key={i} {...props} place={i} />
        ))}
      <button
        type="button"
        onClick={() => change(replaced(document, end, 0, ...newStrategy(freeName(document, 'STRATEGY', 'strategy'))))}
      >
        + Strategy
      </button>
    </details>
  )
}

function Suggestions({ document }: { document: RuleDocument }) {
  const declared = document.statements.filter((s) => s.statement === 'COMPONENT').map((s) => String(s.name))
  const live = [
    ...graph.value.nodes.map((n) => n.component ?? ownName(n.node)),
    ...Object.keys(names.value.nodes).map(ownName),
  ]
  const topics = [...names.value.topics, ...graph.value.edges.map(([, , channel]) => channel), ...(robot.value?.topics ?? [])]
  const list = (id: string, names: string[]): ComponentChildren => (
    <datalist id={id}>
      {[...new Set(names)].filter(Boolean).sort().map((n) => (
        <option value={n} />
      ))}
    </datalist>
  )
  return (
    <>
      {list('components', [...declared, ...live])}
      {list('topics', topics)}
      {list('services', names.value.services)}
      {[...new Set([...declared, ...live])].map((component) =>
        list(`parameters of ${component}`, parametersOf(component, document))
      )}
    </>
  )
}

export function RuleForm({ document, change }: Props) {
  const rules = document.statements.flatMap((s, i) => (s.statement === 'RULE' ? [i] : []))
  return (
    <>
      <Suggestions document={document} />
      {rules.map((place) => (
        <RuleCard key={String(place)} {...{ document, change, place }} />
      ))}
      <button
        type="button"
        class="primary"
        onClick={() =>
          change(replaced(document, document.statements.length, 0, ...newRule(freeName(document, 'RULE', 'NewRule'))))
        }
      >
        + Rule
      </button>
    </>
  )
}
