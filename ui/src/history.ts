// The events of the live robot or of a finished run, and the selected moment.
import { computed, signal, type ReadonlySignal, type Signal } from '@preact/signals'
import { follow, type Incident, inOrder } from './incidents'
import type { Criticality, Health, ManagerEvent } from './types'

export interface Failure {
  rule: string
  criticality: Criticality
  phase: 'failing' | 'attempting' | 'exhausted'
  since: number
  sinceClock?: number
  decision?: ManagerEvent // the last about it: a strategy was chosen, or it waits
  blame?: ManagerEvent // the last that held somebody responsible, be something done about it or not
  tried: string[]
  retryAt?: number
}

export interface Situation {
  t: number
  failures: Failure[] // most critical first
  incidents: Incident[] // in the order of all views
  gone: Set<string> // components
  blind: Set<string> // rules
}

const kLevels: Criticality[] = ['NON_CRITICAL', 'WARNING', 'ERROR']
export const level = (health: Health) =>
  health === 'EXHAUSTED' ? 3 : kLevels.indexOf(health as Criticality)

export const healthOf = (failure: Failure): Health => (failure.phase === 'exhausted' ? 'EXHAUSTED' : failure.criticality)

// Goes through what happened up to `t`.
function situationAt(history: ManagerEvent[], t: number): Situation {
  const failures = new Map<string, Failure>()
  const gone = new Set<string>()
  const blind = new Set<string>()
  const incidents = new Map<string, Incident>()
  for (const event of history) {
    if (event.t > t) break
    follow(incidents, event)
    const failure = event.rule ? failures.get(event.rule) : undefined
    switch (event.type) {
      case 'failure_detected':
        failures.set(event.rule!, {
          rule: event.rule!,
          criticality: event.criticality!,
          phase: 'failing',
          since: event.t,
          sinceClock: event.clock,
          tried: [],
        })
        break
      case 'failure_resolved':
      case 'failure_lost':
        failures.delete(event.rule!)
        break
      case 'strategy_chosen':
        if (!failure) break
        failure.decision = failure.blame = event
        failure.phase = event.dry_run ? 'failing' : 'attempting'
        break
      case 'approval_asked':
        if (!failure) break
        failure.decision = failure.blame = event
        break
      case 'action_held_back': // paused, muted, or beyond a limit: whose fault it is is known nevertheless
        if (!failure) break
        if (event.candidates?.length || !failure.decision?.candidates?.length) failure.decision = event
        failure.blame = event
        break
      case 'failure_held_back':
        if (!failure) break
        failure.decision = event
        if (event.candidates?.some((c) => c.excluded?.failure)) failure.blame = undefined // it is the fault of another
        break
      case 'strategy_abandoned':
      case 'last_resort_done':
        if (failure) failure.phase = 'failing'
        break
      case 'strategy_failed':
        if (!failure) break
        failure.phase = 'failing'
        failure.tried.push(event.strategy!)
        break
      case 'round_spent':
        if (!failure) break
        failure.retryAt = event.retry_at ?? undefined
        failure.tried = []
        break
      case 'rule_exhausted':
        if (failure) failure.phase = 'exhausted'
        break
      case 'reloaded': // what is still there is detected anew
        failures.clear()
        gone.clear()
        blind.clear()
        break
      case 'rule_blind':
        blind.add(event.rule!)
        break
      case 'rule_sees':
        blind.delete(event.rule!)
        break
      case 'component_lost':
        gone.add(event.component!)
        break
      case 'component_found':
        gone.delete(event.component!)
        break
    }
  }
  return { t, failures: [...failures.values()], incidents: inOrder(incidents.values()), gone, blind }
}

const sorted = (failures: Failure[]) =>
  [...failures].sort((a, b) => level(b.criticality) - level(a.criticality) || a.since - b.since)

export interface View {
  isOver: boolean // nothing more will happen
  events: ReadonlySignal<ManagerEvent[]>
  newest: ReadonlySignal<number> // up to when it is known
  moment: Signal<number | null> // in seconds, as all times of the events; null: the newest
  isNewest: ReadonlySignal<boolean>
  windowLength: Signal<number> // of the timeline, in seconds
  windowEnd: Signal<number | null> // null: the newest
  oldest: () => number // from when on it is about the robot
  clockOf?: (t: number) => number // what the clock on the wall showed; nothing of a run that never was
  situation: ReadonlySignal<Situation>
  situationAt: (t: number | null) => Situation // of another moment; null: the newest
  // The components that are held responsible, and for what.
  culprits: ReadonlySignal<Map<string, Failure>>
}

const kUsualWindow = 120

interface Extent {
  isOver: boolean
  // Failures that are known of otherwise than by events, at the newest moment.
  complete?: (failures: Failure[]) => Failure[]
  incidents?: () => Incident[] | undefined // at the newest moment, if they are told otherwise than by events
  clockOf?: (t: number) => number
  oldest?: () => number
}

export function viewOf(
  events: ReadonlySignal<ManagerEvent[]>,
  newest: ReadonlySignal<number>,
  { isOver, complete, incidents, clockOf, oldest = () => 0 }: Extent
): View {
  const moment = signal<number | null>(null)
  const isNewest = computed(() => moment.value === null)
  const at = (t: number | null): Situation => {
    const told = situationAt(events.value, t ?? Infinity)
    const failures = t === null && complete ? [...told.failures, ...complete(told.failures)] : told.failures
    const present = t === null ? incidents?.() : undefined
    return { ...told, failures: sorted(failures), incidents: present ?? told.incidents }
  }
  const situation = computed(() => at(moment.value))
  const culprits = computed(() => {
    const blamed = new Map<string, Failure>()
    const { incidents: open, failures } = situation.value
    for (const incident of open) {
      const root = failures.find((f) => f.rule === incident.rule)
      if (!incident.certain || !root) continue
      for (const component of incident.components) blamed.set(component, root)
    }
    return blamed
  })
  const windowLength = signal(isOver ? Infinity : kUsualWindow)
  const windowEnd = signal<number | null>(null)
  return { isOver, events, newest, moment, isNewest, windowLength, windowEnd, clockOf, oldest, situation, situationAt: at, culprits }
}
