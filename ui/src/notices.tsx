// The result of the last order. A success disappears by itself; a failure, or a text to copy, stays until it is dismissed.
import { signal } from '@preact/signals'

export interface Notice {
  text: string
  isTrouble?: boolean
  stays?: boolean
  undo?: () => void
}

const kLasting = 8000 // ms

export const notice = signal<Notice | null>(null)
let timer = 0

export function tell(next: Notice | null): void {
  clearTimeout(timer)
  notice.value = next
  if (next && !next.isTrouble && !next.stays) timer = window.setTimeout(() => (notice.value = null), kLasting)
}

// Does it, and says what came of it.
export async function act(what: string, action: () => Promise<unknown>): Promise<boolean> {
  tell({ text: `${what} …` })
  try {
    await action()
    tell({ text: `${what}: done` })
    return true
  } catch (error) {
    tell({ text: `${what}: ${(error as Error).message}`, isTrouble: true })
    return false
  }
}

export function Notices() {
  const now = notice.value
  return (
    <div class="notices" role="status" aria-label="Notice">
      {now && (
        <p class={now.isTrouble ? 'notice trouble' : 'notice'}>
          <span>{now.text}</span>
          {now.undo && (
            <button
              type="button"
              onClick={() => {
                now.undo!()
                tell(null)
              }}
            >
              Undo
            </button>
          )}
          <button type="button" class="remove" aria-label="Dismiss" onClick={() => tell(null)}>
            ✕
          </button>
        </p>
      )}
    </div>
  )
}
