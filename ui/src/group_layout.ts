// Where the nodes of a graph stand that is looked at by groups: each group is a block of its own, the blocks stand as nodes
// would (layout.ts), so that nothing moves when one comes nearer.
import { kLayer, kNode, kRow, layered, type Point } from './layout'

const kMostRows = 6 // of a block that is laid out along its data
const kColumn = 240 // of a block of many nodes
const kLine = 96
const kTall = 1.4 // rows for each column of it
const kBetween = { x: 150, y: 110 } // blocks; their names stand there

interface Block {
  points: Map<string, Point> // from its upper left node
  width: number
  height: number
}

function block(nodes: string[], edges: [string, string][]): Block {
  let points = layered(nodes, edges, new Map())
  const rows = new Map<number, number>()
  for (const { x } of points.values()) rows.set(x, (rows.get(x) ?? 0) + 1)
  if (Math.max(...rows.values()) > kMostRows) {
    const order = [...points].sort(([, a], [, b]) => a.x - b.x || a.y - b.y)
    const lines = Math.ceil(Math.sqrt(nodes.length * kTall))
    points = new Map(order.map(([node], place) => [node, { x: Math.floor(place / lines) * kColumn, y: (place % lines) * kLine }]))
  }
  const xs = [...points.values()].map((p) => p.x)
  const ys = [...points.values()].map((p) => p.y)
  const [left, top] = [Math.min(...xs), Math.min(...ys)]
  for (const point of points.values()) {
    point.x -= left
    point.y -= top
  }
  return { points, width: Math.max(...xs) - left + kNode.width, height: Math.max(...ys) - top + kNode.height }
}

// From above to below; beside one another where they are too many.
function inColumns(all: [string, number][]): [string, number][][] {
  all.sort(([, a], [, b]) => a - b)
  const count = Math.ceil(all.length / kMostRows)
  const each = Math.ceil(all.length / count)
  return Array.from({ length: count }, (_, i) => all.slice(i * each, (i + 1) * each))
}

// `groupOf` gives nothing for a node that stands alone.
export function groupedLayout(nodes: string[], edges: [string, string][], groupOf: (node: string) => string | undefined): Map<string, Point> {
  const nameOf = new Map(nodes.map((n) => [n, groupOf(n) ?? `alone ${n}`]))
  const members = new Map<string, string[]>()
  for (const node of nodes) members.set(nameOf.get(node)!, [...(members.get(nameOf.get(node)!) ?? []), node])
  const names = [...members.keys()].sort()
  const isWithin = (name: string) => ([a, b]: [string, string]) => nameOf.get(a) === name && nameOf.get(b) === name
  const blocks = new Map(names.map((name) => [name, block(members.get(name)!, edges.filter(isWithin(name)))]))
  const between = new Map<string, [string, string]>()
  for (const [from, to] of edges) {
    const [a, b] = [nameOf.get(from)!, nameOf.get(to)!]
    if (a !== b) between.set(`${a} ${b}`, [a, b])
  }
  const columns = new Map<number, [string, number][]>()
  for (const [name, { x, y }] of layered(names, [...between.values()], new Map()))
    columns.set(Math.round(x / kLayer), [...(columns.get(Math.round(x / kLayer)) ?? []), [name, y / kRow]])
  const points = new Map<string, Point>()
  let left = 0
  for (const column of [...columns].sort(([a], [b]) => a - b).flatMap(([, all]) => inColumns(all))) {
    const height = column.reduce((sum, [name]) => sum + blocks.get(name)!.height + kBetween.y, -kBetween.y)
    let top = -height / 2
    for (const [name] of column) {
      const { points: own, height: high } = blocks.get(name)!
      for (const [node, { x, y }] of own) points.set(node, { x: left + x + kNode.width / 2, y: top + y + kNode.height / 2 })
      top += high + kBetween.y
    }
    left += Math.max(...column.map(([name]) => blocks.get(name)!.width)) + kBetween.x
  }
  return points
}
