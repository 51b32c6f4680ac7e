// Plots of what the rules read and what processes use: several signals on one time axis, with the thresholds of rules, and
// with failures and repairs as marks. The address says what is shown, so that a link shows the same to others.
import { useEffect, useMemo, useRef } from 'preact/hooks'
import uPlot from 'uplot'
import { byTheCalendar, byTheClock, fromTo, when } from './clock'
import { download } from './download'
import { tell } from './notices'
import { atFirst, curveOf, curves, extent, followCurves, followPast, kindOf, kMostBack, offered, past, plotted, range, reach, show, thresholdsOf, toAddress, trouble, wordsOf } from './plotted'
import { axisLook, type Options, Plotter } from './plotter'
import { clockAt, events, robot } from './store'
import { colour, isDevice } from './theme'
import type { ManagerEvent } from './types'

const kColours = ['#0a72c4', '#d95f02', '#159a72', '#c2459a', '#a17a00', '#5b8dd9', '#8060c0', '#7a7a00']
const kDashes = [undefined, [8, 4], [3, 3]]
const kRanges: [number, string][] = [
  [30, '30 s'],
  [120, '2 min'],
  [300, '5 min'],
  [900, '15 min'],
  [3600, 'hour'],
  [21_600, '6 h'],
  [86_400, 'day'],
]
const kShortest = 1 // s
const kHigh = 420
const isNarrow = isDevice('(max-width: 600px)')
const kMarked: Record<string, string> = { failure_detected: '◆', strategy_chosen: '▼', strategy_failed: '✕', failure_resolved: '✓', rule_exhausted: '✖' }
const kMarkColours: Record<string, string> = { failure_detected: 'ERROR', strategy_chosen: 'accent', strategy_failed: 'WARNING', failure_resolved: 'OK', rule_exhausted: 'ERROR' }

const isMark = (event: ManagerEvent) => event.type in kMarked && !event.dry_run
const clockOf = (event: ManagerEvent) => event.clock ?? clockAt(event.t)

function marksWithin(from: number, to: number): ManagerEvent[] {
  const first = events.value.length > 0 ? clockOf(events.value[0]) : Infinity
  const old = (past.value?.events ?? []).filter((e) => clockOf(e) < first)
  return [...old, ...events.value].filter((e) => isMark(e) && clockOf(e) >= from && clockOf(e) <= to)
}

// One time axis for all: where one has no sample, its line goes on.
function aligned(names: string[]): uPlot.AlignedData {
  const tables = names.flatMap((name): uPlot.AlignedData[] => {
    const { clocks, values } = curveOf(name)
    const { scale } = kindOf(name)
    return [[clocks, values.map((value) => (value === null ? null : value * scale))]]
  })
  return tables.length === 0 ? [[]] : uPlot.join(tables)
}

// With the day below the first label of each, where more than one day is shown.
function labelsOf(clocks: number[]): string[] {
  const { from, to } = extent()
  const digits = clocks.length > 1 && clocks[1] - clocks[0] < 1 ? 1 : 0
  const day = (place: number) => byTheCalendar(clocks[place])
  const isOneDay = byTheCalendar(from) === byTheCalendar(to)
  return clocks.map((clock, i) => byTheClock(clock, digits) + (isOneDay || (i > 0 && day(i) === day(i - 1)) ? '' : `\n${day(i)}`))
}

const figures = (value: number) => (Math.abs(value) >= 1000 ? value.toFixed(0) : String(Number(value.toPrecision(4))))

