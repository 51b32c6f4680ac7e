// What would culprit do if ...? The same planner on a robot that is imagined: components are made ill,
// topics fall silent, signals move, and the plan follows. The real robot is not touched.
import { signal } from '@preact/signals'
import { useEffect, useState } from 'preact/hooks'
import { call, Refusal } from './api'
import { costOf, kCostUnit } from './explain'
import { graph, robot, state } from './store'
import type { State } from './types'

const kConditions = {
  well: '',
  killed: 'KILLED',
  stopped: 'STOPPED',
  hung: 'HUNG',
  inactive: 'STATE inactive',
}
type Condition = keyof typeof kConditions

interface Plan {
  failures: {
    rule: string
    criticality: string
    text: string
    candidates: {
      strategy: string
      success: number
      cost: number
      chosen: boolean
      excluded: { text: string } | null
      flips: { text: string }[]
    }[]
  }[]
  near: { rule: string; input: string; value: number; threshold: number }[]
  unknown: string[]
}

const conditions = signal<Record<string, Condition>>({})
const values = signal<Record<string, string>>({}) // of signals
const silent = signal<Record<string, boolean>>({}) // topics
const taken = signal<State | null>(null) // the robot as it was when one began to imagine

const isSignal = (input: string) => !input.includes('(')

// As it was when one began to imagine.
function usualCondition(place: number): Condition {
  const component = taken.value?.components[place]
  if (component?.process === 'stopped') return 'stopped'
  if (component?.process === 'hung') return 'hung'
  if (component?.process === 'gone' || component?.alive === false) return 'killed'
  return component?.lifecycle === 'inactive' ? 'inactive' : 'well'
}

function isUsuallySilent(place: number): boolean {
  const topic = taken.value?.topics[place]
  return !!topic && topic.rate !== null && topic.age !== null && topic.age > kSilentPeriods / topic.rate
}
const kSilentPeriods = 3

function usualValue(place: number): string {
  const value = taken.value?.inputs[place]
  return value === null || value === undefined ? '' : String(value)
}

// The state in the language of rule tests (docs/plan.md).
function stateText(): string {
  const componentOf = new Map(graph.value.nodes.map((n) => [n.node, n.component]))
  const lines = (robot.value?.components ?? []).map(({ name }, place) => {
    const needs = new Set<string>()
    const tells = new Set<string>()
    for (const [consumer, producer, channel] of graph.value.edges) {
      const from = componentOf.get(producer)
      if (componentOf.get(consumer) === name && from && from !== name && producerWorks(from))
        needs.add(from)
      if (from === name && robot.value!.topics.includes(channel)) tells.add(channel)
    }
    const clause = (word: string, names: Set<string>) =>
      names.size > 0 ? ` ${word} ${[...names].join(' ')}` : ''
    const condition = kConditions[conditions.value[name] ?? usualCondition(place)]
    return `COMPONENT ${name}${clause('NEEDS', needs)}${clause('PUBLISHES', tells)} ${condition}`
  })
  robot.value?.topics.forEach((topic, place) => {
    const rate = taken.value?.topics[place]?.rate ?? 10
    lines.push(`TOPIC ${topic} ${silent.value[topic] ?? isUsuallySilent(place) ? 'silent' : `${rate}Hz`}`)
  })
  robot.value?.inputs.forEach((input, place) => {
    const value = values.value[input] ?? usualValue(place)
    if (isSignal(input) && value !== '') lines.push(`SIGNAL ${input} ${value}`)
  })
  return lines.join('\n') + '\n'
}

// A subscriber of an idle component does not wait for it. A subscriber of a crashed one does.
function producerWorks(name: string): boolean {
  const place = robot.value!.components.findIndex((c) => c.name === name)
  return usualCondition(place) !== 'inactive'
}

