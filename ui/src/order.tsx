// Orders to the manager, and who gives them.
import { signal } from '@preact/signals'
import { call, hasToken } from './api'
import { isReachable } from './freshness'
import { act, tell } from './notices'

const kAuthorKey = 'culprit-author'
const author = signal(localStorage.getItem(kAuthorKey) ?? '')

// For the record.
export const authorName = () => author.value || 'somebody at the page'

// An order that would not arrive is not offered.
export const canOrder = () => hasToken && isReachable.value

// The answer to a standing order (a pause, for example) includes whether it outlives a restart of
// culprit.
export async function order(what: string, body: Record<string, unknown>): Promise<boolean> {
  let text = 'done'
  const isDone = await act(what, async () => {
    const all = { author: authorName(), ...body }
    text = (await call<{ text?: string }>('POST', '/api/orders', all)).text ?? text
  })
  if (isDone) tell({ text: `${what}: ${text}` })
  return isDone
}

export function Author() {
  return (
    <label class="field">
      <span>your name, for the journal</span>
      <input
        value={author.value}
        maxLength={100}
        onChange={(e) => {
          author.value = e.currentTarget.value.trim()
          localStorage.setItem(kAuthorKey, author.value)
        }}
      />
    </label>
  )
}
