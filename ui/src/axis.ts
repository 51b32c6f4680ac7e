// A time axis: where its ticks are, and what they say, from milliseconds to days.
import { byTheCalendar, byTheClock } from './clock'

export interface Tick {
  at: number // in the time of the axis
  label: string
}

const kDay = 86_400
const kSteps = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 10_800, 21_600, 43_200, kDay, 2 * kDay, 7 * kDay, 30 * kDay]

const digitsOf = (step: number) => (step >= 1 ? 0 : step >= 0.1 ? 1 : step >= 0.01 ? 2 : 3)

function labelOf(clock: number, step: number): string {
  if (step >= kDay) return byTheCalendar(clock)
  return step >= 60 ? byTheClock(clock).slice(0, 5) : byTheClock(clock, digitsOf(step))
}

// At most `most` ticks on round times between `begin` and `end`. `clockOf` says what the clock on the wall shows then;
// without one, the axis counts from 0.
export function ticks(begin: number, end: number, most: number, clockOf?: (t: number) => number): Tick[] {
  const step = kSteps.find((s) => (end - begin) / s <= most) ?? kSteps[kSteps.length - 1]
  // Round is what is round for people: in their zone.
  const offset = clockOf ? clockOf(end) - end - 60 * new Date(1000 * clockOf(end)).getTimezoneOffset() : 0
  const first = Math.ceil((begin + offset) / step)
  const result: Tick[] = []
  for (let i = first; i * step - offset <= end; ++i) {
    const at = i * step - offset
    const label = clockOf ? labelOf(clockOf(end) + at - end, step) : `${Number((i * step).toFixed(3))} s`
    result.push({ at, label })
  }
  return result
}
