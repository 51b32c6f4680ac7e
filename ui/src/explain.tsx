// Why: for each failure who is suspected, what was weighed and why not the others, and what happens
// next.
import type { Failure, View } from './history'
import { culprits, isLive, live, now, robot, rulesByComponent, selected, situation, state, stateOfComponent } from './store'
import type { Candidate, ComponentState, Criticality } from './types'

export const kSigns: Record<string, string> = {
  ERROR: '◆',
  WARNING: '▲',
  NON_CRITICAL: '○',
  EXHAUSTED: '✖',
  OK: '✓',
}

export const kWords: Record<Criticality, string> = {
  ERROR: 'error',
  WARNING: 'warning',
  NON_CRITICAL: 'non-critical',
}

const listed = (words: string[]) =>
  words.length < 2 ? words.join('') : `${words.slice(0, -1).join(', ')} and ${words[words.length - 1]}`

function Headline({ view }: { view: View }) {
  const failures = view.situation.value.failures
  if (failures.length === 0)
    return (
      <p class="headline well">
        <b>✓ All is well.</b> No rule sees a failure.
      </p>
    )
  const blamed = [...view.culprits.value.keys()]
  const exhausted = failures.filter((f) => f.phase === 'exhausted')
  return (
    <p class="headline sick">
      {blamed.length > 0 ? (
        <b>
          ★ {listed(blamed)} {blamed.length > 1 ? 'are' : 'is'} held responsible
        </b>
      ) : (
        <b>
          {failures.length} {failures.length > 1 ? 'failures' : 'failure'}, nobody is being repaired
        </b>
      )}
      {exhausted.length > 0 && (
        <>
          {' '}
          Nothing helped against {listed(exhausted.map((f) => f.rule))}: a person must look.
        </>
      )}
    </p>
  )
}

function Suspects({ failure }: { failure: Failure }) {
  const suspects = failure.decision?.suspects ?? []
  if (suspects.length === 0) return null
  return (
    <table class="suspects">
      <caption>Who may be responsible</caption>
      <tbody>
        {suspects.slice(0, 5).map((s) => (
          <tr>
            <th scope="row">{s.component}</th>
            <td class="meter">
              <meter min={0} max={1} value={s.probability} aria-label={`probability for ${s.component}`} />
            </td>
            <td class="number">{(100 * s.probability).toFixed(0)} %</td>
            <td class="muted">{s.failure === failure.rule ? '' : `by ${s.failure}`}</td>
          </tr>
        ))}
      </tbody>
    </table>
  )
}

// What makes no sense was not weighed.
export const costOf = ({ cost, excluded }: { cost: number; excluded: unknown }) =>
  excluded && cost === 0 ? '–' : cost.toFixed(2)

function Candidates({ list, chosen }: { list: Candidate[]; chosen?: string | null }) {
  if (list.length === 0) return null
  return (
    <table class="candidates">
      <caption>What could be done</caption>
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

// What happens next, and when: of the present only, for the past knows what happened.
function Next({ failure }: { failure: Failure }) {
  if (!isLive.value) return null
  const place = robot.value?.rules.findIndex((r) => r.name === failure.rule) ?? -1
  const rule = state.value?.rules[place]
  if (!rule) return null
  const t = now.value
  const left = (at: number | null | undefined) => (at ? Math.max(0, at - t).toFixed(1) : null)
  if (rule.attempt) {
    const { stage, strategy, deadline } = rule.attempt
    if (stage === 'adapting') return <p class="next">Now: {strategy} is being carried out.</p>
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
  if (rule.retry_at) return <p class="next">Next: tried anew in {left(rule.retry_at)} s.</p>
  if (failure.phase === 'exhausted') return <p class="next">Nothing more will be tried.</p>
  return <p class="next">Now: it waits.</p>
}

function FailureCard({ failure, view }: { failure: Failure; view: View }) {
  const decision = failure.decision
  const since = (view.moment.value ?? view.newest.value) - failure.since
  return (
    <article class={`failure ${failure.criticality}`}>
      <h3>
        <span aria-hidden="true">{kSigns[failure.phase === 'exhausted' ? 'EXHAUSTED' : failure.criticality]}</span>{' '}
        {failure.rule}{' '}
        <small>
          {kWords[failure.criticality]}, for {Math.max(0, since).toFixed(1)} s
        </small>
      </h3>
      {decision && <p>{decision.text}.</p>}
      {view === live && <Next failure={failure} />}
      <Suspects failure={failure} />
      <Candidates
        list={decision?.candidates ?? []}
        chosen={decision?.type === 'strategy_chosen' ? decision.strategy : null}
      />
    </article>
  )
}

function describeComponent(known: ComponentState | undefined): string {
  if (!known) return 'unknown'
  const parts = [known.alive === null ? 'not seen yet' : known.alive ? 'alive' : 'not alive']
  if (known.lifecycle) parts.push(known.lifecycle)
  if (known.adapting) parts.push(`being adapted (${known.adapting})`)
  if (known.remark) parts.push(known.remark)
  return parts.join(', ')
}

// The same as the graph in words, for whoever cannot see or point at it.
export function Components() {
  const sick = new Set(situation.value.failures.map((f) => f.rule))
  return (
    <section class="components" aria-label="Components">
      <h2>Components</h2>
      <ul>
        {(robot.value?.components ?? []).map((c) => {
          const rules = rulesByComponent.value.get(c.name) ?? []
          const failing = rules.filter((r) => sick.has(r.name))
          const sign = culprits.value.has(c.name) ? '★' : failing.length > 0 ? '◆' : '✓'
          return (
            <li>
              <button
                type="button"
                aria-pressed={selected.value === c.name}
                onClick={() => (selected.value = selected.value === c.name ? null : c.name)}
              >
                <span aria-hidden="true">{sign}</span> {c.name}
              </button>
              {selected.value === c.name && (
                <div class="details">
                  <p>{isLive.value ? describeComponent(stateOfComponent(c.name)) : 'its state is shown live only'}</p>
                  <p>
                    Rules about it: {listed(rules.map((r) => r.name)) || 'none'}
                    {failing.length > 0 && `; failing: ${listed(failing.map((r) => r.name))}`}.
                  </p>
                </div>
              )}
            </li>
          )
        })}
      </ul>
    </section>
  )
}

export function Explanation({ view }: { view: View }) {
  const wanted = view === live ? selected.value : null
  const rules = robot.value?.rules ?? []
  const failures = view.situation.value.failures.filter(
    (f) => !wanted || rules.find((r) => r.name === f.rule)?.components.includes(wanted)
  )
  return (
    <section class="explanation" aria-label="Explanation">
      <div aria-live="polite">
        <Headline view={view} />
      </div>
      {wanted && (
        <p class="muted">
          Only what concerns {wanted}.{' '}
          <button type="button" onClick={() => (selected.value = null)}>
            Show all
          </button>
        </p>
      )}
      {failures.map((failure) => (
        <FailureCard key={failure.rule} failure={failure} view={view} />
      ))}
    </section>
  )
}
