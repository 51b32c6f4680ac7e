// A drawing of nodes, boxes and edges on a canvas, which can be moved, zoomed and pressed. It knows no robot: what is drawn
// is told anew as often as it changes, and drawn once a frame.
import type { Point } from './layout'

export type Shape = 'rounded' | 'barrel' | 'hexagon' | 'octagon'

export interface SceneNode extends Point {
  id: string
  width: number
  height: number
  label: string // of lines
  textSize: number
  isBold?: boolean
  isLabelAbove?: boolean // else it stands in the middle
  shape: Shape
  fill: string
  fillOpacity: number
  border: string
  borderWidth: number
  dash?: number[]
  isDouble?: boolean
  halo?: string
  isSelected?: boolean
  mapColour?: string // in the corner; without it, it is not there
}
export interface SceneEdge {
  from: SceneNode
  to: SceneNode
  bend: number // of its control point, across the straight line
  label: string
  labelAside: number
  textColour: string
  colour: string
  width: number
  dash?: number[]
}
export interface SceneContent {
  boxes: SceneNode[] // below all else
  edges: SceneEdge[]
  nodes: SceneNode[]
}
export interface Extent {
  left: number
  top: number
  right: number
  bottom: number
}
interface Palette {
  text: string
  surface: string
  accent: string
}

const kLeastZoom = 0.03
const kMostZoom = 2
const kLeastText = 7 // pixels: what is smaller is no text
const kEdgeText = 13
const kLine = 1.2 // the height of one of text
const kArrow = 9
const kStill = 4 // pixels: a press that moves less is no drag
const kWheel = 0.0016
const kFont = 'system-ui, sans-serif'

// The outline around the middle.
function cornersOf({ shape, width, height }: SceneNode): [number, number][] {
  const [w, h] = [width / 2, height / 2]
  if (shape === 'hexagon') return [[-w, 0], [-w / 2, -h], [w / 2, -h], [w, 0], [w / 2, h], [-w / 2, h]]
  if (shape === 'octagon') return [[-w, -h * 0.4], [-w * 0.6, -h], [w * 0.6, -h], [w, -h * 0.4], [w, h * 0.4], [w * 0.6, h], [-w * 0.6, h], [-w, h * 0.4]]
  return [[-w, -h], [w, -h], [w, h], [-w, h]]
}

// Where a line from its middle towards `other` leaves it.
function rim(node: SceneNode, other: Point): Point {
  const [dx, dy] = [other.x - node.x, other.y - node.y]
  if (dx === 0 && dy === 0) return { x: node.x, y: node.y }
  const corners = cornersOf(node)
  let nearest = Infinity
  for (let i = 0; i < corners.length; ++i) {
    const [ax, ay] = corners[i]
    const [bx, by] = corners[(i + 1) % corners.length]
    const across = dx * (by - ay) - dy * (bx - ax)
    if (across === 0) continue
    const along = (ax * (by - ay) - ay * (bx - ax)) / across
    const share = (ax * dy - ay * dx) / across
    if (along > 0 && share >= 0 && share <= 1) nearest = Math.min(nearest, along)
  }
  return nearest === Infinity ? { x: node.x, y: node.y } : { x: node.x + dx * nearest, y: node.y + dy * nearest }
}

export const extentOf = (nodes: SceneNode[]): Extent => ({
  left: Math.min(...nodes.map((n) => n.x - n.width / 2)),
  right: Math.max(...nodes.map((n) => n.x + n.width / 2)),
  top: Math.min(...nodes.map((n) => n.y - n.height / 2)),
  bottom: Math.max(...nodes.map((n) => n.y + n.height / 2)),
})

export class Scene {
  content: SceneContent = { boxes: [], edges: [], nodes: [] }
  zoom = 1
  width = 0
  height = 0
  onPress: (id: string | null) => void = () => {}
  onView: () => void = () => {} // zoomed or moved
  private offset: Point = { x: 0, y: 0 } // of the middle of the drawing from that of the screen, in pixels
  private readonly canvas = document.createElement('canvas')
  private readonly fingers = new Map<number, Point>()
  private dragged = 0 // pixels, since the press
  private frame = 0
  private readonly widths = new Map<string, number>() // of texts of one pixel

