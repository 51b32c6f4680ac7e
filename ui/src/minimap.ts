// All of the graph in a corner, with what one sees of it: for graphs that are larger than the screen. A press goes there.
import { extentOf, type Scene } from './scene'

const kWide = 170
const kHigh = 110
const kPad = 4

export class Minimap {
  private readonly canvas = document.createElement('canvas')
  private frame = 0

  constructor(
    private readonly scene: Scene,
    parent: HTMLElement,
    private readonly accent: () => string
  ) {
    this.canvas.className = 'minimap'
    this.canvas.hidden = true // until it is drawn
    const sharp = devicePixelRatio || 1
    this.canvas.width = kWide * sharp
    this.canvas.height = kHigh * sharp
    parent.append(this.canvas)
    const go = (e: PointerEvent) => {
      const larger = kWide / this.canvas.clientWidth // it is smaller on a phone
      if (e.buttons & 1) this.goTo(e.offsetX * larger, e.offsetY * larger)
    }
    this.canvas.addEventListener('pointerdown', go)
    this.canvas.addEventListener('pointermove', go)
  }

  drawSoon(): void {
    if (this.frame === 0) this.frame = requestAnimationFrame(() => this.draw())
  }

  destroy(): void {
    cancelAnimationFrame(this.frame)
    this.canvas.remove()
  }

  private nodes() {
    const { nodes, boxes } = this.scene.content
    return [...boxes, ...nodes]
  }

  // From the graph to the corner.
  private scale() {
    const box = extentOf(this.nodes())
    const [wide, high] = [box.right - box.left, box.bottom - box.top]
    const factor = Math.min((kWide - 2 * kPad) / Math.max(wide, 1), (kHigh - 2 * kPad) / Math.max(high, 1))
    const [left, top] = [(kWide - wide * factor) / 2, (kHigh - high * factor) / 2]
    return { box, factor, left, top, x: (x: number) => left + (x - box.left) * factor, y: (y: number) => top + (y - box.top) * factor }
  }

  private draw(): void {
    this.frame = 0
    const { box, factor, x, y } = this.scale()
    const { view } = this.scene
    // Without nodes the extent is infinite, the wrong way round.
    this.canvas.hidden = view.left <= box.left && view.top <= box.top && view.right >= box.right && view.bottom >= box.bottom
    if (this.canvas.hidden) return
    const context = this.canvas.getContext('2d')!
    const sharp = devicePixelRatio || 1
    context.setTransform(sharp, 0, 0, sharp, 0, 0)
    context.clearRect(0, 0, kWide, kHigh)
    for (const node of this.nodes()) {
      if (!node.mapColour) continue
      context.fillStyle = node.mapColour
      const [w, h] = [Math.max(2, node.width * factor), Math.max(2, node.height * factor)]
      context.fillRect(x(node.x) - w / 2, y(node.y) - h / 2, w, h)
    }
    context.strokeStyle = this.accent()
    context.lineWidth = 2
    context.strokeRect(x(view.left), y(view.top), (view.right - view.left) * factor, (view.bottom - view.top) * factor)
  }

  private goTo(offsetX: number, offsetY: number): void {
    const { box, factor, left, top } = this.scale()
    this.scene.center({ x: box.left + (offsetX - left) / factor, y: box.top + (offsetY - top) / factor })
  }
}
