// All that is known of one component: its node and process, its topics, what was done to it and what could be.
import { byTheClock, lasting } from './clock'
import { listed } from './incidents'
import { clockAt, events, graph, robot, rulesByComponent, state, stateOfComponent, stateOfTopic } from './store'
import { trendOf } from './trends'

const kWide = 90
const kHigh = 18

function Sparkline({ values }: { values: number[] }) {
  if (values.length < 2) return null
  const most = Math.max(...values, 1e-9)
  const x = (place: number) => (kWide * place) / (values.length - 1)
  const y = (value: number) => kHigh - 1 - ((kHigh - 2) * value) / most
  return (
    <svg class="sparkline" width={kWide} height={kHigh} aria-hidden="true">
      <polyline points={values.map((value, place) => `${x(place)},${y(value)}`).join(' ')} />
    </svg>
  )
}

interface Link {
  topic: string
  others: string[]
}
// The topics of a node in one direction, and who is at their other ends.
function linksOf(node: string, isOut: boolean): Link[] {
  const links = new Map<string, string[]>()
  for (const [consumer, producer, topic] of graph.value.edges) {
    const [own, other] = isOut ? [producer, consumer] : [consumer, producer]
    if (own === node) links.set(topic, [...(links.get(topic) ?? []), other])
  }
  return [...links].map(([topic, others]) => ({ topic, others }))
}

function rateOf(topic: string): string {
  const now = stateOfTopic(topic)
  if (!now || now.rate === null) return robot.value?.topics.includes(topic) ? 'nothing heard yet' : 'not measured'
  return now.age !== null && now.age > 3 / now.rate ? `silent for ${lasting(now.age)}` : `${now.rate.toFixed(1)} Hz`
}

function Topics({ title, links }: { title: string; links: Link[] }) {
  if (links.length === 0) return null
  return (
    <table>
      <caption>{title}</caption>
      <tbody>
        {links.map(({ topic, others }) => (
          <tr>
            <th scope="row" title={others.join(', ')}>
              {topic || 'declared'}
            </th>
            <td class="number">{rateOf(topic)}</td>
            <td>
              <Sparkline values={trendOf(topic)} />
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  )
}

const kMostDone = 8

export function ComponentPanel({ name }: { name: string }) {
  const node = graph.value.nodes.find((n) => n.component === name)?.node
  const now = stateOfComponent(name)
  const rules = rulesByComponent.value.get(name) ?? []
  const strategies = rules.flatMap((r) => r.strategies.filter((s) => s.components.includes(name)).map((s) => `${r.name}.${s.name}`))
  const done = events.value.filter((e) => e.component === name || e.components?.includes(name)).slice(-kMostDone).reverse()
  const facts: [string, string | undefined][] = [
    ['node', node ?? 'not seen'],
    ['process', state.value ? (now?.process ?? 'not seen yet') : 'unknown'],
    ['lifecycle', now?.lifecycle],
    ['being adapted by', now?.adapting],
    ['remark', now?.remark],
    ['rules about it', listed(rules.map((r) => r.name)) || 'none'],
    ['what could be done', listed(strategies) || 'nothing'],
  ]
  return (
    <section class="details" aria-label={`About ${name}`}>
      <dl>
        {facts.map(([what, value]) => value && [<dt>{what}</dt>, <dd>{value}</dd>])}
      </dl>
      <Topics title="it publishes" links={node ? linksOf(node, true) : []} />
      <Topics title="it hears" links={node ? linksOf(node, false) : []} />
      {done.length > 0 && (
        <>
          <h3>What was about it</h3>
          <ol>
            {done.map((e) => (
              <li key={e.number}>
                <time>{byTheClock(e.clock ?? clockAt(e.t))}</time> {e.text}
              </li>
            ))}
          </ol>
        </>
      )}
    </section>
  )
}
