// Follows a fast signal at a pace that people can see: a page that redraws every part with every change falls behind.
import { effect, type ReadonlySignal, signal, untracked } from '@preact/signals'
import { useEffect, useMemo } from 'preact/hooks'

// Follows what `read` gives: at once if it has been quiet, and at most every `period` ms. `urgent`: if this changes, at once in any
// case.
export function usePaced<T>(read: () => T, period: number, urgent: () => unknown = () => null): ReadonlySignal<T> {
  const seen = useMemo(() => signal(untracked(read)), [])
  useEffect(() => {
    let timer = 0
    let isBehind = false
    let last = untracked(urgent)
    const rest = () => {
      timer = window.setTimeout(() => {
        timer = 0
        if (!isBehind) return
        isBehind = false
        seen.value = untracked(read)
        rest()
      }, period)
    }
    const stop = effect(() => {
      const now = read()
      const isUrgent = urgent() !== last
      last = urgent()
      if (timer !== 0 && !isUrgent) return void (isBehind = true)
      clearTimeout(timer)
      isBehind = false
      seen.value = now
      rest()
    })
    return () => {
      stop()
      clearTimeout(timer)
    }
  }, [])
  return seen
}
