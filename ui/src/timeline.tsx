// What happened when: a lane for each rule that ever failed, bars for failures, marks for strategies
// and outcomes; and the moment that the page looks at, which can be moved.
import { useComputed } from '@preact/signals'
import { ticks } from './axis'
import { byTheClock, lasting } from './clock'
import { isOld } from './freshness'
import type { View } from './history'
import type { Criticality, ManagerEvent } from './types'

const kWindows: [number, string][] = [
  [1, '1 s'],
  [10, '10 s'],
  [30, '30 s'],
  [120, '2 min'],
  [600, '10 min'],
  [3600, '1 h'],
  [86_400, '1 day'],
  [Infinity, 'all'],
]

interface Bar {
  from: number
  to: number | null
  criticality: Criticality
  outcome: string
}
interface Lane {
  name: string // of the rule
  bars: Bar[]
  marks: ManagerEvent[]
}

const kMarks: Record<string, string> = {
  strategy_chosen: '▼',
  strategy_failed: '✕',
  round_spent: 'Ⅱ',
  rule_exhausted: '✖',
  fault: '⚡',
  note: '•',
}
// What was only advised was not done.
const signOf = (event: ManagerEvent) => (event.dry_run ? '▽' : kMarks[event.type])

// What is about no rule, above the rules: only of runs that are over is it known.
const kOwnLanes: Record<string, string> = { fault: 'faults', note: 'the robot' }

function lanesOf(events: ManagerEvent[]): Lane[] {
  const own = Object.entries(kOwnLanes)
    .map(([type, name]): Lane => ({ name, bars: [], marks: events.filter((e) => e.type === type) }))
    .filter((lane) => lane.marks.length > 0)
  const byRule = new Map<string, Lane>()
  for (const event of events) {
    if (event.type === 'reloaded') {
      for (const { bars } of byRule.values()) {
        const last = bars[bars.length - 1]
        last.to ??= event.t
      }
    }
    if (!event.rule) continue
    if (event.type === 'failure_detected') {
      const lane = byRule.get(event.rule) ?? { name: event.rule, bars: [], marks: [] }
      lane.bars.push({ from: event.t, to: null, criticality: event.criticality!, outcome: 'open' })
      byRule.set(event.rule, lane)
      continue
    }
    const lane = byRule.get(event.rule)
    const bar = lane?.bars[lane.bars.length - 1]
    if (!lane || !bar) continue
    if (event.type === 'failure_resolved' || event.type === 'failure_lost') {
      bar.to = event.t
      bar.outcome = event.text
    } else if (kMarks[event.type]) {
      lane.marks.push(event)
    }
  }
  return [...own, ...byRule.values()]
}

const kRow = 26
const kAxis = 22 // its height
const kShortest = 0.02 // s, of what is shown

const kNames: [string, string][] = [
  ['▼', 'begun'],
  ['▽', 'would be begun'],
  ['✕', 'did not help'],
  ['✖', 'given up'],
]

// Each bar can be seen and pointed at, be it ever so short.
function Bars({ lane, row, begin, end }: { lane: Lane; row: number; begin: number; end: number }) {
  const share = (t: number) => (100 * (Math.max(begin, Math.min(end, t)) - begin)) / (end - begin)
  return (
    <>
      {lane.bars
        .filter((b) => (b.to ?? end) >= begin && b.from <= end)
        .map((b) => (
          <rect
            class={`bar-${b.criticality}`}
            x={`${share(b.from)}%`}
            y={row * kRow + 5}
            height={kRow - 10}
            rx="2"
            style={{ width: `max(4px, ${share(b.to ?? end) - share(b.from)}%)` }}
          >
            <title>{`${lane.name}: ${b.outcome}`}</title>
          </rect>
        ))}
      {lane.marks
        .filter((m) => m.t >= begin && m.t <= end)
        .map((m) => (
          <text
            x={`${share(m.t)}%`}
            y={row * kRow + 18}
            class={`mark mark-${m.type}`}
            text-anchor={m.type === 'strategy_failed' ? 'end' : 'middle' /* the next strategy may begin there */}
          >
            {signOf(m)}
            <title>{m.text}</title>
          </text>
        ))}
    </>
  )
}

// What is shown: the newest while nobody looks elsewhere, else what is around the moment.
function windowOf(view: View): { begin: number; end: number } {
  const newest = Math.max(view.newest.value, 1)
  const oldest = Math.min(view.oldest(), newest - kShortest)
  const length = Math.max(kShortest, Math.min(view.windowLength.value, newest - oldest))
  const wanted = view.windowEnd.value ?? newest
  const end = Math.max(Math.min(wanted, newest), oldest + length)
  return { begin: end - length, end }
}

function Zoom({ view }: { view: View }) {
  const { begin, end } = windowOf(view)
  const newest = Math.max(view.newest.value, 1)
  const show = (from: number, to: number) => {
    view.windowLength.value = to - from
    view.windowEnd.value = to >= newest - 1e-9 ? null : to
  }
  const zoom = (factor: number) => {
    const length = (end - begin) * factor
    // What one looks at stays in sight.
    const centre = view.moment.value ?? (factor < 1 ? end - length / 2 : end)
    const to = Math.min(newest, centre + length / 2)
    show(Math.max(view.oldest(), to - length), to)
  }
  const pan = (share: number) => {
    const length = end - begin
    const to = Math.min(newest, Math.max(view.oldest() + length, end + share * length))
    show(to - length, to)
  }
  return (
    <span class="zoom" role="group" aria-label="Time shown">
      <button type="button" aria-label="Earlier" title="Earlier" disabled={begin <= view.oldest()} onClick={() => pan(-0.5)}>
        ◀
      </button>
      <button type="button" aria-label="Show a longer time" title="Show a longer time" onClick={() => zoom(3)}>
        −
      </button>
      <button type="button" aria-label="Show a shorter time" title="Show a shorter time" onClick={() => zoom(1 / 3)}>
        +
      </button>
      <button type="button" aria-label="Later" title="Later" disabled={view.windowEnd.value === null} onClick={() => pan(0.5)}>
        ▶
      </button>
    </span>
  )
}

