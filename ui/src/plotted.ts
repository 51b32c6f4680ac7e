// The content of the page of plots: which signals over which time, as the address says it, and their values as the server has them.
import { computed, effect, signal } from '@preact/signals'
import { call } from './api'
import { nowByTheClock } from './freshness'
import { can, robot, state } from './store'
import type { ManagerEvent } from './types'

export interface Curve {
  clocks: number[] // s since 1970, the oldest first
  values: (number | null)[] // null: it was unknown
}
export type Range = { last: number } | { from: number; to: number } // s

const kKept = 900 // s, in the server's memory; the journal reaches further back
const kUsageKept = 86_400 // s, of processor and memory
export const kMostBack = 30 * 86_400 // s
const kUsual = 120 // s
const kPeriod = 1000 // ms
const kMostAtFirst = 3

const isUsage = (name: string) => /^(processor|memory) /.test(name)

export const plotted = signal<string[]>([]) // "rate /scan", "input entropy", "memory camera"
export const range = signal<Range>({ last: kUsual })
export const curves = signal<Map<string, Curve>>(new Map())
// Errors about the values in memory and about the journal: each lasts until its own next answer.
const troubleOfCurves = signal('')
const troubleOfPast = signal('')
export const trouble = computed(() => troubleOfCurves.value || troubleOfPast.value)

// The journal's part: of a time that is no longer in memory.
interface Past {
  clocks: number[]
  curves: Record<string, (number | null)[]>
  events: ManagerEvent[]
}
interface Reach {
  oldest: number | null // since when there are curves; null: only in memory
  why: string
}
export const past = signal<Past | null>(null)
export const reach = signal<Reach | null>(null)

// Memory goes on where the journal ends.
export function curveOf(name: string): Curve {
  const recent = curves.value.get(name) ?? { clocks: [], values: [] }
  const old = past.value?.curves[name]
  if (!old) return recent
  const first = recent.clocks[0] ?? Infinity
  const count = past.value!.clocks.filter((clock) => clock < first).length
  return { clocks: [...past.value!.clocks.slice(0, count), ...recent.clocks], values: [...old.slice(0, count), ...recent.values] }
}