  constructor(
    container: HTMLElement,
    private readonly palette: () => Palette
  ) {
    container.append(this.canvas)
    this.canvas.addEventListener('pointerdown', (e) => this.press(e))
    this.canvas.addEventListener('pointermove', (e) => this.drag(e))
    this.canvas.addEventListener('pointerup', (e) => this.release(e, true))
    this.canvas.addEventListener('pointercancel', (e) => this.release(e, false))
    this.canvas.addEventListener(
      'wheel',
      (e) => {
        e.preventDefault()
        this.zoomBy(Math.exp(-kWheel * e.deltaY * (e.deltaMode === 1 ? 16 : 1)), { x: e.offsetX, y: e.offsetY })
      },
      { passive: false }
    )
    this.resize()
  }

  destroy(): void {
    cancelAnimationFrame(this.frame)
    this.canvas.remove()
  }

  resize(): void {
    const box = this.canvas.parentElement!
    this.width = box.clientWidth
    this.height = box.clientHeight
    const sharp = devicePixelRatio || 1
    if (this.canvas.width !== Math.round(this.width * sharp)) this.canvas.width = Math.round(this.width * sharp)
    if (this.canvas.height !== Math.round(this.height * sharp)) this.canvas.height = Math.round(this.height * sharp)
    this.drawSoon()
  }

  drawSoon(): void {
    if (this.frame === 0)
      this.frame = requestAnimationFrame(() => {
        this.frame = 0
        this.draw()
      })
  }

  drawAtOnce(): void {
    cancelAnimationFrame(this.frame)
    this.frame = 0
    this.draw()
  }

  // The visible part of the drawing.
  get view(): Extent {
    const { x, y } = this.at({ x: 0, y: 0 })
    return { left: x, top: y, right: x + this.width / this.zoom, bottom: y + this.height / this.zoom }
  }
  private at({ x, y }: Point): Point {
    return { x: (x - this.width / 2 - this.offset.x) / this.zoom, y: (y - this.height / 2 - this.offset.y) / this.zoom }
  }

  zoomBy(factor: number, around: Point = { x: this.width / 2, y: this.height / 2 }): void {
    const before = this.at(around)
    this.zoom = Math.min(kMostZoom, Math.max(kLeastZoom, this.zoom * factor))
    const after = this.at(around)
    this.offset = { x: this.offset.x + (after.x - before.x) * this.zoom, y: this.offset.y + (after.y - before.y) * this.zoom }
    this.onView()
    this.drawSoon()
  }
  center({ x, y }: Point): void {
    this.offset = { x: -x * this.zoom, y: -y * this.zoom }
    this.onView()
    this.drawSoon()
  }
  // `below`: pixels at the bottom that are left free.
  fit({ left, top, right, bottom }: Extent, pad: number, most = kMostZoom, below = 0): void {
    const zoom = Math.min((this.width - 2 * pad) / (right - left), (this.height - below - 2 * pad) / (bottom - top), most)
    this.zoom = Math.min(kMostZoom, Math.max(kLeastZoom, zoom))
    this.center({ x: (left + right) / 2, y: (top + bottom) / 2 + below / (2 * this.zoom) })
  }
  // Where a place of the drawing is, in pixels from above.
  yOf(y: number): number {
    return this.height / 2 + this.offset.y + y * this.zoom
  }

