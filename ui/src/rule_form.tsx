// Rules, strategies and adaptations as a form over the statements of the file.
import type { ComponentChildren } from 'preact'
import { kDeclarations, namesOf, placeFor } from './declarations'
import { useEffect, useRef, useState } from 'preact/hooks'
import {
  endOf,
  freeName,
  componentOf,
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
import { SentenceForm } from './sentence_form'
import { setRefused, type Take, undo } from './rule_edits'
import { tell } from './notices'
import { graph, robot } from './store'

interface Props {
  document: RuleDocument
  change: Take
}

type FieldKind = 'text' | 'number' | 'hold' | 'list'
const shown = (value: unknown, kind: FieldKind = 'text'): string =>
  value === undefined ? '' : Array.isArray(value) ? value.join(kind === 'list' ? ' ' : '/') : String(value)

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
    <label class={`field ${props.wide ? 'wide' : props.wider ? 'wider' : kind === 'text' ? '' : 'short'}`}>
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

// What was entered as the member's value; undefined takes the member away.
function valueOf(entered: string, kind: FieldKind, isOptional: boolean): unknown {
  if (entered === '') return isOptional ? undefined : new Error('something has to stand here')
  if (kind === 'text') return entered
  if (kind === 'list') return entered.split(/[\s,]+/)
  const numbers = (kind === 'hold' ? entered.split('/') : [entered]).map(Number)
  if (numbers.some(Number.isNaN)) return new Error(kind === 'hold' ? 'two numbers such as 3/5' : 'a number has to stand here')
  return kind === 'hold' ? numbers : numbers[0]
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

function Check({ document, change, place, member, label }: Props & { place: number; member: string; label: string }) {
  return (
    <label class="check">
      <input
        type="checkbox"
        checked={document.statements[place][member] === true}
        onChange={(e) => {
          const isOn = e.currentTarget.checked
          void change((d) => withMember(d, place, member, isOn || undefined))
        }}
      />{' '}
      {label}
    </label>
  )
}

// What is removed can be brought back, by the notice or by Undo.
function Remove({ what, onClick }: { what: string; onClick: () => Promise<string | null> }) {
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
        take={(t) => change((d) => replaced(d, place, 1, newAdaptation(t, statement)))}
      />
      {(kAdaptations[type] ?? []).map(field)}
      <Field {...{ document, change, place }} member="impact" label="impact" kind="number" />
      <Remove what="adaptation" onClick={() => change((d) => replaced(d, place, 1))} />
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
        <Check {...props} member="last_resort" label="as a last resort" />
        <Remove what={`strategy ${name}`} onClick={() => change((d) => replaced(d, place, end - place))} />
      </div>
      {adaptations.map((i) => (
        <AdaptationForm key={i} {...{ document, change }} place={i} />
      ))}
      <button type="button" onClick={() => change((d) => replaced(d, end, 0, newAdaptation('set_parameter', { statement: 'ADAPTATION', component: componentOf(d, place) })))}>
        + Adaptation
      </button>
    </fieldset>
  )
}

function DeclarationForm({ document, change, place }: Props & { place: number }) {
  const statement = document.statements[place]
  const { title, members, more } = kDeclarations[statement.statement]
  const has = (member: string) => statement[member] !== undefined
  const label = `${title} ${statement.name ?? statement.consumer ?? ''}`.trim()
  return (
    <div class="adaptation" role="group" aria-label={label}>
      <b class="keyword">{title}</b>
      {[...members, ...Object.keys(more)].filter(has).map((member) => (
        <Field
          key={member}
          {...{ document, change, place, member }}
          label={member}
          kind={member === 'producers' ? 'list' : 'text'}
          optional={member in more}
          wider={['launch', 'expression', 'producers'].includes(member)}
          list={{ topic: 'topics', component: 'components', consumer: 'components' }[member]}
        />
      ))}
      {Object.keys(more).some((member) => !has(member)) && (
        <label class="field choice">
          <span>say more</span>
          <select
            value=""
            onChange={(e) => {
              const member = e.currentTarget.value
              if (member) void change((d) => withMember(d, place, member, more[member]))
              e.currentTarget.value = ''
            }}
          >
            <option value="">…</option>
            {Object.keys(more)
              .filter((member) => !has(member))
              .map((member) => (
                <option>{member}</option>
              ))}
          </select>
        </label>
      )}
      <Remove what={label} onClick={() => change((d) => replaced(d, place, 1))} />
    </div>
  )
}

// What the rules are about: components, signals, constants, dependencies, interlocks.
function Declarations({ document, change }: Props) {
  const places = document.statements.flatMap((s, place) => (kDeclarations[s.statement] ? [place] : []))
  const add = (keyword: string) => {
    const fresh = (d: RuleDocument): Statement => ({ statement: keyword, ...kDeclarations[keyword].fresh(d) })
    return change((d) => replaced(d, placeFor(d, keyword), 0, fresh(d)))
  }
  return (
    <details class="rule declarations">
      <summary>What the rules are about: {namesOf(document, 'COMPONENT').join(', ') || 'nothing declared'}</summary>
      {places.map((place) => (
        <DeclarationForm key={place} {...{ document, change, place }} />
      ))}
      <div class="bar">
        {Object.entries(kDeclarations).map(([keyword, { title }]) => (
          <button type="button" onClick={() => void add(keyword)}>
            + {title}
          </button>
        ))}
      </div>
    </details>
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
  const [why, setWhy] = useState<string | null>(null) // the sentence was not taken
  const say = async (next: string) => setWhy(await change((d) => withMember(d, trigger!, 'expression', next)))
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
              take={(c) => change((d) => withMember(d, policies, 'criticality', c))}
            />
            <Field {...props} place={policies} member="for" label="for" optional />
            <Field {...props} place={policies} member="hold" label="hold n/k" kind="hold" optional />
            <Field {...props} place={policies} member="cooldown" label="cooldown" optional />
            <Field {...props} place={policies} member="attempts" label="attempts" kind="number" optional />
            <Check {...props} place={policies} member="on_change" label="on change" />
          </>
        )}
        <Remove what={`rule ${name}`} onClick={() => change((d) => replaced(d, place, end - place))} />
      </div>
      {trigger !== undefined && (
        <SentenceForm
          document={document}
          trigger={String(document.statements[trigger].expression)}
          take={(next) => void say(next)}
        />
      )}
      {why !== null && (
        <small class="ERROR" role="alert">
          ◆ Not taken: {why}
        </small>
      )}
      {trigger !== undefined && <Field {...props} place={trigger} member="expression" label="trigger" wide />}
      {within
        .filter(([s]) => s.statement === 'STRATEGY')
        .map(([, i]) => (
          <StrategyForm key={i} {...props} place={i} />
        ))}
      <button
        type="button"
        onClick={() => change((d) => replaced(d, end, 0, ...newStrategy(freeName(d, 'STRATEGY', 'strategy'), componentOf(d, place))))}
      >
        + Strategy
      </button>
    </details>
  )
}

