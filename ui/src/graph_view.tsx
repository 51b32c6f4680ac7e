// The live dependency graph: data flows from left to right, health is shown by colour, shape and
// word, the culprit and the path of its cascade stand out.
import cytoscape from 'cytoscape'
import { computed, effect, signal } from '@preact/signals'
import { useEffect, useRef } from 'preact/hooks'
import { kLayer, layered, type Point } from './layout'
import { culprits, graph, health, isLive, robot, selected, situation, state, stateOfComponent, stateOfTopic } from './store'
import { colour, isDark } from './theme'
import type { Health } from './types'

export const showsAll = signal(false) // also nodes that no rule is about
export const search = signal('')

const kInfrastructure = /^\/(rosout|parameter_events|tf|tf_static|clock|diagnostics)$/
const kMostLabels = 80

const shortName = (name: string) => name.slice(name.lastIndexOf('/') + 1)
const labelOf = (node: { node: string; component?: string }) => node.component ?? shortName(node.node)

interface Shown {
  nodes: Graph['nodes']
  edges: Map<string, { from: string; to: string; channels: string[] }>
}
type Graph = (typeof graph)['value']

const shown = computed((): Shown => {
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
const cascade = computed((): Set<string> => {
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

const kShapes: Record<Health, string> = {
  OK: 'round-rectangle',
  NON_CRITICAL: 'barrel',
  WARNING: 'hexagon',
  ERROR: 'octagon',
  EXHAUSTED: 'octagon',
}

const kMarks: Record<Health, string> = {
  OK: '',
  NON_CRITICAL: '○ ',
  WARNING: '▲ ',
  ERROR: '◆ ',
  EXHAUSTED: '✖ ',
}

function lineBelow(component: string | undefined): string {
  if (!component) return ''
  const live = isLive.value ? stateOfComponent(component) : undefined
  const decided = culprits.value.get(component)
  if (decided?.phase === 'attempting') return `\n${decided.decision!.strategy}`
  if (situation.value.gone.has(component)) return '\ngone'
  if (live?.alive === false) return '\nnot alive'
  if (live?.lifecycle && live.lifecycle !== 'active') return `\n${live.lifecycle}`
  return ''
}

function rateOf(channel: string): string {
  const topic = isLive.value ? stateOfTopic(channel) : undefined
  if (!topic || topic.rate === null) return ''
  if (isSilent(channel)) return ` silent ${topic.age!.toFixed(1)} s`
  return ` ${topic.rate.toFixed(1)} Hz`
}

function isSilent(channel: string): boolean {
  const topic = isLive.value ? stateOfTopic(channel) : undefined
  return !!topic && topic.rate !== null && topic.age !== null && topic.age > 3 / topic.rate
}

function edgeLabel(channels: string[]): string {
  if (shown.value.edges.size > kMostLabels) return ''
  const watched = channels.filter((c) => rateOf(c))
  const first = watched[0] ?? channels[0]
  const more = channels.length > 1 ? ` +${channels.length - 1}` : ''
  return (first ? shortName(first) : 'declared') + rateOf(first) + more
}

function stylesheet(): cytoscape.StylesheetStyle[] {
  const healths = (Object.keys(kShapes) as Health[]).map((h) => ({
    selector: `node[health = "${h}"]`,
    style: {
      shape: kShapes[h] as cytoscape.Css.NodeShape,
      'background-color': colour(`${h}-fill`),
      'border-color': colour(h),
    },
  }))
  return [
    {
      selector: 'node',
      style: {
        label: 'data(label)',
        'text-wrap': 'wrap',
        'text-valign': 'center',
        'line-height': 1.2,
        'font-size': 15,
        'font-family': 'system-ui, sans-serif',
        color: colour('text'),
        width: 176,
        height: 58,
        'border-width': 2,
      },
    },
    ...healths,
    {
      selector: 'node[!isManaged]',
      style: { 'border-style': 'dotted', 'background-opacity': 0.5, 'font-size': 13, height: 44 },
    },
    { selector: 'node[!isPresent]', style: { 'border-style': 'dashed', 'background-opacity': 0.3 } },
    {
      selector: 'node[?isCulprit]',
      style: {
        'border-width': 6,
        'border-color': colour('culprit'),
        'font-weight': 'bold',
        'underlay-color': colour('culprit'),
        'underlay-padding': 8,
        'underlay-opacity': 0.25,
      },
    },
    { selector: 'node:selected', style: { 'overlay-color': colour('accent'), 'overlay-opacity': 0.15 } },
    {
      selector: 'edge',
      style: {
        label: 'data(label)',
        'font-size': 12,
        'font-family': 'system-ui, sans-serif',
        color: colour('muted'),
        'text-background-color': colour('surface'),
        'text-background-opacity': 0.9,
        'text-background-padding': '2px',
        'curve-style': 'bezier',
        'target-arrow-shape': 'triangle',
        'line-color': colour('line'),
        'target-arrow-color': colour('line'),
        width: 1.5,
      },
    },
    {
      selector: 'edge[?isLong]',
      style: { 'curve-style': 'unbundled-bezier', 'control-point-distances': [90], 'control-point-weights': [0.5] },
    },
    {
      selector: 'edge[?isSilent]',
      style: {
        'line-style': 'dashed',
        'line-color': colour('ERROR'),
        'target-arrow-color': colour('ERROR'),
        color: colour('ERROR'),
      },
    },
    {
      selector: 'edge[?isCascade]',
      style: { width: 5, 'line-color': colour('culprit'), 'target-arrow-color': colour('culprit') },
    },
  ]
}

// Brings the drawing to what is to be shown, touching only what differs.
class Drawing {
  private readonly cy: cytoscape.Core
  private points = new Map<string, Point>()
  private structure = ''

  constructor(container: HTMLElement) {
    this.cy = cytoscape({
      container,
      style: stylesheet(),
      minZoom: 0.1,
      maxZoom: 2,
      autoungrabify: true,
      boxSelectionEnabled: false,
    })
    this.cy.on('tap', 'node', (e) => (selected.value = e.target.data('component') ?? null))
    this.cy.on('tap', (e) => {
      if (e.target === this.cy) selected.value = null
    })
  }

  draw(): void {
    const { nodes, edges } = shown.value
    const structure = nodes.map((n) => n.node).join() + '|' + [...edges.keys()].join()
    this.cy.batch(() => {
      if (structure !== this.structure) this.rebuild()
      for (const node of nodes) this.show(node)
      for (const [id, edge] of edges) {
        this.tell(id, {
          label: edgeLabel(edge.channels),
          isSilent: edge.channels.some(isSilent),
          isCascade: cascade.value.has(id),
          isLong: this.isLong(edge),
        })
      }
    })
    if (structure !== this.structure) this.fit()
    this.structure = structure
  }

  // Cytoscape styles an element anew whenever its data are set, be they as they were or not.
  private tell(id: string, data: Record<string, unknown>): cytoscape.CollectionReturnValue {
    const element = this.cy.getElementById(id)
    const told = element.data()
    if (Object.entries(data).some(([key, value]) => told[key] !== value)) element.data(data)
    return element
  }

  // A straight line would lead through the nodes of the layers between.
  private isLong({ from, to }: { from: string; to: string }): boolean {
    return Math.abs(this.points.get(from)!.x - this.points.get(to)!.x) > 1.5 * kLayer
  }

  private show(node: Graph['nodes'][number]): void {
    const sick = (node.component && health.value.get(node.component)) || 'OK'
    const isCulprit = !!node.component && culprits.value.has(node.component)
    const element = this.tell(node.node, {
      label: (isCulprit ? '★ ' : kMarks[sick]) + labelOf(node) + lineBelow(node.component),
      health: sick,
      component: node.component,
      isManaged: !!node.component,
      isPresent: node.present,
      isCulprit,
    })
    const isSelected = !!node.component && node.component === selected.value
    if (element.selected() !== isSelected) isSelected ? element.select() : element.unselect()
  }

  private rebuild(): void {
    const { nodes, edges } = shown.value
    this.points = layered(
      nodes.map((n) => n.node),
      [...edges.values()].map((e) => [e.from, e.to]),
      this.points
    )
    const wanted = new Set([...nodes.map((n) => n.node), ...edges.keys()])
    this.cy.elements().filter((e) => !wanted.has(e.id())).remove()
    for (const node of nodes) {
      const position = this.points.get(node.node)!
      const known = this.cy.getElementById(node.node)
      if (known.nonempty()) known.position(position)
      else this.cy.add({ data: { id: node.node }, position: { ...position } })
    }
    for (const [id, edge] of edges) {
      if (this.cy.getElementById(id).empty())
        this.cy.add({ data: { id, source: edge.from, target: edge.to } })
    }
  }

  fit(): void {
    this.cy.resize()
    this.cy.fit(undefined, 24)
    if (this.cy.zoom() > 1.3) this.cy.zoom(1.3)
    this.cy.center()
  }
  restyle(): void {
    this.cy.style(stylesheet())
  }
  destroy(): void {
    this.cy.destroy()
  }
}

// A large graph takes a while to paint; nobody sees more than so many changes.
const kPeriod = 66 // ms

// What a drawing depends on.
const readAll = () =>
  [shown, cascade, health, culprits, situation, robot, state, selected, isLive].map((each) => each.value)

export function GraphView() {
  const place = useRef<HTMLDivElement>(null)
  useEffect(() => {
    const drawing = new Drawing(place.current!)
    let timer = 0
    const stop = effect(() => {
      readAll()
      if (timer !== 0) return
      timer = window.setTimeout(() => {
        timer = 0
        drawing.draw()
      }, kPeriod)
    })
    const stopStyling = effect(() => {
      isDark.value // colours are those of the scheme
      drawing.restyle()
    })
    const observer = new ResizeObserver(() => drawing.fit())
    observer.observe(place.current!)
    return () => {
      observer.disconnect()
      clearTimeout(timer)
      stopStyling()
      stop()
      drawing.destroy()
    }
  }, [])
  return (
    <section class="graph" aria-label="Dependency graph">
      <div class="bar">
        <input
          type="search"
          placeholder="Find a node"
          aria-label="Find a node"
          value={search.value}
          onInput={(e) => (search.value = e.currentTarget.value)}
        />
        <label>
          <input
            type="checkbox"
            checked={showsAll.value}
            onChange={(e) => (showsAll.value = e.currentTarget.checked)}
          />
          all nodes and topics
        </label>
        <span class="legend" aria-hidden="true">
          <b class="culprit">★ culprit</b> <b class="ERROR">◆ error</b>{' '}
          <b class="WARNING">▲ warning</b> <b class="NON_CRITICAL">○ non-critical</b>
        </span>
      </div>
      <div class="canvas" ref={place} aria-hidden="true" />
    </section>
  )
}
