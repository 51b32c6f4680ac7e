// The page's data of the live robot: the documents of the stream as signals, and a view of the events.
import { batch, computed, signal } from '@preact/signals'
import { call, follow } from './api'
import { begun, connected, hearsSign, hearsState, nowByTheClock } from './freshness'
import { level, viewOf, type Failure } from './history'
import type { Look } from './looks'
import type { ComponentState, ControlState, Graph, Health, ManagerEvent, Robot, Rule, State, TopicState } from './types'

export const calls = signal<Set<string>>(new Set())
export const can = (method: string, path: string) => calls.value.has(`${method} ${path}`)

export const robot = signal<Robot | null>(null)
export const graph = signal<Graph>({ nodes: [], edges: [] })
export const state = signal<State | null>(null)
export const control = signal<ControlState | null>(null)
export const events = signal<ManagerEvent[]>([])

export const selected = signal<string | null>(null) // a component

const kMostEvents = 4096
const kHiddenPeriod = 500 // ms
const kServerPeriod = 2000 // ms

export async function start(): Promise<void> {
  const about = await call<{ calls: string[] }>('GET', '/api/about')
  calls.value = new Set(about.calls)
  begun()
  if (!can('get', '/api/stream')) return void watchServer()
  // A burst is drawn once per frame. For everything but events only the newest document counts.
  const newest: Partial<Record<string, unknown>> = {}
  let waiting: ManagerEvent[] = []
  let count = 0
  let frame = 0
  const show = () => {
    frame = 0
    batch(() => {
      if (newest.robot) {
        // A state's lists are in the order of its rule set, so new rules drop the older state.
        robot.value = newest.robot as Robot
        state.value = null
      }
      if (newest.graph) graph.value = newest.graph as Graph
      if (newest.state) state.value = newest.state as State
      if (newest.control) control.value = newest.control as ControlState
      if (waiting.length > 0) events.value = [...events.value, ...waiting].slice(-kMostEvents)
    })
    for (const kind of Object.keys(newest)) delete newest[kind]
    waiting = []
  }
  void follow(
    ({ event, data }) => {
      const told = JSON.parse(data)
      if (event === 'hello') {
        if (told.resumed) return
        events.value = []
        waiting = []
      } else if (event === 'event') {
        waiting.push({ ...told, number: ++count })
        if (waiting.length > kMostEvents) waiting.shift() // nobody looks: browsers draw no frames then
      } else {
        if (event === 'robot') delete newest.state
        newest[event] = told
        if (event === 'state') hearsState(told.clock)
      }
      // A hidden page draws no frames, but its title shows the robot's state.
      if (frame === 0) frame = document.hidden ? window.setTimeout(show, kHiddenPeriod) : requestAnimationFrame(show)
    },
    hearsSign,
    connected
  )
}

// Without a robot there are no messages, but whether the server runs matters, too.
async function watchServer(): Promise<void> {
  for (;;) {
    try {
      await call('GET', '/api/about')
      connected(true)
    } catch {
      connected(false)
    }
    await new Promise((resolve) => setTimeout(resolve, kServerPeriod))
  }
}

// The places in the lists of a state, and the relations between components and rules: for robots of
// many parts.
const byPlace = (names: string[]) => new Map(names.map((name, place) => [name, place]))
const placesOfComponents = computed(() => byPlace(robot.value?.components.map((c) => c.name) ?? []))
const placesOfTopics = computed(() => byPlace(robot.value?.topics ?? []))
export const stateOfComponent = (name: string): ComponentState | undefined =>
  state.value?.components[placesOfComponents.value.get(name) ?? -1]
export const stateOfTopic = (name: string): TopicState | undefined =>
  state.value?.topics[placesOfTopics.value.get(name) ?? -1]
export const rulesByComponent = computed(() => {
  const result = new Map<string, Rule[]>()
  for (const rule of robot.value?.rules ?? []) {
    for (const component of rule.components) {
      const list = result.get(component)
      if (list) list.push(rule)
      else result.set(component, [rule])
    }
  }
  return result
})

export const now = computed(() =>
  Math.max(state.value?.t ?? 0, events.value.length ? events.value[events.value.length - 1].t : 0)
)
// The robot as it runs; the moment and all that follows from it.
export const live = viewOf(events, now, {
  isOver: false,
  clockOf: clockAt,
  incidents: () => state.value?.incidents ?? [],
  // Events are forgotten after a while, failures are not.
  complete: (failures) => {
    const last = new Map(events.value.map((e) => [e.rule, e.t]))
    return (robot.value?.rules ?? []).flatMap((rule, place): Failure[] => {
      const told = state.value?.rules[place]
      const isKnown = failures.some((f) => f.rule === rule.name)
      if (!told || told.phase === 'quiet' || isKnown || state.value!.t <= (last.get(rule.name) ?? -1)) return []
      const { name, criticality } = rule
      const phase = told.phase === 'exhausted' ? 'exhausted' : told.attempt ? 'attempting' : 'failing'
      const since = told.since ?? state.value!.t
      return [{ rule: name, criticality, phase, since, sinceClock: clockAt(since), tried: [], retryAt: told.retry_at }]
    })
  },
})
export const { moment, isNewest: isLive, situation, culprits } = live

// By the clock on the wall, when it was `t` seconds since culprit began to watch. Simulated time has its own pace,
// so the nearest published time counts.
export function clockAt(t: number): number {
  let before = state.value ? { t: state.value.t, clock: state.value.clock } : { t, clock: nowByTheClock() }
  const list = events.value
  for (let i = list.length - 1; i >= 0 && before.t > t; --i) {
    const { t: told, clock } = list[i]
    if (clock !== undefined) before = { t: told, clock }
  }
  return before.clock + t - before.t
}

// Rules that are blind: culprit cannot tell whether their failure is present. ERROR rules first.
export const blindRules = computed(() =>
  (robot.value?.rules ?? [])
    .flatMap(({ name, criticality }, i) => {
      const blind = state.value?.rules[i]?.blind
      return blind ? [{ name, criticality, ...blind }] : []
    })
    .sort((a, b) => Number(b.criticality === 'ERROR') - Number(a.criticality === 'ERROR'))
)
export const presentIncidents = computed(() => state.value?.incidents ?? [])

// An earlier moment has its failures only.
const failedThen = computed(() => {
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
// How each component looks now, and at the selected moment.
export const presentLooks = computed(
  () => new Map((robot.value?.components ?? []).map(({ name }, place): [string, Look] => [name, state.value?.components[place]?.look ?? 'UNTOLD']))
)
export const looks = computed((): Map<string, Look> => {
  if (isLive.value) return presentLooks.value
  return new Map((robot.value?.components ?? []).map(({ name }) => [name, failedThen.value.get(name) ?? 'UNTOLD']))
})
// Whether the robot is well, and which components are held responsible: all parts of the page say the same of it in each frame,
// also those that follow the rest at a slower pace.
export const verdict = computed(() => [state.value?.overview.look, ...culprits.value.keys()].join())
// "down", "never seen"; empty: it works.
export const conditionAt = (component: string): string =>
  isLive.value ? (stateOfComponent(component)?.condition ?? '') : situation.value.gone.has(component) ? 'down' : ''
