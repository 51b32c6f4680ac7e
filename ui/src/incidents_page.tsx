// Past incidents: a list and a timeline of days. Each has its own timeline, its decisions and the rejected candidates; to
// read, to link to, and to send.
import { computed, signal, useSignal } from '@preact/signals'
import { useEffect, useRef } from 'preact/hooks'
import { fileAt } from './api'
import { byTheClock, lasting, when } from './clock'
import { download } from './download'
import { PlotLink, Reasons } from './explain'
import { nowByTheClock } from './freshness'
import { viewOf } from './history'
import { listed } from './incidents'
import { answer, chosen, chosenId, followIncidents, incidents, kPeriods, type PastIncident, period, told, trouble } from './past_incidents'
import { kLooks } from './looks'
import { EventLog, Timeline } from './timeline'
import type { ManagerEvent } from './types'

export const showIncident = (id: string) => void (chosenId.value = id)

const itself = (clock: number) => clock // times of incidents are those of the clock on the wall
const lastingOf = (incident: PastIncident) => (incident.over ? incident.seconds : Math.max(incident.seconds, nowByTheClock() - incident.clock))
const kMargin = 0.1 // of its duration, before and behind it
const marginOf = (incident: PastIncident) => Math.max(0.2, kMargin * lastingOf(incident))

const view = viewOf(
  computed(() => (chosen.value ? told.value.events : [])),
  computed(() => (chosen.value ? chosen.value.clock + lastingOf(chosen.value) + (chosen.value.over ? marginOf(chosen.value) : 0) : 1)),
  { isOver: true, clockOf: itself, oldest: () => (chosen.value ? chosen.value.clock - marginOf(chosen.value) : 0) }
)

export const causeOf = (incident: PastIncident) => listed(incident.causes) || incident.rules[0]
export function outcomeOf(incident: PastIncident): string {
  if (incident.given_up) return 'exhausted: a person must look'
  if (!incident.over) return 'still open'
  if (incident.merged_into) return `part of ${incident.merged_into}`
  if (incident.lost) return 'can no longer be evaluated'
  if (incident.cut) return 'unknown: culprit ended before'
  return listed(incident.helped) || 'cleared without a repair'
}

// All of them as the failures of one timeline, by cause.
const asEvents = computed((): ManagerEvent[] =>
  [...incidents.value].sort((a, b) => a.clock - b.clock).flatMap((incident): ManagerEvent[] => {
    const both = { number: 0, label: '', tone: '', severity: 'info' as const, rule: causeOf(incident), text: '' }
    const text = `${when(incident.clock)}, ${lasting(incident.seconds)}: ${outcomeOf(incident)}`
    const from: ManagerEvent = { ...both, t: incident.clock, type: 'failure_detected', criticality: incident.worst, link: `#incidents/${incident.id}` }
    return incident.over ? [from, { ...both, t: incident.clock + incident.seconds, type: 'failure_resolved', text }] : [from]
  })
)
// A timeline of a day need not be drawn anew each second.
const kCoarse = 10 // s
const coarsely = computed(() => Math.ceil(nowByTheClock() / kCoarse) * kCoarse)
const overview = viewOf(asEvents, coarsely, { isOver: false, clockOf: itself, oldest: () => coarsely.value - period.value })
overview.windowLength.value = Infinity

const kMostShown = 100 // of a list that one can read, unless one asks for all
const showsAll = signal(false)

