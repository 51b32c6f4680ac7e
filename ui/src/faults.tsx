// Breaking a demonstration on purpose.
import { signal } from '@preact/signals'
import { useEffect, useState } from 'preact/hooks'
import { call, hasToken, Refusal } from './api'
import { can } from './store'

interface Fault {
  name: string
  component: string
}

export const notice = signal('') // what the last control came to

// Does it, and says what came of it.
export async function act(what: string, action: () => Promise<unknown>): Promise<boolean> {
  notice.value = `${what} …`
  try {
    await action()
    notice.value = `${what}: done`
    return true
  } catch (error) {
    notice.value = `${what}: ${(error as Refusal).message}`
    return false
  }
}

export function Faults() {
  const [faults, setFaults] = useState<Fault[]>([])
  const [chosen, choose] = useState('')
  const isOffered = can('post', '/api/faults')
  useEffect(() => {
    if (!isOffered) return
    void call<{ faults: Fault[] }>('GET', '/api/faults').then(({ faults: all }) => {
      setFaults(all)
      choose(all[0]?.name ?? '')
    })
  }, [isOffered])
  if (!isOffered) return null
  return (
    <form
      class="bar faults"
      onSubmit={(e) => {
        e.preventDefault()
        void act(`Injecting ${chosen}`, () => call('POST', '/api/faults', { name: chosen }))
      }}
    >
      <label>
        Break it:{' '}
        <select value={chosen} onChange={(e) => choose(e.currentTarget.value)}>
          {faults.map((f) => (
            <option value={f.name}>{f.name.includes(':') ? f.name : `${f.name} (${f.component})`}</option>
          ))}
        </select>
      </label>
      <button type="submit" class="danger" disabled={!hasToken}>
        Inject fault
      </button>
      <button
        type="button"
        disabled={!hasToken}
        onClick={() => void act('Clearing all faults', () => call('DELETE', '/api/faults'))}
      >
        Clear all
      </button>
    </form>
  )
}
