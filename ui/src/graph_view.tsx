// The live dependency graph: data flows from left to right, health is shown by colour, shape and
// word, the culprit and the path of its cascade stand out.
import cytoscape from 'cytoscape'
import { computed, effect, signal } from '@preact/signals'
import { useEffect, useRef } from 'preact/hooks'
import { kLayer, kRow, layered, placed, type Point } from './layout'
import { lasting } from './clock'
import { conditionOf } from './incidents'
import { culprits, graph, health, isLive, known, robot, selected, situation, state, stateOfComponent, stateOfTopic } from './store'
import { colour, isDark } from './theme'
import type { Health } from './types'

export const showsAll = signal(false) // also nodes that no rule is about
export const search = signal('')

const kInfrastructure = /^\/(rosout|parameter_events|tf|tf_static|clock|diagnostics)$/
const kMostLabels = 80
const kLeastText = 7 // pixels: what is smaller is no text
const kLeastZoom = 0.5 // at which the names of nodes can be read

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
  if (decided?.phase === 'attempting') return `\n${decided.blame!.strategy}`
  const condition = conditionOf(known(component))
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

function isSilent(channel: string): boolean {
  const topic = isLive.value ? stateOfTopic(channel) : undefined
  return !!topic && topic.rate !== null && topic.age !== null && topic.age > 3 / topic.rate
}

