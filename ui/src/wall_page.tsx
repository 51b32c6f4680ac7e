// For a screen on a wall: big, dark, without buttons, readable from the other end of the room.
import { useEffect } from 'preact/hooks'
import { byTheClock } from './clock'
import { freshness, nowByTheClock } from './freshness'
import { kLooks, rankOf, toneOf } from './looks'
import { status } from './status'
import { presentIncidents, presentLooks, robot, stateOfComponent } from './store'
import { useDark } from './theme'

function Tiles() {
  const blamed = new Set(presentIncidents.value.flatMap((i) => (i.certain ? i.components : [])))
  const lookOf = (name: string) => presentLooks.value.get(name) ?? 'UNTOLD'
  const components = [...(robot.value?.components ?? [])].sort((a, b) => rankOf(lookOf(a.name)) - rankOf(lookOf(b.name)))
  return (
    <ul class="tiles">
      {components.map(({ name }) => (
        <li class={`tile is-${toneOf(lookOf(name))} look-${lookOf(name)}${blamed.has(name) ? ' is-blamed' : ''}`}>
          <b>
            {blamed.has(name) ? '★' : kLooks[lookOf(name)].sign} {name}
          </b>{' '}
          <span>{stateOfComponent(name)?.condition}</span>
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