export interface Kind {
  unit: string
  scale: number // from the server's unit
  words: string
}
const kKinds: Record<string, Kind> = {
  rate: { unit: 'Hz', scale: 1, words: 'rate of' },
  age: { unit: 's', scale: 1, words: 'age of' },
  processor: { unit: '% of a core', scale: 100, words: 'processor of' },
  memory: { unit: 'MB', scale: 1e-6, words: 'memory of' },
  input: { unit: '', scale: 1, words: '' },
}
const kTimes = /^(age|goal_age|frozen)\(/
export function kindOf(name: string): Kind {
  const what = name.slice(0, name.indexOf(' '))
  if (what === 'input') {
    const place = robot.value?.inputs.indexOf(subjectOf(name)) ?? -1
    if (typeof state.value?.inputs[place] === 'boolean') return { ...kKinds.input, unit: 'true = 1' }
    if (kTimes.test(subjectOf(name))) return { ...kKinds.input, unit: 's' }
    if (subjectOf(name).startsWith('rate(')) return { ...kKinds.input, unit: 'Hz' }
  }
  return kKinds[what] ?? kKinds.input
}
export const subjectOf = (name: string) => name.slice(name.indexOf(' ') + 1)
export const wordsOf = (name: string) => `${kindOf(name).words} ${subjectOf(name)}`.trim()

// How an input of the rules is called here.
export function signalOf(input: string): string {
  const [, what, topic] = /^(rate|age)\((\/[^ ,()]+)\)$/.exec(input) ?? []
  return topic && robot.value?.topics.includes(topic) ? `${what} ${topic}` : `input ${input}`
}

// All that can be plotted.
export const offered = computed((): string[] => {
  const { topics = [], inputs = [], components = [] } = robot.value ?? {}
  return [
    ...inputs.filter((_, place) => typeof state.value?.inputs[place] !== 'string').map(signalOf).filter((name) => name.startsWith('input ')),
    ...topics.flatMap((t) => [`rate ${t}`, `age ${t}`]),
    ...components.flatMap(({ name }) => [`processor ${name}`, `memory ${name}`]),
  ]
})

const inputs = () => robot.value?.inputs ?? []

// The constants that rules compare it with, in the unit of the plot. Rules read rates over several windows.
export function thresholdsOf(name: string): number[] {
  const subject = subjectOf(name)
  const what = name.slice(0, name.indexOf(' '))
  if (what === 'rate') return inputs().flatMap((input, place) => (input.startsWith(`rate(${subject}, `) ? (robot.value?.thresholds?.[place] ?? []) : []))
  const [input, scale] =
    what === 'input' ? [subject, 1] : what === 'processor' ? [`cpu(${subject})`, 100] : what === 'memory' ? [`memory(${subject})`, 1.048576] : [`${what}(${subject})`, 1]
  const place = inputs().indexOf(input)
  return (robot.value?.thresholds?.[place] ?? []).map((value) => value * scale)
}

// The part of the address behind "#plots/".
export function toAddress(names: string[], shown: Range): string {
  const query = new URLSearchParams(names.map((name) => ['s', name]))
  if ('last' in shown) query.set('last', String(shown.last))
  else {
    query.set('from', shown.from.toFixed(1))
    query.set('to', shown.to.toFixed(1))
  }
  return `#plots/${query}`
}
export function fromAddress(place: string): void {
  const query = new URLSearchParams(place)
  const number = (key: string) => (query.has(key) ? Number(query.get(key)) : NaN)
  if (query.has('s')) plotted.value = query.getAll('s')
  if (number('to') > number('from')) range.value = { from: number('from'), to: number('to') }
  else if (number('last') > 0) range.value = { last: number('last') }
}
export function show(names: string[], shown: Range = range.value): void {
  plotted.value = names
  range.value = shown
  history.replaceState(null, '', toAddress(names, shown))
}

export function extent(): { from: number; to: number } {
  const shown = range.value
  const now = nowByTheClock()
  return 'last' in shown ? { from: now - shown.last, to: now } : shown
}

// Without signals in the address: the rates of the first topics.
export const atFirst = (): string[] => (robot.value?.topics ?? []).slice(0, kMostAtFirst).map((topic) => `rate ${topic}`)

async function ask(name: string): Promise<[string, Curve]> {
  const known = curves.peek().get(name)
  const since = known?.clocks[known.clocks.length - 1]
  const more = await call<Curve>('GET', `/api/series?name=${encodeURIComponent(name)}${since === undefined ? '' : `&since=${since}`}`)
  const clocks = [...(known?.clocks ?? []), ...more.clocks]
  const values = [...(known?.values ?? []), ...more.values]
  const kept = isUsage(name) ? kUsageKept : kKept
  const first = Math.max(0, clocks.findIndex((clock) => clock > clocks[clocks.length - 1] - kept))
  return [name, { clocks: clocks.slice(first), values: values.slice(first) }]
}

const kSettled = 400 // ms without another choice, until the journal is read
const kAnew = 60_000 // ms, of a time that goes on
const kRetry = 5000 // ms, after an error

// Asks for the time before the curves in memory, whenever another time or signal is chosen. Gives how to stop.
export function followPast(): () => void {
  if (!can('post', '/api/series/past')) return () => {}
  let isOver = false
  let timer = 0
  let asked = 0
  const look = async (): Promise<void> => {
    const { from, to } = extent()
    const recorded = plotted.peek().filter((name) => !isUsage(name))
    const kept = Math.max(0, ...recorded.map((name) => curves.peek().get(name)?.clocks[0] ?? nowByTheClock()))
    const names = from < kept - 2 ? recorded : []
    const own = ++asked
    try {
      const answer = await call<Reach & Partial<Past>>('POST', '/api/series/past', { names, from, to: Math.min(to, kept) })
      if (isOver || own !== asked) return
      troubleOfPast.value = ''
      reach.value = { oldest: answer.oldest, why: answer.why }
      past.value = answer.clocks ? { clocks: answer.clocks, curves: answer.curves!, events: answer.events!.map((event, i) => ({ ...event, number: -1 - i })) } : null
    } catch (error) {
      if (isOver || own !== asked) return
      troubleOfPast.value = (error as Error).message
      wait(kRetry)
    }
  }
  const wait = (time: number) => {
    clearTimeout(timer)
    timer = window.setTimeout(() => {
      void look()
      if ('last' in range.peek()) wait(kAnew)
    }, time)
  }
  const stop = effect(() => {
    plotted.value
    range.value
    wait(kSettled)
  })
  return () => {
    isOver = true
    troubleOfPast.value = ''
    stop()
    clearTimeout(timer)
  }
}

// As long as the page is open. Gives how to stop.
export function followCurves(): () => void {
  let isOver = false
  let isAsking = false
  const look = async (): Promise<void> => {
    if (isAsking || isOver) return
    isAsking = true
    const wanted = plotted.peek()
    try {
      const all = await Promise.all(wanted.map(ask))
      if (!isOver) curves.value = new Map(all)
      troubleOfCurves.value = ''
    } catch (error) {
      if (!isOver) troubleOfCurves.value = (error as Error).message
    }
    isAsking = false
    if (wanted !== plotted.peek()) return look()
  }
  const stop = plotted.subscribe(() => void look())
  const timer = setInterval(() => void look(), kPeriod)
  return () => {
    isOver = true
    stop()
    clearInterval(timer)
  }
}
