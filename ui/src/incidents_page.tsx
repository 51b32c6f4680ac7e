// What went wrong so far: a list, and each with its timeline, its decisions and what was not chosen; to look at, to link
// to, and to send to somebody.
import { computed, signal } from '@preact/signals'
import { byTheClock, lasting, when } from './clock'
import { download } from './download'
import { Candidates, Suspects } from './explain'
import { nowByTheClock } from './freshness'
import { viewOf } from './history'
import { listed } from './incidents'
import { incidentAsHtml } from './incident_export'
import { type PastIncident, pastIncidents } from './past_incidents'
import { kSigns, type Tone } from './status'
import { clockAt, events, now, robot } from './store'
import { EventLog, Timeline } from './timeline'

const all = computed(() => pastIncidents(events.value))
const chosenId = signal('')
export const showIncident = (id: string) => void (chosenId.value = id)
const chosen = computed(() => all.value.find((i) => i.id === chosenId.value) ?? all.value[0])

const kMargin = 0.1 // of its duration, before and behind it
const endOf = (incident: PastIncident) => incident.to ?? now.value
const marginOf = (incident: PastIncident) => Math.max(0.2, kMargin * (endOf(incident) - incident.from))

const view = viewOf(
  computed(() => chosen.value?.events ?? []),
  computed(() => (chosen.value ? endOf(chosen.value) + (chosen.value.to === null ? 0 : marginOf(chosen.value)) : 0)),
  {
    isOver: true,
    clockOf: clockAt,
    oldest: () => (chosen.value ? Math.max(0, chosen.value.from - marginOf(chosen.value)) : 0),
  }
)

export const causeOf = (incident: PastIncident) => listed(incident.causes) || incident.rules[0]
// Failures at components that were not blamed themselves.
export function consequencesOf(incident: PastIncident): string[] {
  const componentsOf = (rule: string) => robot.value?.rules.find((r) => r.name === rule)?.components ?? []
  return incident.rules.slice(1).filter((rule) => !componentsOf(rule).some((c) => incident.causes.includes(c)))
}
export function outcomeOf(incident: PastIncident): string {
  if (incident.isGivenUp) return 'given up: a person must look'
  if (incident.to === null) return 'not over'
  return listed(incident.helped) || 'went away by itself'
}
const lastingOf = (incident: PastIncident) => endOf(incident) - incident.from

function List() {
  return (
    <table class="incident-list">
      <thead>
        <tr>
          <th scope="col">when</th>
          <th scope="col">cause</th>
          <th scope="col">what suffered</th>
          <th scope="col">for</th>
          <th scope="col">what helped</th>
        </tr>
      </thead>
      <tbody>
        {all.value.map((incident) => (
          <tr class={incident === chosen.value ? 'chosen' : ''}>
            <th scope="row">
              <a href={`#incidents/${incident.id}`} aria-current={incident === chosen.value ? 'true' : undefined}>
                {when(incident.clock)}
              </a>
            </th>
            <td>
              <span class={incident.worst} aria-hidden="true">
                {kSigns[incident.worst as Tone]}
              </span>{' '}
              <b>{causeOf(incident)}</b>
            </td>
            <td>{consequencesOf(incident).join(', ') || 'nothing else'}</td>
            <td class="number">{lasting(lastingOf(incident))}</td>
            <td>{outcomeOf(incident)}</td>
          </tr>
        ))}
      </tbody>
    </table>
  )
}

function Decisions({ incident }: { incident: PastIncident }) {
  const decisions = incident.events.filter((e) => (e.candidates?.length ?? 0) > 0)
  return (
    <section aria-label="Decisions">
      <h2>What was decided</h2>
      {decisions.length === 0 && <p class="muted">Nothing was decided.</p>}
      {decisions.map((event) => (
        <details key={event.number} class="why">
          <summary>
            <time>{byTheClock(event.clock ?? clockAt(event.t), 2)}</time> {event.text}
          </summary>
          <Suspects decision={event} rule={event.rule!} />
          <Candidates list={event.candidates ?? []} chosen={event.type === 'strategy_chosen' ? event.strategy : null} />
        </details>
      ))}
    </section>
  )
}

function Details({ incident }: { incident: PastIncident }) {
  const send = () => {
    const facts = { cause: causeOf(incident), consequences: consequencesOf(incident), outcome: outcomeOf(incident), seconds: lastingOf(incident) }
    const html = incidentAsHtml({ incident, ...facts, robot: robot.value?.robot ?? '', end: endOf(incident), clockOf: clockAt, at: nowByTheClock() })
    download(`incident-${incident.id}.html`, html, 'text/html')
  }
  return (
    <section class="incident-details" aria-label="Incident">
      <div class="bar">
        <h2>
          {causeOf(incident)}, {when(incident.clock)}
        </h2>
        <button type="button" onClick={send}>
          Save as a page to send …
        </button>
      </div>
      <p>
        {incident.to === null ? 'It has lasted for' : 'It lasted'} {lasting(lastingOf(incident))}.{' '}
        {consequencesOf(incident).length > 0 && `${listed(consequencesOf(incident))} suffered. `}
        {incident.to !== null && `What helped: ${outcomeOf(incident)}.`}
      </p>
      <Timeline view={view} />
      <div class="columns">
        <Decisions incident={incident} />
        <EventLog view={view} />
      </div>
    </section>
  )
}

export function IncidentsPage() {
  return (
    <main class="incidents">
      <h2>What went wrong since culprit began to watch</h2>
      {all.value.length === 0 ? <p class="headline well">Nothing so far.</p> : <List />}
      {chosen.value && <Details incident={chosen.value} />}
    </main>
  )
}
