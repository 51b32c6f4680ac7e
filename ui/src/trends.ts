// How often topics came in the last minutes, for those who look on: kept by this page, as far as it was open.
import { effect } from '@preact/signals'
import { robot, state } from './store'

const kPeriod = 1 // s
const kMost = 120

const rates = new Map<string, number[]>()
let told = -Infinity

effect(() => {
  const now = state.value
  if (!now) return
  if (now.t >= told && now.t - told < kPeriod) return
  told = now.t
  robot.peek()?.topics.forEach((topic, place) => {
    const { rate, age } = now.topics[place] ?? { rate: null, age: null }
    if (rate === null) return
    const list = rates.get(topic) ?? []
    list.push(age !== null && age > 3 / rate ? 0 : rate) // silent
    if (list.length > kMost) list.shift()
    rates.set(topic, list)
  })
})

export const trendOf = (topic: string): number[] => rates.get(topic) ?? []
