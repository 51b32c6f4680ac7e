// The declarations that the form offers: the members of each, their kinds, and the values of a new one.
import { freeName, inTemplates, plainStatements, type RuleDocument, type Statement } from './rule_document'

// How a member is entered and shown: one name or several as "/a /b", a pair as "docker slam", a range as "0..1", a hold as "3/5", arguments as "lidar, /scan",
// parameters as "name, hz = 10".
export type FieldKind = 'text' | 'names' | 'number' | 'hold' | 'list' | 'pair' | 'range' | 'arguments' | 'parameters'
export interface Member {
  kind?: FieldKind | 'flag' // text
  label?: string // its name
  of?: string[] // one of these
  list?: string // of names to offer
  begins?: unknown // with what it is added; nothing: it is always there
  needs?: string[] // it makes sense beside one of these only
  wide?: boolean
}
// One of several ways to say it: members that stand together.
export interface Way {
  words: string
  members: Record<string, unknown> // with what they begin
}
export interface Declaration {
  title: string
  members: Record<string, Member> // in the order of the line
  ways?: { label: string; all: Way[] }
  fresh: (document: RuleDocument) => Omit<Statement, 'statement'>
}

const kOwners: Way[] = [
  { words: 'no owner that culprit can ask', members: {} },
  { words: 'culprit, by a command', members: { launch: 'ros2 run my_package my_node' } },
  { words: 'systemd', members: { unit: 'my_node.service' } },
  { words: 'docker or podman', members: { container: ['docker', 'my_node'] } },
  { words: 'a component container', members: { in: '/my_container', plugin: 'my_package::MyNode' } },
  { words: 'its launcher, again and again', members: { respawned: true } },
]
const kSources: Way[] = [
  { words: 'a field of a topic', members: { topic: '/topic', field: 'data' } },
  { words: 'a key of a diagnostic', members: { diagnostic: 'my_status', key: 'my_key' } },
  { words: 'a parameter', members: { component: 'my_node', parameter: 'my_parameter' } },
]

const kDrills: Way[] = [
  { words: 'breaks it so many times at most', members: { type: 'limit', times: 0 } },
  { words: 'leaves a fault out', members: { type: 'without', fault: 'kill' } },
  { words: 'sets a parameter', members: { type: 'set_parameter', parameter: 'my_parameter', value: '0' } },
]