  private press(e: PointerEvent): void {
    if (e.button !== 0) return
    this.canvas.setPointerCapture(e.pointerId)
    this.fingers.set(e.pointerId, { x: e.offsetX, y: e.offsetY })
    if (this.fingers.size === 1) this.dragged = 0
  }
  private drag(e: PointerEvent): void {
    const before = this.fingers.get(e.pointerId)
    if (!before) return
    const now = { x: e.offsetX, y: e.offsetY }
    this.dragged += Math.hypot(now.x - before.x, now.y - before.y)
    const other = [...this.fingers].find(([id]) => id !== e.pointerId)?.[1]
    this.fingers.set(e.pointerId, now)
    if (this.dragged < kStill) return
    if (other) {
      const apart = (p: Point) => Math.max(1, Math.hypot(p.x - other.x, p.y - other.y))
      this.zoomBy(apart(now) / apart(before), { x: (now.x + other.x) / 2, y: (now.y + other.y) / 2 })
      return
    }
    this.offset = { x: this.offset.x + now.x - before.x, y: this.offset.y + now.y - before.y }
    this.onView()
    this.drawSoon()
  }
  private release(e: PointerEvent, isDone: boolean): void {
    const wasAlone = this.fingers.size === 1
    if (!this.fingers.delete(e.pointerId) || !isDone || !wasAlone || this.dragged >= kStill) return
    const { x, y } = this.at({ x: e.offsetX, y: e.offsetY })
    const isHit = (n: SceneNode) => Math.abs(n.x - x) <= n.width / 2 && Math.abs(n.y - y) <= n.height / 2
    const { nodes, boxes } = this.content
    this.onPress((nodes.find(isHit) ?? boxes.find(isHit))?.id ?? null)
  }

  private draw(): void {
    const context = this.canvas.getContext('2d')!
    const sharp = devicePixelRatio || 1
    context.setTransform(sharp, 0, 0, sharp, 0, 0)
    context.clearRect(0, 0, this.width, this.height)
    context.translate(this.width / 2 + this.offset.x, this.height / 2 + this.offset.y)
    context.scale(this.zoom, this.zoom)
    context.textAlign = 'center'
    context.textBaseline = 'middle'
    const palette = this.palette()
    const { left, top, right, bottom } = this.view
    const isSeen = (n: SceneNode) => n.x + n.width > left && n.x - n.width < right && n.y + n.height > top && n.y - n.height < bottom
    for (const box of this.content.boxes) if (isSeen(box)) this.drawNode(context, box, palette)
    for (const edge of this.content.edges) {
      const margin = Math.abs(edge.bend)
      const isAway =
        Math.max(edge.from.x, edge.to.x) + margin < left || Math.min(edge.from.x, edge.to.x) - margin > right ||
        Math.max(edge.from.y, edge.to.y) + margin < top || Math.min(edge.from.y, edge.to.y) - margin > bottom
      if (!isAway) this.drawEdge(context, edge, palette)
    }
    for (const node of this.content.nodes) if (isSeen(node)) this.drawNode(context, node, palette)
  }

  private drawNode(context: CanvasRenderingContext2D, node: SceneNode, { text, surface, accent }: Palette): void {
    const { x, y, width, height } = node
    if (node.halo) {
      context.globalAlpha = 0.25
      context.fillStyle = node.halo
      context.beginPath()
      context.roundRect(x - width / 2 - 8, y - height / 2 - 8, width + 16, height + 16, 8)
      context.fill()
    }
    const outline = (inset: number) => {
      context.beginPath()
      if (node.shape === 'rounded' || node.shape === 'barrel')
        return context.roundRect(x - width / 2 + inset, y - height / 2 + inset, width - 2 * inset, height - 2 * inset, node.shape === 'barrel' ? height / 2 : 8)
      cornersOf({ ...node, width: width - 2 * inset, height: height - 2 * inset }).forEach(([cx, cy], i) => (i === 0 ? context.moveTo(x + cx, y + cy) : context.lineTo(x + cx, y + cy)))
      context.closePath()
    }
    outline(0)
    context.globalAlpha = node.fillOpacity
    context.fillStyle = node.fill
    context.fill()
    context.globalAlpha = 1
    context.strokeStyle = node.border
    context.lineWidth = node.borderWidth
    context.setLineDash(node.dash ?? [])
    context.stroke()
    context.setLineDash([])
    if (node.isDouble) {
      context.strokeStyle = surface
      context.lineWidth = node.borderWidth / 3
      context.stroke()
    }
    if (node.isSelected) {
      context.globalAlpha = 0.15
      context.fillStyle = accent
      context.fill()
      context.globalAlpha = 1
    }
    if (node.textSize * this.zoom < kLeastText) return
    context.fillStyle = text
    const lines = node.label.split('\n')
    const first = node.isLabelAbove ? y - height / 2 - 4 - (lines.length - 0.5) * kLine * node.textSize : y - ((lines.length - 1) * kLine * node.textSize) / 2
    const room = node.isLabelAbove ? Infinity : width - 14
    lines.forEach((line, i) => this.write(context, line, x, first + i * kLine * node.textSize, node.textSize, node.isBold, room))
  }

