// The input of a condition over the last minutes, with its threshold, which can be dragged or moved by the arrow keys.
import { useRef, useState } from 'preact/hooks'
import { lasting } from './clock'
import type { Clause } from './sentence'
import { state } from './store'
import { type Trend, trendOf } from './trends'

const kUnits: Record<string, number> = { ns: 1e-9, us: 1e-6, ms: 1e-3, s: 1, min: 60, h: 3600 }
const kSteps = 100 // from one end to the other, of an arrow key
const kHigh = 96
const kWide = 320

// The number that it stands for, in seconds if it is a time; null if it is no plain number, such as a constant.
export function amountOf(text: string): number | null {
  const match = /^(-?[\d.]+(?:e[+-]?\d+)?)(ns|us|ms|s|min|h)?$/i.exec(text)
  const number = match ? Number(match[1]) * (match[2] ? kUnits[match[2]] : 1) : NaN
  return Number.isFinite(number) ? number : null
}
const isTime = (clause: Clause) => clause.kind === 'silent'

// As the rules spell it: two figures are enough.
export function spelled(amount: number, clause: Clause): string {
  if (!isTime(clause)) return String(Number(amount.toPrecision(3)))
  return amount < 10 ? `${Math.max(1, Number((amount * 1000).toPrecision(2)))}ms` : `${Number(amount.toPrecision(2))}s`
}

function trendLookedAt({ kind, name }: Clause): Trend {
  if (kind === 'silent') return trendOf('age', name)
  if (kind === 'slow') return trendOf('rate', name)
  return trendOf('input', kind === 'odd' ? `phi(${name})` : name)
}
const kSketched = ['silent', 'slow', 'odd', 'value', 'mean', 'least', 'most']
export const isSketched = ({ kind }: Clause) => kSketched.includes(kind)

// True if the condition holds for the value.
function holds(clause: Clause, value: number, threshold: number): boolean {
  if (clause.kind === 'silent' || clause.kind === 'odd') return value > threshold
  if (clause.kind === 'slow') return value < threshold
  return clause.how.startsWith('>') ? value > threshold : clause.how.startsWith('<') ? value < threshold : value === threshold
}

// `constant`: what the threshold is where it is a constant of the file.
export function Sketch({ clause, constant, take }: { clause: Clause; constant?: string; take: (value: string) => void }) {
  state.value // new with each
  const place = useRef<SVGSVGElement>(null)
  const [dragged, drag] = useState<number | null>(null)
  const own = amountOf(clause.value)
  const fixed = own ?? amountOf(constant ?? '')
  const { values: series, times } = trendLookedAt(clause)
  if (series.length < 2) return <p class="muted sketch-none">No sketch: the running rules do not read this, or the page was opened a moment ago.</p>
  const threshold = dragged ?? fixed
  const low = Math.min(clause.kind === 'value' ? Infinity : 0, ...series, fixed ?? Infinity)
  const high = Math.max(...series, fixed ?? -Infinity)
  const pad = (high - low || Math.abs(high) || 1) * 0.3
  const [least, most] = [clause.kind === 'value' ? low - pad : 0, high + pad]
  const y = (value: number) => kHigh - ((value - least) / (most - least)) * kHigh
  const x = (i: number) => (kWide * i) / (series.length - 1)
  const valueAt = (clientY: number) => {
    const box = place.current!.getBoundingClientRect()
    return least + (1 - Math.min(1, Math.max(0, (clientY - box.top) / box.height))) * (most - least)
  }
  const settle = (value: number) => {
    drag(null)
    take(spelled(value, clause))
  }
  const isAbove = threshold !== null && holds(clause, most, threshold)
  const share = threshold === null ? 0 : series.filter((value) => holds(clause, value, threshold)).length / series.length
  const words = threshold === null ? clause.value : spelled(threshold, clause)
  return (
    <div class="sketch">
      <svg
        ref={place}
        viewBox={`0 0 ${kWide} ${kHigh}`}
        preserveAspectRatio="none"
        onPointerDown={(e) => {
          if (own === null) return
          e.currentTarget.setPointerCapture(e.pointerId)
          drag(valueAt(e.clientY))
        }}
        onPointerMove={(e) => {
          if (dragged !== null) drag(valueAt(e.clientY))
        }}
        onPointerUp={(e) => {
          if (dragged !== null) settle(valueAt(e.clientY))
        }}
        onPointerCancel={() => drag(null)}
        role={own === null ? 'img' : 'slider'}
        {...(own === null ? {} : { tabindex: 0 }) /* in SVG, attributes are written as they stand here */}
        aria-label={own === null ? `${clause.name} over time` : `threshold of ${clause.name}`}
        aria-orientation={own === null ? undefined : 'vertical'}
        aria-valuemin={own === null ? undefined : least}
        aria-valuemax={own === null ? undefined : most}
        aria-valuenow={threshold ?? undefined}
        aria-valuetext={own === null ? undefined : words}
        onKeyDown={(e) => {
          const step = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1, PageUp: 10, PageDown: -10 }[e.key]
          if (!step || own === null) return
          e.preventDefault()
          settle(Math.max(isTime(clause) ? 0.001 : -Infinity, own + (step * (most - least)) / kSteps))
        }}
      >
        {threshold !== null && (clause.how === '' || /[<>]/.test(clause.how)) && (
          <rect class="firing" x="0" width={kWide} y={isAbove ? 0 : y(threshold)} height={isAbove ? Math.max(0, y(threshold)) : Math.max(0, kHigh - y(threshold))} />
        )}
        <polyline points={series.map((value, i) => `${x(i)},${y(value)}`).join(' ')} />
        {threshold !== null && <line class="threshold" x1="0" x2={kWide} y1={y(threshold)} y2={y(threshold)} />}
      </svg>
      <p class="muted">
        {lasting(times[times.length - 1] - times[0])} up to now, from {spelled(Math.min(...series), clause)} to {spelled(Math.max(...series), clause)}.{' '}
        {threshold !== null && `Beyond ${words}: ${Math.round(100 * share)} % of the time. `}
        {own === null ? `${clause.value} is a constant: change it above.` : 'Drag the line.'}
      </p>
    </div>
  )
}
