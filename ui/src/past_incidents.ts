// Past incidents from the journal, as the server lists them (docs/web.md), and the events of the selected one.
import { batch, computed, effect, signal, untracked } from '@preact/signals'
import { call } from './api'
import { isReachable, nowByTheClock } from './freshness'
import { can, events } from './store'
import type { Criticality, ManagerEvent } from './types'

export interface PastIncident {
  id: string // of its beginning, for links: the same after a restart
  first: number // of the rows that tell it
  last: number
  clock: number // when it began, seconds since 1970
  seconds: number // how long; so far, if it lasts
  over: boolean
  cut: boolean // culprit ended before it was over
  lost: boolean // what its rule reads could not be seen any more
  merged_into: string | null // the id of the incident that its failures belonged to at its end
  given_up: boolean
  worst: Criticality
  causes: string[] // components
  rules: string[]
  consequences: string[] // rules
  helped: string[] // strategies
  recordings?: { name: string; path: string; bytes: number }[] // of the black box, the oldest first
}
interface Answer {
  journal: string | null
  remark?: string
  oldest?: number
  incidents: PastIncident[]
}

export const kPeriods: [number, string][] = [
  [3600, 'hour'],
  [86_400, 'day'],
  [7 * 86_400, 'week'],
  [30 * 86_400, 'month'],
]
export const period = signal(86_400) // s, back from now
export const answer = signal<Answer | null>(null)
export const trouble = signal('')
const kBefore = 60 // s
const since = computed(() => Math.min(untracked(nowByTheClock) - period.value, linked.value - kBefore))

export const chosenId = signal('') // '': the newest
const kIdBase = 36
// A link may be older than what is shown: its id says when that was.
const linked = computed(() => (chosenId.value ? parseInt(chosenId.value, kIdBase) / 1000 || Infinity : Infinity))

// Those that are open, the most urgent first; then the newest first.
export const incidents = computed(() => answer.value?.incidents ?? [])
export const chosen = computed(() => incidents.value.find((i) => i.id === chosenId.value) ?? (chosenId.value ? undefined : incidents.value[0]))

export const told = signal<{ key: string; events: ManagerEvent[] }>({ key: '', events: [] })
const keyOf = ({ first, last }: PastIncident) => `${first} ${last}`

const kChanging = /^(incident_|failure_|strategy_chosen|approval_asked|action_held_back|rule_exhausted|reloaded)/
const kSoon = 500 // ms: the journal is written by then

let asked = 0
async function load(): Promise<void> {
  const mine = ++asked
  try {
    const next = await call<Answer>('GET', `/api/incidents?since=${Math.max(0, since.peek()).toFixed(3)}`)
    if (mine !== asked) return
    batch(() => {
      answer.value = next
      trouble.value = ''
    })
  } catch (error) {
    if (mine === asked) trouble.value = (error as Error).message
  }
}

async function loadEvents(incident: PastIncident): Promise<void> {
  const key = keyOf(incident)
  const from = answer.peek()?.journal === null ? '&from=stream' : ''
  try {
    const list = await call<{ events: ManagerEvent[] }>('GET', `/api/incidents/events?first=${incident.first}&last=${incident.last}${from}`)
    if (chosen.peek() && keyOf(chosen.peek()!) === key)
      told.value = { key, events: list.events.map((event, number) => ({ ...event, number })) }
  } catch (error) {
    trouble.value = (error as Error).message
  }
}

// Looks as long as the page is open. Gives how to stop.
export function followIncidents(): () => void {
  if (!can('get', '/api/incidents')) return () => {}
  let timer = 0
  let seen = events.peek().length > 0 ? events.peek()[events.peek().length - 1].number : 0
  const stopLoading = effect(() => {
    since.value
    void load()
  })
  const stopFollowing = effect(() => {
    const list = events.value
    const hasChanged = list.some((e) => e.number > seen && kChanging.test(e.type))
    seen = list.length > 0 ? list[list.length - 1].number : 0
    if (hasChanged && timer === 0)
      timer = window.setTimeout(() => {
        timer = 0
        void load()
      }, kSoon)
  })
  // Once culprit is back, the page reads again, where it failed before.
  const stopReturning = effect(() => {
    if (isReachable.value && trouble.peek()) void load()
  })
  const stopTelling = effect(() => {
    if (chosen.value && keyOf(chosen.value) !== told.peek().key) void loadEvents(chosen.value)
  })
  return () => {
    clearTimeout(timer)
    stopLoading()
    stopFollowing()
    stopReturning()
    stopTelling()
  }
}
