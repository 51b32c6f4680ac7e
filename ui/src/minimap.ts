// All of the graph in a corner, with what one sees of it: for graphs that are larger than the screen. A press goes there.
import type cytoscape from 'cytoscape'
import { colour } from './theme'

const kWide = 170
const kHigh = 110
const kPad = 4
const kKinds = ['OK', 'NON_CRITICAL', 'WARNING', 'ERROR', 'EXHAUSTED', 'culprit', 'accent', 'line']

export class Minimap {
  private readonly canvas = document.createElement('canvas')
  private colours: Record<string, string> = {}
  private frame = 0

  constructor(
    private readonly cy: cytoscape.Core,
    parent: HTMLElement
  ) {
    this.canvas.className = 'minimap'
    const sharp = devicePixelRatio || 1
    this.canvas.width = kWide * sharp
    this.canvas.height = kHigh * sharp
    parent.append(this.canvas)
    this.restyle()
    cy.on('viewport', () => this.drawSoon())
    const go = (e: PointerEvent) => {
      if (e.buttons & 1) this.goTo(e.offsetX, e.offsetY)
    }
    this.canvas.addEventListener('pointerdown', go)
    this.canvas.addEventListener('pointermove', go)
  }

  restyle(): void {
    for (const kind of kKinds) this.colours[kind] = colour(kind)
    this.drawSoon()
  }

  drawSoon(): void {
    if (this.frame === 0) this.frame = requestAnimationFrame(() => this.draw())
  }

  destroy(): void {
    cancelAnimationFrame(this.frame)
    this.canvas.remove()
  }

  // From the graph to the corner.
  private scale() {
    const box = this.cy.elements().boundingBox({ includeLabels: false, includeOverlays: false })
    const factor = Math.min((kWide - 2 * kPad) / Math.max(box.w, 1), (kHigh - 2 * kPad) / Math.max(box.h, 1))
    const [left, top] = [(kWide - box.w * factor) / 2, (kHigh - box.h * factor) / 2]
    return { box, factor, x: (x: number) => left + (x - box.x1) * factor, y: (y: number) => top + (y - box.y1) * factor, left, top }
  }

  private draw(): void {
    this.frame = 0
    const { box, factor, x, y } = this.scale()
    const view = this.cy.extent()
    const isWhole = view.x1 <= box.x1 && view.y1 <= box.y1 && view.x2 >= box.x2 && view.y2 >= box.y2
    this.canvas.hidden = isWhole
    if (isWhole) return
    const context = this.canvas.getContext('2d')!
    const sharp = devicePixelRatio || 1
    context.setTransform(sharp, 0, 0, sharp, 0, 0)
    context.clearRect(0, 0, kWide, kHigh)
    this.cy.nodes('[!isGroup]').forEach((node) => {
      const { x: cx, y: cy } = node.position()
      context.fillStyle = this.colours[node.data('isCulprit') ? 'culprit' : node.data('tone')] ?? this.colours.line
      const [w, h] = [Math.max(2, node.width() * factor), Math.max(2, node.height() * factor)]
      context.fillRect(x(cx) - w / 2, y(cy) - h / 2, w, h)
    })
    context.strokeStyle = this.colours.accent
    context.lineWidth = 2
    context.strokeRect(x(view.x1), y(view.y1), view.w * factor, view.h * factor)
  }

  private goTo(offsetX: number, offsetY: number): void {
    const { box, factor, left, top } = this.scale()
    const [gx, gy] = [box.x1 + (offsetX - left) / factor, box.y1 + (offsetY - top) / factor]
    const zoom = this.cy.zoom()
    this.cy.pan({ x: this.cy.width() / 2 - gx * zoom, y: this.cy.height() / 2 - gy * zoom })
  }
}