function Suggestions({ document }: { document: RuleDocument }) {
  const declared = namesOf(document, 'COMPONENT')
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
      {list('signals', namesOf(document, 'SIGNAL'))}
      {list('constants', namesOf(document, 'CONST'))}
      {[...new Set([...declared, ...live])].map((component) =>
        list(`parameters of ${component}`, parametersOf(component, document))
      )}
    </>
  )
}

// One that no rule is about yet, if there is one: of the file, or else of the robot.
function usualComponent(document: RuleDocument): string {
  const declared = namesOf(document, 'COMPONENT')
  const live = graph.value.nodes.map((n) => n.component ?? ownName(n.node))
  const used = new Set(document.statements.filter((s) => s.statement === 'ADAPTATION').map((s) => String(s.component)))
  const known = [...declared, ...live, ...Object.keys(names.value.nodes).map(ownName)]
  return known.find((c) => !used.has(c)) ?? known[0] ?? 'my_node'
}

export function RuleForm({ document, change }: Props) {
  const rules = document.statements.flatMap((s, i) => (s.statement === 'RULE' ? [i] : []))
  return (
    <>
      <Suggestions document={document} />
      <Declarations document={document} change={change} />
      {rules.map((place) => (
        <RuleCard key={String(place)} {...{ document, change, place }} />
      ))}
      <button
        type="button"
        class="primary"
        onClick={() =>
          change((d) => replaced(d, d.statements.length, 0, ...newRule(d, usualComponent(d))))
        }
      >
        + Rule
      </button>
    </>
  )
}
