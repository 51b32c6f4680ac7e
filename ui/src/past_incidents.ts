// What went wrong so far, one entry for each time that the robot was not well.
import { level } from './history'
import type { Criticality, Health, ManagerEvent } from './types'

export interface PastIncident {
  id: string // of its beginning: the same after a reload, and on another machine
  from: number
  to: number | null // null: it lasts
  clock: number // when it began, on the wall
  causes: string[] // components that were held responsible, the first first
  rules: string[] // that saw a failure, the first first
  helped: string[] // strategies
  isGivenUp: boolean
  worst: Health
  events: ManagerEvent[]
}

const kIdBase = 36
const idOf = (event: ManagerEvent) => Math.round(1000 * (event.clock ?? event.t)).toString(kIdBase)

const addTo = (list: string[], names: string[]) => list.push(...names.filter((n) => !list.includes(n)))

// What an event says about whose fault it is and what came of it.
function learn(incident: PastIncident, event: ManagerEvent): void {
  incident.events.push(event)
  if (event.criticality && level(event.criticality as Criticality) > level(incident.worst)) incident.worst = event.criticality
  if (event.type === 'failure_detected') addTo(incident.rules, [event.rule!])
  if (['strategy_chosen', 'approval_asked', 'action_held_back'].includes(event.type)) addTo(incident.causes, event.components ?? [])
  if (event.type === 'failure_resolved' && event.strategy) addTo(incident.helped, [event.strategy])
  if (event.type === 'rule_exhausted') incident.isGivenUp = true
}

const begun = (event: ManagerEvent, before: ManagerEvent[]): PastIncident => ({
  id: idOf(event),
  from: event.t,
  to: null,
  clock: event.clock ?? event.t,
  causes: [],
  rules: [],
  helped: [],
  isGivenUp: false,
  worst: 'OK',
  events: before,
})

// Newest first. What came shortly before belongs to it: a component is lost before a rule sees it.
export function pastIncidents(events: ManagerEvent[]): PastIncident[] {
  const list: PastIncident[] = []
  const open = new Set<string>()
  let now: PastIncident | null = null
  events.forEach((event, place) => {
    if (event.type === 'failure_detected') {
      if (!now) {
        const isPart = (e: ManagerEvent) => e.type === 'component_lost' && event.t - e.t < kShortly
        now = begun(event, events.slice(Math.max(0, place - kBefore), place).filter(isPart))
        list.unshift(now)
      }
      open.add(event.rule!)
    }
    if (!now) return
    learn(now, event)
    if (event.type === 'failure_resolved' || event.type === 'failure_lost') open.delete(event.rule!)
    if (event.type === 'reloaded') open.clear() // what is still there is detected anew
    if (open.size > 0) return
    now.to = event.t
    now = null
  })
  return list
}
const kBefore = 5 // events
const kShortly = 2 // s
