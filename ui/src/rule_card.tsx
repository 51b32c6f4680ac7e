// A rule of the form: its policies, its trigger, its strategies and their adaptations.
import { useState } from 'preact/hooks'
import { namesOf } from './declarations'
import { Check, Choice, Field, type Props, Remove } from './form_fields'
import { HindsightOfRule } from './hindsight'
import { names, ownName } from './live_names'
import {
  componentOf,
  endOf,
  freeName,
  kAdaptations,
  kOptional,
  newAdaptation,
  newStrategy,
  replaced,
  type RuleDocument,
  type Statement,
  withMember,
} from './rule_document'
import { SentenceForm } from './sentence_form'
import { graph } from './store'

// The names to offer for a member of an adaptation of `component`.
const listOf = (member: string, component: string) =>
  ({ topic: 'topics', service: 'services', parameter: `parameters of ${component}` })[member]

// A strategy begins with no THEN.
function withoutAdaptation(document: RuleDocument, place: number, isFirst: boolean): RuleDocument {
  const isNext = document.statements[place + 1]?.statement === 'ADAPTATION'
  return replaced(isFirst && isNext ? withMember(document, place + 1, 'then', undefined) : document, place, 1)
}

function AdaptationForm({ document, change, place, isFirst }: Props & { place: number; isFirst: boolean }) {
  const statement = document.statements[place]
  const type = String(statement.type)
  const field = (member: string) => (
    <Field {...{ document, change, place, member }} label={member} optional={kOptional.includes(member)} list={listOf(member, String(statement.component))} />
  )
  return (
    <div class="adaptation" role="group" aria-label="Adaptation">
      {!isFirst && <Check {...{ document, change, place }} member="then" label="then" />}
      <Field {...{ document, change, place }} member="component" label="component" list="components" />
      <Choice
        label="type"
        value={type}
        of={Object.keys(kAdaptations)}
        take={(t) => change((d) => replaced(d, place, 1, newAdaptation(t, statement)))}
      />
      {(kAdaptations[type] ?? []).map(field)}
      <Field {...{ document, change, place }} member="impact" label="impact" kind="number" />
      <Remove what="adaptation" onClick={() => change((d) => withoutAdaptation(d, place, isFirst))} />
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
        <Check {...props} member="last_resort" label="as a last resort" without="within" />
        {document.statements[place].last_resort && <Field {...props} member="within" label="within (2s)" optional />}
        <Remove what={`strategy ${name}`} onClick={() => change((d) => replaced(d, place, end - place))} />
      </div>
      {adaptations.map((i) => (
        <AdaptationForm key={i} {...{ document, change }} place={i} isFirst={i === adaptations[0]} />
      ))}
      <button type="button" onClick={() => change((d) => replaced(d, end, 0, newAdaptation('set_parameter', { statement: 'ADAPTATION', component: componentOf(d, place) })))}>
        + Adaptation
      </button>
    </fieldset>
  )
}

// A rule that only reports has no strategies: it loses them, and gets one again.
function OnlyReports({ document, change, place, policies }: Props & { place: number; policies: number }) {
  const report = (d: RuleDocument, isOn: boolean) => {
    const end = endOf(d, place)
    const changed = withMember(d, policies, 'report', isOn || undefined)
    if (!isOn) return replaced(changed, end, 0, ...newStrategy(freeName(d, 'STRATEGY', 'strategy'), usualComponent(d)))
    const first = d.statements.findIndex((s, i) => i > place && i < end && s.statement === 'STRATEGY')
    return first < 0 ? changed : replaced(changed, first, end - first)
  }
  return (
    <label class="check">
      <input
        type="checkbox"
        checked={document.statements[policies].report === true}
        onChange={(e) => {
          const isOn = e.currentTarget.checked
          void change((d) => report(d, isOn))
        }}
      />{' '}
      only report
    </label>
  )
}

// `isTemplate`: it stands in a template, where nothing of it has run.
export function RuleCard({ document, change, place, isTemplate = false }: Props & { place: number; isTemplate?: boolean }) {
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
              of={['NON_CRITICAL', 'WARNING', 'ERROR', 'OK', 'DEGRADED', 'FAILURE']}
              take={(c) => change((d) => withMember(d, policies, 'criticality', c))}
            />
            <Field {...props} place={policies} member="for" label="for" optional />
            <Field {...props} place={policies} member="hold" label="hold n/k" kind="hold" optional />
            <Field {...props} place={policies} member="cooldown" label="cooldown" optional />
            <Field {...props} place={policies} member="attempts" label="attempts" kind="number" optional />
            <Check {...props} place={policies} member="on_change" label="on change" />
            <OnlyReports {...props} place={place} policies={policies} />
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
      {!isTemplate && <HindsightOfRule name={name} />}
      {within
        .filter(([s]) => s.statement === 'STRATEGY')
        .map(([, i]) => (
          <StrategyForm key={i} {...props} place={i} />
        ))}
      {(policies === undefined || document.statements[policies].report !== true) && (
        <button
          type="button"
          onClick={() => change((d) => replaced(d, end, 0, ...newStrategy(freeName(d, 'STRATEGY', 'strategy'), componentOf(d, place))))}
        >
          + Strategy
        </button>
      )}
    </details>
  )
}

// One that no rule is about yet, if there is one: of the file, or else of the robot.
export function usualComponent(document: RuleDocument): string {
  const declared = namesOf(document, 'COMPONENT')
  const live = graph.value.nodes.map((n) => n.component ?? ownName(n.node))
  const used = new Set(document.statements.filter((s) => s.statement === 'ADAPTATION').map((s) => String(s.component)))
  const known = [...declared, ...live, ...Object.keys(names.value.nodes).map(ownName)]
  return known.find((c) => !used.has(c)) ?? known[0] ?? 'my_node'
}
