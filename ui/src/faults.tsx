// Breaking a demonstration on purpose.
import { useEffect, useState } from 'preact/hooks'
import { call } from './api'
import { canOrder } from './order'
import { act } from './notices'
import { can } from './store'

interface Fault {
  name: string
  component: string
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
      <button type="submit" class="danger" disabled={!canOrder()}>
        Inject fault
      </button>
      <button
        type="button"
        disabled={!canOrder()}
        onClick={() => void act('Clearing all faults', () => call('DELETE', '/api/faults'))}
      >
        Clear all
      </button>
    </form>
  )
}
