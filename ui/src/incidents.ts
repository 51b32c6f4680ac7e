// Incidents as culprit finds them: one cause, and what fails because of it. The page computes none: the present ones
// stand in the state, those of an earlier moment in the events.
import type { Criticality, Health, ManagerEvent } from './types'

export interface Incident {
  id: string
  headline: string // "camera is down"
  health: Health // of the worst of its failures
  since: number
  rule: string // the failure that explains the others
  components: string[] // that are held responsible, or are about to be
  certain: boolean // the manager holds them responsible
  host: string | null // the unreachable host, where they are: it is what is wrong
  consequences: string[] // rules
  needs_person: boolean
  doing?: string // at present only
  next?: string
}

const kNanosecond = 1e-9 // s

function incidentOf(event: ManagerEvent): Incident {
  return {
    id: event.incident!,
    headline: event.headline!,
    health: event.exhausted ? 'EXHAUSTED' : event.criticality!,
    since: event.t - (event.age_ns ?? 0) * kNanosecond,
    rule: event.rule!,
    components: event.components ?? [],
    certain: event.certain ?? false,
    host: event.host ?? null,
    consequences: event.consequences ?? [],
    needs_person: event.needs_person ?? false,
  }
}

// The change of the open incidents by an event.
export function follow(open: Map<string, Incident>, event: ManagerEvent): void {
  if (event.type === 'incident_opened' || event.type === 'incident_changed') open.set(event.incident!, incidentOf(event))
  if (event.type === 'incident_closed') open.delete(event.incident!)
  if (event.type === 'reloaded') open.clear() // what is still there is opened anew
}

const kOrder: Criticality[] = ['ERROR', 'WARNING', 'NON_CRITICAL']
const gravity = ({ health }: Incident) => (health === 'EXHAUSTED' ? -1 : kOrder.indexOf(health as Criticality))

// As in the state.
export const inOrder = (open: Iterable<Incident>): Incident[] =>
  [...open].sort((a, b) => Number(b.needs_person) - Number(a.needs_person) || gravity(a) - gravity(b) || a.since - b.since)

export const listed = (words: string[]) =>
  words.length < 2 ? words.join('') : `${words.slice(0, -1).join(', ')} and ${words[words.length - 1]}`
