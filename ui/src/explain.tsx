// Why: for each cause who is held responsible, what it makes fail, what was weighed and why not the others, and what
// happens next.
import { ComponentPanel } from './component_panel'
import { byTheClock, lasting, lastingSoFar, when } from './clock'
import { nowByTheClock } from './freshness'
import { search } from './graph_model'
import type { Failure, View } from './history'
import { headlineOf, healthOf, type Incident, incidentsOf, type Known, listed } from './incidents'
import { usePaced } from './paced'
import { doingOf, kSigns, type Tone } from './status'
import { blindRules, clockAt, culprits, incidents, isLive, isNothingWatched, known, live, now, robot, rulesByComponent, selected, situation, state } from './store'
import type { Candidate, Criticality, Evidence, ManagerEvent } from './types'

export const kWords: Record<Criticality, string> = {
  ERROR: 'error',
  WARNING: 'warning',
  NON_CRITICAL: 'non-critical',
}

// A finished run has only its events.
const knownIn = (view: View): Known => (view === live ? known : (c) => ({ isGone: view.situation.value.gone.has(c) }))
const incidentsIn = (view: View) =>
  view === live ? incidents.value : incidentsOf(view.situation.value.failures, () => [], knownIn(view))

const signed = (log_odds: number) => `${log_odds < 0 ? '−' : '+'}${Math.abs(log_odds).toFixed(1)}`

function EvidenceList({ evidence }: { evidence: Evidence[] }) {
  if (evidence.length === 0) return null
  return (
    <ul class="evidence">
      {evidence.map((each) => (
        <li>
          {each.text}
          {each.age_ns === undefined ? '' : `, for ${lasting(each.age_ns / 1e9)}`}{' '}
          <small title="log-odds: above 0 it speaks for this suspect">
            {each.source} {signed(each.log_odds)}
          </small>
        </li>
      ))}
    </ul>
  )
}

