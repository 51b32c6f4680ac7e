// For a screen on a wall: big, dark, without buttons, readable from the other end of the room.
import { useEffect } from 'preact/hooks'
import { byTheClock } from './clock'
import { freshness, nowByTheClock } from './freshness'
import { level } from './history'
import { conditionOf } from './incidents'
import { kSigns, status, type Tone } from './status'
import { health, present, presentlyKnown, robot } from './store'
import { useDark } from './theme'

function Tiles() {
  const blamed = new Set(present.value.incidents.flatMap((i) => (i.isCertain ? i.components : [])))
  const sick = (name: string) => health.value.get(name) ?? 'OK'
  const components = [...(robot.value?.components ?? [])].sort((a, b) => level(sick(b.name)) - level(sick(a.name)))
  return (
    <ul class="tiles">
      {components.map(({ name }) => (
        <li class={`tile is-${sick(name)}${blamed.has(name) ? ' is-blamed' : ''}`}>
          <b>
            {blamed.has(name) ? '★' : kSigns[sick(name) as Tone]} {name}
          </b>{' '}
          <span>{conditionOf(presentlyKnown(name))}</span>
        </li>
      ))}
    </ul>
  )
}

export function WallPage() {
  useEffect(useDark, [])
  const { tone, sign, word, headline, detail, modes } = status.value
  const isFresh = freshness.value.kind === 'fresh'
  return (
    <main class={`wall is-${tone}`}>
      <section aria-label="Status">
        <p class="wall-level">
          <span aria-hidden="true">{sign}</span> {word}
        </p>
        <h1 aria-live="polite">{headline}</h1>
        <p class="wall-detail">{detail}</p>
      </section>
      <Tiles />
      <footer>
        <span>{robot.value?.robot}</span>
        <span>{modes.map((m) => m.word).join('  ')}</span>
        <time>{isFresh ? byTheClock(nowByTheClock()) : `as of ${byTheClock(nowByTheClock())}`}</time>
        <a href="#robot">Leave the wall view</a>
      </footer>
    </main>
  )
}
