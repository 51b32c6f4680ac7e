// The content of the graph: its nodes and edges, their labels, and the path of a failure.
import { computed, signal } from '@preact/signals'
import { lasting } from './clock'
import { kLooks, type Look } from './looks'
import { conditionAt, culprits, graph, isLive, robot, situation, stateOfComponent, stateOfTopic } from './store'
import type { Graph } from './types'

export const showsAll = signal(false) // also nodes that no rule is about
export const search = signal('')

const kInfrastructure = /^\/(rosout|parameter_events|tf|tf_static|clock|diagnostics)$/
const kMostLabels = 80

const shortName = (name: string) => name.slice(name.lastIndexOf('/') + 1)
export const labelOf = (node: { node: string; component?: string }) => node.component ?? shortName(node.node)

export interface Shown {
  nodes: Graph['nodes']
  edges: Map<string, { from: string; to: string; channels: string[] }>
}

export const shown = computed((): Shown => {
  const wanted = search.value.toLowerCase()
  const nodes = graph.value.nodes.filter(
    (n) =>
      (showsAll.value || n.component !== undefined) && n.node.toLowerCase().includes(wanted)
  )
  const ids = new Set(nodes.map((n) => n.node))
  const edges: Shown['edges'] = new Map()
  for (const [consumer, producer, channel] of graph.value.edges) {
    if (!ids.has(consumer) || !ids.has(producer)) continue
    if (!showsAll.value && kInfrastructure.test(channel)) continue
    const id = `${producer} > ${consumer}`
    const edge = edges.get(id) ?? { from: producer, to: consumer, channels: [] }
    edge.channels.push(channel)
    edges.set(id, edge)
  }
  return { nodes, edges }
})

// The edges on the way from a culprit to what fails because of it.
export const cascade = computed((): Set<string> => {
  const nodeOf = new Map(graph.value.nodes.map((n) => [n.component, n.node]))
  const rules = new Map(robot.value?.rules.map((r) => [r.name, r]) ?? [])
  const path = new Set<string>()
  for (const [culprit, failure] of culprits.value) {
    const goals = new Set(
      [...(failure.decision?.explains ?? []), ...waitingFor(failure.rule)]
        .flatMap((rule) => rules.get(rule)?.components ?? [])
        .map((c) => nodeOf.get(c))
    )
    const start = nodeOf.get(culprit)
    if (start) for (const id of edgesBetween(start, goals)) path.add(id)
  }
  return path
})

// The failures that wait because of `cause`, directly or through others.
function waitingFor(cause: string): string[] {
  const found = [cause]
  for (const rule of found) {
    for (const failure of situation.value.failures) {
      const waits = failure.decision?.candidates?.some((c) => c.excluded?.failure === rule)
      if (waits && !found.includes(failure.rule)) found.push(failure.rule)
    }
  }
  return found.slice(1)
}

function edgesBetween(start: string, goals: Set<string | undefined>): string[] {
  const edges = [...shown.value.edges]
  const reach = (from: string[], forward: boolean) => {
    const seen = new Set(from)
    for (let i = 0; i < from.length; ++i) {
      for (const [, e] of edges) {
        const [here, next] = forward ? [e.from, e.to] : [e.to, e.from]
        if (here === from[i] && !seen.has(next)) {
          seen.add(next)
          from.push(next)
        }
      }
    }
    return seen
  }
  const below = reach([start], true)
  const above = reach([...goals].filter((g): g is string => !!g && below.has(g)), false)
  return edges.filter(([, e]) => below.has(e.from) && above.has(e.to)).map(([id]) => id)
}

export const markOf = (look: Look) => (look === 'OK' || look === 'UNTOLD' ? '' : `${kLooks[look].sign} `)

export function lineBelow(component: string | undefined): string {
  if (!component) return ''
  const live = isLive.value ? stateOfComponent(component) : undefined
  const decided = culprits.value.get(component)
  if (decided?.phase === 'attempting' && decided.blame?.strategy) return `\n${decided.blame.strategy}`
  const condition = conditionAt(component)
  if (condition) return `\n${condition}`
  if (live?.lifecycle && live.lifecycle !== 'active') return `\n${live.lifecycle}`
  return ''
}

function rateOf(channel: string): string {
  const topic = isLive.value ? stateOfTopic(channel) : undefined
  if (!topic || topic.rate === null) return ''
  if (isSilent(channel)) return `silent ${lasting(topic.age!)}`
  return `${topic.rate.toFixed(1)} Hz`
}

export function isSilent(channel: string): boolean {
  const topic = isLive.value ? stateOfTopic(channel) : undefined
  return !!topic && topic.rate !== null && topic.age !== null && topic.age > 3 / topic.rate
}

export function edgeLabel(channels: string[]): string {
  if (shown.value.edges.size > kMostLabels) return ''
  const watched = channels.filter((c) => rateOf(c))
  const first = watched[0] ?? channels[0]
  const more = channels.length > 1 ? ` +${channels.length - 1}` : ''
  const name = (first ? shortName(first) : 'declared') + more
  const rate = first ? rateOf(first) : ''
  return rate ? `${name}\n${rate}` : name
}

