// An incident as one HTML file without a script: for a colleague who has neither the robot nor culprit.
import { ticks } from './axis'
import { byTheCalendar, byTheClock, lasting } from './clock'
import type { PastIncident } from './past_incidents'
import { costOf } from './explain'
import type { Candidate, ManagerEvent } from './types'

export interface Report {
  incident: PastIncident
  robot: string
  events: ManagerEvent[]
  cause: string
  outcome: string
  seconds: number
  at: number // when it is written, by the clock on the wall, as all times here
}

// Names come from the robot: what they say is only text.
const kEscapes: Record<string, string> = { '&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;', "'": '&#39;' }
const safe = (text: unknown) => String(text).replace(/[&<>"']/g, (c) => kEscapes[c])

const kStyle = `:root{color-scheme:light dark}body{font:15px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem}
table{border-collapse:collapse;width:100%;margin:.4rem 0 1rem}td,th{text-align:left;vertical-align:top;padding:.2rem .8rem .2rem 0;border-bottom:1px solid #8885}
th{font-weight:600}time,td:first-child{font-variant-numeric:tabular-nums;white-space:nowrap}svg{width:100%;height:auto;background:#8881;border-radius:6px}
.ERROR{fill:#c4362b}.WARNING{fill:#b07a10}.NON_CRITICAL{fill:#3f7fb8}text{fill:currentColor;font-size:12px}line{stroke:#8886}`

const kWide = 900
const kNames = 170
const kRow = 24

function timeline({ incident, events, seconds }: Report): string {
  const end = incident.clock + seconds
  const margin = Math.max(0.1, 0.05 * seconds)
  const [begin, last] = [incident.clock - margin, end + margin]
  const x = (t: number) => kNames + ((t - begin) / (last - begin)) * (kWide - kNames)
  const rows = incident.rules.map((rule, row) => {
    const own = events.filter((e) => e.rule === rule)
    const bars: string[] = []
    let from: ManagerEvent | null = null
    const bar = (to: number) => {
      const width = Math.max(3, x(to) - x(from!.t))
      return `<rect class="${from!.criticality}" x="${x(from!.t)}" y="${row * kRow + 5}" width="${width}" height="${kRow - 10}" rx="2"/>`
    }
    for (const event of own) {
      if (event.type === 'failure_detected') from = event
      if (from && (event.type === 'failure_resolved' || event.type === 'failure_lost')) {
        bars.push(bar(event.t))
        from = null
      }
    }
    if (from) bars.push(bar(end))
    const mark = (e: ManagerEvent) => `<text x="${x(e.t)}" y="${row * kRow + 17}" text-anchor="middle">${e.dry_run ? '▽' : '▼'}</text>`
    const marks = own.filter((e) => e.type === 'strategy_chosen').map(mark)
    return `<text x="0" y="${row * kRow + 17}">${safe(rule)}</text>${bars.join('')}${marks.join('')}`
  })
  const height = incident.rules.length * kRow
  const axis = ticks(begin, last, 6, (t) => t).map(({ at, label }) => {
    const line = `<line x1="${x(at)}" x2="${x(at)}" y1="0" y2="${height}"/>`
    return `${line}<text x="${x(at)}" y="${height + 16}" text-anchor="middle">${safe(label)}</text>`
  })
  return `<svg viewBox="0 0 ${kWide} ${height + 22}" role="img" aria-label="Failures over time">${axis.join('')}${rows.join('')}</svg>`
}

const row = (cells: string[]) => `<tr>${cells.map((c) => `<td>${c}</td>`).join('')}</tr>`
const table = (head: string[], rows: string[]) => `<table><thead><tr>${head.map((h) => `<th>${h}</th>`).join('')}</tr></thead><tbody>${rows.join('')}</tbody></table>`

function decision(event: ManagerEvent): string {
  const time = byTheClock(event.t, 2)
  const isChosen = (name: string) => event.type === 'strategy_chosen' && event.strategy === name
  const why = (c: Candidate) => (isChosen(c.strategy) ? '<b>chosen</b>' : safe(c.excluded?.text ?? ''))
  const candidates = (event.candidates ?? []).map((c) => row([safe(c.strategy), costOf(c), why(c)]))
  const suspects = (event.suspects ?? []).map((s) => `${safe(s.component)} ${(100 * s.probability).toFixed(0)} %`).join(', ')
  return `<h3><time>${time}</time> ${safe(event.text)}</h3>${suspects && `<p>Who may be responsible: ${suspects}</p>`}${table(['strategy', 'cost', 'why, or why not'], candidates)}`
}

export function incidentAsHtml(report: Report): string {
  const { incident, events, robot, cause, outcome, seconds, at } = report
  const title = `${cause}, ${byTheCalendar(incident.clock)} ${byTheClock(incident.clock)}`
  const facts = [
    row(['robot', safe(robot)]),
    row(['cause', `<b>${safe(cause)}</b>`]),
    row(['what suffered', safe(incident.consequences.join(', ') || 'nothing else')]),
    row(['lasted', `${lasting(seconds)}${incident.over ? '' : ' so far'}`]),
    row(['what helped', safe(outcome)]),
  ]
  const decisions = events.filter((e) => (e.candidates?.length ?? 0) > 0).map(decision)
  const log = events.map((e) => row([byTheClock(e.t, 3), safe(e.label), safe(e.text)]))
  return `<!doctype html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1"><title>${safe(title)}</title><style>${kStyle}</style></head><body>
<h1>${safe(title)}</h1><table><tbody>${facts.join('')}</tbody></table>
<h2>When</h2>${timeline(report)}
<h2>What was decided</h2>${decisions.join('') || '<p>Nothing was decided.</p>'}
<h2>What happened</h2>${table(['time', '', 'what'], log)}
<p>Written by culprit, ${byTheCalendar(at)} ${byTheClock(at)}. Times are those of the clock of whoever wrote this.</p></body></html>
`
}
