// What happened when: a lane for each rule that ever failed, bars for failures, marks for strategies
// and outcomes; and the moment that the page looks at, which can be moved.
import { untracked, useComputed } from '@preact/signals'
import { useMemo } from 'preact/hooks'
import type { VNode } from 'preact'
import { type Tick, ticks } from './axis'
import { byTheClock, lasting } from './clock'
import { isOld } from './freshness'
import type { View } from './history'
import { usePaced } from './paced'
import { isDevice } from './theme'
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
  link?: string
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
// A dry run only advises.
const signOf = (event: ManagerEvent) => (event.dry_run ? '▽' : kMarks[event.type])

// Lanes without a rule, above the rules: only finished runs have them.
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
      lane.bars.push({ from: event.t, to: null, criticality: event.criticality!, outcome: 'open', link: event.link })
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
const kLeastShare = 0.2 // %, between two bars

const kNames: [string, string][] = [
  ['▼', 'started'],
  ['▽', 'would start'],
  ['✕', 'did not help'],
  ['✖', 'exhausted'],
]

// Each bar can be seen and pointed at, be it ever so short.
function Bars({ lane, row, begin, end }: { lane: Lane; row: number; begin: number; end: number }) {
  const share = (t: number) => (100 * (Math.max(begin, Math.min(end, t)) - begin)) / (end - begin)
  const shown = lane.bars.filter((b) => (b.to ?? end) >= begin && b.from <= end)
  // A thousand in a day do not fit into the pixels.
  const apart = shown.filter((b, i) => i === 0 || share(b.to ?? end) - share(shown[i - 1].from) > kLeastShare)
  return (
    <>
      {apart.map((b) => (
        <rect
          class={`bar-${b.criticality}${b.link ? ' leads' : ''}`}
          x={`${share(b.from)}%`}
          y={row * kRow + 5}
          height={kRow - 10}
          rx="2"
          style={{ width: `max(4px, ${share(b.to ?? end) - share(b.from)}%)` }}
          onClick={b.link ? () => (location.hash = b.link!) : undefined /* the list beside it is for the keyboard */}
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

// The shown window: the newest data, unless the reader looks at another moment.
function windowOf(view: View): { begin: number; end: number } {
  const newest = Math.max(view.newest.value, 1)
  const oldest = Math.min(view.oldest(), newest - kShortest)
  const length = Math.max(kShortest, Math.min(view.windowLength.value, newest - oldest))
  const wanted = view.windowEnd.value ?? newest
  const end = Math.max(Math.min(wanted, newest), oldest + length)
  return { begin: end - length, end }
}

function show(view: View, from: number, to: number): void {
  const newest = Math.max(view.newest.value, 1)
  view.windowLength.value = to - from
  view.windowEnd.value = to >= newest - 1e-9 ? null : to
}
// The point at `centre` keeps its place.
function zoomAround(view: View, factor: number, centre: number): void {
  const { begin, end } = windowOf(view)
  const to = Math.min(Math.max(view.newest.value, 1), centre + (end - centre) * factor)
  show(view, Math.max(view.oldest(), to - (end - begin) * factor), to)
}

function Zoom({ view }: { view: View }) {
  const { begin, end } = windowOf(view)
  // Brings the selected moment to the middle.
  const zoom = (factor: number) => {
    const length = (end - begin) * factor
    const centre = view.moment.value ?? (factor < 1 ? end - length / 2 : end)
    const to = Math.min(Math.max(view.newest.value, 1), centre + length / 2)
    show(view, Math.max(view.oldest(), to - length), to)
  }
  const pan = (share: number) => {
    const length = end - begin
    const to = Math.min(Math.max(view.newest.value, 1), Math.max(view.oldest() + length, end + share * length))
    show(view, to - length, to)
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

function Moment({ view }: { view: View }) {
  const { moment, isNewest, isOver, windowEnd } = view
  const end = Math.max(view.newest.value, 1)
  const at = moment.value ?? end
  const words = view.clockOf ? byTheClock(view.clockOf(at), 1) : `${at.toFixed(1)} s`
  return (
    <>
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
      <output class="moment">{isNewest.value ? `${isOver ? 'the end' : isOld.value ? 'the last state' : 'now'}, ${words}` : `at ${words}`}</output>
    </>
  )
}

function Head({ view, hasMoment }: { view: View; hasMoment: boolean }) {
  const { windowLength, windowEnd } = view
  return (
    <div class="bar">
      {hasMoment && <Moment view={view} />}
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
      {hasMoment && <span class="legend" aria-hidden="true">
        {kNames.map(([sign, name]) => (
          <span>
            <b>{sign}</b> {name}
          </span>
        ))}
      </span>}
    </div>
  )
}

// Bars move by less than a pixel between two states, and there may be hundreds of them.
const kPeriod = 200 // ms

// The view, as often as it is worth drawing.
function usePacedView(view: View): View {
  const told = usePaced(() => ({ events: view.events.value, newest: view.newest.value }), kPeriod)
  const events = useComputed(() => told.value.events)
  const newest = useComputed(() => told.value.newest)
  const { clockOf } = view
  return useMemo(() => ({ ...view, events, newest, clockOf: clockOf && ((t) => untracked(() => clockOf(t))) }), [view])
}

export function Timeline({ view: itself, label = 'Timeline', hasMoment = true }: { view: View; label?: string; hasMoment?: boolean }) {
  const view = usePacedView(itself)
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
  // By Ctrl and the wheel, or by two fingers on a touchpad; the wheel alone moves the page.
  const onWheel = (e: WheelEvent) => {
    if (!e.ctrlKey) return
    e.preventDefault()
    const { left, width } = (e.currentTarget as Element).getBoundingClientRect()
    zoomAround(view, Math.exp(e.deltaY / kWheel), begin + (span * (e.clientX - left)) / width)
  }
  return (
    <section class="timeline" aria-label={label}>
      <Head view={view} hasMoment={hasMoment} />
      <div class="lanes">
        <div class="names">
          {visible.map((lane) => (
            <span title={lane.name}>{lane.name}</span>
          ))}
        </div>
        <svg class="plot" width="100%" height={height + kAxis} role="img" onWheel={onWheel}
          aria-label="Failures over time; the list of what happened says the same in words">
          {apart(ticks(begin, end, isNarrow.value ? 3 : 7, view.clockOf), (at) => (at - begin) / span).map(({ at, label: words, anchor }) => (
            <g class="tick">
              <line x1={percent(at)} x2={percent(at)} y1="0" y2={height} />
              {anchor && (
                <text x={percent(at)} y={height + 16} text-anchor={anchor}>
                  {words}
                </text>
              )}
            </g>
          ))}
          {visible.length === 0 && view.newest.value > 0 && (
            <text x="8" y="18">No failure was detected in this time.</text>
          )}
          {visible.map((lane, row) => (
            <Bars key={lane.name} {...{ lane, row, begin, end }} />
          ))}
          {hasMoment && <line x1={percent(at)} x2={percent(at)} y1="0" y2={height} class="playhead" />}
        </svg>
        {hasMoment && <span />}
        {hasMoment && <input
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
        />}
      </div>
    </section>
  )
}

const isNarrow = isDevice('(max-width: 700px)')
const isMedium = isDevice('(max-width: 1100px)')
const kWheel = 300 // of the wheel's way: so much of it zooms by e
// Labels at the ends stay inside, and one that would stand on the one before is left out.
const anchorOf = (share: number, wide: number) => (share < wide / 2 ? 'start' : share > 1 - wide / 2 ? 'end' : 'middle')
function apart(all: Tick[], shareOf: (at: number) => number): (Tick & { anchor?: string })[] {
  const ofLetter = isNarrow.value ? 0.028 : isMedium.value ? 0.02 : 0.013 // its share of the axis
  let taken = -Infinity
  return all.map((tick) => {
    const share = shareOf(tick.at)
    const wide = ofLetter * tick.label.length
    const anchor = anchorOf(share, wide)
    const from = share - { start: 0, middle: wide / 2, end: wide }[anchor]!
    if (from < taken) return tick
    taken = from + wide
    return { ...tick, anchor }
  })
}

const kLogPeriod = 50 // ms

function EventLine({ event, view }: { event: ManagerEvent; view: View }) {
  return (
    <li>
      <button type="button" onClick={() => (view.moment.value = event.t)} title={`Look at this moment, ${event.t.toFixed(2)} s after the beginning`} data-t={event.t}>
        {view.clockOf ? byTheClock(event.clock ?? untracked(() => view.clockOf!(event.t)), 2) : event.t.toFixed(2)}
      </button>
      <span class={`label tone-${event.tone}`}>{event.label}</span>
      <span>{event.text}</span>
    </li>
  )
}

export function EventLog({ view }: { view: View }) {
  const events = usePaced(() => view.events.value, kLogPeriod)
  // Past events do not change: only new lines are created.
  const lines = useMemo(() => new WeakMap<ManagerEvent, VNode>(), [view])
  const lineOf = (event: ManagerEvent) => {
    const line = lines.get(event) ?? <EventLine key={event.number} {...{ event, view }} />
    lines.set(event, line)
    return line
  }
  const upTo = view.moment.value ?? Infinity
  const list = events.value.filter((e) => e.text && e.t <= upTo).slice(-200)
  list.reverse()
  return (
    <section class="log" aria-label="Event log">
      <h2>Event log</h2>
      {list.length === 0 && <p class="muted">No events yet.</p>}
      <ol>{list.map(lineOf)}</ol>
    </section>
  )
}