function Head({ view }: { view: View }) {
  const { moment, isNewest, isOver, windowLength, windowEnd } = view
  const end = Math.max(view.newest.value, 1)
  const at = moment.value ?? end
  const words = view.clockOf ? byTheClock(view.clockOf(at), 1) : `${at.toFixed(1)} s`
  return (
    <div class="bar">
      <button
        type="button"
        class={isNewest.value ? '' : 'primary'}
        aria-pressed={isNewest.value}
        onClick={() => {
          moment.value = null
          windowEnd.value = null
        }}
      >
        {isOver ? 'End' : '● Live'}
      </button>
      <output class="moment">{isNewest.value ? `${isOver ? 'the end' : isOld.value ? 'the last told' : 'now'}, ${words}` : `at ${words}`}</output>
      <label>
        show{' '}
        <select
          value={String(windowLength.value)}
          onChange={(e) => {
            windowLength.value = Number(e.currentTarget.value)
            windowEnd.value = null
          }}
        >
          {!kWindows.some(([length]) => length === windowLength.value) && (
            <option value={String(windowLength.value)}>{lasting(windowLength.value)}</option>
          )}
          {kWindows.map(([length, name]) => (
            <option value={String(length)}>{name}</option>
          ))}
        </select>
      </label>
      <Zoom view={view} />
      <span class="legend" aria-hidden="true">
        {kNames.map(([sign, name]) => (
          <span>
            <b>{sign}</b> {name}
          </span>
        ))}
      </span>
    </div>
  )
}

export function Timeline({ view }: { view: View }) {
  const { moment } = view
  const lanes = useComputed(() => lanesOf(view.events.value))
  const { begin, end } = windowOf(view)
  const span = end - begin
  const percent = (t: number) => `${(100 * (Math.max(begin, Math.min(end, t)) - begin)) / span}%`
  const at = moment.value ?? end
  const visible = lanes.value.filter(
    (l) =>
      l.bars.some((b) => (b.to ?? end) >= begin && b.from <= end) ||
      (l.bars.length === 0 && l.marks.some((m) => m.t >= begin && m.t <= end))
  )
  const height = Math.max(1, visible.length) * kRow
  return (
    <section class="timeline" aria-label="Timeline">
      <Head view={view} />
      <div class="lanes">
        <div class="names">
          {visible.map((lane) => (
            <span title={lane.name}>{lane.name}</span>
          ))}
        </div>
        <svg class="plot" width="100%" height={height + kAxis} role="img"
          aria-label="Failures over time; the list of what happened says the same in words">
          {ticks(begin, end, isNarrow.matches ? 3 : 7, view.clockOf).map((tick) => (
            <g class="tick">
              <line x1={percent(tick.at)} x2={percent(tick.at)} y1="0" y2={height} />
              <text x={percent(tick.at)} y={height + 16} text-anchor={anchorOf((tick.at - begin) / span)}>
                {tick.label}
              </text>
            </g>
          ))}
          {visible.length === 0 && (
            <text x="8" y="18">Nothing has failed in this time.</text>
          )}
          {visible.map((lane, row) => (
            <Bars key={lane.name} {...{ lane, row, begin, end }} />
          ))}
          <line x1={percent(at)} x2={percent(at)} y1="0" y2={height} class="playhead" />
        </svg>
        <span />
        <input
          class="scrub"
          type="range"
          aria-label="Moment to look at, in seconds"
          aria-valuetext={view.clockOf ? byTheClock(view.clockOf(at), 1) : `${at.toFixed(1)} s`}
          min={begin}
          max={end}
          step={span > 10 ? 0.1 : span / 1000}
          value={at}
          onInput={(e) => {
            const wanted = Number(e.currentTarget.value)
            moment.value = wanted >= view.newest.value - 0.05 ? null : wanted
          }}
        />
      </div>
    </section>
  )
}

const isNarrow = matchMedia('(max-width: 700px)')
// Labels at the ends stay inside.
const anchorOf = (share: number) => (share < 0.06 ? 'start' : share > 0.94 ? 'end' : 'middle')

export function EventLog({ view }: { view: View }) {
  const { moment } = view
  const upTo = moment.value ?? Infinity
  const list = view.events.value.filter((e) => e.t <= upTo).slice(-200)
  list.reverse()
  return (
    <section class="log" aria-label="What happened">
      <h2>What happened</h2>
      {list.length === 0 && <p class="muted">Nothing yet.</p>}
      <ol>
        {list.map((event) => (
          <li key={event.number}>
            <button type="button" onClick={() => (moment.value = event.t)} title={`Look at this moment, ${event.t.toFixed(2)} s after the beginning`} data-t={event.t}>
              {view.clockOf ? byTheClock(event.clock ?? view.clockOf(event.t), 2) : event.t.toFixed(2)}
            </button>
            <span class={`label tone-${event.tone}`}>{event.label}</span>
            <span>{event.text}</span>
          </li>
        ))}
      </ol>
    </section>
  )
}
