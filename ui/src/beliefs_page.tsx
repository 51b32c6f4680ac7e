// The belief in each strategy: how often it helps, prior and posterior.
import { useMemo, useState } from 'preact/hooks'
import type uPlot from 'uplot'
import { call } from './api'
import { beta, density } from './beta'
import { when } from './clock'
import { download } from './download'
import { act } from './notices'
import { order, canOrder } from './order'
import { axisLook, type Options, Plotter } from './plotter'
import { can, clockAt, events, robot, state } from './store'
import { colour } from './theme'
import type { ManagerEvent, Strategy } from './types'

interface Entry {
  rule: string
  strategy: Strategy
  belief: [number, number]
  began: [number, number] // before anything was counted: as the rules say, or a fleet learned
}

// Beliefs come by strategy in the order of the rule set, which is that of the rules.
function entries(): Entry[] {
  const list: Entry[] = []
  let place = 0
  for (const rule of robot.value?.rules ?? []) {
    for (const strategy of rule.strategies) {
      list.push({
        rule: rule.name,
        strategy,
        belief: state.value?.beliefs[place] ?? strategy.prior,
        began: state.value?.priors[place] ?? strategy.prior,
      })
      ++place
    }
  }
  return list
}

const kGrid = Array.from({ length: 201 }, (_, i) => i / 200)

const densityOptions = (): Options => ({
  scales: { x: { time: false } },
  axes: [
    { ...axisLook(), label: 'success rate' },
    { ...axisLook(), label: 'density' },
  ],
  series: [
    { label: 'success' },
    { label: 'prior of the rules', stroke: colour('muted'), dash: [6, 4], width: 2 },
    { label: 'learned', stroke: colour('accent'), width: 2 },
  ],
})

function Density({ entry }: { entry: Entry }) {
  const { prior } = entry.strategy
  const [a, b] = entry.belief
  const data = useMemo((): uPlot.AlignedData => [kGrid, kGrid.map((p) => density(p, prior[0], prior[1])), kGrid.map((p) => density(p, a, b))], [prior, a, b])
  return (
    <figure>
      <figcaption>
        {entry.rule}.{entry.strategy.name}: {entry.strategy.actions.join(', ')}
      </figcaption>
      <Plotter label={`Belief in ${entry.strategy.name}`} height={300} most={640} make={densityOptions} remake="" data={data} />
    </figure>
  )
}

// The credible interval as a bar, the mean as a line, the prior of the rules as a ring.
function Interval({ low, high, now, prior }: { low: number; high: number; now: number; prior: number }) {
  const x = (p: number) => `${2 + 96 * p}%`
  return (
    <svg class="interval" width="100%" height="18" aria-hidden="true">
      <line x1={x(0)} x2={x(1)} y1="9" y2="9" class="track" />
      <rect x={x(low)} width={`${96 * (high - low)}%`} y="4" height="10" rx="3" />
      <line x1={x(now)} x2={x(now)} y1="1" y2="17" class="now" />
      <circle cx={x(prior)} cy="9" r="4" />
    </svg>
  )
}

const kOutcomes: Record<string, string> = {
  failure_resolved: '✓ helped',
  strategy_failed: '✕ did not help',
  adaptation_failed: '✕ could not be carried out',
  strategy_abandoned: '– was abandoned; not counted',
}
const kMostOutcomes = 50

// The outcome of each attempt, newest first.
function Outcomes({ entry }: { entry: Entry }) {
  const mine = (e: ManagerEvent) => e.rule === entry.rule && e.strategy === entry.strategy.name && !!kOutcomes[e.type]
  const list = events.value.filter(mine).slice(-kMostOutcomes).reverse()
  return (
    <section aria-label="Outcomes">
      <h3>Outcomes</h3>
      {list.length === 0 && <p class="muted">Not tried since culprit started.</p>}
      <ol>
        {list.map((e) => (
          <li key={e.number}>
            <time>{when(e.clock ?? clockAt(e.t))}</time> {kOutcomes[e.type]}
          </li>
        ))}
      </ol>
    </section>
  )
}

const kFile = 'beliefs.json'

// The beliefs as a file that `culprit beliefs import` takes on another robot.
const exportAll = () =>
  act('Exporting the learned values', async () => {
    const learned = await call<unknown>('GET', '/api/beliefs')
    download(kFile, JSON.stringify(learned, null, 2) + '\n', 'application/json')
  })

// Forgetting cannot be taken back, so that it is asked twice.
function Forget({ rule }: { rule: string }) {
  const [asked, ask] = useState<string | null>(null) // '' is all rules
  if (!can('post', '/api/orders')) return null
  const words = asked === '' ? 'all learned values' : `the learned values of ${asked}`
  if (asked !== null)
    return (
      <span class="bar" role="alert">
        Forget {words}? There is no undo.
        <button
          type="button"
          class="danger"
          onClick={() => {
            void order(`Forgetting ${words}`, { order: 'forget', ...(asked ? { rule: asked } : {}) })
            ask(null)
          }}
        >
          Forget
        </button>
        <button type="button" onClick={() => ask(null)}>
          Keep
        </button>
      </span>
    )
  return (
    <>
      <button type="button" disabled={!canOrder() || !rule} onClick={() => ask(rule)}>
        Reset {rule} …
      </button>
      <button type="button" disabled={!canOrder()} onClick={() => ask('')}>
        Reset all …
      </button>
    </>
  )
}

export function BeliefsPage() {
  const [chosen, choose] = useState(0)
  const list = entries()
  return (
    <main class="beliefs">
      <div class="bar">
        <h2>Success rate of each strategy</h2>
        <button type="button" onClick={() => void exportAll()}>
          Export …
        </button>
        <Forget rule={list[chosen]?.rule ?? ''} />
      </div>
      <div class="columns">
        <div class="scrolls" tabIndex={0} role="group" aria-label="Beliefs">
          <table>
            <thead>
              <tr>
                <th scope="col">strategy</th>
                <th scope="col">prior</th>
                <th scope="col">learned mean</th>
                <th scope="col">90 % range</th>
                <th scope="col" class="interval-head">0 % to 100 %</th>
                <th scope="col">learned from</th>
              </tr>
            </thead>
            <tbody>
              {list.map((entry, i) => {
                const { prior } = entry.strategy
                const [a, b] = entry.belief
                const [low, high] = beta(a, b).interval
                const seen = Math.max(0, a + b - entry.began[0] - entry.began[1])
                const percent = (p: number) => `${(100 * p).toFixed(0)} %`
                return (
                  <tr class={i === chosen ? 'chosen' : ''}>
                    <th scope="row">
                      <button type="button" aria-pressed={i === chosen} onClick={() => choose(i)}>
                        {entry.rule}.<wbr />{entry.strategy.name}
                      </button>
                    </th>
                    <td class="number">{percent(prior[0] / (prior[0] + prior[1]))}</td>
                    <td class="number">{percent(a / (a + b))}</td>
                    <td class="number">
                      {percent(low)} to {percent(high)}
                    </td>
                    <td>
                      <Interval low={low} high={high} now={a / (a + b)} prior={prior[0] / (prior[0] + prior[1])} />
                    </td>
                    <td class="number">
                      {seen < 0.5 ? 'nothing yet' : `${seen.toFixed(0)} outcome${seen < 1.5 ? '' : 's'}`}
                    </td>
                  </tr>
                )
              })}
            </tbody>
          </table>
        </div>
        {list[chosen] && (
          <div>
            <Density entry={list[chosen]} />
            <Outcomes entry={list[chosen]} />
          </div>
        )}
      </div>
    </main>
  )
}
