// The graph of the rule file, beside its text. A press on a node leads to its line; without a pointer, a list of the nodes does.
import { effect, signal } from '@preact/signals'
import { useEffect, useRef, useState } from 'preact/hooks'
import { coloursNow } from './graph_style'
import { listed } from './incidents'
import type { Point } from './layout'
import { contentOf, type FileGraph, fileGraph, graphFollows, has, idOf, lineOf, placesOf, why, type Written } from './rule_graph'
import { extentOf, Scene } from './scene'
import { can } from './store'
import { isDark, isDevice } from './theme'

const kPad = 16 // pixels
const kMostFitted = 1 // zoom
const isWide = isDevice('(min-width: 901px)')

const chosen = signal<string | null>(null)

function Canvas({ onLine }: { onLine: (line: number) => void }) {
  const place = useRef<HTMLDivElement>(null)
  useEffect(() => {
    let colours = coloursNow()
    let places = new Map<string, Point>()
    let structure = ''
    const scene = new Scene(place.current!, () => ({ text: colours('text'), surface: colours('surface'), accent: colours('accent') }))
    const fit = () => {
      scene.resize()
      if (scene.content.nodes.length > 0) scene.fit(extentOf(scene.content.nodes), kPad, kMostFitted)
    }
    scene.onPress = (id) => {
      chosen.value = id
      const line = id && fileGraph.peek() ? lineOf(fileGraph.peek()!, id) : undefined
      if (line) onLine(line)
    }
    const stop = effect(() => {
      isDark.value // colours are those of the scheme
      colours = coloursNow()
      const graph = fileGraph.value
      if (!graph) return
      const now = JSON.stringify([graph.components.map((c) => c.name), graph.dependencies, graph.rules.map((r) => [r.name, r.reads, r.adapts])])
      const isNew = now !== structure
      structure = now
      if (isNew) places = placesOf(graph, places)
      scene.content = contentOf(graph, places, colours, chosen.value)
      scene.drawSoon()
      if (isNew) fit()
    })
    const observer = new ResizeObserver(fit)
    observer.observe(place.current!)
    return () => {
      observer.disconnect()
      stop()
      scene.destroy()
    }
  }, [])
  return <div class="canvas" ref={place} aria-hidden="true" />
}

// The node that was pressed.
function Chosen({ graph }: { graph: FileGraph }) {
  const rule = graph.rules.find((r) => idOf('rule', r.name) === chosen.value)
  if (!rule) return null
  const parts = [
    rule.reads.length > 0 && `reads ${listed(rule.reads)}`,
    rule.adapts.length > 0 && `adapts ${listed(rule.adapts)}`,
    rule.spreads.length > 0 && `may spread to ${listed(rule.spreads)}`,
  ].filter(Boolean)
  return parts.length > 0 ? <p>{`${rule.name} ${parts.join('; ')}.`}</p> : null
}

// The same as a press on the drawing, by keyboard. The list alone only chooses: an arrow key in it must not move the focus into the text.
function NodeChoice({ graph, onLine }: { graph: FileGraph; onLine: (line: number) => void }) {
  const options = (kind: 'component' | 'rule', all: Written[]) =>
    all.map(({ name, mistake }) => (
      <option value={idOf(kind, name)}>
        {name}
        {mistake ? ` (${mistake})` : ''}
      </option>
    ))
  const line = chosen.value ? lineOf(graph, chosen.value) : undefined
  return (
    <p>
      <select aria-label="Node of the graph" value={has(graph, chosen.value) ? chosen.value! : ''} onChange={(e) => (chosen.value = e.currentTarget.value || null)}>
        <option value="">no node</option>
        {graph.components.length > 0 && <optgroup label="Components">{options('component', graph.components)}</optgroup>}
        {graph.rules.length > 0 && <optgroup label="Rules">{options('rule', graph.rules)}</optgroup>}
      </select>{' '}
      <button type="button" disabled={!line} onClick={() => line && onLine(line)}>
        Go to its line
      </button>
    </p>
  )
}

const counted = (count: number, what: string) => `${count} ${what}${count === 1 ? '' : 's'}`

export function RuleGraphView({ text, onLine }: { text: () => string; onLine: (line: number) => void }) {
  const [isOpen, setOpen] = useState(isWide.value)
  const isThere = can('post', '/api/rules/graph')
  useEffect(() => (isOpen && isThere ? graphFollows(text) : undefined), [isOpen, isThere])
  if (!isThere) return null
  const graph = fileGraph.value
  return (
    <details class="file-graph" open={isOpen} onToggle={(e) => setOpen(e.currentTarget.open)}>
      <summary>Graph of the file{graph && isOpen ? `: ${counted(graph.components.length, 'component')}, ${counted(graph.rules.length, 'rule')}` : ''}</summary>
      {isOpen && (
        <>
          <Canvas onLine={onLine} />
          <p class="muted">Lines: solid, depends on; dotted, is read by; dashed, adapts. Marks: ◆ error, ▲ warning.</p>
          {graph && <NodeChoice graph={graph} onLine={onLine} />}
          {why.value && <p class="muted">{why.value}.</p>}
          {graph && <Chosen graph={graph} />}
        </>
      )}
    </details>
  )
}
