// The live dependency graph: data flows from left to right, health is shown by colour, shape and word, the culprit and
// the path of its cascade stand out.
import { effect, untracked } from '@preact/signals'
import { useEffect, useRef } from 'preact/hooks'
import { Drawing, isUpright, kDiscovery } from './graph_drawing'
import { cascade, search, shown, showsAll } from './graph_model'
import { effective, groupBy, type Grouping, grouping, kGroupings } from './grouping'
import { tell } from './notices'
import { culprits, isLive, looks, robot, selected, situation, state, verdict } from './store'
import { isDark } from './theme'

// A large graph takes a while to paint; changes at a shorter period would not be visible.
const kPeriod = 66 // ms

// The inputs of a drawing.
const readAll = () =>
  [shown, cascade, effective, looks, culprits, situation, robot, state, selected, isLive].map((each) => each.value)

export function GraphView() {
  const place = useRef<HTMLDivElement>(null)
  const held = useRef<Drawing | null>(null)
  useEffect(() => {
    const drawing = (held.current = new Drawing(place.current!))
    const holding = setTimeout(() => drawing.holdPlaces(), kDiscovery)
    const turn = () => drawing.turn()
    isUpright.addEventListener('change', turn)
    let timer = 0
    let drawn = verdict.peek()
    const stop = effect(() => {
      readAll()
      if (verdict.value !== drawn) {
        drawn = verdict.value
        return untracked(() => drawing.drawAtOnce())
      }
      if (timer !== 0) return
      timer = window.setTimeout(() => {
        timer = 0
        drawing.draw()
      }, kPeriod)
    })
    const stopStyling = effect(() => {
      isDark.value // colours are those of the scheme
      drawing.restyle()
    })
    const observer = new ResizeObserver(() => drawing.turn())
    observer.observe(place.current!)
    return () => {
      observer.disconnect()
      isUpright.removeEventListener('change', turn)
      clearTimeout(holding)
      clearTimeout(timer)
      stopStyling()
      stop()
      drawing.destroy()
    }
  }, [])
  const layOutAnew = () => {
    const undo = held.current?.layOutAnew()
    tell({ text: 'New layout.', undo })
  }
  return (
    <section class="graph" aria-label="Dependency graph">
      <div class="bar">
        <input
          type="search"
          placeholder="Find a node"
          aria-label="Find a node"
          value={search.value}
          onInput={(e) => (search.value = e.currentTarget.value)}
        />
        <label>
          <input
            type="checkbox"
            checked={showsAll.value}
            onChange={(e) => (showsAll.value = e.currentTarget.checked)}
          />
          all nodes and topics
        </label>
        <label>
          by{' '}
          <select aria-label="Group nodes by" value={grouping.value} onChange={(e) => groupBy(e.currentTarget.value as Grouping)}>
            {Object.entries(kGroupings).map(([each, words]) => (
              <option value={each}>{words}</option>
            ))}
          </select>
        </label>
        <span class="zoom" role="group" aria-label="Zoom of the graph">
          <button type="button" aria-label="Smaller" title="Smaller" onClick={() => held.current?.zoom(1 / 1.3)}>
            −
          </button>
          <button type="button" aria-label="Larger" title="Larger" onClick={() => held.current?.zoom(1.3)}>
            +
          </button>
          <button type="button" aria-label="Show all of the graph" title="Show all of it" onClick={() => held.current?.fit(true)}>
            ⤢
          </button>
          <button type="button" aria-label="New layout" title="New layout: nodes keep their places otherwise" onClick={layOutAnew}>
            ⟲
          </button>
        </span>
      </div>
      <div class="drawing-place">
        <div class="canvas" ref={place} aria-hidden="true" />
        <span class="legend" aria-hidden="true">
          <b class="culprit">★ culprit</b> <b class="ERROR">◆ error</b>{' '}
          <b class="WARNING">▲ warning</b> <b class="NON_CRITICAL">○ non-critical</b>
        </span>
      </div>
    </section>
  )
}
