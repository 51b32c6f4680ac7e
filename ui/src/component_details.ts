// The selected component: the load of its process, its parameters and its latest log lines. Polled while it is selected.
import { signal } from '@preact/signals'
import { call } from './api'
import { can } from './store'

interface Process {
  pid: number
  memory: number // bytes
  threads: number
}
interface Usage {
  clock: number // seconds since 1970
  processor: number // of one core, over the seconds before
  memory: number // bytes
}
interface Details {
  node: string
  process: Process | null
  usage: Usage[] // oldest first
  parameters: Record<string, number | string | boolean | null> | null
  log: { clock: number; level: string; text: string }[]
}

const kPeriod = 2000 // ms

export const details = signal<Details | null>(null)
export const trouble = signal('')

// Gives how to stop.
export function lookAt(component: string): () => void {
  details.value = null
  trouble.value = ''
  if (!can('get', '/api/component')) return () => {}
  let isOver = false
  const look = async () => {
    try {
      const answer = await call<Details>('GET', `/api/component?name=${encodeURIComponent(component)}`)
      if (isOver) return
      details.value = answer
      trouble.value = ''
    } catch (error) {
      if (!isOver) trouble.value = (error as Error).message
    }
  }
  void look()
  const timer = setInterval(() => void look(), kPeriod)
  return () => {
    isOver = true
    clearInterval(timer)
  }
}
