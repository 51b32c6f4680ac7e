// Draws the robot on its map on a canvas: all of the map, north up as its frame has it.
import type { Grid, MapPicture, Robot } from './map'
import { colour } from './theme'

const kMargin = 12 // pixels
const kRobot = 13
const kDot = 3
export const kStale = 1 // s: what is older may be elsewhere by now

// The cells as a picture, in the colours of the scheme.
export function painted(grid: Grid): HTMLCanvasElement {
  const canvas = document.createElement('canvas')
  canvas.width = grid.width
  canvas.height = grid.height
  const context = canvas.getContext('2d')!
  const image = context.createImageData(grid.width, grid.height)
  const rgb = (name: string) => [1, 3, 5].map((at) => parseInt(colour(name).slice(at, at + 2), 16))
  const [wall, unknown] = [rgb('muted'), rgb('line')]
  for (let i = 0; i < grid.cells.length; ++i) {
    const cell = grid.cells[i]
    image.data.set(cell === '?' ? unknown : wall, 4 * i)
    image.data[4 * i + 3] = cell === '?' ? 60 : (255 * Number(cell)) / 9
  }
  context.putImageData(image, 0, 0)
  return canvas
}

// From the map's frame, whose y axis goes up, to pixels.
function viewOf({ width, height, resolution, origin: [x, y, yaw] }: Grid, wide: number, high: number) {
  const corners = [[0, 0], [width, 0], [0, height], [width, height]].map(([column, row]) => {
    const [dx, dy] = [column * resolution, row * resolution]
    return [x + dx * Math.cos(yaw) - dy * Math.sin(yaw), y + dx * Math.sin(yaw) + dy * Math.cos(yaw)]
  })
  const range = (axis: number) => [Math.min(...corners.map((c) => c[axis])), Math.max(...corners.map((c) => c[axis]))]
  const [[left, right], [bottom, top]] = [range(0), range(1)]
  const scale = Math.max(1e-9, Math.min((wide - 2 * kMargin) / (right - left), (high - 2 * kMargin) / (top - bottom)))
  const at = ([px, py]: number[]): [number, number] => [wide / 2 + scale * (px - (left + right) / 2), high / 2 - scale * (py - (bottom + top) / 2)]
  return { scale, at }
}

// An old pose is hollow.
function drawRobot(context: CanvasRenderingContext2D, [x, y]: [number, number], { yaw, age }: Robot) {
  context.save()
  context.translate(x, y)
  context.rotate(-yaw)
  context.beginPath()
  context.moveTo(kRobot, 0)
  context.lineTo(-kRobot * 0.8, kRobot * 0.75)
  context.lineTo(-kRobot * 0.4, 0)
  context.lineTo(-kRobot * 0.8, -kRobot * 0.75)
  context.closePath()
  context.lineWidth = 2
  context.fillStyle = context.strokeStyle = colour('accent')
  if (age > kStale) {
    context.setLineDash([4, 3])
    context.fillStyle = colour('surface')
  }
  context.fill()
  context.stroke()
  context.restore()
}

function drawPath(context: CanvasRenderingContext2D, points: [number, number][]) {
  context.strokeStyle = colour('accent')
  context.lineWidth = 2
  context.beginPath()
  points.forEach(([x, y]) => context.lineTo(x, y))
  context.stroke()
  const [x, y] = points[points.length - 1]
  context.beginPath()
  context.arc(x, y, 7, 0, 2 * Math.PI)
  context.moveTo(x + 2, y)
  context.arc(x, y, 2, 0, 2 * Math.PI)
  context.stroke()
}

export function drawMap(canvas: HTMLCanvasElement, grid: Grid, cells: HTMLCanvasElement, picture: MapPicture): void {
  const sharp = devicePixelRatio || 1
  const { clientWidth: wide, clientHeight: high } = canvas
  canvas.width = wide * sharp
  canvas.height = high * sharp
  const context = canvas.getContext('2d')!
  context.scale(sharp, sharp)
  const { scale, at } = viewOf(grid, wide, high)
  context.save()
  context.imageSmoothingEnabled = false
  context.translate(...at(grid.origin))
  context.rotate(-grid.origin[2])
  context.scale(scale * grid.resolution, -scale * grid.resolution)
  context.drawImage(cells, 0, 0)
  context.restore()
  if (picture.path && picture.path.points.length > 0) drawPath(context, picture.path.points.map(at))
  if (picture.scan && picture.scan.age <= kStale) {
    context.fillStyle = colour('OK')
    for (const [x, y] of picture.scan.points.map(at)) context.fillRect(x - kDot / 2, y - kDot / 2, kDot, kDot)
  }
  for (const robot of picture.robots) drawRobot(context, at(robot.at), robot)
}
