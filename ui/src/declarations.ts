// What rules are about, as the form offers it: which members a declaration has, and what a new one begins with.
import { freeName, type RuleDocument, type Statement } from './rule_document'

interface Kind {
  title: string
  members: string[] // that it always has
  more: Record<string, string> // that it may have, with what each begins with
  fresh: (document: RuleDocument) => Omit<Statement, 'statement'>
}

const kStale = { stale: '1s' }

export const kDeclarations: Record<string, Kind> = {
  COMPONENT: {
    title: 'Component',
    members: ['name'],
    more: { node: '/my_node', launch: 'ros2 run my_package my_node', unit: 'my_node.service', host: 'user@computer', env: 'NAME=value', setup: '/opt/ros/humble/setup.bash', cwd: '/tmp' },
    fresh: (document) => {
      const name = freeName(document, 'COMPONENT', 'my_node')
      return { name, node: `/${name}` }
    },
  },
  SIGNAL: {
    title: 'Signal',
    members: ['name', 'topic', 'field', 'diagnostic', 'key', 'component', 'parameter'],
    more: kStale,
    fresh: (document) => ({ name: freeName(document, 'SIGNAL', 'my_signal'), topic: '/topic', field: 'data' }),
  },
  CONST: {
    title: 'Constant',
    members: ['name', 'value'],
    more: {},
    fresh: (document) => ({ name: freeName(document, 'CONST', 'limit'), value: '1' }),
  },
  DEPENDENCY: {
    title: 'Dependency',
    members: ['consumer', 'producers'],
    more: {},
    fresh: (document) => {
      const [consumer = 'my_node', producer = 'another_node'] = namesOf(document, 'COMPONENT')
      return { consumer, producers: [producer] }
    },
  },
  INTERLOCK: {
    title: 'Interlock',
    members: ['expression'],
    more: {},
    fresh: () => ({ expression: 'false' }),
  },
}

export const namesOf = (document: RuleDocument, keyword: string) =>
  document.statements.filter((s) => s.statement === keyword).map((s) => String(s.name))

// Behind the last of its kind, or else before the first rule.
export function placeFor(document: RuleDocument, keyword: string): number {
  const kinds = document.statements.map((s) => s.statement)
  const last = kinds.lastIndexOf(keyword)
  if (last >= 0) return last + 1
  const first = kinds.indexOf('RULE')
  return first >= 0 ? first : kinds.length
}
