// What the page knows of the robot that runs: the documents of the stream as signals, and a view of
// what happened.
import { batch, computed, signal } from '@preact/signals'
import { call, follow } from './api'
import { level, viewOf } from './history'
import type { ComponentState, ControlState, Graph, Health, ManagerEvent, Robot, Rule, State, TopicState } from './types'

export const calls = signal<Set<string>>(new Set())
export const can = (method: string, path: string) => calls.value.has(`${method} ${path}`)

export const isConnected = signal(false)
export const robot = signal<Robot | null>(null)
export const graph = signal<Graph>({ nodes: [], edges: [] })
export const state = signal<State | null>(null)
export const control = signal<ControlState | null>(null)
export const events = signal<ManagerEvent[]>([])

export const selected = signal<string | null>(null) // a component

const kMostEvents = 4096

export async function start(): Promise<void> {
  const about = await call<{ calls: string[] }>('GET', '/api/about')
  calls.value = new Set(about.calls)
  if (!can('get', '/api/stream')) return
  // What comes in bursts is drawn once for all of one frame. Of all but events only the newest counts.
  const newest: Partial<Record<string, unknown>> = {}
  let waiting: ManagerEvent[] = []
  let count = 0
  let frame = 0
  const show = () => {
    frame = 0
    batch(() => {
      if (newest.robot) {
        // The lists of a state are in the order of the rule set that it was told for.
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
      const document = JSON.parse(data)
      if (event === 'hello') {
        if (document.resumed) return
        events.value = []
        waiting = []
      } else if (event === 'event') {
        waiting.push({ ...document, number: ++count })
        if (waiting.length > kMostEvents) waiting.shift() // nobody looks: browsers draw no frames then
      } else {
        if (event === 'robot') delete newest.state
        newest[event] = document
      }
      if (frame === 0) frame = requestAnimationFrame(show)
    },
    (connected) => (isConnected.value = connected)
  )
}

// Where things stand in the lists of a state, and who is about whom: for robots of many parts.
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
export const live = viewOf(events, now, { isOver: false })
export const { moment, isNewest: isLive, situation, culprits } = live

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
