// The robot on its map, beside the explanation of its failures.
import { useEffect, useMemo, useRef } from 'preact/hooks'
import { lasting } from './clock'
import { began, grid, lookAtMap, type MapPicture, picture, type Robot, trouble, wanted } from './map'
import { drawMap, kStale, painted } from './map_drawing'
import { isLive } from './store'
import { isDark } from './theme'

const kDiscovery = 4000 // ms

const degrees = (yaw: number) => `${Math.round((yaw * 180) / Math.PI)}°`
const place = ({ frame, at: [x, y], yaw, age }: Robot) =>
  `${frame} at x ${x.toFixed(1)} m, y ${y.toFixed(1)} m, ${degrees(yaw)}${age > kStale ? `, as of ${lasting(age)} ago` : ''}`

function Canvas({ map }: { map: MapPicture }) {
  const canvas = useRef<HTMLCanvasElement>(null)
  const now = grid.value!
  const cells = useMemo(() => painted(now), [now, isDark.value])
  const draw = useRef(() => {})
  draw.current = () => canvas.current && drawMap(canvas.current, now, cells, map)
  useEffect(() => draw.current())
  useEffect(() => {
    const observer = new ResizeObserver(() => draw.current())
    observer.observe(canvas.current!)
    return () => observer.disconnect()
  }, [])
  return <canvas ref={canvas} class="map" role="img" aria-label={`Map ${map.topic}: ${map.robots.map(place).join('; ')}`} />
}

// In place of the map.
function nothingYet(map: MapPicture | null): string {
  if (trouble.value) return trouble.value
  if (map?.troubles.length) return ''
  if (map?.topics.length) return `No message on ${wanted.value || map.topics[0]} yet.`
  if (Date.now() - began.value < kDiscovery) return 'Looking for a map …'
  return 'No node publishes a nav_msgs/msg/OccupancyGrid.'
}

function Legend({ map }: { map: MapPicture }) {
  const { width, height, resolution, coarser } = grid.value!
  return (
    <p class="muted">
      {(width * resolution).toFixed(1)} × {(height * resolution).toFixed(1)} m{coarser > 1 && `, drawn ${coarser} times coarser`}
      {map.robots.map((robot) => `; ${place(robot)}`)}
      {map.path && `; path ${map.path.topic}, ending at ◎`}
      {map.scan && (map.scan.age > kStale ? `; ${map.scan.topic} is ${lasting(map.scan.age)} old` : `; dots: ${map.scan.topic}`)}
    </p>
  )
}

export function MapView() {
  useEffect(lookAtMap, [])
  const map = picture.value
  const topics = map?.topics ?? []
  return (
    <section class="graph" aria-label="Map">
      {topics.length > 1 && (
        <div class="bar">
          <label>
            map{' '}
            <select aria-label="Topic of the map" value={wanted.value || map!.topic} onChange={(e) => (wanted.value = e.currentTarget.value)}>
              {topics.map((topic) => (
                <option>{topic}</option>
              ))}
            </select>
          </label>
        </div>
      )}
      <div class="canvas">{map && grid.value ? <Canvas map={map} /> : <p class="nothing">{nothingYet(map)}</p>}</div>
      {map && grid.value && <Legend map={map} />}
      {[...(map?.troubles ?? []), ...(isLive.value ? [] : ['The map shows the present, not the moment of the timeline'])].map((text) => (
        <p role="status">▲ {text}.</p>
      ))}
    </section>
  )
}
