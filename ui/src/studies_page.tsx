// Campaigns over the exemplars: start one, see how far it is and what it found; or open a result.
import { signal } from '@preact/signals'
import { useEffect, useState } from 'preact/hooks'
import { call, hasToken, Refusal, textOf } from './api'
import { download } from './download'
import { act, tell } from './notices'
import { showRun, SingleRun } from './single_run'
import { type StudyResult, type StudyTable, studyTable } from './study_table'

interface Campaign {
  study: string | null
  runs: number
  seed: number
  state: 'running' | 'done' | 'failed' | 'stopped'
  seconds: number
  done?: [number, number]
  trouble?: string
  has_report: boolean
}

const kStudies: Record<string, { title: string; runs: number; unit: string }> = {
  sunset: { title: 'SUNSET: the paper’s evaluation on a drone’s segmentation', runs: 18, unit: 'runs of each configuration' },
  suave: { title: 'SUAVE: an underwater robot that looks for a pipeline', runs: 20, unit: 'runs of each manager' },
  rca: { title: 'Root causes: random robots with several faults at once', runs: 20, unit: 'episodes' },
}
const kPeriod = 1000 // ms, between two looks

const campaign = signal<Campaign | null>(null)
const opened = signal<{ title: string; result: StudyResult; table: StudyTable } | null>(null)

function open(title: string, result: unknown): void {
  opened.value = { title, result: result as StudyResult, table: studyTable(result) }
  showRun(null)
}

async function look(): Promise<void> {
  const before = campaign.value?.state
  const now = await call<Campaign>('GET', '/api/studies')
  campaign.value = now.study === null ? null : now
  const hasEnded = now.state === 'done' && (before === 'running' || !opened.value)
  if (!hasEnded) return
  const result = await call<unknown>('GET', '/api/studies/result')
  open(`${now.study}, ${now.runs} ${kStudies[now.study!].unit}, seed ${now.seed}`, result)
}

function Start() {
  const [study, choose] = useState('sunset')
  const [runs, setRuns] = useState(String(kStudies.sunset.runs))
  const [seed, setSeed] = useState('1')
  const isRunning = campaign.value?.state === 'running'
  return (
    <form
      class="row"
      onSubmit={(e) => {
        e.preventDefault()
        const body = { study, runs: Number(runs), seed: Number(seed) }
        void act(`Starting ${study}`, () => call('POST', '/api/studies', body)).then(() => look())
      }}
    >
      <label class="field wider">
        <span>campaign</span>
        <select
          value={study}
          onChange={(e) => {
            choose(e.currentTarget.value)
            setRuns(String(kStudies[e.currentTarget.value].runs))
          }}
        >
          {Object.entries(kStudies).map(([name, { title }]) => (
            <option value={name}>{title}</option>
          ))}
        </select>
      </label>
      <label class="field">
        <span>{kStudies[study].unit}</span>
        <input type="number" min="1" max="100000" required value={runs} onInput={(e) => setRuns(e.currentTarget.value)} />
      </label>
      <label class="field short">
        <span>seed</span>
        <input type="number" min="0" required value={seed} onInput={(e) => setSeed(e.currentTarget.value)} />
      </label>
      <button type="submit" class="primary" disabled={!hasToken || isRunning}>
        Start
      </button>
    </form>
  )
}

const kWords = { running: 'is running', done: '✓ is done', failed: '◆ failed', stopped: 'was stopped' }

// A link cannot send the token, which an address that others can reach asks for.
const save = async (study: string) =>
  download(`${study}.html`, await textOf('/api/studies/report'), 'text/html')

function Progress() {
  const now = campaign.value
  if (!now) return null
  return (
    <section aria-label="Progress" class="progress">
      <p role="status">
        <b>{now.study}</b> {kWords[now.state]}, {now.seconds.toFixed(0)} s
        {now.done && `, ${now.done[0].toLocaleString('en')} of ${now.done[1].toLocaleString('en')} simulated runs`}
      </p>
      {now.state === 'running' && (
        <div class="bar">
          <progress max={now.done?.[1]} value={now.done?.[0]} aria-label={`How far ${now.study} is`} />
          <button
            type="button"
            disabled={!hasToken}
            onClick={() => void act(`Stopping ${now.study}`, () => call('DELETE', '/api/studies')).then(() => look())}
          >
            Stop
          </button>
        </div>
      )}
      {now.trouble && <pre class="sick">{now.trouble}</pre>}
      {now.has_report && (
        <p>
          <a href="/api/studies/report" target="_blank" rel="noopener">
            Open the report
          </a>
          , with plots and timelines, or{' '}
          <button type="button" onClick={() => void act('Saving the report', () => save(now.study!))}>
            Save it …
          </button>
        </p>
      )}
    </section>
  )
}

function Open() {
  const read = async (file: File | undefined) => {
    if (!file) return
    try {
      open(file.name, JSON.parse(await file.text()))
      tell({ text: `Opening ${file.name}: done` })
    } catch (error) {
      tell({ text: `Opening ${file.name}: ${(error as Error).message}`, isTrouble: true })
    }
  }
  return (
    <label class="field">
      <span>or open a result (culprit study … --json)</span>
      <input type="file" accept=".json,application/json" onChange={(e) => void read(e.currentTarget.files?.[0])} />
    </label>
  )
}

// For a reader who has never seen a result.
function First() {
  if (opened.value || campaign.value) return null
  const start = () =>
    act('Starting sunset', () => call('POST', '/api/studies', { study: 'sunset', runs: 1, seed: 1 })).then(() => look())
  return (
    <section class="banner" aria-label="To begin with">
      <p>
        A campaign breaks a simulated robot again and again, lets several managers repair it, and compares them: how often they
        hit the right component, and how long the robot is down. The smallest one takes a minute.
      </p>
      <p>
        <button type="button" class="primary" disabled={!hasToken} onClick={() => void start()}>
          See a first one: SUNSET, each configuration once (thousands of short simulated runs, about a minute)
        </button>
      </p>
    </section>
  )
}

function Findings() {
  if (!opened.value) return null
  const { columns, rows } = opened.value.table
  return (
    <section aria-label="Findings">
      <h2>{opened.value.title}</h2>
      <p class="muted">mean ± standard deviation</p>
      <div class="scrolls" tabIndex={0} role="group" aria-label="Table of findings">
        <table>
          <thead>
            <tr>
              {columns.map((c) => (
                <th scope="col">{c}</th>
              ))}
            </tr>
          </thead>
          <tbody>
            {rows.map((row) => (
              <tr>
                {columns.map((c) => (
                  <td class="number">{row[c] ?? ''}</td>
                ))}
              </tr>
            ))}
          </tbody>
        </table>
      </div>
    </section>
  )
}

export function StudiesPage() {
  useEffect(() => {
    const once = () => look().catch((error: Refusal) => tell({ text: error.message, isTrouble: true }))
    void once()
    const timer = setInterval(() => {
      if (campaign.value?.state === 'running') void once()
    }, kPeriod)
    return () => clearInterval(timer)
  }, [])
  return (
    <main class="studies">
      <h2>Campaigns over the exemplars</h2>
      <First />
      <Start />
      <Open />
      <Progress />
      <Findings />
      {opened.value && <SingleRun result={opened.value.result} key={opened.value.title} />}
    </main>
  )
}
