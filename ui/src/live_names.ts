// The names of the live robot for the form to offer: nodes, topics, services, and parameters of the nodes in the rules.
import { signal } from '@preact/signals'
import { call, hasToken } from './api'
import type { RuleDocument } from './rule_document'
import { can } from './store'

interface Names {
  nodes: Record<string, { parameters: Record<string, unknown> }>
  topics: string[]
  services: string[]
}

const kPeriod = 3000 // ms: how long discovery takes

export const names = signal<Names>({ nodes: {}, topics: [], services: [] })
export const ownName = (node: string) => node.slice(node.lastIndexOf('/') + 1)

// Looks as long as the form is open. `text` gives the rules as they are at the time.
export function follow(text: () => string): () => void {
  if (!can('post', '/api/rules/names') || !hasToken) return () => {}
  const look = async () => {
    try {
      names.value = await call<Names>('POST', '/api/rules/names', { text: text() })
    } catch {
      // Names that are not offered can be typed.
    }
  }
  void look()
  const timer = setInterval(() => void look(), kPeriod)
  return () => clearInterval(timer)
}

// Those of the node, and those that the file uses already.
export function parametersOf(component: string, document: RuleDocument): string[] {
  const declared = document.statements.find((s) => s.statement === 'COMPONENT' && s.name === component)
  const nodes = Object.entries(names.value.nodes).filter(([node]) =>
    declared?.node ? node === [declared.node].flat()[0] : ownName(node) === component
  )
  const used = document.statements
    .filter((s) => s.statement === 'ADAPTATION' && s.component === component && s.parameter !== undefined)
    .map((s) => String(s.parameter))
  return [...nodes.flatMap(([, { parameters }]) => Object.keys(parameters)), ...used]
}
