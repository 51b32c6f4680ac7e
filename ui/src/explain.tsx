// Why: for each cause who is held responsible, what it makes fail, what was weighed and why not the others, and what
// happens next.
import { type Signal, signal, untracked } from '@preact/signals'
import { ComponentPanel } from './component_panel'
import { byTheClock, lasting, lastingSoFar, when } from './clock'
import { isOld, nowByTheClock } from './freshness'
import { Term } from './glossary'
import { search } from './graph_model'
import { type Failure, healthOf, type View } from './history'
import { type Incident, listed } from './incidents'
import { usePaced } from './paced'
import { type Range, signalOf, toAddress } from './plotted'
import { isIll, kLooks, type Look, rankOf } from './looks'
import { capital } from './status'
import { blindRules, can, clockAt, conditionAt, culprits, graph, isLive, live, looks, now, robot, selected, state, verdict } from './store'
import type { Candidate, Criticality, Evidence, ManagerEvent } from './types'

export const kWords: Record<Criticality, string> = {
  ERROR: 'error',
  WARNING: 'warning',
  NON_CRITICAL: 'non-critical',
}

const kNanosecond = 1e-9 // s
const signed = (log_odds: number) => `${log_odds < 0 ? '−' : '+'}${Math.abs(log_odds).toFixed(1)}`

// An answer to a question of culprit's. It has a list of its own, since it is no onset and has no weight.
const isAnswer = ({ source }: Evidence) => source === 'answer'

function EvidenceList({ evidence }: { evidence: Evidence[] }) {
  const weighed = evidence.filter((each) => !isAnswer(each))
  if (weighed.length === 0) return null
  return (
    <ul class="evidence">
      {weighed.map((each) => (
        <li>
          {each.text}
          {each.age_ns ? `, for ${lasting(each.age_ns / 1e9)}` : ''}{' '}
          <small title="log-odds: above 0 for this suspect, below 0 against it">
            {each.source} {signed(each.log_odds)}
          </small>
        </li>
      ))}
    </ul>
  )
}

function Answers({ decision }: { decision: ManagerEvent }) {
  const answers = (decision.suspects ?? []).flatMap(({ evidence }) => (evidence ?? []).filter(isAnswer))
  if (answers.length === 0) return null
  return (
    <>
      <h3>Asked and answered</h3>
      <ul class="evidence">
        {answers.map(({ text, age_ns }) => (
          <li>
            {text}, {lasting((age_ns ?? 0) * kNanosecond)} before the decision
          </li>
        ))}
      </ul>
    </>
  )
}

// As culprit computed it with the decision.
function WhatWouldChange({ decision }: { decision: ManagerEvent }) {
  const hinges = (decision.suspects ?? []).flatMap(({ evidence }) => (evidence ?? []).filter((each) => each.without))
  const ends = new Set((decision.candidates ?? []).flatMap(({ excluded }) => (excluded?.ends ? [excluded.ends] : [])))
  if (hinges.length === 0 && ends.size === 0) return null
  return (
    <>
      <h3>What would change this</h3>
      <ul class="evidence">
        {hinges.map(({ text, without }) => (
          <li>
            Without “{text}”, <b>{without}</b> would be held responsible.
          </li>
        ))}
        {[...ends].map((end) => (
          <li>{sentence(end)}</li>
        ))}
      </ul>
    </>
  )
}