export function Suspects({ decision, rule }: { decision: ManagerEvent; rule: string }) {
  const suspects = decision.suspects ?? []
  if (suspects.length === 0) return null
  return (
    <table class="suspects">
      <caption>Possible causes</caption>
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

// An excluded candidate has no cost.
export const costOf = ({ cost, excluded }: { cost: number; excluded: unknown }) =>
  excluded && cost === 0 ? '–' : cost.toFixed(2)

export function Candidates({ list, chosen }: { list: Candidate[]; chosen?: string | null }) {
  if (list.length === 0) return null
  return (
    <table class="candidates">
      <caption>Possible repairs</caption>
      <thead>
        <tr>
          <th scope="col">strategy</th>
          <th scope="col">cost</th>
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

// The next step and its time: for the present only, since the past has its events.
function Next({ failure, incident }: { failure: Failure; incident: Incident }) {
  if (!isLive.value) return null
  const place = robot.value?.rules.findIndex((r) => r.name === failure.rule) ?? -1
  const rule = state.value?.rules[place]
  if (!rule) return null
  const t = now.value
  const left = (at: number | null | undefined) => (at ? Math.max(0, at - t).toFixed(1) : null)
  if (rule.attempt) {
    const { stage, strategy, deadline } = rule.attempt
    const { chosen } = rule.attempt
    if (stage === 'adapting')
      return (
        <p class="next">
          Now: {strategy} is being carried out, for {lasting(t - chosen)}.
        </p>
      )
    if (stage === 'undoing') return <p class="next">Now: what {strategy} changed is being undone.</p>
    return (
      <p class="next">
        Now: waiting for the symptom to go
        {left(deadline) && `; if it has not in ${left(deadline)} s, the next strategy is tried`}.
      </p>
    )
  }
  if (rule.settling)
    return (
      <p class="next">
        Now: it is expected to go away with {rule.settling.with}, within {left(rule.settling.until)} s.
      </p>
    )
  if (rule.retry_at) return <p class="next">Next: another round in {left(rule.retry_at)} s.</p>
  if (failure.phase === 'exhausted') return <p class="next">Nothing more will be tried: a person must look.</p>
  return <p class="next">Now: {doingOf(incident)}.</p>
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
      <Suspects decision={decision} rule={failure.rule} />
      <Candidates
        list={decision.candidates ?? []}
        chosen={decision.type === 'strategy_chosen' ? decision.strategy : null}
      />
    </details>
  )
}

// Under its cause: the reason for waiting is shown, the tables are those of the cause.
function Consequence({ failure, view }: { failure: Failure; view: View }) {
  return (
    <li class={healthOf(failure)}>
      <p>
        <span aria-hidden="true">{kSigns[healthOf(failure) as Tone]}</span> <b>{failure.rule}</b>{' '}
        <small class="muted">
          <Since {...{ failure, view }} />
        </small>
      </p>
      {failure.decision && <p class="muted">{failure.decision.text}.</p>}
      <Why failure={failure} isOpen={false} />
    </li>
  )
}

const isWide = matchMedia('(min-width: 901px)')

function IncidentCard({ incident, view }: { incident: Incident; view: View }) {
  const { root, consequences, health } = incident
  return (
    <article class={`incident ${health}`}>
      <h2>
        <span class={incident.isCertain ? 'culprit' : health} aria-hidden="true">
          {incident.isCertain ? '★' : kSigns[health as Tone]}
        </span>{' '}
        {headlineOf(incident, knownIn(view))}
      </h2>
      <p class="muted">
        {root.rule}: {kWords[root.criticality]}{root.phase === 'exhausted' ? ', given up, ' : ' '}
        
        <Since failure={root} view={view} />
      </p>
      {root.decision && <p>{root.decision.text}.</p>}
      {view === live && <Next failure={root} incident={incident} />}
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
      <Why failure={root} isOpen={isWide.matches} />
    </article>
  )
}

const kMostComponents = 60 // what one can look through; more are found by their names

function ComponentButton({ name, sign }: { name: string; sign: string }) {
  return (
    <button type="button" aria-pressed={selected.value === name} onClick={() => (selected.value = selected.value === name ? null : name)}>
      <span aria-hidden="true">{sign}</span> {name}
    </button>
  )
}

const kPeriod = 150 // ms

// The same as the graph in words, for readers that cannot see or point at it.
export function Components() {
  const signs = usePaced(() => {
    const sick = new Set(situation.value.failures.map((f) => f.rule))
    const blamed = culprits.value
    const ofRules = rulesByComponent.value
    const signOf = (name: string) => (blamed.has(name) ? '★' : ofRules.get(name)?.some((r) => sick.has(r.name)) ? '◆' : '✓')
    return (robot.value?.components ?? []).map(({ name }) => ({ name, sign: signOf(name) }))
  }, kPeriod)
  const wanted = search.value.toLowerCase()
  const found = signs.value.filter(({ name }) => name.toLowerCase().includes(wanted))
  const rest = found.slice(kMostComponents)
  const ill = rest.filter(({ sign }) => sign !== '✓').slice(0, kMostComponents)
  return (
    <section class="components" aria-label="Components">
      <h2>Components</h2>
      <ul>
        {found.slice(0, kMostComponents).map((each) => (
          <li key={each.name}>
            <ComponentButton {...each} />
          </li>
        ))}
      </ul>
      {rest.length > 0 && (
        <p class="muted others">
          and {rest.length} more, to be found by their names above the graph.{' '}
          {ill.map((each) => (
            <ComponentButton key={each.name} {...each} />
          ))}
        </p>
      )}
      {selected.value && <ComponentPanel key={selected.value} name={selected.value} />}
    </section>
  )
}

// Rules that say nothing, and why.
function BlindRules() {
  const blind = blindRules.value
  if (isNothingWatched.value && blind.length === 0) return <p class="headline">Watching nothing: there is no rule.</p>
  return (
    <>
      {blind.map((rule) => (
        <article class={`incident ${rule.criticality}`} key={rule.name}>
          <h2>{rule.name} is blind</h2>
          <p>
            {rule.text}. culprit cannot tell whether its failure is present, since {byTheClock(clockAt(rule.since), 1)}.
          </p>
        </article>
      ))}
    </>
  )
}

export function Explanation({ view }: { view: View }) {
  const wanted = view === live ? selected.value : null
  const rules = robot.value?.rules ?? []
  const isAbout = (f: Failure) => !wanted || !!rules.find((r) => r.name === f.rule)?.components.includes(wanted)
  const all = incidentsIn(view)
  const shown = all.filter((i) => [i.root, ...i.consequences].some(isAbout) || i.components.includes(wanted ?? ''))
  return (
    <section class="explanation" aria-label="Explanation">
      {view === live && !isLive.value && (
        <p class="past">
          You look at <b>{byTheClock(clockAt(view.moment.value!), 1)}</b>, {lastingSoFar(now.value - view.moment.value!)} before
          what was told last. <button type="button" onClick={() => (view.moment.value = null)}>Back to now</button>
        </p>
      )}
      {view === live && isLive.value && <BlindRules />}
      {all.length === 0 && !(view === live && isLive.value && (blindRules.value.length > 0 || isNothingWatched.value)) && (
        <p class="headline well">
          <b>✓ All is well.</b> No rule sees a failure{view.isNewest.value ? '' : ' at this moment'}.
        </p>
      )}
      {wanted && (
        <p class="muted">
          Only what concerns {wanted}.{' '}
          <button type="button" onClick={() => (selected.value = null)}>
            Show all
          </button>
        </p>
      )}
      {shown.map((incident) => (
        <IncidentCard key={incident.root.rule} {...{ incident, view }} />
      ))}
    </section>
  )
}
