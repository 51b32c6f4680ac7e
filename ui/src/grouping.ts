// Which nodes belong together: by namespace, by the container or by the host that runs them. A large robot is looked
// at by groups first.
import { computed, signal } from '@preact/signals'
import { graph, robot } from './store'
import type { ComponentFacts, Graph } from './types'

export const kGroupings = { auto: 'as it suits', none: 'nothing', namespace: 'namespace', container: 'container', host: 'host' } as const
export type Grouping = keyof typeof kGroupings

const kKey = 'culprit-grouping'
const kMany = 40 // nodes: fewer are seen at once

const stored = localStorage.getItem(kKey) ?? ''
export const grouping = signal<Grouping>(stored in kGroupings ? (stored as Grouping) : 'auto')
export function groupBy(next: Grouping): void {
  grouping.value = next
  localStorage.setItem(kKey, next)
}

type Node = Graph['nodes'][number]
const namespaceOf = ({ node }: Node) => node.slice(0, node.lastIndexOf('/')) || '/'

// How it is grouped: what suits depends on how many there are.
export const effective = computed((): Grouping => {
  if (grouping.value !== 'auto') return grouping.value
  const { nodes } = graph.value
  const isLarge = nodes.length > kMany && new Set(nodes.map(namespaceOf)).size > 1
  return isLarge ? 'namespace' : 'none'
})

const factsByName = computed(() => new Map(robot.value?.components.map((c): [string, ComponentFacts] => [c.name, c]) ?? []))

// Nothing: it belongs to none.
export function groupOf(node: Node): string | undefined {
  const facts = factsByName.value.get(node.component ?? '')
  switch (effective.value) {
    case 'namespace':
      return namespaceOf(node)
    case 'container':
      return facts?.container
    case 'host':
      return facts && (node.host ?? facts.host ?? 'this host')
    default:
      return undefined
  }
}
