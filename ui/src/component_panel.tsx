// All that is known of one component: its node and process, its topics, what was done to it and what could be.
import { useEffect } from 'preact/hooks'
import { byTheClock, lasting } from './clock'
import { details, lookAt, trouble } from './component_details'
import { listed } from './incidents'
import { can, clockAt, events, graph, robot, rulesByComponent, stateOfComponent, stateOfTopic } from './store'
import { toAddress } from './plotted'
import { trendOf } from './trends'

const kWide = 90
const kHigh = 18
const kPlotted = 900 // s, of a plot that is opened

// A press opens the plot of `signals`.
function Sparkline({ values, signals }: { values: number[]; signals: string[] }) {
  if (values.length < 2) return null
  const most = Math.max(...values, 1e-9)
  const x = (place: number) => (kWide * place) / (values.length - 1)
  const y = (value: number) => kHigh - 1 - ((kHigh - 2) * value) / most
  const drawing = (
    <svg class="sparkline" width={kWide} height={kHigh} aria-hidden="true">
      <polyline points={values.map((value, place) => `${x(place)},${y(value)}`).join(' ')} />
    </svg>
  )
  if (!can('get', '/api/series')) return drawing
  return (
    <a href={toAddress(signals, { last: kPlotted })} title="Plot" aria-label={`Plot ${signals.join(', ')}`}>
      {drawing}
    </a>
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
  if (!now || now.rate === null) return robot.value?.topics.includes(topic) ? 'no message yet' : 'not measured'
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
              <Sparkline values={trendOf('rate', topic).values} signals={[`rate ${topic}`, `age ${topic}`]} />
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  )
}

const kMegabyte = 1_000_000
const megabytes = (bytes: number) => `${(bytes / kMegabyte).toFixed(bytes < 10 * kMegabyte ? 1 : 0)} MB`

// The load of its process, now and in the last quarter of an hour.
function Usage({ name }: { name: string }) {
  const { process, usage } = details.value!
  if (!process) return null
  const last = usage[usage.length - 1]
  const rows: [string, string, number[]][] = [
    ['processor', last ? `${(100 * last.processor).toFixed(1)} % of a core` : 'measuring …', usage.map((u) => u.processor)],
    ['memory', megabytes(process.memory), usage.map((u) => u.memory)],
  ]
  return (
    <table>
      <caption>process {process.pid}, {process.threads} threads</caption>
      <tbody>
        {rows.map(([what, now, values]) => (
          <tr>
            <th scope="row">{what}</th>
            <td class="number">{now}</td>
            <td>
              <Sparkline values={values} signals={[`${what} ${name}`]} />
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  )
}

function Parameters() {
  const all = Object.entries(details.value!.parameters ?? {})
  if (all.length === 0) return null
  return (
    <details>
      <summary>Parameters ({all.length})</summary>
      <table>
        <tbody>
          {all.map(([name, value]) => (
            <tr>
              <th scope="row">{name}</th>
              <td>{value === null ? 'a list, or not set' : String(value)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </details>
  )
}

const kTones: Record<string, string> = { fatal: 'ERROR', error: 'ERROR', warning: 'WARNING' }

function Log() {
  const { log } = details.value!
  return (
    <>
      <h3>Latest log lines</h3>
      {log.length === 0 && <p class="muted">No lines since this view was opened.</p>}
      <ol class="lines" tabIndex={0} aria-label="Log lines">
        {[...log].reverse().map((line) => (
          <li>
            <time>{byTheClock(line.clock, 1)}</time> <b class={kTones[line.level]}>{line.level}</b> {line.text}
          </li>
        ))}
      </ol>
    </>
  )
}

const kMostDone = 8

export function ComponentPanel({ name }: { name: string }) {
  useEffect(() => lookAt(name), [name])
  const facts = robot.value?.components.find((c) => c.name === name)
  const known = graph.value.nodes.find((n) => n.component === name)
  const node = known?.node
  const now = stateOfComponent(name)
  const rules = rulesByComponent.value.get(name) ?? []
  const strategies = rules.flatMap((r) => r.strategies.filter((s) => s.components.includes(name)).map((s) => ({ name: `${r.name}.${s.name}`, actions: s.actions })))
  const done = events.value.filter((e) => e.text && (e.component === name || e.components?.includes(name))).slice(-kMostDone).reverse()
  const rows: [string, string | undefined][] = [
    ['node', known ? `${known.node}${known.present ? '' : ', not discovered now'}` : 'not discovered'],
    ['process', now?.process ?? (now?.condition || 'unknown')],
    ['started by', facts?.owner ?? (facts && 'not known: the rules name no owner')],
    ['host', (now?.host ?? facts?.host) && `${now?.host ?? facts?.host}${now?.unheard ? ', which is unreachable' : ''}`],
    ['lifecycle', now?.lifecycle],
    ['being adapted by', now?.adapting],
    ['remark', now?.remark],
    ['rules about it', listed(rules.map((r) => r.name)) || 'none'],
    ['what could be done', strategies.length === 0 ? 'nothing' : undefined],
  ]
  return (
    <section class="details" aria-label={`About ${name}`}>
      <dl>
        {rows.map(([what, value]) => value && [<dt>{what}</dt>, <dd>{value}</dd>])}
      </dl>
      {strategies.length > 0 && (
        <table>
          <caption>what could be done</caption>
          <tbody>
            {strategies.map((strategy) => (
              <tr>
                <th scope="row">{strategy.name}</th>
                <td>{strategy.actions.join(', ')}</td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
      {details.value && <Usage name={name} />}
      <Topics title="it publishes" links={node ? linksOf(node, true) : []} />
      <Topics title="it subscribes to" links={node ? linksOf(node, false) : []} />
      {details.value && <Parameters />}
      {done.length > 0 && (
        <>
          <h3>Its events</h3>
          <ol>
            {done.map((e) => (
              <li key={e.number}>
                <time>{byTheClock(e.clock ?? clockAt(e.t))}</time> {e.text}
              </li>
            ))}
          </ol>
        </>
      )}
      {details.value && <Log />}
      {trouble.value && <p class="muted">Details are missing: {trouble.value}</p>}
    </section>
  )
}
