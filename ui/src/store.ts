// What the page knows: the documents of the stream as signals, and the situation at the moment that
// is looked at, which may be in the past.
import { computed, signal } from '@preact/signals'
import { call, follow } from './api'
import type { ControlState, Criticality, Graph, Health, ManagerEvent, Robot, State } from './types'

export const calls = signal<Set<string>>(new Set())
export const can = (method: string, path: string) => calls.value.has(`${method} ${path}`)

export const isConnected = signal(false)
export const robot = signal<Robot | null>(null)
export const graph = signal<Graph>({ nodes: [], edges: [] })
export const state = signal<State | null>(null)
export const control = signal<ControlState | null>(null)
export const events = signal<ManagerEvent[]>([])

// Seconds since the start of the manager; null: now.
export const moment = signal<number | null>(null)
export const selected = signal<string | null>(null) // a component
export const isLive = computed(() => moment.value === null)

const kMostEvents = 4096

export async function start(): Promise<void> {
  const about = await call<{ calls: string[] }>('GET', '/api/about')
  calls.value = new Set(about.calls)
  if (!can('get', '/api/stream')) return
  let waiting: ManagerEvent[] = []
  // Events come in bursts: the page is drawn once for all of one frame.
  const show = () => {
    if (waiting.length === 0) return
    events.value = [...events.value, ...waiting].slice(-kMostEvents)
    waiting = []
  }
  void follow(
    ({ event, data }) => {
      const document = JSON.parse(data)
      if (event === 'hello' && !document.resumed) events.value = []
      if (event === 'robot') robot.value = document
      if (event === 'graph') graph.value = document
      if (event === 'state') state.value = document
      if (event === 'control') control.value = document
      if (event === 'event') {
        if (waiting.length === 0) requestAnimationFrame(show)
        waiting.push(document)
      }
    },
    (connected) => (isConnected.value = connected)
  )
}

export interface Failure {
  rule: string
  criticality: Criticality
  phase: 'failing' | 'attempting' | 'exhausted'
  since: number
  decision?: ManagerEvent // the last about it: "decided" or "waiting"
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
    switch (event.kind) {
      case 'detected':
        failures.set(event.rule!, {
          rule: event.rule!,
          criticality: event.criticality!,
          phase: 'failing',
          since: event.t,
          tried: [],
        })
        break
      case 'resolved':
      case 'lost_sight':
        failures.delete(event.rule!)
        break
      case 'decided':
        if (!failure) break
        failure.decision = event
        failure.phase = event.dry_run ? 'failing' : 'attempting'
        break
      case 'waiting':
      case 'approval_asked':
        if (failure) failure.decision = event
        break
      case 'abandoned':
        if (failure) failure.phase = 'failing'
        break
      case 'no_help':
        if (!failure) break
        failure.phase = 'failing'
        failure.tried.push(event.strategy!)
        break
      case 'pause':
        if (!failure) break
        failure.retryAt = event.retry_at ?? undefined
        failure.tried = []
        break
      case 'exhausted':
        if (failure) failure.phase = 'exhausted'
        break
      case 'lost':
        gone.add(event.component!)
        break
      case 'found':
        gone.delete(event.component!)
        break
    }
  }
  const list = [...failures.values()]
  list.sort((a, b) => level(b.criticality) - level(a.criticality) || a.since - b.since)
  return { t, failures: list, gone }
}

export const now = computed(() =>
  Math.max(state.value?.t ?? 0, events.value.length ? events.value[events.value.length - 1].t : 0)
)
export const situation = computed(() =>
  situationAt(events.value, moment.value === null ? Infinity : moment.value)
)

// Who is being adapted, and for what: the components that are held responsible.
export const culprits = computed(() => {
  const blamed = new Map<string, Failure>()
  for (const failure of situation.value.failures) {
    if (failure.decision?.kind !== 'decided' || failure.phase === 'exhausted') continue
    for (const component of failure.decision.components ?? []) {
      if (!blamed.has(component)) blamed.set(component, failure)
    }
  }
  return blamed
})

// Health of components: as sick as the most critical failure whose strategies touch them.
export const health = computed(() => {
  const result = new Map<string, Health>()
  const rules = new Map(robot.value?.rules.map((r) => [r.name, r]) ?? [])
  for (const failure of situation.value.failures) {
    const sick: Health = failure.phase === 'exhausted' ? 'EXHAUSTED' : failure.criticality
    for (const component of rules.get(failure.rule)?.components ?? []) {
      const before = result.get(component)
      if (!before || level(sick) > level(before)) result.set(component, sick)
    }
  }
  return result
})
