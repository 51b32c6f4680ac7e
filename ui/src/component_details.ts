// Of the component that is looked at: what its process uses, its parameters and what it logged last. Asked for as long as
// somebody looks.
import { signal } from '@preact/signals'
import { call } from './api'
import { can } from './store'

interface Process {
  pid: number
  processor_s: number // that it has used since it began
  memory: number // bytes
  threads: number
}
interface Answer {
  node: string
  process: Process | null
  parameters: Record<string, number | string | boolean | null> | null
  log: { clock: number; level: string; text: string }[]
}
export interface Usage {
  processor: number // of one core
  memory: number // bytes
}
export interface Details extends Answer {
  usage: Usage[] // oldest first, one for each look
}

const kPeriod = 2000 // ms
const kMostUsage = 150

export const details = signal<Details | null>(null)
export const trouble = signal('')

const usages = new Map<string, Usage[]>() // also while nobody looks

// Gives how to stop.
export function lookAt(component: string): () => void {
  details.value = null
  trouble.value = ''
  if (!can('get', '/api/component')) return () => {}
  const usage = usages.get(component) ?? []
  usages.set(component, usage)
  let before: { process: Process; at: number } | null = null
  let isOver = false
  const look = async () => {
    try {
      const answer = await call<Answer>('GET', `/api/component?name=${encodeURIComponent(component)}`)
      if (isOver) return
      const at = performance.now() / 1000
      const { process } = answer
      if (process && before && before.process.pid === process.pid)
        usage.push({ processor: Math.max(0, process.processor_s - before.process.processor_s) / (at - before.at), memory: process.memory })
      if (usage.length > kMostUsage) usage.shift()
      before = process && { process, at }
      details.value = { ...answer, usage: [...usage] }
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
