// The decisions that the rules in the editor would have made recently: a replay of the journal, before they are saved.
import { computed, signal } from '@preact/signals'
import { call, hasToken } from './api'
import { lasting, when } from './clock'
import { viewOf } from './history'
import type { RuleDocument } from './rule_document'
import { can } from './store'
import { Timeline } from './timeline'
import type { Criticality, ManagerEvent } from './types'

interface Said {
  clock: number // seconds since 1970
  what: 'detected' | 'gone' | 'chosen'
  rule: string
  strategy?: string
}
interface Answer {
  since: number
  until: number
  missing: string[] // what was not recorded: "topic /scan"
  recorded: Said[] // by the rules that ran
  other: Said[] // by these
}

const kTimes: [number, string][] = [
  [600, '10 minutes'],
  [3600, 'hour'],
  [86_400, 'day'],
]
const seconds = signal(3600)
const found = signal<{ answer: Answer; text: string; criticality: Map<string, Criticality> } | null>(null)
const isLooking = signal(false)
const trouble = signal('')
const text = signal('') // as it is in the editor
export const hindsightFollows = (now: string) => void (text.value = now)

const isOfThisText = computed(() => found.value?.text === text.value)

async function look(document: RuleDocument): Promise<void> {
  const asked = text.value
  isLooking.value = true
  trouble.value = ''
  try {
    const answer = await call<Answer>('POST', '/api/rules/replay', { text: asked, seconds: seconds.value })
    const criticality = new Map<string, Criticality>()
    let rule = ''
    for (const s of document.statements) {
      if (s.statement === 'RULE') rule = String(s.name)
      if (s.statement === 'POLICIES') criticality.set(rule, s.criticality as Criticality)
    }
    found.value = { answer, text: asked, criticality }
  } catch (error) {
    trouble.value = (error as Error).message.replace(/^culprit: /, '').trim()
  }
  isLooking.value = false
}

const kTypes = { detected: 'failure_detected', gone: 'failure_resolved', chosen: 'strategy_chosen' }
const events = computed((): ManagerEvent[] =>
  (found.value?.answer.other ?? []).map(({ clock, what, rule, strategy }, number) => ({
    number, t: clock, clock, type: kTypes[what], label: '', severity: 'info', tone: '', rule, strategy, dry_run: true,
    text: strategy ? `${strategy} would start` : '', criticality: found.value!.criticality.get(rule) ?? 'WARNING',
  }))
)
const view = viewOf(events, computed(() => found.value?.answer.until ?? 1), {
  isOver: true,
  clockOf: (t) => t,
  oldest: () => found.value?.answer.since ?? 0,
})

// How often a rule would have failed, for how long, and what would have been begun.
interface Summary {
  times: number
  seconds: number
  begun: Map<string, number>
}
function summaryOf(said: Said[], rule: string, until: number): Summary {
  const summary: Summary = { times: 0, seconds: 0, begun: new Map() }
  let from: number | null = null
  for (const each of said) {
    if (each.rule !== rule) continue
    if (each.what === 'chosen') summary.begun.set(each.strategy!, (summary.begun.get(each.strategy!) ?? 0) + 1)
    if (each.what === 'detected') {
      ++summary.times
      from = each.clock
    }
    if (each.what === 'gone' && from !== null) {
      summary.seconds += each.clock - from
      from = null
    }
  }
  if (from !== null) summary.seconds += until - from
  return summary
}
const inWords = ({ times, seconds: long, begun }: Summary): string => {
  if (times === 0) return 'no failure'
  const strategies = [...begun].map(([name, count]) => `${name} ${count} ×`).join(', ')
  return `${times === 1 ? 'one failure' : `${times} failures`}, ${lasting(long)} in all${strategies && `; ${strategies}`}`
}

// Beside the rule that one writes.
export function HindsightOfRule({ name }: { name: string }) {
  if (!found.value) return null
  const { answer } = found.value
  const summary = summaryOf(answer.other, name, answer.until)
  return (
    <p class={isOfThisText.value ? 'hindsight' : 'hindsight muted'}>
      In the {lasting(answer.until - answer.since)} before {when(answer.until)} it would have seen {inWords(summary)}.
      {!isOfThisText.value && ' That was before your last change.'}
    </p>
  )
}

function Result() {
  const { answer } = found.value!
  const rules = [...new Set([...answer.other, ...answer.recorded].map((s) => s.rule))]
  return (
    <>
      {answer.missing.length > 0 && (
        <p class="sick" role="alert">
          ▲ Not recorded, because the rules of that time did not read it: {answer.missing.join(', ')}. Conditions on it are unknown here.
        </p>
      )}
      <Timeline view={view} label="Failures and repairs under these rules" />
      {rules.length === 0 && <p>Neither these rules nor the rules of that time saw a failure.</p>}
      {rules.length > 0 && (
        <table>
          <thead>
            <tr>
              <th scope="col">rule</th>
              <th scope="col">these rules</th>
              <th scope="col">the rules of that time</th>
            </tr>
          </thead>
          <tbody>
            {rules.map((rule) => (
              <tr>
                <th scope="row">{rule}</th>
                <td>{inWords(summaryOf(answer.other, rule, answer.until))}</td>
                <td>{inWords(summaryOf(answer.recorded, rule, answer.until))}</td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
      <p class="muted">A replay repairs nothing: each failure lasts as long as it did. Strategies are those that would have started.</p>
    </>
  )
}

export function Hindsight({ document, hasErrors }: { document: RuleDocument; hasErrors: boolean }) {
  if (!can('post', '/api/rules/replay')) return null
  return (
    <details class="rule" open={found.value !== null || trouble.value !== ''}>
      <summary>What would these rules have done?</summary>
      <div class="bar">
        <button type="button" disabled={!hasToken || hasErrors || isLooking.value} onClick={() => void look(document)}>
          {isLooking.value ? 'Looking back …' : 'Look back'}
        </button>
        <label>
          at the last{' '}
          <select value={String(seconds.value)} onChange={(e) => (seconds.value = Number(e.currentTarget.value))}>
            {kTimes.map(([time, name]) => (
              <option value={String(time)}>{name}</option>
            ))}
          </select>
        </label>
        {found.value && !isOfThisText.value && <span class="muted">The result below is older than your last change.</span>}
      </div>
      {trouble.value && (
        <p class="sick" role="alert">
          ◆ {trouble.value}
        </p>
      )}
      {found.value && <Result />}
    </details>
  )
}
