// How far an edge has to bend so that it leads through no node.
import { kNode, type Point } from './layout'

const kGap = 8 // between an edge and a node that it passes
const kBends = [0, 90, -90, 150, -150, 220, -220, 300, -300]
const kMostPassed = 200 // nodes: beyond, nobody follows a single edge

// How far the control point of a curve of the second degree stands from the straight line.
export function clearBend(from: Point, to: Point, others: Point[]): number {
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