export const kDeclarations: Record<string, Declaration> = {
  ROBOT: { title: 'Robot', members: { name: {} }, fresh: () => ({ name: 'my_robot' }) },
  CYCLE: { title: 'Cycle', members: { length: {} }, fresh: () => ({ length: '200ms' }) },
  COMPONENT: {
    title: 'Component',
    members: {
      name: {},
      node: { kind: 'names', begins: '/my_node', list: 'nodes' },
      launch: { wide: true },
      env: { begins: 'NAME=value', needs: ['launch'] },
      setup: { begins: '/opt/ros/humble/setup.bash', needs: ['launch'] },
      cwd: { begins: '/tmp', needs: ['launch'] },
      unit: {},
      user: { kind: 'flag', begins: true, needs: ['unit'], label: 'of the user’s systemd' },
      container: { kind: 'pair' },
      host: { begins: 'user@computer', needs: ['unit', 'container'] },
      in: { list: 'nodes' },
      plugin: {},
      package: { begins: 'my_package', needs: ['in'] },
      parameters: { begins: '/etc/my_robot.yaml', needs: ['in'] },
      remap: { begins: 'image:=/camera/image', needs: ['in'] },
      respawned: { kind: 'flag' },
      required: { kind: 'flag', begins: true },
      ready: { begins: '20s' },
      lifecycle: { of: ['self', 'managed', 'launcher'], begins: 'self' },
    },
    ways: { label: 'started by', all: kOwners },
    fresh: (document) => {
      const name = freeName(document, 'COMPONENT', 'my_node')
      return { name, node: `/${name}` }
    },
  },
  SIGNAL: {
    title: 'Signal',
    members: {
      name: {},
      topic: { list: 'topics' },
      field: {},
      diagnostic: {},
      key: {},
      component: { list: 'components' },
      parameter: {},
      from: { list: 'components' },
      stale: { begins: '1s' },
      range: { kind: 'range', begins: [0, 1] },
    },
    ways: { label: 'read from', all: kSources },
    fresh: (document) => ({ name: freeName(document, 'SIGNAL', 'my_signal'), topic: '/topic', field: 'data' }),
  },
  CONST: {
    title: 'Constant',
    members: { name: {}, value: {} },
    fresh: (document) => ({ name: freeName(document, 'CONST', 'limit'), value: '1' }),
  },
  DEPENDENCY: {
    title: 'Dependency',
    members: { consumer: { list: 'components' }, producers: { kind: 'list', wide: true } },
    fresh: (document) => {
      const [consumer = 'my_node', producer = 'another_node'] = namesOf(document, 'COMPONENT')
      return { consumer, producers: [producer] }
    },
  },
  GROUP: {
    title: 'Group with a lifecycle manager',
    members: { name: {}, members: { kind: 'list', wide: true }, manager: { list: 'components' } },
    fresh: (document) => {
      const [member = 'my_node', manager = 'my_manager'] = namesOf(document, 'COMPONENT')
      return { name: freeName(document, 'GROUP', 'my_group'), members: [member], manager }
    },
  },
  IGNORE: { title: 'Topics to ignore', members: { topics: { kind: 'list', wide: true } }, fresh: () => ({ topics: ['/rosout'] }) },
  INTERLOCK: { title: 'Interlock', members: { expression: { wide: true } }, fresh: () => ({ expression: 'false' }) },
  ABORT: { title: 'End of a drill', members: { expression: { wide: true } }, fresh: () => ({ expression: 'false' }) },
  DRILL: {
    title: 'Drill',
    members: {
      component: { list: 'components' },
      parameter: {},
      value: {},
      fault: { of: ['kill', 'hang', 'slow', 'deactivate', 'restart'] },
      times: { kind: 'number' },
    },
    ways: { label: 'what it says', all: kDrills },
    fresh: (document) => ({ component: namesOf(document, 'COMPONENT')[0] ?? 'my_node', type: 'limit', times: 0 }),
  },
}

// At most one of each, in front of all else.
const kOnlyOnce = ['ROBOT', 'CYCLE']
export const canAdd = (document: RuleDocument, keyword: string) =>
  !kOnlyOnce.includes(keyword) || !document.statements.some((s) => s.statement === keyword)

const membersOf = (way: Way) => Object.keys(way.members)
export const wayOf = (ways: Way[], statement: Statement): Way =>
  ways.find((w) => membersOf(w).length > 0 && membersOf(w).every((m) => statement[m] !== undefined)) ??
  ways.find((w) => membersOf(w).length === 0) ?? ways[0]
export const makesSense = ({ needs }: Member, statement: Statement) => !needs || needs.some((n) => statement[n] !== undefined)
// Said in another way: what belongs to the others goes.
export function inWay({ ways, members }: Declaration, statement: Statement, words: string): Statement {
  const chosen = ways!.all.find((w) => w.words === words)!
  const changed = { ...statement }
  for (const member of ways!.all.flatMap(membersOf)) if (!(member in chosen.members)) delete changed[member]
  for (const [member, value] of Object.entries(chosen.members)) {
    const isInAll = ways!.all.every((w) => member in w.members) // and so tells the ways apart
    changed[member] = isInAll ? value : (changed[member] ?? value)
  }
  for (const [member, facts] of Object.entries(members)) if (!makesSense(facts, changed)) delete changed[member]
  return changed
}

export const namesOf = (document: RuleDocument, keyword: string) =>
  plainStatements(document).filter((s) => s.statement === keyword).map((s) => String(s.name))

// Behind the last of its kind, or else before the first rule.
export function placeFor(document: RuleDocument, keyword: string): number {
  const isInTemplate = inTemplates(document)
  const kinds = document.statements.map((s, place) => (isInTemplate[place] ? '' : s.statement))
  if (kOnlyOnce.includes(keyword)) return keyword === 'CYCLE' && kinds[0] === 'ROBOT' ? 1 : 0
  if (keyword === 'INCLUDE' && !kinds.includes(keyword)) return kinds.filter((kind) => kOnlyOnce.includes(kind)).length
  const last = kinds.lastIndexOf(keyword)
  if (last >= 0) return last + 1
  const first = kinds.indexOf('RULE')
  return first >= 0 ? first : kinds.length
}
