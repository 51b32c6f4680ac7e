// The graph as a drawing: where its nodes stand, and how they and their edges look at present.
import { clearBend } from './edge_bends'
import { cascade, edgeLabel, isSilent, markOf, labelOf, lineBelow, search, shown, type Shown, showsAll } from './graph_model'
import { coloursNow, kLeastZoom, styled } from './graph_style'
import { effective, groupOf } from './grouping'
import { boxesOf, flowsOf, type Groups, groupsOf, isFar } from './group_boxes'
import { groupedLayout } from './group_layout'
import { Minimap } from './minimap'
import { kLayer, kNode, kRow, layered, placed, type Point } from './layout'
import { toneOf } from './looks'
import { type Extent, extentOf, Scene, type SceneEdge, type SceneNode } from './scene'
import { culprits, looks, robot, selected } from './store'
import type { Graph } from './types'

type Node = Graph['nodes'][number]
type Edge = Shown['edges'] extends Map<string, infer E> ? E : never

const kMostFitted = 1.3 // zoom
const kNearly = 0.9 // what is left out for names that are hardly larger would be missed
const kAside = 19 // from an edge to its label
export const kDiscovery = 10_000 // ms
export const isUpright = matchMedia('(max-width: 700px)')
const kUprightRow = 208
const kUprightLayer = 130
const kBack = 30 // how far an edge bends that has another one in the opposite direction
const kText = 17
const kLegend = 40 // pixels at the bottom, where the legend is
const kUnmanaged = { height: 44, textSize: 13 } // a node that no rule is about

