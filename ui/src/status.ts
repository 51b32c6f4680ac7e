// How the robot is and what culprit does about it, in the words of the status bar: the same on every page, in the
// title of the window and in its icon.
import { computed } from '@preact/signals'
import { lastingSoFar, when } from './clock'
import { freshness, nowByTheClock, refusal } from './freshness'
import { type Incident, listed } from './incidents'
import { kLooks, type Tone } from './looks'
import { can, clockAt, control, robot, state } from './store'

export interface Mode {
  name: 'paused' | 'deaf' | 'held' | 'dry-run' | 'approval' | 'muted' | 'acting' | 'none' | 'bygone'
  word: string
  explanation: string
}
export interface Status {
  tone: Tone
  sign: string
  word: string // of a few letters
  headline: string
  detail: string
  modes: Mode[] // the one that matters most first
}

// The modes that keep culprit from acting as usual.
export const modes = computed((): Mode[] => {
  const now = control.value
  if (!now) return [{ name: 'none', word: '', explanation: '' }]
  const list: Mode[] = []
  const add = (name: Mode['name'], word: string, explanation: string) => list.push({ name, word, explanation })
  const asked = listed(now.asked.map((a) => a.strategy))
  const muted = listed(now.silences.map((s) => s.component ?? s.rule ?? ''))
  if (now.paused) add('paused', 'Ⅱ Paused', 'Nothing is changed on the robot until you resume.')
  if (now.hears === false) add('deaf', '⚠ Deaf', "culprit does not receive the robot's messages: it judges nothing and does nothing.")
  if (asked) add('approval', '? Approval', `Waits for your approval: ${asked}.`)
  if (now.dry_run) add('dry-run', '◌ Dry run', 'culprit only reports what it would do.')
  if (now.held_back && !now.paused) add('held', 'Ⅱ Held back', `No strategy starts: ${now.held_back}.`)
  if (muted) add('muted', '∅ Muted', `No strategy starts for ${muted}.`)
  if (list.length === 0) add('acting', '● Acting', 'culprit repairs failures.')
  return list
})

export const sinceOf = (incident: Incident) => clockAt(incident.since)

type Told = Omit<Status, 'modes'>
const told = (tone: Tone, sign: string, word: string, headline: string, detail: string): Told => ({ tone, sign, word, headline, detail })

// A sentence begins with a capital letter; a component keeps its name.
export function capital(text: string): string {
  const first = text.split(/[ ,]/, 1)[0]
  return robot.value?.components.some(({ name }) => name === first) ? text : text.charAt(0).toUpperCase() + text.slice(1)
}

// culprit decides how the robot is; here it is only put into words with a clock.
function ofRobot(): Told {
  if (!state.value) {
    const { sign, word, tone } = kLooks.UNTOLD
    return told(tone, sign, word, 'Asking culprit how the robot is', 'no data yet')
  }
  const { look, headline, detail } = state.value.overview
  const { sign, word, tone } = kLooks[look]
  const [first, ...others] = state.value.incidents
  if (!first) return told(tone, sign, word, capital(headline), detail)
  const since = sinceOf(first)
  const suffering = first.consequences.length > 0 ? ` → ${listed(first.consequences)}` : ''
  const more = others.length > 0 ? `; also ${listed(others.map((i) => i.headline))}` : ''
  return told(tone, sign, word, headline + suffering, `since ${when(since)} (${lastingSoFar(nowByTheClock() - since)}), ${first.doing}${more}`)
}

export const status = computed((): Status => {
  const fresh = freshness.value
  if (fresh.kind === 'lost' || fresh.kind === 'stuck') {
    const was = can('get', '/api/stream') && state.value ? ` It was: ${ofRobot().headline}.` : ''
    const why = fresh.kind === 'lost' ? 'Disconnected' : 'Nothing new from culprit'
    const wasMode = (m: Mode): Mode => ({ ...m, name: 'bygone', word: `was: ${m.word.replace(/^\S /, '')}` })
    return {
      ...told('lost', '⚠', 'Old', `${why} since ${when(fresh.since)}`, refusal.value ? `${capital(refusal.value)}.` : `This view is outdated.${was}`),
      modes: modes.value.filter((m) => m.word).map(wasMode),
    }
  }
  if (!can('get', '/api/stream'))
    return { ...told('unknown', '–', 'No robot', 'No robot here', 'this culprit edits rules and runs studies'), modes: [] }
  return { ...ofRobot(), modes: modes.value }
})

// The title says the worst first: of a tab one sees two or three words.
export const title = computed(() => {
  const { sign, headline, tone, modes: all } = status.value
  const mode = all[0] && !['acting', 'none', 'bygone'].includes(all[0].name) ? `${all[0].word} · ` : ''
  const name = robot.value?.robot ? `${robot.value.robot} · culprit` : 'culprit'
  if (tone === 'unknown' && !can('get', '/api/stream')) return 'culprit'
  return `${tone === 'lost' ? '' : mode}${sign} ${headline} · ${name}`
})