// In a box of its own: the one that is looked at stands below, and is not to be looked for behind a hundred others.
function List() {
  const box = useRef<HTMLDivElement>(null)
  const id = chosen.value?.id
  useEffect(() => box.current!.querySelector('.chosen')?.scrollIntoView({ block: 'nearest' }), [id])
  return (
    <div class="incident-box" ref={box}>
      <table class="incident-list">
        <thead>
          <tr>
            <th scope="col">start</th>
            <th scope="col">cause</th>
            <th scope="col">effects</th>
            <th scope="col" class="number">duration</th>
            <th scope="col">outcome</th>
          </tr>
        </thead>
        <tbody>
          {incidents.value.slice(0, showsAll.value ? undefined : kMostShown).map((incident) => (
            <tr class={incident === chosen.value ? 'chosen' : ''}>
              <th scope="row">
                <a href={`#incidents/${incident.id}`} aria-current={incident === chosen.value ? 'true' : undefined}>
                  {when(incident.clock)}
                </a>
              </th>
              <td>
                <span class={incident.worst} aria-hidden="true">
                  {kLooks[incident.worst].sign}
                </span>{' '}
                <b>{causeOf(incident)}</b>
              </td>
              <td>{incident.consequences.join(', ') || 'nothing else'}</td>
              <td class="number">{lasting(lastingOf(incident))}</td>
              <td>{outcomeOf(incident)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  )
}

function Decisions() {
  const decisions = told.value.events.filter((e) => (e.candidates?.length ?? 0) > 0)
  return (
    <section aria-label="Decisions">
      <h2>Decisions</h2>
      {decisions.length === 0 && <p class="muted">No decisions.</p>}
      {decisions.map((event) => (
        <details key={event.number} class="why">
          <summary>
            <time>{byTheClock(event.clock!, 2)}</time> {event.text}
          </summary>
          <Reasons decision={event} />
        </details>
      ))}
    </section>
  )
}

// As it was recorded: what came in, and what was decided, to be played again; and what the robot's topics said.
function Recordings({ incident }: { incident: PastIncident }) {
  const journal = answer.value?.journal
  const save = async (name: string) => {
    try {
      download(name, await fileAt(`/api/incidents/recording?name=${encodeURIComponent(name)}`), 'application/octet-stream')
    } catch (error) {
      trouble.value = (error as Error).message
    }
  }
  return (
    <>
      {journal && (
        <p class="muted">
          Recorded in <code>{journal}</code>: <code>culprit replay</code> plays it again, also with other rules.
        </p>
      )}
      {(incident.recordings ?? []).map(({ name, path, bytes }) => (
        <p>
          <button type="button" onClick={() => void save(name)}>
            Save the robot's topics (MCAP, {(bytes / 1e6).toFixed(1)} MB)
          </button>{' '}
          <span class="muted">
            from <code>{path}</code>; for Foxglove, <code>ros2 bag</code> and <code>culprit replay</code>
          </span>
        </p>
      ))}
    </>
  )
}

const kPlottedBefore = 30 // s, and behind it

function Details({ incident }: { incident: PastIncident }) {
  const isMaking = useSignal(false)
  // Reading a recording takes a while.
  const send = async () => {
    isMaking.value = true
    const from = answer.value?.journal === null ? '&from=stream' : ''
    try {
      download(`incident-${incident.id}.html`, await fileAt(`/api/incidents/page?id=${incident.id}${from}`), 'text/html')
    } catch (error) {
      trouble.value = (error as Error).message
    }
    isMaking.value = false
  }
  return (
    <section class="incident-details" aria-label="Incident">
      <div class="bar">
        <h2>
          {causeOf(incident)}, {when(incident.clock)}
        </h2>
        <button type="button" disabled={isMaking.value} onClick={() => void send()}>
          {isMaking.value ? 'Making it …' : 'Save as a page to send …'}
        </button>
      </div>
      <p>
        {incident.over ? 'It lasted' : 'It has lasted for'} {lasting(lastingOf(incident))}.{' '}
        {incident.consequences.length > 0 && `Effects: ${listed(incident.consequences)}. `}
        {incident.over && `Outcome: ${outcomeOf(incident)}.`}
      </p>
      <PlotLink rules={incident.rules} range={{ from: incident.clock - kPlottedBefore, to: incident.clock + lastingOf(incident) + kPlottedBefore }} />
      <Recordings incident={incident} />
      <Timeline view={view} />
      <div class="columns">
        <Decisions />
        <EventLog view={view} />
      </div>
    </section>
  )
}

function Head() {
  const { remark, oldest } = answer.value ?? {}
  return (
    <div class="bar">
      <h2>Incidents</h2>
      <label>
        in the last{' '}
        <select value={String(period.value)} onChange={(e) => (period.value = Number(e.currentTarget.value))}>
          {kPeriods.map(([seconds, name]) => (
            <option value={String(seconds)}>{name}</option>
          ))}
        </select>
      </label>
      <span class="muted">
        {remark && `Only the latest events: ${remark}.`}
        {oldest ? `The journal begins ${when(oldest)}.` : ''}
      </span>
    </div>
  )
}

export function IncidentsPage() {
  useEffect(followIncidents, [])
  const isMissing = answer.value !== null && chosenId.value !== '' && !chosen.value
  return (
    <main class="incidents">
      <Head />
      {trouble.value && <p class="sick" role="alert">◆ {trouble.value}</p>}
      {answer.value === null && !trouble.value && <p>Reading the journal …</p>}
      {answer.value !== null && incidents.value.length === 0 && <p>No incidents in this time.</p>}
      {isMissing && <p role="alert">The journal has no incident with this address.</p>}
      {incidents.value.length > 0 && (
        <>
          {incidents.value.length > 1 && <Timeline view={overview} label="All incidents" hasMoment={false} />}
          <List />
        </>
      )}
      {incidents.value.length > kMostShown && !showsAll.value && (
        <p>
          <button type="button" onClick={() => (showsAll.value = true)}>
            Show all {incidents.value.length}
          </button>
        </p>
      )}
      {chosen.value && <Details key={chosen.value.id} incident={chosen.value} />}
    </main>
  )
}
