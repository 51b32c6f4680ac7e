// Above every page, always at the same place: how the robot is, whose fault it is and since when; whether culprit
// acts; whether all this is new; and the brake.
import { computed, effect, signal } from '@preact/signals'
import { byTheClock } from './clock'
import { hasToken } from './api'
import { freshness, nowByTheClock } from './freshness'
import { canOrder, order } from './order'
import type { Tone } from './looks'
import { type Mode, status, title } from './status'
import { can, control, presentIncidents } from './store'
import { colour, isDark } from './theme'

const isOrdering = signal(false)

async function brake(isPaused: boolean): Promise<void> {
  isOrdering.value = true
  await order(isPaused ? 'Resuming' : 'Pausing', { order: isPaused ? 'resume' : 'pause' })
  isOrdering.value = false
}

const canBrake = () => can('post', '/api/orders') && canOrder() && !!control.value

// A user in a hurry presses twice: the key only pauses, the button resumes.
addEventListener('keydown', (e) => {
  const isBrake = e.code === 'Pause' || (e.altKey && !e.ctrlKey && !e.metaKey && e.code === 'KeyP')
  if (!isBrake || !canBrake()) return
  e.preventDefault()
  if (!control.value!.paused) void brake(false)
})

function Brake() {
  if (!can('post', '/api/orders')) return <span class="brake-place" />
  const isPaused = control.value?.paused ?? false
  const why = hasToken
    ? isPaused
      ? 'culprit acts again'
      : 'culprit changes nothing on the robot until you resume (Alt+P or the Pause key)'
    : 'Read-only. To control culprit, open the address that it printed, with its token.'
  return (
    <button
      type="button"
      class={`brake ${isPaused ? 'primary' : 'danger'}`}
      disabled={!canBrake() || isOrdering.value}
      title={why}
      aria-keyshortcuts="Alt+P Pause"
      onClick={() => void brake(isPaused)}
    >
      <span aria-hidden="true">{isPaused ? '▶' : 'Ⅱ'} </span>
      {isPaused ? 'Resume' : 'Pause'}
      {!isPaused && <kbd aria-hidden="true">Alt P</kbd>}
    </button>
  )
}

function Freshness() {
  const now = freshness.value
  if (now.kind === 'connecting') return <span class="freshness">connecting</span>
  if (now.kind === 'fresh')
    return (
      <span class="freshness well" title="This view is up to date">
        <span aria-hidden="true">● </span>
        <span class="long">live </span>
        <time>{byTheClock(nowByTheClock())}</time>
      </span>
    )
  return (
    <span class="freshness">
      <span class="long">as of </span>
      <time>{byTheClock(now.since)}</time>
    </span>
  )
}

export function StatusBar() {
  const { tone, sign, word, headline, detail, modes } = status.value
  return (
    <section class={`status-bar is-${tone}`} aria-label="Status">
      <p class="level">
        <span aria-hidden="true">{sign}</span> {word}
      </p>
      <div class="cause">
        <p role="status">
          <b>{headline}</b>
        </p>
        <p class="detail">{detail}</p>
      </div>
      <div class="modes" role="status" aria-label="Mode">
        {modes.slice(0, kMostModes).map((m) => (
          <span class={`mode mode-${m.name}`} title={m.explanation}>
            {m.word}
          </span>
        ))}
      </div>
      <Freshness />
      <Brake />
    </section>
  )
}
const kMostModes = 2

// In two lines, what the modes mean, where nothing else says it: incidents say that nothing is done in a pause.
const kSaidElsewhere = ['acting', 'none', 'bygone', 'approval', 'deaf']
export function ModeNotes() {
  const isSaid = ({ name }: Mode) => kSaidElsewhere.includes(name) || (name === 'paused' && presentIncidents.value.length > 0)
  const notes = status.value.modes.filter((m) => !isSaid(m))
  return (
    <>
      {notes.map((m) => (
        <p class={`mode-note mode-${m.name}`}>
          <b>{m.word}</b>: {m.explanation}
        </p>
      ))}
    </>
  )
}

const kShapes: Record<string, string> = {
  ERROR: '<path d="M16 2 30 16 16 30 2 16z"/>',
  WARNING: '<path d="M16 3 31 29H1z"/>',
  NON_CRITICAL: '<circle cx="16" cy="16" r="13"/>',
  EXHAUSTED: '<path d="M5 1 16 11 27 1l4 4-10 11 10 11-4 4-11-10L5 31l-4-4 10-11L1 5z"/>',
  OK: '<circle cx="16" cy="16" r="14"/><path d="m9 16 5 6 9-12" fill="none" stroke="#fff" stroke-width="4"/>',
}

function icon(tone: Tone, isPaused: boolean): string {
  const fill = kShapes[tone] ? colour(tone) : colour('muted')
  const shape = kShapes[tone] ?? '<circle cx="16" cy="16" r="11" fill="none" stroke-width="6" stroke-dasharray="6 5" stroke="' + fill + '"/>'
  const bars = isPaused ? `<path d="M18 16h14v16H18z" fill="${colour('surface')}"/><path d="M20 18h4v13h-4zm6 0h4v13h-4z" fill="${colour('text')}"/>` : ''
  const svg = `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 32 32"><g fill="${fill}">${shape}</g>${bars}</svg>`
  return `data:image/svg+xml,${encodeURIComponent(svg)}`
}

// The window in the task bar is looked at more often than the page. To ask for a colour takes the time of a frame, so the icon
// follows what it shows and not each state.
const iconTone = computed(() => status.value.tone)
const iconPaused = computed(() => control.value?.paused ?? false)
export function followInTitle(): void {
  const link = document.querySelector<HTMLLinkElement>('link[rel="icon"]')!
  effect(() => {
    document.title = title.value
  })
  effect(() => {
    isDark.value
    const next = icon(iconTone.value, iconPaused.value)
    if (link.href !== next) link.href = next
  })
}
