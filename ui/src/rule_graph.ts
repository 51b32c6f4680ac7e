// The graph of the rule file that is being written, as culprit reads it (POST /api/rules/graph), and where its nodes stand.
import { effect, signal } from '@preact/signals'
import { call, Refusal } from './api'
import { clearBend } from './edge_bends'
import { type Colours, styled } from './graph_style'
import { kNode, layered, type Point } from './layout'
import type { SceneContent, SceneEdge, SceneNode } from './scene'

type Mistake = 'error' | 'warning'
export interface Written {
  name: string
  file?: string
  line?: number
  mistake?: Mistake
}
export interface FileComponent extends Written {
  declared: boolean
}
export interface FileRule extends Written {
  criticality: string
  reads: string[]
  adapts: string[]
  spreads: string[] // components that depend on what it is about
}
export interface FileGraph {
  components: FileComponent[]
  dependencies: { consumer: string; producer: string }[]
  rules: FileRule[]
  errors: number
  warnings: number
}

const kQuiet = 400 // ms without a change
const kNameOfText = 'rules' // that the server has for what the page sends

export const fileGraph = signal<FileGraph | null>(null)
export const why = signal('') // it is not that of the text

// `read` gives the text. Gives how to stop.
export function graphFollows(read: () => string): () => void {
  let timer = 0
  let newest = 0
  const look = async (text: string) => {
    const mine = ++newest
    try {
      const graph = await call<FileGraph>('POST', '/api/rules/graph', { text })
      if (mine !== newest) return
      const isNone = graph.components.length + graph.rules.length === 0 && graph.errors > 0
      const shown = isNone ? (fileGraph.value ?? graph) : graph
      fileGraph.value = shown
      const isEarlier = shown.components.length + shown.rules.length > 0
      why.value = !isNone ? '' : isEarlier ? 'This graph is of an earlier text: mend the errors to see the present one' : 'There is no graph yet: mend the errors first'
    } catch (error) {
      if (mine === newest && (error as Refusal).status !== 0) why.value = (error as Refusal).message
    }
  }
  const stop = effect(() => {
    const text = read()
    clearTimeout(timer)
    timer = window.setTimeout(() => void look(text), kQuiet)
  })
  return () => {
    ++newest
    clearTimeout(timer)
    stop()
  }
}

export const idOf = (kind: 'component' | 'rule', name: string) => `${kind} ${name}`
const nodeOf = (graph: FileGraph, id: string | null): Written | undefined =>
  graph.components.find((c) => idOf('component', c.name) === id) ?? graph.rules.find((r) => idOf('rule', r.name) === id)
export const has = (graph: FileGraph, id: string | null) => nodeOf(graph, id) !== undefined
// Its line, if it stands in the text itself.
export function lineOf(graph: FileGraph, id: string): number | undefined {
  const found = nodeOf(graph, id)
  return found?.file === kNameOfText ? found.line : undefined
}

// Rules stand behind what they read and adapt.
export function placesOf({ components, dependencies, rules }: FileGraph, before: Map<string, Point>): Map<string, Point> {
  const ids = [...components.map((c) => idOf('component', c.name)), ...rules.map((r) => idOf('rule', r.name))]
  const between = dependencies.map((d): [string, string] => [idOf('component', d.producer), idOf('component', d.consumer)])
  const about = rules.flatMap((r) => [...new Set([...r.reads, ...r.adapts])].map((c): [string, string] => [idOf('component', c), idOf('rule', r.name)]))
  return layered(ids, [...between, ...about], before)
}

const kText = 17
const kAside = 18 // how far the edges between a rule and a component bend, which may lead both ways
const kMarks: Record<Mistake, string> = { error: '◆ ', warning: '▲ ' }

function node(written: Written, id: string, at: Point, colours: Colours, chosen: string | null): SceneNode {
  const tone = written.mistake === 'error' ? 'ERROR' : written.mistake === 'warning' ? 'WARNING' : 'unknown'
  return {
    ...at,
    ...styled(tone, colours),
    id,
    width: kNode.width,
    height: kNode.height,
    textSize: kText,
    label: (written.mistake ? kMarks[written.mistake] : '') + written.name,
    isSelected: id === chosen,
  }
}

// `chosen`: a node, of which a rule shows where its failure may spread to.
export function contentOf(graph: FileGraph, places: Map<string, Point>, colours: Colours, chosen: string | null): SceneContent {
  const rule = graph.rules.find((r) => idOf('rule', r.name) === chosen)
  const reached = new Set(rule?.spreads)
  const components = graph.components.map((c): SceneNode => {
    const id = idOf('component', c.name)
    return { ...node(c, id, places.get(id)!, colours, chosen), ...(c.declared ? {} : { dash: [6, 4] }), ...(reached.has(c.name) ? { halo: colours('culprit') } : {}) }
  })
  const rules = graph.rules.map((r): SceneNode => {
    const id = idOf('rule', r.name)
    const box = node(r, id, places.get(id)!, colours, chosen)
    return { ...box, shape: 'barrel', label: `${box.label}\n${r.criticality}` }
  })
  const nodes = [...components, ...rules]
  const byId = new Map(nodes.map((n) => [n.id, n]))
  const edge = (from: string, to: string, look: Partial<SceneEdge>): SceneEdge => ({
    from: byId.get(from)!, to: byId.get(to)!, bend: kAside, label: '', labelAside: 0, textColour: colours('text'), colour: colours('line'), width: 1.5, ...look,
  })
  const own = rule && (rule.adapts.length > 0 ? rule.adapts : rule.reads) // a rule that only reports is about what it reads
  const starts = new Set([...(own ?? []), ...reached])
  const edges = graph.dependencies.map(({ consumer, producer }) => {
    const [from, to] = [idOf('component', producer), idOf('component', consumer)]
    const others = nodes.filter((n) => n.id !== from && n.id !== to)
    const isPath = reached.has(consumer) && starts.has(producer)
    return edge(from, to, { bend: clearBend(byId.get(from)!, byId.get(to)!, others), ...(isPath ? { colour: colours('culprit'), width: 4 } : {}) })
  })
  for (const r of graph.rules) {
    const id = idOf('rule', r.name)
    for (const c of r.reads) edges.push(edge(idOf('component', c), id, { dash: [2, 4] }))
    for (const c of r.adapts) edges.push(edge(id, idOf('component', c), { dash: [9, 5], colour: colours('accent') }))
  }
  return { boxes: [], edges, nodes }
}
