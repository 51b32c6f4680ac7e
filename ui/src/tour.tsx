// A tour of the page in six steps, on the first visit. It can be ended at each step, and begun again on the page of help.
import { signal } from '@preact/signals'
import { useEffect } from 'preact/hooks'
import { robot } from './store'

const kKey = 'culprit-tour'
const kSteps: [place: string, title: string, text: string][] = [
  ['.status-bar', 'Status', 'This bar shows the health of the robot, the root cause, and the current repair. It is the same on every page.'],
  ['.brake', 'Pause', 'Pause stops all repairs at once, also by Alt-P. Only this button resumes.'],
  ['.graph', 'Graph', 'Data flows from left to right. A star marks the blamed component. Press a component for its process, topics and log.'],
  ['.explanation', 'Explanation', 'Each incident shows its suspects with the evidence, the possible repairs, and the reason against each other repair.'],
  ['.timeline', 'Timeline', 'Failures and repairs over time. Move the slider to see the robot at an earlier moment.'],
  ['header nav', 'Pages', 'Incidents has the past, Plots the signals, Rules the rule file. Help explains terms and starts this tour again.'],
]

// null: no tour.
const step = signal<number | null>(localStorage.getItem(kKey) === null ? 0 : null)

export function beginTour(): void {
  location.hash = 'robot'
  step.value = 0
}
function end(): void {
  step.value = null
  localStorage.setItem(kKey, 'ended')
}

export function Tour() {
  const now = step.value
  const isShown = now !== null && robot.value !== null
  useEffect(() => {
    if (!isShown) return
    const element = document.querySelector(kSteps[now][0])
    element?.classList.add('toured')
    element?.scrollIntoView({ block: 'nearest' })
    return () => element?.classList.remove('toured')
  }, [now, isShown])
  // Wherever the focus is: a newcomer's is at the top of the page.
  useEffect(() => {
    if (!isShown) return
    const onKey = (e: KeyboardEvent) => e.key === 'Escape' && end()
    addEventListener('keydown', onKey)
    return () => removeEventListener('keydown', onKey)
  }, [isShown])
  if (!isShown) return null
  const [, title, text] = kSteps[now]
  return (
    <section class="tour" aria-label="Tour">
      <p aria-live="polite">
        <b>
          {title} ({now + 1} of {kSteps.length})
        </b>
        <br />
        {text}
      </p>
      <div class="bar">
        <button type="button" disabled={now === 0} onClick={() => (step.value = now - 1)}>
          Back
        </button>
        <button type="button" class="primary" onClick={() => (now + 1 < kSteps.length ? (step.value = now + 1) : end())}>
          {now + 1 < kSteps.length ? 'Next' : 'Done'}
        </button>
        <button type="button" onClick={end}>
          End the tour <kbd aria-hidden="true">Esc</kbd>
        </button>
      </div>
    </section>
  )
}
