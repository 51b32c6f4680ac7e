// Orders to the manager, and who gives them.
import { signal } from '@preact/signals'
import { call } from './api'
import { act } from './faults'

const kAuthorKey = 'culprit-author'
const author = signal(localStorage.getItem(kAuthorKey) ?? '')

// For the record.
export const authorName = () => author.value || 'somebody at the page'

export const order = (what: string, body: Record<string, unknown>) =>
  act(what, () => call('POST', '/api/orders', { author: authorName(), ...body }))

export function Author() {
  return (
    <label class="field">
      <span>your name, for the record</span>
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
