// Brings the drawing of the graph to what is to be shown, touching only what differs.
import cytoscape from 'cytoscape'
import { clearBend } from './edge_bends'
import { cascade, edgeLabel, isSilent, markOf, labelOf, lineBelow, search, shown, showsAll } from './graph_model'
import { kLeastZoom, stylesheet } from './graph_style'
import { effective, groupOf } from './grouping'
import { GroupBoxes } from './group_boxes'
import { groupedLayout } from './group_layout'
import { Minimap } from './minimap'
import { kLayer, kRow, layered, placed, type Point } from './layout'
import { toneOf } from './looks'
import { culprits, looks, robot, selected } from './store'
import type { Graph } from './types'

type Node = Graph['nodes'][number]

const kNearly = 0.9 // what is left out for names that are hardly larger would be missed
const kAside = 19 // from an edge to its label
export const kDiscovery = 10_000 // ms
export const isUpright = matchMedia('(max-width: 700px)')
const kUprightRow = 208
const kUprightLayer = 130
const kUprightGroups = { x: 2.1, y: 0.36 } // of blocks of nodes, which are wider than high


// Where the nodes of this robot stand, also after a reload.
const placesKey = () => {
  const groups = effective.peek()
  return `culprit-places ${robot.peek()?.robot ?? ''}${groups === 'none' ? '' : ` by ${groups}`}`
}
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

export class Drawing {
  private readonly cy: cytoscape.Core
  private points = new Map<string, Point>()
  private held: Map<string, Point> // for ever
  private wanted = `${showsAll.peek()} ${search.peek()}`
  private groups = effective.peek()
  private key = placesKey() // until it is known which robot it is, nothing is held
  private readonly minimap: Minimap
  private readonly boxes: GroupBoxes
  private middle = 0 // of what is shown
  private bends = new Map<string, number>() // of edges that would lead through nodes
  private readonly begun = Date.now()
  private structure = ''

  constructor(container: HTMLElement) {
    this.held = readPlaces()
    this.cy = cytoscape({
      container,
      style: stylesheet(),
      minZoom: 0.03,
      maxZoom: 2,
      autoungrabify: true,
      boxSelectionEnabled: false,
    })
    this.minimap = new Minimap(this.cy, container)
    this.boxes = new GroupBoxes(this.cy, (id, data) => void this.tell(id, data))
    this.cy.on('tap', 'node', (e) => {
      if (e.target.data('isGroup')) this.cy.fit(e.target, 40)
      else selected.value = e.target.data('component') ?? null
    })
    this.cy.on('zoom', () => {
      const hidNodes = this.boxes.hidesNodes
      this.boxes.zoomed()
      if (hidNodes && !this.boxes.hidesNodes) this.draw() // what has changed of them meanwhile
    })
    this.cy.on('tap', (e) => {
      if (e.target === this.cy) selected.value = null
    })
  }