function edgeLabel(channels: string[]): string {
  if (shown.value.edges.size > kMostLabels) return ''
  const watched = channels.filter((c) => rateOf(c))
  const first = watched[0] ?? channels[0]
  const more = channels.length > 1 ? ` +${channels.length - 1}` : ''
  const name = (first ? shortName(first) : 'declared') + more
  const rate = first ? rateOf(first) : ''
  return rate ? `${name}\n${rate}` : name
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
        'font-size': 17,
        'font-family': 'system-ui, sans-serif',
        color: colour('text'),
        width: kNode.width,
        height: kNode.height,
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
        'font-size': 13,
        'text-wrap': 'wrap',
        'min-zoomed-font-size': kLeastText,
        'font-family': 'system-ui, sans-serif',
        color: colour('text'),
        'text-background-color': colour('surface'),
        'text-background-opacity': 1,
        'text-background-padding': '2px',
        'text-margin-y': 'data(aside)' as never, // beside the edge, which stays to be seen
        'text-background-shape': 'roundrectangle',
        'curve-style': 'bezier',
        'target-arrow-shape': 'triangle',
        'line-color': colour('line'),
        'target-arrow-color': colour('line'),
        width: 1.5,
      },
    },
    {
      selector: 'edge[?isLong]',
      style: { 'curve-style': 'unbundled-bezier', 'control-point-distances': 'data(bend)' as never, 'control-point-weights': [0.5] },
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

const kNode = { width: 192, height: 58 }
const kGap = 8 // between an edge and a node that it passes
const kBends = [0, 90, -90, 150, -150, 220, -220, 300, -300]
const kMostPassed = 200 // nodes: beyond, nobody follows a single edge

// How far an edge has to bend so that it leads through no node: the control point of a curve of the second degree,
// across the straight line, as Cytoscape counts it.
function clearBend(from: Point, to: Point, others: Point[]): number {
  if (others.length > kMostPassed) return kBends[1]
  const [vx, vy] = [to.x - from.x, to.y - from.y]
  const length = Math.hypot(vx, vy) || 1
  const isClear = (bend: number) => {
    const control = { x: (from.x + to.x) / 2 - (vy / length) * bend, y: (from.y + to.y) / 2 + (vx / length) * bend }
    for (let t = 0.05; t < 1; t += 0.05) {
      const at = (a: number, c: number, b: number) => (1 - t) ** 2 * a + 2 * t * (1 - t) * c + t ** 2 * b
      const [x, y] = [at(from.x, control.x, to.x), at(from.y, control.y, to.y)]
      const isHit = (p: Point) => Math.abs(p.x - x) < kNode.width / 2 + kGap && Math.abs(p.y - y) < kNode.height / 2 + kGap
      if (others.some(isHit)) return false
    }
    return true
  }
  return kBends.find(isClear) ?? kBends[1]
}

const kAside = 19 // from an edge to its label
const kDiscovery = 10_000 // ms
const isUpright = matchMedia('(max-width: 700px)')
const kUprightRow = 208
const kUprightLayer = 130

// Where the nodes of this robot stand, also after a reload.
const placesKey = () => `culprit-places ${robot.peek()?.robot ?? ''}`
function readPlaces(): Map<string, Point> {
  try {
    return new Map(JSON.parse(localStorage.getItem(placesKey()) ?? '[]'))
  } catch {
    return new Map()
  }
}
function writePlaces(places: Map<string, Point>): void {
  localStorage.setItem(placesKey(), JSON.stringify([...places]))
}

// Brings the drawing to what is to be shown, touching only what differs.
class Drawing {
  private readonly cy: cytoscape.Core
  private points = new Map<string, Point>()
  private held: Map<string, Point> // for ever
  private wanted = `${showsAll.peek()} ${search.peek()}`
  private middle = 0 // of what is shown
  private bends = new Map<string, number>() // of edges that would lead through nodes
  private readonly begun = Date.now()
  private structure = ''

  constructor(container: HTMLElement) {
    this.held = readPlaces()
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
          label: isUpright.matches && this.isLong(edge) ? '' : edgeLabel(edge.channels), // it would lie under nodes
          isSilent: edge.channels.some(isSilent),
          isCascade: cascade.value.has(id),
          isLong: this.isLong(edge),
          bend: this.bends.get(id) ?? 0,
          aside: this.aside(edge),
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
    this.place()
    const wanted = new Set([...nodes.map((n) => n.node), ...edges.keys()])
    this.cy.elements().filter((e) => !wanted.has(e.id())).remove()
    this.bend()
    for (const node of nodes) {
      const position = this.onScreen(this.points.get(node.node)!)
      const known = this.cy.getElementById(node.node)
      if (known.nonempty()) known.position(position)
      else this.cy.add({ data: { id: node.node }, position: { ...position } })
    }
    for (const [id, edge] of edges) {
      if (this.cy.getElementById(id).empty())
        this.cy.add({ data: { id, source: edge.from, target: edge.to } })
    }
  }

  // While a robot is discovered, what comes late would stand at the edge; then nothing moves any more.
  private place(): void {
    const { nodes, edges } = shown.value
    const names = nodes.map((n) => n.node)
    const links = [...edges.values()].map((e): [string, string] => [e.from, e.to])
    // Whoever asks for more or for less sees what is there stay where it is.
    const wanted = `${showsAll.value} ${search.value}`
    if (wanted !== this.wanted) this.holdPlaces()
    this.wanted = wanted
    const isDiscovered = Date.now() - this.begun > kDiscovery
    if (this.held.size === 0 && !isDiscovered) {
      this.points = layered(names, links, this.points)
      return
    }
    if (this.held.size === 0) this.held = this.points
    this.held = this.points = placed(names, links, this.held)
    writePlaces(this.held)
  }

  // Labels stand outside, where fewer edges are.
  private aside({ from, to }: { from: string; to: string }): number {
    const [a, b] = [this.points.get(from)!, this.points.get(to)!]
    return a.y + b.y > 2 * this.middle ? kAside : -kAside
  }

  private bend(): void {
    const places = new Map([...this.points].map(([node, point]) => [node, this.onScreen(point)]))
    this.bends.clear()
    const rows = shown.value.nodes.flatMap(({ node }) => this.points.get(node)?.y ?? [])
    this.middle = (Math.min(...rows) + Math.max(...rows)) / 2
    for (const [id, edge] of shown.value.edges) {
      const [from, to] = [places.get(edge.from), places.get(edge.to)]
      if (!from || !to || !this.isLong(edge)) continue // what is new is drawn soon
      const others = shown.value.nodes.flatMap(({ node }) => places.get(node) ?? [])
      this.bends.set(id, clearBend(from, to, others.filter((p) => p !== from && p !== to)))
    }
  }

  // The data flow down a screen that is higher than wide.
  private onScreen({ x, y }: Point): Point {
    return isUpright.matches ? { x: (y / kRow) * kUprightRow, y: (x / kLayer) * kUprightLayer } : { x, y }
  }

  holdPlaces(): void {
    if (this.held.size === 0 && this.points.size > 0) writePlaces((this.held = this.points))
  }
  layOutAnew(): void {
    this.held.clear()
    this.points.clear()
    this.structure = ''
    const { nodes, edges } = shown.value
    const managed = nodes.filter((n) => n.component).map((n) => n.node)
    const links = [...edges.values()].map((e): [string, string] => [e.from, e.to])
    const own = links.filter(([from, to]) => managed.includes(from) && managed.includes(to))
    this.held = layered(managed.length > 0 ? managed : nodes.map((n) => n.node), own, new Map())
    this.draw()
  }

  zoom(factor: number): void {
    const { width, height } = this.size()
    this.cy.zoom({ level: this.cy.zoom() * factor, renderedPosition: { x: width / 2, y: height / 2 } })
  }
  private size() {
    return { width: this.cy.width(), height: this.cy.height() }
  }

  // All of it if its names can be read then; else a part of it, with who is at fault in the middle.
  fit(isWhole = false): void {
    this.cy.resize()
    this.cy.fit(undefined, 24)
    if (this.cy.zoom() > 1.3) this.cy.zoom(1.3)
    if (isWhole || this.cy.zoom() >= kLeastZoom) return void this.cy.center()
    this.cy.zoom(kLeastZoom)
    const guilty = this.cy.nodes('[?isCulprit]')
    const managed = this.cy.nodes('[?isManaged]')
    this.cy.center(guilty.nonempty() ? guilty : managed.nonempty() ? managed : undefined)
  }
  turn(): void {
    this.bend()
    this.cy.batch(() => {
      for (const [node, point] of this.points) this.cy.getElementById(node).position(this.onScreen(point))
    })
    this.fit()
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
  const held = useRef<Drawing | null>(null)
  useEffect(() => {
    const drawing = (held.current = new Drawing(place.current!))
    const holding = setTimeout(() => drawing.holdPlaces(), kDiscovery)
    const turn = () => drawing.turn()
    isUpright.addEventListener('change', turn)
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
    const observer = new ResizeObserver(() => drawing.turn())
    observer.observe(place.current!)
    return () => {
      observer.disconnect()
      isUpright.removeEventListener('change', turn)
      clearTimeout(holding)
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
        <span class="zoom" role="group" aria-label="Zoom of the graph">
          <button type="button" aria-label="Smaller" title="Smaller" onClick={() => held.current?.zoom(1 / 1.3)}>
            −
          </button>
          <button type="button" aria-label="Larger" title="Larger" onClick={() => held.current?.zoom(1.3)}>
            +
          </button>
          <button type="button" aria-label="Show all of the graph" title="Show all of it" onClick={() => held.current?.fit(true)}>
            ⤢
          </button>
          <button type="button" aria-label="Lay out anew" title="Lay out anew: nodes keep their places otherwise" onClick={() => held.current?.layOutAnew()}>
            ⟲
          </button>
        </span>
        <span class="legend" aria-hidden="true">
          <b class="culprit">★ culprit</b> <b class="ERROR">◆ error</b>{' '}
          <b class="WARNING">▲ warning</b> <b class="NON_CRITICAL">○ non-critical</b>
        </span>
      </div>
      <div class="canvas" ref={place} aria-hidden="true" />
    </section>
  )
}
