// What happened when: a lane for each rule that ever failed, bars for failures, marks for strategies
// and outcomes; and the moment that the page looks at, which can be moved.
import { useComputed } from '@preact/signals'
import type { View } from './history'
import type { Criticality, ManagerEvent } from './types'

const kWindows: [number, string][] = [
  [30, '30 s'],
  [120, '2 min'],
  [600, '10 min'],
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

export function Timeline({ view }: { view: View }) {
  const { moment, isNewest, isOver, windowLength } = view
  const lanes = useComputed(() => lanesOf(view.events.value))
  const end = Math.max(view.newest.value, 1)
  const begin = Math.max(0, end - windowLength.value)
  const span = end - begin
  const percent = (t: number) => `${(100 * (Math.max(begin, Math.min(end, t)) - begin)) / span}%`
  const at = moment.value ?? end
  const visible = lanes.value.filter(
    (l) => l.bars.some((b) => (b.to ?? end) >= begin) || (l.bars.length === 0 && l.marks.some((m) => m.t >= begin))
  )
  return (
    <section class="timeline" aria-label="Timeline">
      <div class="bar">
        <button
          type="button"
          class={isNewest.value ? 'primary' : ''}
          aria-pressed={isNewest.value}
          onClick={() => (moment.value = null)}
        >
          {isOver ? 'End' : '● Live'}
        </button>
        <output class="moment">
          {isNewest.value ? `${isOver ? 'the end' : 'now'}, ${end.toFixed(1)} s` : `at ${at.toFixed(1)} s`}
        </output>
        <label>
          show{' '}
          <select
            value={String(windowLength.value)}
            onChange={(e) => (windowLength.value = Number(e.currentTarget.value))}
          >
            {kWindows.map(([length, name]) => (
              <option value={String(length)}>{name}</option>
            ))}
          </select>
        </label>
      </div>
      <div class="lanes">
        <div class="names">
          {visible.map((lane) => (
            <span title={lane.name}>{lane.name}</span>
          ))}
        </div>
        <svg class="plot" width="100%" height={Math.max(1, visible.length) * kRow} role="img"
          aria-label="Failures over time; the list of what happened says the same in words">
          {visible.length === 0 && (
            <text x="8" y="18">Nothing has failed in this time.</text>
          )}
          {visible.map((lane, row) => (
            <g key={lane.name}>
              {lane.bars
                .filter((b) => (b.to ?? end) >= begin)
                .map((b) => (
                  <svg x={percent(b.from)} y={row * kRow + 5} overflow="visible">
                    <title>{`${lane.name}: ${b.outcome}`}</title>
                    <rect
                      class={`bar-${b.criticality}`}
                      width={`${(100 * ((b.to ?? end) - Math.max(begin, b.from))) / span}%`}
                      height={kRow - 10}
                      rx="3"
                    />
                  </svg>
                ))}
              {lane.marks
                .filter((m) => m.t >= begin)
                .map((m) => (
                  <text
                    x={percent(m.t)}
                    y={row * kRow + 18}
                    class="mark"
                    text-anchor={m.type === 'strategy_failed' ? 'end' : 'middle' /* the next strategy may begin there */}
                  >
                    {kMarks[m.type]}
                    <title>{m.text}</title>
                  </text>
                ))}
            </g>
          ))}
          <line x1={percent(at)} x2={percent(at)} y1="0" y2="100%" class="playhead" />
        </svg>
        <span />
        <input
          class="scrub"
          type="range"
          aria-label="Moment to look at, in seconds"
          min={begin}
          max={end}
          step="0.1"
          value={at}
          onInput={(e) => {
            const wanted = Number(e.currentTarget.value)
            moment.value = wanted >= end - 0.05 ? null : wanted
          }}
        />
      </div>
    </section>
  )
}

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
            <button type="button" onClick={() => (moment.value = event.t)} title="Look at this moment">
              {event.t.toFixed(2)}
            </button>
            <span class={`label tone-${event.tone}`}>{event.label}</span>
            <span>{event.text}</span>
          </li>
        ))}
      </ol>
    </section>
  )
}
