// The groups of a large graph: near, a box around the nodes of each. From far away, the box alone with its number of failed
// nodes, and the data flow between groups.
import { cascade, markOf, type Shown } from './graph_model'
import { type Colours, styled } from './graph_style'
import { groupOf } from './grouping'
import { kNode, type Point } from './layout'
import { isIll, type Look, rankOf, toneOf } from './looks'
import type { SceneEdge, SceneNode } from './scene'
import { culprits, looks } from './store'
import type { Graph } from './types'

type Node = Graph['nodes'][number]

const kText = 15 // pixels on the screen, of its name
const kLargestText = 240 // in the graph
const kFar = 0.3 // zoom, from which on groups are seen and not their members
const kPad = 18

export interface Groups {
  members: Map<string, Node[]>
  flows: Map<string, { from: string; to: string; edges: string[] }> // from group to group; a node without a group stands for itself
}

export function groupsOf({ nodes, edges }: Shown): Groups {
  const members = new Map<string, Node[]>()
  const ends = new Map<string, string>()
  for (const node of nodes) {
    const group = groupOf(node)
    ends.set(node.node, group === undefined ? node.node : boxOf(group))
    if (group !== undefined) members.set(group, [...(members.get(group) ?? []), node])
  }
  const flows: Groups['flows'] = new Map()
  if (members.size === 0) return { members, flows }
  for (const [id, { from, to }] of edges) {
    const [a, b] = [ends.get(from)!, ends.get(to)!]
    if (a === b || (a === from && b === to)) continue
    const flow = `${a} >> ${b}`
    const known = flows.get(flow)
    if (known) known.edges.push(id)
    else flows.set(flow, { from: a, to: b, edges: [id] })
  }
  return { members, flows }
}

// The box of a group, among the nodes of a scene.
export const boxOf = (group: string) => `group ${group}`

export const isFar = (zoom: number, { members }: Groups) => zoom < kFar && members.size > 0

const lookOf = (n: Node): Look => (n.component && looks.value.get(n.component)) || 'OK'

// As ill as the worst of its members, with how many there are. The further away, the larger are names: they are what one
// reads then. `pointOf`: where a node stands.
export function boxesOf({ members }: Groups, zoom: number, pointOf: (node: string) => Point, colours: Colours): SceneNode[] {
  const size = Math.round(Math.min(kLargestText, Math.max(kText, kText / zoom)))
  const far = zoom < kFar
  return [...members].map(([group, nodes]) => {
    const points = nodes.map((n) => pointOf(n.node))
    const [xs, ys] = [points.map((p) => p.x), points.map((p) => p.y)]
    const [left, right, top, bottom] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)]
    const worst = nodes.map(lookOf).reduce((a, b) => (rankOf(b) < rankOf(a) ? b : a))
    const ill = nodes.filter((n) => isIll(lookOf(n))).length
    const isCulprit = nodes.some((n) => n.component && culprits.value.has(n.component))
    const label = `${isCulprit ? '★ ' : markOf(worst)}${group}\n${ill > 0 ? `${ill} of ${nodes.length} ill` : nodes.length}`
    const place = { x: (left + right) / 2, y: (top + bottom) / 2, width: right - left + kNode.width + 2 * kPad, height: bottom - top + kNode.height + 2 * kPad }
    return { ...styled(toneOf(worst), colours), id: boxOf(group), ...place, shape: 'rounded', label, textSize: size, isBold: true,
      isLabelAbove: !far, fillOpacity: far ? 1 : 0.3, isDouble: false, halo: undefined, mapColour: far ? colours(toneOf(worst)) : undefined,
      ...(isCulprit ? { border: colours('culprit'), borderWidth: Math.max(5, Math.min(30, size / 5)) } : { borderWidth: 2 }) }
  })
}

// Seen from far away only.
export function flowsOf({ flows }: Groups, nodes: Map<string, SceneNode>, colours: Colours): SceneEdge[] {
  return [...flows.values()].flatMap(({ from, to, edges }): SceneEdge[] => {
    const [a, b] = [nodes.get(from), nodes.get(to)]
    if (!a || !b) return []
    const isCascade = edges.some((id) => cascade.value.has(id))
    const colour = isCascade ? colours('culprit') : colours('faint')
    return [{ from: a, to: b, bend: 0, label: '', labelAside: 0, textColour: colour, colour, width: isCascade ? 30 : 12 }]
  })
}
