// One run of a campaign, played again: on the timeline of the robot that runs, with what was thought at
// each moment.
import { computed, signal } from '@preact/signals'
import { useState } from 'preact/hooks'
import { call, hasToken } from './api'
import { Explanation } from './explain'
import { act } from './notices'
import { viewOf } from './history'
import { can } from './store'
import { rowName, type StudyResult } from './study_table'
import { EventLog, Timeline } from './timeline'
import type { ManagerEvent } from './types'

interface PlayedRun {
  title: string
  scenario: string
  is_told: boolean
  end: number
  events: ManagerEvent[]
}

const played = signal<PlayedRun | null>(null)
const view = viewOf(
  computed(() => played.value?.events ?? []),
  computed(() => played.value?.end ?? 0),
  { isOver: true }
)

export function showRun(run: PlayedRun | null): void {
  if (run) run.events.forEach((event, place) => (event.number = place))
  played.value = run
  view.moment.value = null
}

// Why runs of this result cannot be played again; nothing if they can.
function obstacle({ study, campaign }: StudyResult): string | null {
  if (!study || !campaign) return 'this result does not say which campaign it is of'
  const seeds = [campaign.seed, campaign.scenario?.seed ?? 0]
  if (!seeds.every(Number.isSafeInteger)) return 'its seed is a larger number than browsers know exactly'
  return null
}

export function SingleRun({ result }: { result: StudyResult }) {
  const [row, chooseRow] = useState(0)
  const [run, chooseRun] = useState(0)
  if (!can('post', '/api/studies/run')) return null
  const why = obstacle(result)
  if (why) return <p class="muted">Single runs cannot be shown: {why}.</p>
  const runs = result.campaign!.runs ?? result.campaign!.episodes ?? 1
  const scenarios = (result.scenarios ?? []).slice(0, runs)
  const play = async () => {
    const body = { study: result.study, campaign: result.campaign, row, run }
    const answer = await call<Omit<PlayedRun, 'title'>>('POST', '/api/studies/run', body)
    showRun({ ...answer, title: `${rowName(result.rows[row])}: run ${run}` })
  }
  return (
    <section aria-label="Single run" class="single-run">
      <h2>A single run</h2>
      <p class="muted">
        Played again from the campaign’s seed. The result was made by culprit {result.campaign!.version || 'of no version'};
        another version may play another run.
      </p>
      <form
        class="row"
        onSubmit={(e) => {
          e.preventDefault()
          void act(`Playing run ${run}`, play)
        }}
      >
        <label class="field wider">
          <span>manager</span>
          <select value={String(row)} onChange={(e) => chooseRow(Number(e.currentTarget.value))}>
            {result.rows.map((each, place) => (
              <option value={String(place)}>{rowName(each)}</option>
            ))}
          </select>
        </label>
        {scenarios.length > 0 && (
          <label class="field wider">
            <span>scenario</span>
            <select
              value={String(run % result.scenarios!.length)}
              onChange={(e) => chooseRun(Number(e.currentTarget.value))}
            >
              {scenarios.map((scenario, place) => (
                <option value={String(place)}>{scenario}</option>
              ))}
            </select>
          </label>
        )}
        <label class="field short">
          <span>run, from 0</span>
          <input
            type="number"
            min="0"
            max={runs - 1}
            required
            value={String(run)}
            onInput={(e) => chooseRun(Number(e.currentTarget.value))}
          />
        </label>
        <button type="submit" disabled={!hasToken}>
          Play it again
        </button>
      </form>
      <Played />
    </section>
  )
}

function Played() {
  const run = played.value
  if (!run) return null
  return (
    <>
      <h3>
        {run.title}
        {run.scenario && <small>, {run.scenario.replace(/[_]/g, ' ').replace(/[+]/g, ' and ')}</small>}
      </h3>
      <Timeline view={view} />
      <div class="columns">
        {run.is_told ? (
          <Explanation view={view} />
        ) : (
          <p class="muted">This manager reports no events; these are the robot's.</p>
        )}
        <EventLog view={view} />
      </div>
    </>
  )
}
