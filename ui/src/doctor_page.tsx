// The doctor's findings, without a rule: it looks on request, for the chosen time (docs/doctor.md).
import { computed, signal } from '@preact/signals'
import { useEffect } from 'preact/hooks'
import { call, hasToken } from './api'
import { when } from './clock'
import { download } from './download'
import { nowByTheClock } from './freshness'
import { robot } from './store'

interface Finding {
  code: string
  severity: 'error' | 'warning' | 'note'
  who: string
  seen: string
  matters: string
  remedy: string
}
interface Report {
  domain: number
  nodes: number
  findings: Finding[]
}

const kTimes: [number, string][] = [
  [4, '4 s'],
  [8, '8 s'],
  [30, '30 s'],
  [60, '1 min'],
]
const kSigns: Record<Finding['severity'], string> = { error: '◆', warning: '▲', note: '○' }
const kTones: Record<Finding['severity'], string> = { error: 'ERROR', warning: 'WARNING', note: 'NON_CRITICAL' }
const kTick = 100 // ms

const seconds = signal(8)
const report = signal<(Report & { at: number; raw: unknown }) | null>(null)
const before = signal<Set<string> | null>(null) // what the last report found
const begun = signal(0) // ms; 0: nobody looks now
const now = signal(0)
const trouble = signal('')
const wanted = signal('') // a word to look for
const isLooking = computed(() => begun.value > 0)

const keyOf = (f: Finding) => `${f.code} ${f.who}`

async function look(): Promise<void> {
  begun.value = now.value = Date.now()
  trouble.value = ''
  try {
    const found = await call<Report>('POST', '/api/doctor', { seconds: seconds.value })
    before.value = report.value ? new Set(report.value.findings.map(keyOf)) : null
    report.value = { ...found, at: nowByTheClock(), raw: found }
  } catch (error) {
    trouble.value = (error as Error).message
  }
  begun.value = 0
}

function Progress() {
  useEffect(() => {
    const timer = setInterval(() => (now.value = Date.now()), kTick)
    return () => clearInterval(timer)
  }, [])
  const passed = (now.value - begun.value) / 1000
  return (
    <p class="bar" role="status">
      <progress max={seconds.value} value={passed} aria-label="How far the examination is" />
      culprit examines the robot for {seconds.value} s, and changes nothing.
    </p>
  )
}

function Card({ finding }: { finding: Finding }) {
  const isNew = before.value !== null && !before.value.has(keyOf(finding))
  return (
    <article class={`failure ${kTones[finding.severity] ?? ''}`}>
      <h3>
        <span class={kTones[finding.severity]} aria-hidden="true">
          {kSigns[finding.severity] ?? '○'}
        </span>{' '}
        {finding.who} {isNew && <span class="mode">new</span>}
      </h3>
      <p>
        <b>{finding.seen}.</b>
      </p>
      <p class="muted">{finding.matters}.</p>
      <p>
        → {finding.remedy}. <small class="muted">{finding.severity} {finding.code}</small>
      </p>
    </article>
  )
}

function Findings() {
  const { findings, nodes, domain, at, raw } = report.value!
  const isWanted = (f: Finding) => Object.values(f).some((text) => String(text).toLowerCase().includes(wanted.value.toLowerCase()))
  const shown = findings.filter(isWanted)
  const count = (severity: string) => findings.filter((f) => f.severity === severity).length
  const gone = [...(before.value ?? [])].filter((key) => !findings.some((f) => keyOf(f) === key))
  return (
    <section class="findings" aria-label="Findings">
      <p class={findings.length === 0 ? 'headline well' : 'headline'}>
        <b>
          {findings.length === 0
            ? '✓ No findings. culprit sees nothing wrong from outside.'
            : `${count('error')} ${count('error') === 1 ? 'error' : 'errors'}, ${findings.length - count('error')} less severe.`}
        </b>{' '}
        {nodes} {nodes === 1 ? 'node' : 'nodes'} on domain {domain}, examined at {when(at)}.{' '}
        {gone.length > 0 && `Gone since the last time: ${gone.join(', ')}.`}
      </p>
      {findings.length > 0 && (
        <div class="bar">
          <input type="search" aria-label="Find a finding" placeholder="Find a node, a topic, a code" value={wanted.value} onInput={(e) => (wanted.value = e.currentTarget.value)} />
          <button type="button" onClick={() => download('doctor.json', JSON.stringify(raw, null, 2) + '\n', 'application/json')}>
            Save as JSON …
          </button>
        </div>
      )}
      {shown.map((finding) => (
        <Card key={keyOf(finding) + finding.seen} finding={finding} />
      ))}
      {shown.length === 0 && findings.length > 0 && <p class="muted">No finding contains “{wanted.value}”.</p>}
    </section>
  )
}

export function DoctorPage() {
  return (
    <main class="doctor">
      <h2>Examine {robot.value?.robot || 'the robot'}, without rules</h2>
      <form
        class="bar"
        onSubmit={(e) => {
          e.preventDefault()
          void look()
        }}
      >
        <label>
          look for{' '}
          <select value={String(seconds.value)} onChange={(e) => (seconds.value = Number(e.currentTarget.value))}>
            {kTimes.map(([time, name]) => (
              <option value={String(time)}>{name}</option>
            ))}
          </select>
        </label>
        <button type="submit" class="primary" disabled={!hasToken || isLooking.value}>
          Examine
        </button>
      </form>
      {isLooking.value && <Progress />}
      {trouble.value && (
        <p class="sick" role="alert">
          ◆ {trouble.value}
        </p>
      )}
      {report.value && <Findings />}
      {!report.value && !isLooking.value && (
        <p class="muted">
          Nodes that do not discover each other, and why; several nodes of one name; nodes that hang or have exited; diagnostics that report trouble. It
          joins the robot’s network, looks, and leaves.
        </p>
      )}
    </main>
  )
}
