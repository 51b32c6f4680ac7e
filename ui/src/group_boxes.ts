// Draws the groups of a large graph: near, a box around the nodes of each. From far away, the box alone with its number
// of failed nodes, and the data flow between groups. Boxes are plain elements of a known size, since Cytoscape's compound
// nodes cost time with each change.
import type cytoscape from 'cytoscape'
import { cascade, markOf, type Shown } from './graph_model'
import { groupOf } from './grouping'
import { kNode, type Point } from './layout'
import { isIll, type Look, rankOf, toneOf } from './looks'
import { culprits, looks } from './store'
import type { Graph } from './types'

type Node = Graph['nodes'][number]

const kText = 15 // pixels on the screen, of its name
const kLargestText = 170 // in the graph
const kFar = 0.3 // zoom, from which on groups are seen and not their members
const kPad = 18
const idOf = (group: string) => `group ${group}`

interface Group {
  id: string
  nodes: Node[]
}

export class GroupBoxes {
  private groups: Group[] = []
  private flows = new Map<string, string[]>() // from group to group, with the edges that it stands for
  private isFar = false
  private size = kText

  constructor(
    private readonly cy: cytoscape.Core,
    private readonly tell: (id: string, data: Record<string, unknown>) => void
  ) {}

  // True if single nodes are hidden.
  get hidesNodes(): boolean {
    return this.isFar && this.groups.length > 0
  }

  // A group that is not among these is gone.
  ids(): string[] {
    return [...this.groups.map((g) => g.id), ...this.flows.keys()]
  }

  prepare({ nodes, edges }: Shown): void {
    const members = new Map<string, Node[]>()
    for (const node of nodes) {
      const group = groupOf(node)
      if (group !== undefined) members.set(group, [...(members.get(group) ?? []), node])
    }
    this.groups = [...members].map(([group, all]) => ({ id: idOf(group), nodes: all }))
    this.flows.clear()
    if (this.groups.length === 0) return
    const ends = new Map(nodes.map((n) => [n.node, groupOf(n) === undefined ? n.node : idOf(groupOf(n)!)]))
    for (const [id, { from, to }] of edges) {
      const [a, b] = [ends.get(from)!, ends.get(to)!]
      if (a === b || (a === from && b === to)) continue
      const flow = `${a} >> ${b}`
      this.flows.set(flow, [...(this.flows.get(flow) ?? []), id])
    }
  }

  // `pointOf`: where a node stands on the screen.
  place(pointOf: (node: string) => Point): void {
    for (const { id, nodes } of this.groups) {
      const points = nodes.map((n) => pointOf(n.node))
      const [xs, ys] = [points.map((p) => p.x), points.map((p) => p.y)]
      const [left, right, top, bottom] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)]
      const data = { w: right - left + kNode.width + 2 * kPad, h: bottom - top + kNode.height + 2 * kPad }
      const position = { x: (left + right) / 2, y: (top + bottom) / 2 }
      const box = this.cy.getElementById(id)
      if (box.empty()) this.cy.add({ data: { id, isGroup: true, size: this.size, ...data }, position })
      else box.data(data).position(position)
    }
  }
  // Nodes are there by now.
  connect(): void {
    for (const flow of this.flows.keys()) {
      const [source, target] = flow.split(' >> ')
      if (this.cy.getElementById(flow).empty()) this.cy.add({ data: { id: flow, source, target, isGroup: true } })
    }
    this.zoomed(true)
  }

  // As ill as the worst of its members, with how many there are.
  show(): void {
    const lookOf = (n: Node): Look => (n.component && looks.value.get(n.component)) || 'OK'
    for (const { id, nodes } of this.groups) {
      const worst = nodes.map(lookOf).reduce((a, b) => (rankOf(b) < rankOf(a) ? b : a))
      const ill = nodes.filter((n) => isIll(lookOf(n))).length
      const isCulprit = nodes.some((n) => n.component && culprits.value.has(n.component))
      const count = ill > 0 ? `${ill} of ${nodes.length} ill` : nodes.length
      this.tell(id, { label: `${isCulprit ? '★ ' : markOf(worst)}${groupOf(nodes[0])}\n${count}`, tone: toneOf(worst), isCulprit })
    }
    for (const [flow, edges] of this.flows) this.tell(flow, { isCascade: edges.some((id) => cascade.value.has(id)) })
  }

  // The further away, the larger are names: they are what one reads then.
  zoomed(isNew = false): void {
    if (this.groups.length === 0) return
    const zoom = this.cy.zoom()
    const size = Math.round(Math.min(kLargestText, Math.max(kText, kText / zoom)))
    const isFar = zoom < kFar
    if (!isNew && size === this.size && isFar === this.isFar) return
    this.cy.batch(() => {
      if (isNew || size !== this.size) this.cy.nodes('[?isGroup]').data('size', size)
      if (isNew || isFar !== this.isFar) {
        const within = new Set(this.groups.flatMap((g) => g.nodes.map((n) => n.node)))
        this.cy.elements('[?isGroup]').toggleClass('far', isFar)
        this.cy.nodes('[!isGroup]').forEach((n) => void n.toggleClass('far', isFar && within.has(n.id())))
        this.cy.edges('[!isGroup]').forEach((e) => void e.toggleClass('far', isFar && (within.has(e.source().id()) || within.has(e.target().id()))))
      }
    })
    this.size = size
    this.isFar = isFar
  }
}
