// How topics came and signals went in the last minutes, for those who look on: kept by this page, as far as it was open.
import { effect } from '@preact/signals'
import { robot, state } from './store'

const kPeriod = 0.5 // s
const kMost = 240

export interface Trend {
  values: number[] // the newest last
  times: number[] // s since culprit began to watch
}
const kNone: Trend = { values: [], times: [] }

const trends = new Map<string, Trend>()
let told = -Infinity

function keep(name: string, value: number): void {
  const trend = trends.get(name) ?? { values: [], times: [] }
  trend.values.push(value)
  trend.times.push(told)
  if (trend.values.length > kMost) {
    trend.values.shift()
    trend.times.shift()
  }
  trends.set(name, trend)
}

effect(() => {
  const now = state.value
  if (!now) return
  if (now.t >= told && now.t - told < kPeriod) return
  if (now.t < told) trends.clear() // another culprit
  told = now.t
  robot.peek()?.topics.forEach((topic, place) => {
    const { rate, age } = now.topics[place] ?? { rate: null, age: null }
    if (age !== null) keep(`age ${topic}`, age)
    if (rate !== null) keep(`rate ${topic}`, age !== null && age > 3 / rate ? 0 : rate) // silent
  })
  robot.peek()?.inputs.forEach((input, place) => {
    const value = now.inputs[place]
    if (typeof value === 'number' || typeof value === 'boolean') keep(`input ${input}`, Number(value))
  })
})

// `what`: "age" (s), "rate" (Hz) of a topic, or "input" (as the rules name it).
export const trendOf = (what: 'age' | 'rate' | 'input', name: string): Trend => trends.get(`${what} ${name}`) ?? kNone