const middleOf = ({ left, top, right, bottom }: Extent): Point => ({ x: (left + right) / 2, y: (top + bottom) / 2 })

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
  private readonly scene: Scene
  private points = new Map<string, Point>()
  private held: Map<string, Point> // for ever
  private wanted = `${showsAll.peek()} ${search.peek()}`
  private grouping = effective.peek()
  private key = placesKey() // until it is known which robot it is, nothing is held
  private readonly minimap: Minimap
  private groups: Groups = { members: new Map(), flows: new Map() }
  private middle = 0 // of what is shown
  private bends = new Map<string, number>() // of edges that would lead through nodes
  private readonly begun = Date.now()
  private structure = ''
  private colours = coloursNow()
  private drawnZoom = 0 // for which the groups were drawn

  constructor(container: HTMLElement) {
    this.held = readPlaces()
    this.scene = new Scene(container, () => ({ text: this.colours('text'), surface: this.colours('surface'), accent: this.colours('accent') }))
    this.minimap = new Minimap(this.scene, container, () => this.colours('accent'))
    this.scene.onPress = (id) => {
      const box = this.scene.content.boxes.find((b) => b.id === id)
      if (box) this.scene.fit(extentOf([box]), 40)
      else selected.value = shown.peek().nodes.find((n) => n.node === id)?.component ?? null
    }
    this.scene.onView = () => {
      this.minimap.drawSoon()
      if (this.groups.members.size > 0 && this.scene.zoom !== this.drawnZoom) this.fill() // names of groups are as large as one can read them
    }
  }

  draw(): void {
    const { nodes, edges } = shown.value
    if (this.grouping !== effective.value || this.key !== placesKey()) this.regroup()
    const structure = nodes.map((n) => `${n.node} ${groupOf(n) ?? ''}`).join() + '|' + [...edges.keys()].join()
    const isNew = structure !== this.structure
    if (isNew) {
      this.place()
      this.groups = groupsOf(shown.value)
      this.bend()
    }
    this.structure = structure
    this.fill()
    if (isNew) this.fit()
  }

  // In this frame.
  drawAtOnce(): void {
    this.draw()
    this.scene.drawAtOnce()
  }

  // Other groups stand elsewhere, and so do the nodes of another robot.
  private regroup(): void {
    this.grouping = effective.value
    this.key = placesKey()
    this.points.clear()
    this.held = readPlaces()
    this.structure = ''
  }

  // The content of the drawing at the present zoom.
  private fill(): void {
    const { nodes, edges } = shown.value
    if (nodes.some((n) => !this.points.has(n.node))) return // they are placed soon
    const { zoom } = this.scene
    const far = isFar(zoom, this.groups)
    this.drawnZoom = zoom
    const boxes = boxesOf(this.groups, zoom, (node) => this.onScreen(this.points.get(node)!), this.colours)
    const own = nodes.filter((n) => !far || groupOf(n) === undefined).map((n) => this.sceneNode(n))
    const byId = new Map([...boxes, ...own].map((n) => [n.id, n]))
    const lines: SceneEdge[] = far ? flowsOf(this.groups, byId, this.colours) : []
    for (const [id, edge] of edges) {
      const [from, to] = [byId.get(edge.from), byId.get(edge.to)]
      if (from && to) lines.push(this.sceneEdge(id, edge, from, to))
    }
    this.scene.content = { boxes, edges: lines, nodes: own }
    this.scene.drawSoon()
    this.minimap.drawSoon()
  }

  private sceneNode(node: Node): SceneNode {
    const { component } = node
    const look = component ? (looks.value.get(component) ?? 'UNTOLD') : 'OK'
    const isCulprit = !!component && culprits.value.has(component)
    const tone = toneOf(look)
    const dash = !node.present ? [6, 4] : !component ? [2, 3] : undefined
    return {
      ...this.onScreen(this.points.get(node.node)!),
      ...styled(tone, this.colours),
      id: node.node,
      width: kNode.width,
      height: kNode.height,
      textSize: kText,
      ...(component ? {} : { ...kUnmanaged, fillOpacity: 0.5 }),
      ...(node.present ? {} : { fillOpacity: 0.3 }),
      ...(isCulprit ? { border: this.colours('culprit'), borderWidth: 6, halo: this.colours('culprit'), isBold: true, isDouble: false } : {}),
      label: (isCulprit ? '★ ' : markOf(look)) + labelOf(node) + lineBelow(component),
      dash,
      isSelected: !!component && component === selected.value,
      mapColour: this.colours(isCulprit ? 'culprit' : tone),
    }
  }

  private sceneEdge(id: string, edge: Edge, from: SceneNode, to: SceneNode): SceneEdge {
    const isLost = edge.channels.some(isSilent)
    const isCascade = cascade.value.has(id)
    const isLong = this.isLong(edge)
    const hasBack = edge.from !== edge.to && shown.value.edges.has(`${edge.to} > ${edge.from}`)
    return {
      from,
      to,
      bend: this.bends.get(id) ?? (hasBack ? kBack : 0),
      label: isUpright.matches && isLong ? '' : edgeLabel(edge.channels), // it would lie under nodes
      labelAside: this.aside(edge),
      textColour: this.colours(isLost ? 'ERROR' : 'text'),
      colour: this.colours(isCascade ? 'culprit' : isLost ? 'ERROR' : 'line'),
      width: isCascade ? 5 : 1.5,
      dash: isLost ? [6, 4] : undefined,
    }
  }

  // A straight line may lead through nodes between the two.
  private mayCross(edge: Edge): boolean {
    return this.isLong(edge) || Math.abs(this.points.get(edge.from)!.x - this.points.get(edge.to)!.x) < kLayer / 2
  }
  // Beyond the next layer.
  private isLong({ from, to }: Edge): boolean {
    return Math.abs(this.points.get(from)!.x - this.points.get(to)!.x) > 1.5 * kLayer
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
    if (this.grouping === 'none') return layered(names, links, before)
    const byName = new Map(shown.value.nodes.map((n) => [n.node, n]))
    return groupedLayout(names, links, (name) => groupOf(byName.get(name)!))
  }
  // The other members of a new node's group, beside which it is drawn.
  private companions(nodes: Node[]): (name: string) => string[] {
    if (this.grouping === 'none') return () => []
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
      if (!from || !to || !this.mayCross(edge)) continue // what is new is drawn soon
      const others = shown.value.nodes.flatMap(({ node }) => places.get(node) ?? [])
      this.bends.set(id, clearBend(from, to, others.filter((p) => p !== from && p !== to)))
    }
  }

  // The data flow down a screen that is higher than wide; groups are blocks that do not become higher by it.
  private onScreen({ x, y }: Point): Point {
    if (!isUpright.matches || this.grouping !== 'none') return { x, y }
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
    const isShown = (node: string) => managed.size === 0 || this.grouping !== 'none' || managed.has(node)
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
    this.scene.zoomBy(factor)
  }

  // All of it if its names can be read then; else a part of it, with who is at fault in the middle.
  fit(isWhole = false): void {
    this.scene.resize()
    const { boxes, nodes } = this.scene.content
    if (boxes.length + nodes.length === 0) return
    const all = extentOf([...boxes, ...nodes])
    const pad = isUpright.matches ? 10 : this.grouping === 'none' ? 24 : 40
    this.scene.fit(all, pad, kMostFitted)
    const room = this.scene.height - kLegend
    if (!isUpright.matches && this.scene.yOf(all.bottom) > room) this.scene.fit(all, pad, kMostFitted, kLegend)
    // From far away one reads the groups.
    if (isWhole || this.grouping !== 'none' || this.scene.zoom >= kNearly * kLeastZoom) return
    const guilty = nodes.filter((n) => n.halo)
    const managed = nodes.filter((n) => n.height === kNode.height)
    this.scene.zoomBy(kLeastZoom / this.scene.zoom)
    this.scene.center(middleOf(guilty.length > 0 ? extentOf(guilty) : managed.length > 0 ? extentOf(managed) : all))
  }
  turn(): void {
    this.scene.resize()
    this.bend()
    this.fill()
    this.fit()
  }
  restyle(): void {
    this.colours = coloursNow()
    this.fill()
  }
  destroy(): void {
    this.minimap.destroy()
    this.scene.destroy()
  }
}
