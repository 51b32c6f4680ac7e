// A trigger as a sentence, for people who do not write programs: what is looked at, how much of it is too much, and what
// it is now.
import { useState } from 'preact/hooks'
import { lasting } from './clock'
import { namesOf } from './declarations'
import { names, ownName } from './live_names'
import type { RuleDocument } from './rule_document'
import { type Clause, kCompared, kComparisons, kKinds, type Kind, kWindows, sentenceOf, type Sentence, usualClause, written } from './sentence'
import { isSketched, Sketch } from './sketch'
import { graph, robot, state, stateOfComponent, stateOfTopic } from './store'

const kStates = ['unconfigured', 'inactive', 'active', 'finalized']
type About = 'topics' | 'components' | 'signals' | 'diagnostics' | 'actions' | ''
const kAbout: Record<Kind, About> = {
  silent: 'topics', slow: 'topics', odd: 'topics', dead: 'components', state: 'components', parameter: 'components', level: 'diagnostics',
  value: 'signals', mean: 'signals', least: 'signals', most: 'signals', spread: 'signals', frozen: 'signals', changed: 'signals', goals: 'actions', goalAge: 'actions', logs: 'components', cpu: 'components', memory: 'components', text: '',
}
const kStandIns: Record<About, string> = { topics: '/topic', components: 'my_node', signals: 'my_signal', diagnostics: 'my_status', actions: '/my_action', '': '' }

// The first that there is of what a clause of this kind is about.
function firstName(kind: Kind, document: RuleDocument): string {
  const components = [...namesOf(document, 'COMPONENT'), ...graph.value.nodes.map((n) => n.component ?? ownName(n.node))]
  const topics = [...(robot.value?.topics ?? []), ...names.value.topics]
  const about = kAbout[kind]
  const all = { topics, components, signals: namesOf(document, 'SIGNAL'), diagnostics: [], actions: [], '': [] }[about]
  return all[0] ?? kStandIns[about]
}

// Its current value, if the live robot has it.
function nowOf({ kind, name, second }: Clause): string {
  if (kAbout[kind] === 'topics') {
    const topic = stateOfTopic(name.split(' ')[0])
    if (!topic || topic.rate === null) return ''
    return kind === 'slow' ? `${topic.rate.toFixed(1)} Hz` : topic.age === null ? '' : lasting(topic.age)
  }
  if (kind === 'dead' || kind === 'state') {
    const component = stateOfComponent(name)
    return (kind === 'state' ? component?.lifecycle : component?.process) ?? ''
  }
  const input = kind === 'parameter' ? `parameter(${name}, ${second})` : kind === 'level' || kind === 'cpu' || kind === 'memory' ? `${kind}(${name})` : kind === 'frozen' ? `frozen(${name}, ${second})` : name
  const value = state.value?.inputs[robot.value?.inputs.indexOf(input) ?? -1]
  return value === undefined || value === null ? '' : typeof value === 'number' ? String(Number(value.toPrecision(3))) : String(value)
}

interface Props {
  document: RuleDocument
  trigger: string
  take: (trigger: string) => void
}

// The robot's state comes in while one types: what is typed stays until the field is left.
function Typed(props: { label: string; class?: string; value: string; list?: string; take: (entered: string) => void }) {
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

const constantOf = (name: string, document: RuleDocument) =>
  document.statements.find((s) => s.statement === 'CONST' && s.name === name)?.value as string | undefined

interface ClauseProps {
  document: RuleDocument
  clause: Clause
  word: string // in front of it
  take: (c: Clause) => void
  remove?: () => void
}

function ClauseForm({ document, clause, word, take, remove }: ClauseProps) {
  const { kind, name, how, value, second } = clause
  const now = nowOf(clause)
  const about = kAbout[kind]
  return (
    <div class="clause">
      <b>{word}</b>
      <select
        aria-label="what is looked at"
        value={kind}
        onChange={(e) => {
          const next = e.currentTarget.value as Kind
          take(usualClause(next, kAbout[next] === about && name ? name : firstName(next, document)))
        }}
      >
        {Object.entries(kKinds).map(([each, words]) => (
          <option value={each}>{words}</option>
        ))}
      </select>
      {kWindows.includes(kind) && <Typed label={kind === 'goals' ? 'how they ended, in how long' : kind === 'logs' ? 'from which level on, in how long' : 'over how long'} class="amount" value={second} take={(entered) => take({ ...clause, second: entered })} />}
      {about !== '' && <Typed label="its name" value={name} list={about} take={(entered) => take({ ...clause, name: entered })} />}
      {kind === 'parameter' && (
        <Typed label="which parameter" value={second} list={`parameters of ${name}`} take={(entered) => take({ ...clause, second: entered })} />
      )}
      {kCompared.includes(kind) && (
        <select aria-label="how it compares" value={how} onChange={(e) => take({ ...clause, how: e.currentTarget.value })}>
          {(kind === 'state' ? ['==', '!='] : Object.keys(kComparisons)).map((each) => (
            <option value={each}>{kComparisons[each]}</option>
          ))}
        </select>
      )}
      {kind === 'state' && (
        <select aria-label="which state" value={value} onChange={(e) => take({ ...clause, value: e.currentTarget.value })}>
          {[...new Set([...kStates, value])].map((each) => (
            <option>{each}</option>
          ))}
        </select>
      )}
      {kind !== 'state' && kind !== 'dead' && kind !== 'changed' && kind !== 'frozen' && (
        <Typed
          label={kind === 'text' ? 'the expression' : 'how much'}
          class={kind === 'text' ? '' : 'amount'}
          value={value}
          list={kind === 'text' ? undefined : 'constants'}
          take={(entered) => take({ ...clause, value: entered })}
        />
      )}
      {now && <span class="muted">now {now}</span>}
      {remove && (
        <button type="button" class="remove" aria-label="Remove this condition" onClick={remove}>
          ✕
        </button>
      )}
      {robot.value && isSketched(clause) && !name.startsWith('{') && <Sketch clause={clause} constant={constantOf(value, document)} take={(next) => take({ ...clause, value: next })} />}
    </div>
  )
}

const kBetween: Record<Sentence['between'], [string, string]> = { '&&': ['all of these hold', 'and'], '||': ['any of these holds', 'or'] }

export function SentenceForm({ document, trigger, take }: Props) {
  const sentence = sentenceOf(trigger)
  const { between, clauses } = sentence
  const say = (all: Clause[], by = between) => take(written({ between: by, clauses: all }))
  return (
    <div class="sentence" role="group" aria-label="Sentence">
      {clauses.map((clause, place) => (
        <ClauseForm
          key={place}
          {...{ document, clause }}
          word={place === 0 ? 'when' : kBetween[between][1]}
          take={(next) => say(clauses.map((c, i) => (i === place ? next : c)))}
          remove={clauses.length > 1 ? () => say(clauses.filter((_, i) => i !== place)) : undefined}
        />
      ))}
      <div class="bar">
        <button type="button" onClick={() => say([...clauses, usualClause('dead', firstName('dead', document))])}>
          + condition
        </button>
        {clauses.length > 1 && (
          <select aria-label="how many have to hold" value={between} onChange={(e) => say(clauses, e.currentTarget.value as Sentence['between'])}>
            {Object.entries(kBetween).map(([each, [words]]) => (
              <option value={each}>{words}</option>
            ))}
          </select>
        )}
      </div>
    </div>
  )
}
