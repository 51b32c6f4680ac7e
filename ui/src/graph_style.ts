// How nodes and edges look, in the colours of the scheme.
import type { Shape, SceneNode } from './scene'
import { colour } from './theme'
import type { Tone } from './looks'

export const kLeastZoom = 0.5 // at which the names of nodes can be read

const kShapes: Partial<Record<Tone, Shape>> = { NON_CRITICAL: 'barrel', WARNING: 'hexagon', ERROR: 'octagon', EXHAUSTED: 'octagon' }

// The colours of app.css by name, each asked for once.
export type Colours = (name: string) => string
export function coloursNow(): Colours {
  const known = new Map<string, string>()
  return (name) => {
    let value = known.get(name)
    if (value === undefined) known.set(name, (value = colour(name)))
    return value
  }
}

// A component that no rule judges is neither well nor ill.
export const styled = (tone: Tone, colours: Colours): Pick<SceneNode, 'shape' | 'fill' | 'border' | 'borderWidth' | 'isDouble' | 'fillOpacity'> => ({
  shape: kShapes[tone] ?? 'rounded',
  fill: colours(`${tone}-fill`),
  fillOpacity: 1,
  border: colours(tone),
  borderWidth: tone === 'blind' ? 6 : 2,
  isDouble: tone === 'blind',
})