// Below the curves: a line for each threshold and each mark.
function drawMarks(plot: uPlot, names: string[]): void {
  const { ctx, bbox } = plot
  const ratio = devicePixelRatio || 1
  ctx.save()
  ctx.lineWidth = ratio
  ctx.font = `${12 * ratio}px system-ui, sans-serif`
  names.forEach((name, i) => {
    for (const threshold of thresholdsOf(name)) {
      const y = plot.valToPos(threshold, kindOf(name).unit || 'value', true)
      if (y < bbox.top || y > bbox.top + bbox.height) continue
      ctx.strokeStyle = ctx.fillStyle = kColours[i % kColours.length]
      ctx.setLineDash([2 * ratio, 4 * ratio])
      ctx.beginPath()
      ctx.moveTo(bbox.left, y)
      ctx.lineTo(bbox.left + bbox.width, y)
      ctx.stroke()
      ctx.textAlign = 'left'
      ctx.fillText(`threshold ${figures(threshold)}`, bbox.left + 6 * ratio, y - 4 * ratio)
    }
  })
  ctx.setLineDash([])
  ctx.textAlign = 'center'
  const { min = 0, max = 0 } = plot.scales.x
  for (const event of marksWithin(min, max)) {
    const x = plot.valToPos(clockOf(event), 'x', true)
    ctx.strokeStyle = ctx.fillStyle = colour(kMarkColours[event.type])
    ctx.globalAlpha = 0.6
    ctx.beginPath()
    ctx.moveTo(x, bbox.top + 14 * ratio)
    ctx.lineTo(x, bbox.top + bbox.height)
    ctx.stroke()
    ctx.globalAlpha = 1
    ctx.fillText(kMarked[event.type], x, bbox.top + 11 * ratio)
  }
  ctx.restore()
}

function optionsFor(names: string[], zoomTo: (from: number, to: number) => void): Options {
  const units = [...new Set(names.map((name) => kindOf(name).unit || 'value'))]
  const scales: uPlot.Scales = { x: { time: true, range: () => [extent().from, extent().to] } }
  for (const unit of units) {
    const own = names.filter((name) => (kindOf(name).unit || 'value') === unit).flatMap(thresholdsOf)
    scales[unit] = {
      // With its thresholds: how far a curve is from them is what one looks for.
      range: (_, low, high) => {
        const [least, most] = [Math.min(low ?? Infinity, ...own), Math.max(high ?? -Infinity, ...own)]
        if (!Number.isFinite(least)) return [0, 1]
        const pad = (most - least || Math.abs(most) || 1) * 0.08
        return [unit === 'value' || least < 0 ? least - pad : 0, most + pad]
      },
    }
  }
  return {
    scales,
    cursor: { drag: { x: true, y: false, setScale: false } },
    select: { show: true, left: 0, top: 0, width: 0, height: 0 },
    axes: [
      { ...axisLook(), space: 96, values: (_, splits) => labelsOf(splits) },
      ...units.map((unit, i): uPlot.Axis => ({ ...axisLook(), scale: unit, ...(isNarrow.value ? { size: 46 } : { label: unit, size: 62 }), side: i === 0 ? 3 : 1, ...(i === 0 ? {} : { grid: { show: false } }) })),
    ],
    series: [
      { label: 'time', value: (_, clock) => (clock === null ? '–' : when(clock, 1)) },
      ...names.map((name, i): uPlot.Series => ({
        label: wordsOf(name),
        scale: kindOf(name).unit || 'value',
        stroke: kColours[i % kColours.length],
        dash: kDashes[Math.floor(i / kColours.length) % kDashes.length],
        width: 2,
        points: { show: false },
        value: (_, value) => (value === null || value === undefined ? '–' : `${figures(value)} ${kindOf(name).unit}`),
      })),
    ],
    hooks: {
      drawClear: [(plot) => drawMarks(plot, names)],
      setSelect: [
        (plot) => {
          const { left, width } = plot.select
          if (width < 4) return
          zoomTo(plot.posToVal(left, 'x'), plot.posToVal(left + width, 'x'))
          plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false)
        },
      ],
    },
  }
}