function Suspects({ decision, rule }: { decision: ManagerEvent; rule: string }) {
  const suspects = decision.suspects ?? []
  if (suspects.length === 0) return null
  return (
    <table class="suspects">
      <caption>
        <Term word="root cause">Possible causes</Term> <small class="muted">(log-odds)</small>
      </caption>
      <tbody>
        {suspects.slice(0, 5).map((s) => (
          <tr>
            <th scope="row">{s.component}</th>
            <td class="meter">
              <meter min={0} max={1} value={s.probability} aria-label={`probability for ${s.component}`} />
            </td>
            <td class="number">{(100 * s.probability).toFixed(0)} %</td>
            <td class="muted">
              {s.failure === rule ? '' : `by ${s.failure}`}
              <EvidenceList evidence={s.evidence ?? []} />
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  )
}

export const kCostUnit = 'Expected effort, relative to the slowest strategy of the rules: no unit. Of the paper’s planner: 0 to 2.'

// Causes begin before their effects: what began when, of all suspects on one axis that ends with the decision.
function Onsets({ decision }: { decision: ManagerEvent }) {
  const onsets = (decision.suspects ?? [])
    .flatMap(({ component, evidence }) =>
      (evidence ?? []).flatMap((each) => (each.age_ns === undefined || isAnswer(each) ? [] : [{ component, text: each.text, age: each.age_ns * kNanosecond, isFor: each.log_odds >= 0 }]))
    )
    .sort((a, b) => b.age - a.age)
  if (onsets.length < 2) return null
  const longest = Math.max(onsets[0].age, kNanosecond)
  const at = (age: number) => `${2 + 96 * (1 - age / longest)}%`
  return (
    <details class="why">
      <summary>What began first, until the decision at {byTheClock(decision.clock ?? clockAt(decision.t), 2)}</summary>
      <table class="onsets">
        <tbody>
          {onsets.map(({ component, text, age, isFor }) => (
            <tr>
              <th scope="row">
                {component}: <small>{text}</small>
              </th>
              <td class="axis">
                <svg width="100%" height="16" aria-hidden="true">
                  <line x1={at(age)} x2={at(0)} y1="8" y2="8" />
                  <circle cx={at(age)} cy="8" r="4" class={isFor ? 'for' : 'against'} />
                </svg>
              </td>
              <td class="number">{lasting(age)} before</td>
            </tr>
          ))}
        </tbody>
      </table>
      <p class="muted">Hollow: evidence against the suspect.</p>
    </details>
  )
}

// An excluded candidate has no cost.
export const costOf = ({ cost, excluded }: { cost: number; excluded: unknown }) =>
  excluded && cost === 0 ? '–' : cost.toFixed(2)

function Candidates({ list, chosen }: { list: Candidate[]; chosen?: string | null }) {
  if (list.length === 0) return null
  return (
    <table class="candidates">
      <caption>
        <Term word="candidate">Possible repairs</Term>
      </caption>
      <thead>
        <tr>
          <th scope="col">strategy</th>
          <th scope="col" title={kCostUnit}>
            relative <Term>cost</Term>
          </th>
          <th scope="col">why, or why not</th>
        </tr>
      </thead>
      <tbody>
        {list.map((c) => (
          <tr class={c.strategy === chosen ? 'chosen' : ''}>
            <th scope="row">{c.strategy}</th>
            <td class="number">{costOf(c)}</td>
            <td>{c.excluded ? c.excluded.text : <b>chosen</b>}</td>
          </tr>
        ))}
      </tbody>
    </table>
  )
}

// All that a decision rests on.
export function Reasons({ decision }: { decision: ManagerEvent }) {
  return (
    <>
      <Suspects decision={decision} rule={decision.rule!} />
      <Answers decision={decision} />
      <WhatWouldChange decision={decision} />
      <Onsets decision={decision} />
      <Candidates list={decision.candidates ?? []} chosen={decision.type === 'strategy_chosen' ? decision.strategy : null} />
    </>
  )
}

// The current action and the next one: for the present only, since the past has its events.
const kSaidByNext = ['approval_asked', 'action_held_back'] // events
function Next({ incident }: { incident: Incident }) {
  const { doing, next } = incident
  if (!isLive.value || !doing) return null
  return <p class="next">{sentence(next ? `${doing}; ${next}` : doing)}</p>
}

// By the clock; of a run that is over, by its own time.
function Since({ failure, view }: { failure: Failure; view: View }) {
  if (view !== live)
    return <>at {failure.since.toFixed(1)} s, for {lasting((view.moment.value ?? view.newest.value) - failure.since)}</>
  const since = failure.sinceClock ?? clockAt(failure.since)
  const until = isLive.value ? nowByTheClock() : clockAt(view.moment.value!)
  return <>since {when(since)}, for {lastingSoFar(until - since)}</>
}

function Why({ failure, isOpen }: { failure: Failure; isOpen: boolean }) {
  const decision = failure.decision
  if (!decision?.suspects?.length && !decision?.candidates?.length) return null
  return (
    <details class="why" open={isOpen}>
      <summary>Possible causes and repairs</summary>
      <Reasons decision={decision} />
    </details>
  )
}

// Under its cause: the reason for waiting is shown, the tables are those of the cause.
function Consequence({ failure, view }: { failure: Failure; view: View }) {
  return (
    <li class={healthOf(failure)}>
      <p>
        <span aria-hidden="true">{kLooks[healthOf(failure)].sign}</span> <b>{failure.rule}</b>{' '}
        <small class="muted">
          <Since {...{ failure, view }} />
        </small>
      </p>
      {failure.decision?.text && <p class="muted">{failure.decision.text}.</p>}
      <Why failure={failure} isOpen={false} />
    </li>
  )
}

const kPlotted = 300 // s, at least
const kBefore = 60 // s, of the time before an incident

// To the plot of what its rules read.
export function PlotLink({ rules, range }: { rules: string[]; range: Range }) {
  if (!can('get', '/api/series')) return null
  const inputs = robot.value?.inputs ?? []
  const read = new Set((robot.value?.rules ?? []).filter((r) => rules.includes(r.name)).flatMap((r) => r.inputs))
  const names = [...read].map((place) => signalOf(inputs[place]))
  if (names.length === 0) return null
  return (
    <p>
      <a href={toAddress(names, range)}>Plot what these rules read</a>
    </p>
  )
}

// The time back to a while before it began.
const sinceBefore = (incident: Incident) => Math.max(kPlotted, Math.ceil((untracked(nowByTheClock) - clockAt(incident.since) + kBefore) / kBefore) * kBefore)

const isWide = matchMedia('(min-width: 901px)')

function IncidentCard({ incident, view }: { incident: Incident; view: View }) {
  const { health } = incident
  const failures = view.situation.value.failures
  const root = failures.find((f) => f.rule === incident.rule)
  const consequences = failures.filter((f) => incident.consequences.includes(f.rule))
  return (
    <article class={`incident ${health}`} data-incident={incident.id}>
      <h2>
        <span class={incident.certain ? 'culprit' : health} aria-hidden="true">
          {incident.certain ? '★' : kLooks[health].sign}
        </span>{' '}
        {incident.headline}
      </h2>
      {root && (
        <p class="muted">
          {root.rule}: {kWords[root.criticality]}
          {root.phase === 'exhausted' ? ', exhausted, ' : ' '}
          <Since failure={root} view={view} />
          {can('get', '/api/incidents') && view === live && (
            <>
              , <Term>incident</Term> <a href={`#incidents/${incident.id}`}>{incident.id}</a>
            </>
          )}
        </p>
      )}
      {root?.decision?.text && !(isLive.value && kSaidByNext.includes(root.decision.type)) && <p>{root.decision.text}.</p>}
      {view === live && <Next incident={incident} />}
      {view === live && <PlotLink rules={[incident.rule, ...incident.consequences]} range={{ last: sinceBefore(incident) }} />}
      {consequences.length > 0 && (
        <details class="consequences">
          <summary>
            → {consequences.length === 1 ? 'one consequence' : `${consequences.length} consequences`}:{' '}
            {listed(consequences.map((f) => f.rule))}
          </summary>
          <ul>
            {consequences.map((failure) => (
              <Consequence key={failure.rule} {...{ failure, view }} />
            ))}
          </ul>
        </details>
      )}
      {root && <Why failure={root} isOpen={isWide.matches} />}
    </article>
  )
}

const kFewComponents = 10 // need no filter
const kMostComponents = 60 // what one can look through; more are found by their names

interface Entry {
  name: string
  host: string
  space: string // its namespace
  look: Look
  condition: string
  isBlamed: boolean
}

function ComponentButton({ name, look, condition, isBlamed }: Entry) {
  return (
    <button
      type="button"
      class={`look-${look}`}
      aria-pressed={selected.value === name}
      title={condition || kLooks[look].word}
      onClick={() => (selected.value = selected.value === name ? null : name)}
    >
      <span aria-hidden="true">{isBlamed ? '★' : kLooks[look].sign}</span> {name}
      {condition && <small> {condition}</small>}
    </button>
  )
}

const kPeriod = 150 // ms

const kLevels: Record<string, (look: Look) => boolean> = {
  'all levels': () => true,
  'failing or down': isIll,
  'not judged': (look) => !isIll(look) && look !== 'OK',
  well: (look) => look === 'OK',
}
const level = signal('all levels')
const host = signal('')
const space = signal('')

// Offered where there is something to choose.
function Filter({ label, chosen, all, every }: { label: string; chosen: Signal<string>; all: string[]; every: string }) {
  if (all.length < 2 && !chosen.value) return null
  return (
    <select aria-label={label} value={chosen.value} onChange={(e) => (chosen.value = e.currentTarget.value)}>
      <option value="">{every}</option>
      {[...new Set([...all, ...(chosen.value ? [chosen.value] : [])])].sort().map((each) => (
        <option>{each}</option>
      ))}
    </select>
  )
}

// The same as the graph in words, for readers that cannot see or point at it. The worst come first.
export function Components() {
  const entries = usePaced(() => {
    const blamed = culprits.value
    const nodes = new Map(graph.value.nodes.map((n) => [n.component, n.node]))
    const all = (robot.value?.components ?? []).map(({ name, node, host: own }, place): Entry => {
      const full = nodes.get(name) ?? node ?? ''
      const on = state.value?.components[place]?.host ?? own ?? 'this host'
      return { name, host: on, space: full.slice(0, full.lastIndexOf('/')) || '/', look: looks.value.get(name) ?? 'UNTOLD', condition: conditionAt(name), isBlamed: blamed.has(name) }
    })
    return all.sort((a, b) => Number(b.isBlamed) - Number(a.isBlamed) || rankOf(a.look) - rankOf(b.look))
  }, kPeriod, () => verdict.value)
  const wanted = search.value.toLowerCase()
  const isFiltered = entries.value.length > kFewComponents // a filter that is not shown hides nothing
  const passes = (e: Entry) => kLevels[level.value](e.look) && (!host.value || e.host === host.value) && (!space.value || e.space === space.value)
  const found = entries.value.filter((e) => e.name.toLowerCase().includes(wanted) && (!isFiltered || passes(e)))
  const differ = (of: (entry: Entry) => string) => [...new Set(entries.value.map(of))]
  const rest = found.slice(kMostComponents)
  return (
    <section class="components" aria-label="Components">
      <h2>
        <Term word="component">Components</Term>
      </h2>
      {isFiltered && (
        <div class="bar filters" role="group" aria-label="Filter the components">
          <select aria-label="Level" value={level.value} onChange={(e) => (level.value = e.currentTarget.value)}>
            {Object.keys(kLevels).map((each) => (
              <option>{each}</option>
            ))}
          </select>
          <Filter label="Namespace" chosen={space} all={differ((e) => e.space)} every="all namespaces" />
          <Filter label="Host" chosen={host} all={differ((e) => e.host)} every="all hosts" />
          <span class="muted" role="status">
            {found.length} of {entries.value.length}
          </span>
        </div>
      )}
      <ul>
        {found.slice(0, kMostComponents).map((each) => (
          <li key={each.name}>
            <ComponentButton {...each} />
          </li>
        ))}
      </ul>
      {found.length === 0 && entries.value.length > 0 && <p class="muted">No component matches.</p>}
      {rest.length > 0 && <p class="muted others">and {rest.length} more; find them by name above the graph.</p>}
      {selected.value && <ComponentPanel key={selected.value} name={selected.value} />}
    </section>
  )
}

// Rules that say nothing, and why.
function BlindRules() {
  return (
    <>
      {blindRules.value.map((rule) => (
        <article class={`incident ${rule.criticality}`} key={rule.name}>
          <h2>
            {rule.name} is <Term>blind</Term>
          </h2>
          <p>
            {sentence(rule.text)} Since {byTheClock(clockAt(rule.since), 1)}, culprit cannot tell whether its failure is present.
          </p>
        </article>
      ))}
    </>
  )
}

const sentence = (text: string) => capital(text) + (/[.?!]$/.test(text) ? '' : '.')

// Only events are known about another moment, and no alarm is not health.
function NoFailureThen({ view }: { view: View }) {
  const blind = [...view.situation.value.blind]
  return (
    <p class="headline look-UNTOLD">
      <b>No rule sees a failure{view.isNewest.value ? '' : ' at this moment'}.</b>
      {blind.length > 0 && ` ${listed(blind)} ${blind.length === 1 ? 'is' : 'are'} blind.`}
    </p>
  )
}

// Where nothing has failed: how the robot is, as culprit says it.
function NoIncident({ view }: { view: View }) {
  if (view !== live || !isLive.value) return <NoFailureThen view={view} />
  if (!state.value) return <p class="headline look-UNTOLD">… Asking culprit how the robot is.</p>
  const { look, headline, detail } = state.value.overview
  return (
    <p class={`headline look-${look} ${look === 'OK' ? 'well' : ''}`}>
      <b>
        {kLooks[look].sign} {sentence(isOld.value ? `It was: ${headline}` : headline)}
      </b>{' '}
      {blindRules.value.length === 0 && sentence(detail)}
    </p>
  )
}

export function Explanation({ view }: { view: View }) {
  const wanted = view === live ? selected.value : null
  const rules = robot.value?.rules ?? []
  const isAbout = (rule: string) => !wanted || !!rules.find((r) => r.name === rule)?.components.includes(wanted)
  const all = view.situation.value.incidents
  const shown = all.filter((i) => [i.rule, ...i.consequences].some(isAbout) || i.components.includes(wanted ?? ''))
  return (
    <section class="explanation" aria-label="Explanation">
      {view === live && !isLive.value && (
        <p class="past">
          You see the robot at <b>{byTheClock(clockAt(view.moment.value!), 1)}</b>, {lastingSoFar(now.value - view.moment.value!)} before
          the latest data. <button type="button" onClick={() => (view.moment.value = null)}>Back to now</button>
        </p>
      )}
      {all.length === 0 && <NoIncident view={view} />}
      {wanted && (
        <p class="muted">
          Only incidents of {wanted}.{' '}
          <button type="button" onClick={() => (selected.value = null)}>
            Show all
          </button>
        </p>
      )}
      {shown.map((incident) => (
        <IncidentCard key={incident.id} {...{ incident, view }} />
      ))}
      {view === live && isLive.value && <BlindRules />}
    </section>
  )
}