function usePlan(): { plan: Plan | null; trouble: string } {
  const [plan, setPlan] = useState<Plan | null>(null)
  const [trouble, setTrouble] = useState('')
  const [rules, setRules] = useState<string | null>(null)
  useEffect(() => {
    call<{ text: string }>('GET', '/api/rules').then((f) => setRules(f.text), (e) => setTrouble(e.message))
  }, [])
  const text = taken.value ? stateText() : ''
  useEffect(() => {
    if (rules === null || text === '') return
    let isOld = false
    call<Plan>('POST', '/api/what-if', { rules, state: text }).then(
      (p) => {
        if (isOld) return
        setPlan(p)
        setTrouble('')
      },
      (e: Refusal) => {
        if (!isOld) setTrouble(e.message)
      }
    )
    return () => {
      isOld = true
    }
  }, [rules, text])
  return { plan, trouble }
}

function PlanView({ plan }: { plan: Plan }) {
  if (plan.failures.length === 0)
    return (
      <>
        <p class="headline well">
          <b>✓ Nothing would fail.</b>
        </p>
        {plan.near.map((n) => (
          <p class="muted">
            Near: {n.rule}, {n.input} is {n.value.toPrecision(3)}, compared with {n.threshold}
          </p>
        ))}
      </>
    )
  return (
    <>
      {plan.failures.map((f) => (
        <article class={`failure ${f.criticality}`}>
          <h3>{f.rule}</h3>
          <p>{f.text}.</p>
          <table class="candidates">
            <thead>
              <tr>
                <th scope="col">strategy</th>
                <th scope="col">helps in</th>
                <th scope="col" title={kCostUnit}>
                  relative cost
                </th>
                <th scope="col">why, or why not</th>
              </tr>
            </thead>
            <tbody>
              {f.candidates.map((c) => (
                <tr class={c.chosen ? 'chosen' : ''}>
                  <th scope="row">{c.strategy}</th>
                  <td class="number">{(100 * c.success).toFixed(0)} %</td>
                  <td class="number">{costOf(c)}</td>
                  <td>
                    {c.excluded ? c.excluded.text : <b>chosen</b>}
                    {c.flips.length > 0 && (
                      <span class="muted">. It would be chosen if {c.flips.map((x) => x.text).join(', or ')}.</span>
                    )}
                  </td>
                </tr>
              ))}
            </tbody>
          </table>
        </article>
      ))}
    </>
  )
}

export function SimulatorPage() {
  if (!taken.value && state.value) taken.value = state.value
  const { plan, trouble } = usePlan()
  return (
    <main class="simulator">
      <h2>What would culprit do if …?</h2>
      <div class="columns">
        <form aria-label="The imagined robot" onSubmit={(e) => e.preventDefault()}>
          <p class="muted">Describe a robot. The plan is for it; the real robot is not touched.</p>
          <h3>Components</h3>
          {(robot.value?.components ?? []).map(({ name }, place) => (
            <label class="field">
              <span>{name}</span>
              <select
                value={conditions.value[name] ?? usualCondition(place)}
                onChange={(e) =>
                  (conditions.value = { ...conditions.value, [name]: e.currentTarget.value as Condition })
                }
              >
                {Object.keys(kConditions).map((c) => (
                  <option>{c}</option>
                ))}
              </select>
            </label>
          ))}
          <h3>Topics</h3>
          {(robot.value?.topics ?? []).map((topic, place) => (
            <label>
              <input
                type="checkbox"
                checked={silent.value[topic] ?? isUsuallySilent(place)}
                onChange={(e) => (silent.value = { ...silent.value, [topic]: e.currentTarget.checked })}
              />{' '}
              {topic} is silent
            </label>
          ))}
          {(robot.value?.inputs ?? []).some(isSignal) && <h3>Signals</h3>}
          {(robot.value?.inputs ?? []).map(
            (input, place) =>
              isSignal(input) && (
                <label class="field">
                  <span>{input}</span>
                  <input
                    value={values.value[input] ?? usualValue(place)}
                    onChange={(e) => (values.value = { ...values.value, [input]: e.currentTarget.value })}
                  />
                </label>
              )
          )}
          <button
            type="button"
            onClick={() => {
              taken.value = state.peek()
              conditions.value = {}
              values.value = {}
              silent.value = {}
            }}
          >
            As the robot is now
          </button>
        </form>
        <section aria-label="Plan" aria-live="polite">
          {trouble && <pre class="sick unreadable">{trouble}</pre>}
          {plan && <PlanView plan={plan} />}
        </section>
      </div>
    </main>
  )
}