// The shown values as a table for other programs (CSV).
function asTable(names: string[]): string {
  const { from, to } = extent()
  const [clocks, ...columns] = aligned(names)
  const cell = (text: string) => (/[",\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text)
  const head = ['time', 'clock_s', ...names.map((name) => wordsOf(name) + (kindOf(name).unit && ` [${kindOf(name).unit}]`))]
  const rows = [...clocks].flatMap((clock, row) =>
    clock < from || clock > to ? [] : [[new Date(clock * 1000).toISOString(), String(clock), ...columns.map((c) => String(c[row] ?? ''))]]
  )
  return [head, ...rows].map((row) => row.map(cell).join(',')).join('\n') + '\n'
}

// The plot with its names and a background, as one image.
function asPicture(plot: uPlot, names: string[]): Promise<Blob | null> {
  const ratio = devicePixelRatio || 1
  const { canvas } = plot.ctx
  const head = 26 * ratio
  const whole = Object.assign(document.createElement('canvas'), { width: canvas.width, height: canvas.height + head * (names.length + 1) })
  const context = whole.getContext('2d')!
  context.fillStyle = colour('surface')
  context.fillRect(0, 0, whole.width, whole.height)
  context.font = `${15 * ratio}px system-ui, sans-serif`
  context.fillStyle = colour('text')
  const { from, to } = extent()
  context.fillText(`${robot.value?.robot ?? ''}, ${fromTo(from, to)}`, 12 * ratio, 18 * ratio)
  names.forEach((name, i) => {
    context.fillStyle = kColours[i % kColours.length]
    context.fillText(`━ ${wordsOf(name)}${kindOf(name).unit && ` [${kindOf(name).unit}]`}`, 12 * ratio, head * (i + 1) + 18 * ratio)
  })
  context.drawImage(canvas, 0, head * (names.length + 1))
  return new Promise((resolve) => whole.toBlob(resolve, 'image/png'))
}

const stamp = () => new Date(extent().to * 1000).toISOString().slice(0, 19).replace(/:/g, '-')

function Chosen() {
  const names = plotted.value
  const input = useRef<HTMLInputElement>(null)
  const add = () => {
    const text = input.current!.value
    const name = offered.value.find((each) => wordsOf(each) === text || each === text)
    if (!name || names.includes(name)) return
    input.current!.value = ''
    show([...names, name])
  }
  return (
    <div class="bar">
      <form
        class="bar"
        onSubmit={(e) => {
          e.preventDefault()
          add()
        }}
      >
        <label>
          Signal <input ref={input} list="plottable" placeholder="rate of /topic" onChange={add} size={28} />
        </label>
        <datalist id="plottable">
          {offered.value.map((name) => (
            <option value={wordsOf(name)} />
          ))}
        </datalist>
        <button type="submit">Add</button>
      </form>
      <ul class="chips" aria-label="Plotted signals">
        {names.map((name, i) => (
          <li key={name}>
            <button type="button" aria-label={`Remove ${wordsOf(name)}`} title="Remove" onClick={() => show(names.filter((each) => each !== name))}>
              <span aria-hidden="true" style={{ color: kColours[i % kColours.length] }}>
                ━
              </span>{' '}
              {wordsOf(name)} <span aria-hidden="true">×</span>
            </button>
          </li>
        ))}
      </ul>
    </div>
  )
}

function Time() {
  const isLive = 'last' in range.value
  const { from, to } = extent()
  const move = (begin: number, end: number) => show(plotted.value, { from: begin, to: end })
  const zoom = (factor: number) => {
    const half = Math.max(kShortest, (to - from) * factor) / 2
    if (isLive) return show(plotted.value, { last: Math.min(kMostBack, 2 * half) })
    move((from + to) / 2 - half, (from + to) / 2 + half)
  }
  const pan = (share: number) => move(from + share * (to - from), to + share * (to - from))
  return (
    <div class="bar">
      <label>
        show{' '}
        <select
          value={isLive && 'last' in range.value ? String(range.value.last) : ''}
          onChange={(e) => show(plotted.value, { last: Number(e.currentTarget.value) })}
        >
          {kRanges.map(([seconds, words]) => (
            <option value={String(seconds)}>the last {words}</option>
          ))}
          {(!('last' in range.value) || !kRanges.some(([s]) => 'last' in range.value && s === range.value.last)) && <option value={'last' in range.value ? String(range.value.last) : ''}>another time</option>}
        </select>
      </label>
      <button type="button" aria-pressed={isLive} onClick={() => show(plotted.value, { last: kRanges[1][0] })}>
        ● Live
      </button>
      <span class="zoom" role="group" aria-label="Time shown">
        <button type="button" aria-label="Earlier" title="Earlier" onClick={() => pan(-0.5)}>
          ◀
        </button>
        <button type="button" aria-label="Show a longer time" title="Show a longer time" onClick={() => zoom(2)}>
          −
        </button>
        <button type="button" aria-label="Show a shorter time" title="Show a shorter time; or drag across the plot" onClick={() => zoom(0.5)}>
          +
        </button>
        <button type="button" aria-label="Later" title="Later" disabled={isLive} onClick={() => pan(0.5)}>
          ▶
        </button>
      </span>
      <span class="muted">{isLive ? '' : fromTo(from, to)}</span>
    </div>
  )
}

function Exports({ plot }: { plot: { current: uPlot | null } }) {
  const names = plotted.value
  const link = async () => {
    const { from, to } = extent()
    const address = location.origin + location.pathname + toAddress(names, { from, to })
    try {
      await navigator.clipboard.writeText(address)
      tell({ text: 'The link is copied. It shows these signals over this time.' })
    } catch {
      tell({ text: `Copy this link: ${address}`, stays: true }) // browsers give the clipboard to secure pages only
    }
  }
  const picture = async () => {
    const blob = plot.current && (await asPicture(plot.current, names))
    if (blob) download(`plot-${stamp()}.png`, blob, 'image/png')
  }
  return (
    <div class="bar">
      <button type="button" disabled={names.length === 0} onClick={() => download(`plot-${stamp()}.csv`, asTable(names), 'text/csv')}>
        Save as CSV
      </button>
      <button type="button" disabled={names.length === 0} onClick={() => void picture()}>
        Save as picture
      </button>
      <button type="button" onClick={() => void link()}>
        Copy link
      </button>
    </div>
  )
}

// Since when there is something to see, and why not for longer.
function howFarBack(): string {
  if (!reach.value) return 'culprit keeps the last 15 min.'
  const { oldest, why } = reach.value
  if (oldest === null) return `culprit keeps the last 15 min: ${why}.`
  return `Plots reach back to ${when(oldest)}: ${why}. Processor and memory that no rule reads are kept for a day.`
}

// Its dotted lines are for eyes only.
function inWords(name: string): string {
  const thresholds = thresholdsOf(name).map(figures).join(' and ')
  return thresholds ? `${wordsOf(name)} (threshold ${thresholds} ${kindOf(name).unit})` : wordsOf(name)
}

export function PlotsPage() {
  const plot = useRef<uPlot | null>(null)
  useEffect(followCurves, [])
  useEffect(followPast, [])
  const names = plotted.value
  useEffect(() => {
    if (names.length === 0 && !location.hash.includes('/')) show(atFirst())
  }, [robot.value?.robot])
  const data = useMemo(() => aligned(names), [names, curves.value, past.value])
  const { from, to } = extent()
  const isEmpty = data.length < 2 || data.slice(1).every((column) => [...column].every((value) => value === null || value === undefined))
  const marks = marksWithin(from, to)
  useEffect(() => plot.current?.setData(data), [from, to, marks.length])
  return (
    <main class="plots">
      <h2>Plots</h2>
      <Chosen />
      <Time />
      {trouble.value && <p class="sick" role="alert">◆ {trouble.value}</p>}
      {names.length === 0 ? (
        <p class="muted">Choose a signal: an input of the rules, rate or age of a topic, processor or memory of a component.</p>
      ) : (
        <Plotter
          label={`${names.map(inWords).join(', ')} over time; Save as CSV has the values`}
          height={isNarrow.value ? kHigh / 1.5 : kHigh}
          remake={names.map((name) => name + kindOf(name).unit).join() + (robot.value?.thresholds?.length ?? 0) + isNarrow.value}
          make={() => optionsFor(names, (begin, end) => show(plotted.value, { from: begin, to: Math.max(end, begin + kShortest) }))}
          data={data}
          onPlot={(made) => (plot.current = made)}
        />
      )}
      {names.length > 0 && isEmpty && <p class="muted">No values in this time.</p>}
      <p class="muted">{howFarBack()}</p>
      <Exports plot={plot} />
      {marks.length > 0 && (
        <section aria-label="Marks">
          <h3>Failures and repairs in this time</h3>
          <ol class="marks">
            {marks.map((event) => (
              <li key={event.number}>
                <span class={`tone-${event.tone}`} aria-hidden="true">
                  {kMarked[event.type]}
                </span>{' '}
                <time>{when(clockOf(event), 1)}</time> {event.text}
              </li>
            ))}
          </ol>
        </section>
      )}
    </main>
  )
}