  // Smaller where there is no room for it, and cut off where that would be too small.
  private write(context: CanvasRenderingContext2D, line: string, x: number, y: number, size: number, isBold: boolean | undefined, room: number): void {
    const weight = isBold ? 'bold ' : ''
    const long = this.widthOf(context, line, weight) * size
    const fitting = Math.max(size * 0.7, Math.min(size, (size * room) / long))
    let shown = line
    for (let length = line.length; length > 1 && this.widthOf(context, shown, weight) * fitting > room; --length) shown = `${line.slice(0, length)}…`
    context.font = `${weight}${fitting}px ${kFont}`
    context.fillText(shown, x, y)
  }
  private widthOf(context: CanvasRenderingContext2D, line: string, weight: string): number {
    const key = weight + line
    let width = this.widths.get(key)
    if (width === undefined) {
      if (this.widths.size > 10_000) this.widths.clear()
      context.font = `${weight}100px ${kFont}`
      this.widths.set(key, (width = context.measureText(line).width / 100))
    }
    return width
  }

  private drawEdge(context: CanvasRenderingContext2D, edge: SceneEdge, { surface }: Palette): void {
    const { from, to } = edge
    const [dx, dy] = [to.x - from.x, to.y - from.y]
    const length = Math.hypot(dx, dy) || 1
    const control = from === to ? { x: from.x, y: from.y - 2 * from.height } : { x: (from.x + to.x) / 2 - (dy / length) * edge.bend, y: (from.y + to.y) / 2 + (dx / length) * edge.bend }
    const begin = from === to ? { x: from.x - from.width / 3, y: from.y - from.height / 2 } : rim(from, control)
    const tip = from === to ? { x: from.x + from.width / 3, y: from.y - from.height / 2 } : rim(to, control)
    const [ax, ay] = [tip.x - control.x, tip.y - control.y]
    const arrow = kArrow + 2 * (edge.width - 1.5)
    const reach = Math.hypot(ax, ay) || 1
    const [ux, uy] = [ax / reach, ay / reach]
    const end = { x: tip.x - ux * arrow, y: tip.y - uy * arrow }
    context.strokeStyle = context.fillStyle = edge.colour
    context.lineWidth = edge.width
    context.setLineDash(edge.dash ?? [])
    context.beginPath()
    context.moveTo(begin.x, begin.y)
    context.quadraticCurveTo(control.x, control.y, end.x, end.y)
    context.stroke()
    context.setLineDash([])
    context.beginPath()
    context.moveTo(tip.x, tip.y)
    context.lineTo(end.x - uy * arrow * 0.5, end.y + ux * arrow * 0.5)
    context.lineTo(end.x + uy * arrow * 0.5, end.y - ux * arrow * 0.5)
    context.fill()
    if (!edge.label || kEdgeText * this.zoom < kLeastText) return
    const middle = { x: (begin.x + tip.x) / 4 + control.x / 2, y: (begin.y + tip.y) / 4 + control.y / 2 + edge.labelAside }
    const lines = edge.label.split('\n')
    const wide = Math.max(...lines.map((line) => this.widthOf(context, line, ''))) * kEdgeText
    const high = lines.length * kEdgeText * kLine
    context.fillStyle = surface
    context.fillRect(middle.x - wide / 2 - 2, middle.y - high / 2 - 1, wide + 4, high + 2)
    context.fillStyle = edge.textColour
    lines.forEach((line, i) => this.write(context, line, middle.x, middle.y + (i - (lines.length - 1) / 2) * kEdgeText * kLine, kEdgeText, false, Infinity))
  }
}
