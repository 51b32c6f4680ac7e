// The robot on its map, as culprit draws it while somebody looks (GET /api/map): culprit subscribes to nothing for it else.
import { computed, signal } from '@preact/signals'
import { call } from './api'
import { can, graph } from './store'

type Point = [x: number, y: number] // m, in the map's frame

export interface Grid {
  width: number // cells
  height: number
  resolution: number // m a cell
  coarser: number // how many cells of the message are one of these, in each direction
  origin: [x: number, y: number, yaw: number] // of the corner of the first cell
  cells: string // row by row: 0 free to 9 occupied, ? unknown
}
export interface Robot {
  frame: string
  at: Point
  yaw: number
  age: number // s
}
export interface Line {
  topic: string
  age: number
  points: Point[]
}
export interface MapPicture {
  topics: string[]
  topic: string
  frame: string
  number: number
  grid: Grid | null
  robots: Robot[]
  path: Line | null
  scan: Line | null
  troubles: string[]
}

const kPeriod = 200 // ms

export const wanted = signal('') // the topic that a person has chosen
export const picture = signal<MapPicture | null>(null)
export const grid = signal<Grid | null>(null)
export const trouble = signal('')
export const began = signal(0) // ms

// The graph names no types. A robot whose map is called otherwise has its view at #map.
export const hasMap = computed(() => can('get', '/api/map') && graph.value.edges.some(([, , topic]) => /map$/.test(topic)))

// Gives how to stop.
export function lookAtMap(): () => void {
  picture.value = grid.value = null
  began.value = Date.now()
  let isOver = false
  let timer = 0
  let known = 0
  const look = async () => {
    try {
      const map = await call<MapPicture>('GET', `/api/map?topic=${encodeURIComponent(wanted.value)}&known=${known}`)
      if (isOver) return
      if (map.number !== known) grid.value = map.grid
      known = map.number
      picture.value = map
      trouble.value = ''
    } catch (error) {
      if (!isOver) trouble.value = (error as Error).message
    }
    again()
  }
  const again = () => {
    if (!isOver) timer = window.setTimeout(() => (document.hidden ? again() : void look()), kPeriod)
  }
  void look()
  return () => {
    isOver = true
    clearTimeout(timer)
  }
}
