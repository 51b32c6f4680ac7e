// A trigger as a sentence, for people who do not write programs: what is looked at, how much of it is too much, and what
// it is now.
import { useState } from 'preact/hooks'
import { lasting } from './clock'
import { namesOf } from './declarations'
import { names, ownName } from './live_names'
import type { RuleDocument } from './rule_document'
import { type Clause, kComparisons, kKinds, type Kind, sentenceOf, usualClause, written } from './sentence'
import { graph, robot, state, stateOfComponent, stateOfTopic } from './store'

const kStates = ['unconfigured', 'inactive', 'active', 'finalized']
const kLists: Record<Kind, string> = { silent: 'topics', slow: 'topics', dead: 'components', state: 'components', value: 'signals' }

// The first that there is of what a clause of this kind is about.
function firstName(kind: Kind, document: RuleDocument): string {
  const components = [...namesOf(document, 'COMPONENT'), ...graph.value.nodes.map((n) => n.component ?? ownName(n.node))]
  const topics = [...(robot.value?.topics ?? []), ...names.value.topics]
  const all = { topics, components, signals: namesOf(document, 'SIGNAL') }[kLists[kind]] ?? []
  return all[0] ?? { topics: '/topic', components: 'my_node', signals: 'my_signal' }[kLists[kind]]!
}

// What it is now, if the robot that runs has it.
function nowOf({ kind, name }: Clause): string {
  if (kind === 'silent' || kind === 'slow') {
    const topic = stateOfTopic(name)
    if (!topic || topic.rate === null) return ''
    return kind === 'slow' ? `${topic.rate.toFixed(1)} Hz` : topic.age === null ? '' : lasting(topic.age)
  }
  if (kind === 'value') {
    const value = state.value?.inputs[robot.value?.inputs.indexOf(name) ?? -1]
    return value === undefined || value === null ? '' : typeof value === 'number' ? String(Number(value.toPrecision(3))) : String(value)
  }
  const component = stateOfComponent(name)
  return (kind === 'state' ? component?.lifecycle : component?.process) ?? ''
}

interface Props {
  document: RuleDocument
  trigger: string
  take: (trigger: string) => void
}

// The robot's state comes in while one types: what is typed stays until the field is left.
function Typed(props: { label: string; class?: string; value: string; list: string; take: (entered: string) => void }) {
  const [draft, setDraft] = useState<string | null>(null)
  return (
    <input
      aria-label={props.label}
      class={props.class}
      value={draft ?? props.value}
      list={props.list}
      spellcheck={false}
      onInput={(e) => setDraft(e.currentTarget.value)}
      onChange={(e) => {
        const entered = e.currentTarget.value.trim()
        setDraft(null)
        if (entered !== '' && entered !== props.value) props.take(entered)
      }}
    />
  )
}

function ClauseForm(props: { document: RuleDocument; clause: Clause; isFirst: boolean; take: (c: Clause) => void; remove?: () => void }) {
  const { document, clause, take, remove } = props
  const { kind, name, how, value } = clause
  const now = nowOf(clause)
  const comparisons = kind === 'state' ? ['==', '!='] : Object.keys(kComparisons)
  return (
    <div class="clause">
      <b>{props.isFirst ? 'when' : 'and'}</b>
      <select
        aria-label="what is looked at"
        value={kind}
        onChange={(e) => {
          const next = e.currentTarget.value as Kind
          const isSameKind = kLists[next] === kLists[kind]
          take(usualClause(next, isSameKind ? name : firstName(next, document)))
        }}
      >
        {Object.entries(kKinds).map(([each, words]) => (
          <option value={each}>{words}</option>
        ))}
      </select>
      <Typed label="its name" value={name} list={kLists[kind]} take={(entered) => take({ ...clause, name: entered })} />
      {(kind === 'value' || kind === 'state') && (
        <select aria-label="how it compares" value={how} onChange={(e) => take({ ...clause, how: e.currentTarget.value })}>
          {comparisons.map((each) => (
            <option value={each}>{kComparisons[each]}</option>
          ))}
        </select>
      )}
      {kind === 'state' ? (
        <select aria-label="which state" value={value} onChange={(e) => take({ ...clause, value: e.currentTarget.value })}>
          {[...new Set([...kStates, value])].map((each) => (
            <option>{each}</option>
          ))}
        </select>
      ) : (
        kind !== 'dead' && (
          <Typed label="how much" class="amount" value={value} list="constants" take={(entered) => take({ ...clause, value: entered })} />
        )
      )}
      {now && <span class="muted">now {now}</span>}
      {remove && (
        <button type="button" class="remove" aria-label="Remove this condition" onClick={remove}>
          ✕
        </button>
      )}
    </div>
  )
}

export function SentenceForm({ document, trigger, take }: Props) {
  const clauses = sentenceOf(trigger)
  if (!clauses) return <p class="muted">This trigger is more than a sentence can say; it is edited as text.</p>
  const put = (place: number, ...by: Clause[]) => take(written([...clauses.slice(0, place), ...by, ...clauses.slice(place + 1)]))
  return (
    <div class="sentence" role="group" aria-label="Sentence">
      {clauses.map((clause, place) => (
        <ClauseForm
          key={place}
          {...{ document, clause }}
          isFirst={place === 0}
          take={(next) => put(place, next)}
          remove={clauses.length > 1 ? () => put(place) : undefined}
        />
      ))}
      <button type="button" onClick={() => take(written([...clauses, usualClause('dead', firstName('dead', document))]))}>
        + and …
      </button>
    </div>
  )
}