  draw(): void {
    const { nodes, edges } = shown.value
    if (this.groups !== effective.value || this.key !== placesKey()) this.regroup()
    const structure = nodes.map((n) => `${n.node} ${groupOf(n) ?? ''}`).join() + '|' + [...edges.keys()].join()
    this.cy.batch(() => {
      if (structure !== this.structure) this.rebuild()
      this.boxes.show()
      const isHidden = this.boxes.hidesNodes && structure === this.structure
      for (const node of nodes) if (!isHidden || groupOf(node) === undefined) this.show(node)
      for (const [id, edge] of isHidden ? [] : edges) {
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
    this.minimap.drawSoon()
  }

  // Other groups stand elsewhere, and so do the nodes of another robot.
  private regroup(): void {
    this.groups = effective.value
    this.key = placesKey()
    this.cy.elements().remove()
    this.points.clear()
    this.held = readPlaces()
    this.structure = ''
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

  private show(node: Node): void {
    const look = node.component ? (looks.value.get(node.component) ?? 'UNTOLD') : 'OK'
    const isCulprit = !!node.component && culprits.value.has(node.component)
    const element = this.tell(node.node, {
      label: (isCulprit ? '★ ' : markOf(look)) + labelOf(node) + lineBelow(node.component),
      tone: toneOf(look),
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
    this.boxes.prepare(shown.value)
    const wanted = new Set([...nodes.map((n) => n.node), ...edges.keys(), ...this.boxes.ids()])
    this.cy.elements().filter((e) => !wanted.has(e.id())).remove()
    this.bend()
    const pointOf = (node: string) => this.onScreen(this.points.get(node)!)
    this.boxes.place(pointOf)
    for (const { node } of nodes) {
      const known = this.cy.getElementById(node)
      if (known.nonempty()) known.position(pointOf(node))
      else this.cy.add({ data: { id: node }, position: { ...pointOf(node) } })
    }
    for (const [id, edge] of edges) {
      if (this.cy.getElementById(id).empty())
        this.cy.add({ data: { id, source: edge.from, target: edge.to } })
    }
    this.boxes.connect()
  }

  // While a robot is discovered, what comes late would stand at the edge; then nothing moves any more.
  private place(): void {
    const { nodes, edges } = shown.value
    const names = nodes.map((n) => n.node)
    const links = [...edges.values()].map((e): [string, string] => [e.from, e.to])
    // If the user asks for more or fewer nodes, those that are there keep their places.
    const wanted = `${showsAll.value} ${search.value}`
    if (wanted !== this.wanted) this.holdPlaces()
    this.wanted = wanted
    const isDiscovered = Date.now() - this.begun > kDiscovery
    if (this.held.size === 0 && !isDiscovered) {
      this.points = this.laidOut(names, links, this.points)
      return
    }
    if (this.held.size === 0) this.held = this.points
    this.held = this.points = placed(names, links, this.held, this.companions(nodes))
    writePlaces(this.held)
  }
  private laidOut(names: string[], links: [string, string][], before: Map<string, Point>): Map<string, Point> {
    if (this.groups === 'none') return layered(names, links, before)
    const byName = new Map(shown.value.nodes.map((n) => [n.node, n]))
    return groupedLayout(names, links, (name) => groupOf(byName.get(name)!))
  }
  // The other members of a new node's group, beside which it is drawn.
  private companions(nodes: Node[]): (name: string) => string[] {
    if (this.groups === 'none') return () => []
    const groups = new Map(nodes.map((n) => [n.node, groupOf(n)]))
    return (name) => nodes.map((n) => n.node).filter((n) => n !== name && groups.get(n) !== undefined && groups.get(n) === groups.get(name))
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
    if (!isUpright.matches) return { x, y }
    if (this.groups !== 'none') return { x: y * kUprightGroups.x, y: x * kUprightGroups.y }
    return { x: (y / kRow) * kUprightRow, y: (x / kLayer) * kUprightLayer }
  }

  holdPlaces(): void {
    if (this.held.size === 0 && this.points.size > 0) writePlaces((this.held = this.points))
  }
  // Gives how to take it back.
  layOutAnew(): () => void {
    const before = new Map(this.held)
    this.held = new Map()
    this.points = new Map()
    this.structure = ''
    const { nodes, edges } = shown.value
    const links = [...edges.values()].map((e): [string, string] => [e.from, e.to])
    const managed = new Set(nodes.filter((n) => n.component).map((n) => n.node))
    // A node without a rule is placed beside the others.
    const isShown = (node: string) => managed.size === 0 || this.groups !== 'none' || managed.has(node)
    const own = links.filter(([from, to]) => isShown(from) && isShown(to))
    this.held = this.laidOut(nodes.map((n) => n.node).filter(isShown), own, new Map())
    this.draw()
    return () => {
      this.held = before
      this.structure = ''
      this.draw()
    }
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
    this.cy.fit(this.cy.nodes(), this.groups === 'none' ? 24 : 40)
    if (this.cy.zoom() > 1.3) this.cy.zoom(1.3)
    // From far away one reads the groups.
    if (isWhole || this.groups !== 'none' || this.cy.zoom() >= kNearly * kLeastZoom) return void this.cy.center()
    this.cy.zoom(kLeastZoom)
    const guilty = this.cy.nodes('[?isCulprit]')
    const managed = this.cy.nodes('[?isManaged]')
    this.cy.center(guilty.nonempty() ? guilty : managed.nonempty() ? managed : undefined)
  }
  turn(): void {
    this.bend()
    this.cy.batch(() => {
      for (const [node, point] of this.points) this.cy.getElementById(node).position(this.onScreen(point))
      this.boxes.place((node) => this.onScreen(this.points.get(node)!))
    })
    this.fit()
  }
  restyle(): void {
    this.cy.style(stylesheet())
    this.minimap.restyle()
  }
  destroy(): void {
    this.minimap.destroy()
    this.cy.destroy()
  }
}

