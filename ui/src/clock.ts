// Times for people: by the clock on the robot's wall, in this browser's zone, and how long something takes.

// `clock` in seconds since 1970.
export function byTheClock(clock: number, digits = 0): string {
  const date = new Date(clock * 1000)
  const two = (n: number) => String(n).padStart(2, '0')
  const whole = `${two(date.getHours())}:${two(date.getMinutes())}:${two(date.getSeconds())}`
  if (digits === 0) return whole
  return `${whole}.${String(date.getMilliseconds()).padStart(3, '0').slice(0, digits)}`
}

export function byTheCalendar(clock: number): string {
  const date = new Date(clock * 1000)
  const two = (n: number) => String(n).padStart(2, '0')
  return `${date.getFullYear()}-${two(date.getMonth() + 1)}-${two(date.getDate())}`
}

const isToday = (clock: number) => new Date(clock * 1000).toDateString() === new Date().toDateString()

// With the day where it is another one than today.
export const when = (clock: number, digits = 0) => (isToday(clock) ? '' : `${byTheCalendar(clock)} `) + byTheClock(clock, digits)

// "14:00:00 to 14:05:00", with the days where it may not be clear which.
export function fromTo(from: number, to: number): string {
  if (isToday(from) && isToday(to)) return `${byTheClock(from)} to ${byTheClock(to)}`
  const day = byTheCalendar(from) === byTheCalendar(to) ? '' : `${byTheCalendar(to)} `
  return `${byTheCalendar(from)} ${byTheClock(from)} to ${day}${byTheClock(to)}`
}

// "40 ms", "0.4 s", "12 s", "3 min 5 s", "2 h 10 min": two figures are enough to act on.
export function lasting(seconds: number): string {
  if (seconds > 0 && seconds < 0.0995) return `${Math.max(1, Math.round(1000 * seconds))} ms`
  if (seconds < 9.95) return `${Math.max(0, seconds).toFixed(1)} s`
  const whole = Math.round(seconds)
  if (whole < 60) return `${whole} s`
  if (whole < 3600) return `${Math.floor(whole / 60)} min ${whole % 60} s`
  if (whole < 86_400) return `${Math.floor(whole / 3600)} h ${Math.floor((whole % 3600) / 60)} min`
  return `${Math.floor(whole / 86_400)} d ${Math.floor((whole % 86_400) / 3600)} h`
}

// Without tenths, for what is counted while one looks.
export const lastingSoFar = (seconds: number) => (seconds < 60 ? `${Math.floor(Math.max(0, seconds))} s` : lasting(seconds))
