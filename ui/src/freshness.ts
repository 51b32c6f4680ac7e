// Whether the shown data is fresh. A page that keeps showing old data would mislead.
import { computed, signal } from '@preact/signals'

const kPatience = 2500 // ms without a sign: a server that lives gives one every second
const kStatePatience = 5000 // ms without a state, while the server gives signs: its manager does not come round
const kTick = 250 // ms, of clocks that run while one looks

const isOpen = signal(false) // the connection
const wasOpen = signal(false)
const lastSign = signal(0) // ms, of this browser's clock; 0: there was none
const lastState = signal(0)
const skew = signal(0) // s, of the robot's clock before this browser's
const tick = signal(Date.now())

// A page that was busy or asleep itself first receives the messages that have arrived meanwhile.
const kLate = 1000 // ms
let ticked = Date.now()
setInterval(() => {
  const now = Date.now()
  const isLate = now - ticked > kLate
  ticked = now
  if (isLate) setTimeout(() => (tick.value = Date.now()), kTick)
  else tick.value = now
}, kTick)

export function begun(): void {
  lastSign.value = tick.value = Date.now()
}
export function hearsSign(): void {
  lastSign.value = Date.now()
}
export function hearsState(clock: number | undefined): void {
  lastState.value = Date.now()
  if (clock !== undefined) skew.value = clock - lastState.value / 1000
}
// Why culprit refuses the connection; empty: it does not, or it does not answer.
export const refusal = signal('')
export function connected(isNow: boolean, why = ''): void {
  isOpen.value = isNow
  refusal.value = why
  if (isNow) {
    wasOpen.value = true
    hearsSign()
  }
  tick.value = Date.now()
}

export type Freshness =
  | { kind: 'connecting' }
  | { kind: 'fresh' }
  | { kind: 'lost' | 'stuck'; since: number } // by the robot's clock

const onTheWall = (ms: number) => ms / 1000 + skew.value

export const freshness = computed((): Freshness => {
  const isSilent = tick.value - lastSign.value > kPatience
  if (lastSign.value === 0 || (!wasOpen.value && !isSilent)) return { kind: 'connecting' }
  if (!isOpen.value || isSilent)
    return { kind: 'lost', since: onTheWall(lastState.value || lastSign.value) }
  if (lastState.value !== 0 && tick.value - lastState.value > kStatePatience)
    return { kind: 'stuck', since: onTheWall(lastState.value) }
  return { kind: 'fresh' }
})
export const isOld = computed(() => freshness.value.kind === 'lost' || freshness.value.kind === 'stuck')

// culprit answers: its manager may be stuck, and receives a pause all the same.
export const isReachable = computed(() => freshness.value.kind === 'fresh' || freshness.value.kind === 'stuck')

// By the robot's clock, which stands still on a page that receives nothing.
export const nowByTheClock = (): number =>
  freshness.value.kind === 'lost' || freshness.value.kind === 'stuck' ? freshness.value.since : onTheWall(tick.value)
