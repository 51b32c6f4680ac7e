// What happened, and a moment of it that is looked at: of the robot that runs, or of a run that is
// over.
import { computed, signal, type ReadonlySignal, type Signal } from '@preact/signals'
import type { Criticality, Health, ManagerEvent } from './types'

export interface Failure {
  rule: string
  criticality: Criticality
  phase: 'failing' | 'attempting' | 'exhausted'
  since: number
  decision?: ManagerEvent // the last about it: a strategy was chosen, or it waits
  tried: string[]
  retryAt?: number
}

export interface Situation {
  t: number
  failures: Failure[] // most critical first
  gone: Set<string> // components
}

const kLevels: Criticality[] = ['NON_CRITICAL', 'WARNING', 'ERROR']
export const level = (health: Health) =>
  health === 'EXHAUSTED' ? 3 : kLevels.indexOf(health as Criticality)

// Goes through what happened up to `t`.
export function situationAt(history: ManagerEvent[], t: number): Situation {
  const failures = new Map<string, Failure>()
  const gone = new Set<string>()
  for (const event of history) {
    if (event.t > t) break
    const failure = event.rule ? failures.get(event.rule) : undefined
    switch (event.type) {
      case 'failure_detected':
        failures.set(event.rule!, {
          rule: event.rule!,
          criticality: event.criticality!,
          phase: 'failing',
          since: event.t,
          tried: [],
        })
        break
      case 'failure_resolved':
      case 'failure_lost':
        failures.delete(event.rule!)
        break
      case 'strategy_chosen':
        if (!failure) break
        failure.decision = event
        failure.phase = event.dry_run ? 'failing' : 'attempting'
        break
      case 'failure_held_back':
      case 'approval_asked':
        if (failure) failure.decision = event
        break
      case 'strategy_abandoned':
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
        break
      case 'component_lost':
        gone.add(event.component!)
        break
      case 'component_found':
        gone.delete(event.component!)
        break
    }
  }
  const list = [...failures.values()]
  list.sort((a, b) => level(b.criticality) - level(a.criticality) || a.since - b.since)
  return { t, failures: list, gone }
}

export interface View {
  isOver: boolean // nothing more will happen
  events: ReadonlySignal<ManagerEvent[]>
  newest: ReadonlySignal<number> // up to when it is known
  moment: Signal<number | null> // in seconds, as all times of the events; null: the newest
  isNewest: ReadonlySignal<boolean>
  windowLength: Signal<number> // of the timeline, in seconds
  situation: ReadonlySignal<Situation>
  // Who is being adapted, and for what: the components that are held responsible.
  culprits: ReadonlySignal<Map<string, Failure>>
}

const kUsualWindow = 120

export function viewOf(
  events: ReadonlySignal<ManagerEvent[]>,
  newest: ReadonlySignal<number>,
  { isOver }: { isOver: boolean }
): View {
  const moment = signal<number | null>(null)
  const isNewest = computed(() => moment.value === null)
  const situation = computed(() => situationAt(events.value, moment.value ?? Infinity))
  const culprits = computed(() => {
    const blamed = new Map<string, Failure>()
    for (const failure of situation.value.failures) {
      if (failure.decision?.type !== 'strategy_chosen' || failure.phase === 'exhausted') continue
      for (const component of failure.decision.components ?? []) {
        if (!blamed.has(component)) blamed.set(component, failure)
      }
    }
    return blamed
  })
  const windowLength = signal(isOver ? Infinity : kUsualWindow)
  return { isOver, events, newest, moment, isNewest, windowLength, situation, culprits }
}
