// How the robot is and what culprit does about it, in the words of the status bar: the same on every page, in the
// title of the window and in its icon.
import { computed } from '@preact/signals'
import { lastingSoFar, when } from './clock'
import { freshness, nowByTheClock } from './freshness'
import { headlineOf, type Incident, listed } from './incidents'
import { blindRules, can, clockAt, control, isNothingWatched, present, presentlyKnown, robot, state } from './store'

export type Tone = 'OK' | 'NON_CRITICAL' | 'WARNING' | 'ERROR' | 'EXHAUSTED' | 'unknown' | 'lost'
export interface Mode {
  name: 'paused' | 'deaf' | 'dry-run' | 'approval' | 'silenced' | 'acting' | 'none' | 'bygone'
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

export const kSigns: Record<Tone, string> = {
  ERROR: '◆',
  WARNING: '▲',
  NON_CRITICAL: '○',
  EXHAUSTED: '✖',
  OK: '✓',
  unknown: '…',
  lost: '⚠',
}
const kHealthWords: Record<string, string> = {
  ERROR: 'Error',
  WARNING: 'Warning',
  NON_CRITICAL: 'Minor',
  EXHAUSTED: 'Gave up',
}

// The modes that keep culprit from acting as usual.
export const modes = computed((): Mode[] => {
  const now = control.value
  if (!now) return [{ name: 'none', word: '', explanation: '' }]
  const list: Mode[] = []
  const add = (name: Mode['name'], word: string, explanation: string) => list.push({ name, word, explanation })
  const asked = listed(now.asked.map((a) => a.strategy))
  const silenced = listed(now.silences.map((s) => s.component ?? s.rule ?? ''))
  if (now.paused) add('paused', 'Ⅱ Paused', 'Nothing is changed on the robot until you resume.')
  if (now.hears === false) add('deaf', '⚠ Deaf', "culprit does not receive the robot's messages: it judges nothing and does nothing.")
  if (asked) add('approval', '? Approval', `Waits for your word: ${asked}.`)
  if (now.dry_run) add('dry-run', '◌ Dry run', 'Culprit only says what it would do.')
  if (silenced) add('silenced', '∅ Silenced', `Left alone: ${silenced}.`)
  if (list.length === 0) add('acting', '● Acting', 'Culprit repairs what fails.')
  return list
})

export const sinceOf = (incident: Incident) => incident.sinceClock ?? clockAt(incident.since)

// The current repair, or the reason why there is none.
export function doingOf(incident: Incident): string {
  const { root } = incident
  if (root.phase === 'exhausted') return 'nothing helped: a person must look'
  if (control.value?.paused) return 'paused: nothing is done'
  if (control.value?.asked.some((a) => a.rule === root.rule)) return 'waits for your approval'
  const actions = listed(root.blame?.actions ?? []) || root.blame?.strategy
  if (root.blame?.type === 'strategy_chosen' && root.phase === 'attempting') return `being repaired: ${actions}`
  if (root.blame?.dry_run) return `would be repaired: ${actions}`
  if (root.heldBack) return `not repaired: ${root.heldBack}`
  return 'nothing is done yet'
}

type Told = Omit<Status, 'modes'>
const told = (tone: Tone, sign: string, word: string, headline: string, detail: string): Told => ({ tone, sign, word, headline, detail })

function ofIncidents(incidents: Incident[]): Told {
  const worst = incidents[0]
  const since = sinceOf(worst)
  const others = incidents.slice(1)
  const more = others.length > 0 ? `; also ${listed(others.map((i) => headlineOf(i, presentlyKnown)))}` : ''
  const suffering = worst.consequences.length > 0 ? ` → ${listed(worst.consequences.map((f) => f.rule))}` : ''
  return {
    tone: worst.health as Tone,
    sign: kSigns[worst.health as Tone],
    word: kHealthWords[worst.health],
    headline: headlineOf(worst, presentlyKnown) + suffering,
    detail: `since ${when(since)} (${lastingSoFar(nowByTheClock() - since)}), ${doingOf(worst)}${more}`,
  }
}

function ofRobot(): Told {
  if (!state.value)
    return told('unknown', kSigns.unknown, 'Asking', 'Nothing is known yet', 'culprit has not sent the robot\'s state so far')
  const { incidents } = present.value
  if (incidents.length > 0) return ofIncidents(incidents)
  const count = robot.value?.rules.length ?? 0
  const detail = `no failure is seen by ${count} ${count === 1 ? 'rule' : 'rules'}`
  if (control.value?.hears === false)
    return told('unknown', '?', 'Unknown', "culprit does not receive the robot's messages", 'nothing is judged until it does')
  const blind = blindRules.value
  if (isNothingWatched.value)
    return told('unknown', '?', 'Unknown', 'Watching nothing', blind.length > 0 ? `no rule can see: ${blind[0].text}` : 'there is no rule')
  if (blind.length > 0) {
    const isGrave = blind[0].criticality === 'ERROR'
    const more = blind.length > 1 ? ` (and ${blind.length - 1} more)` : ''
    return told(
      isGrave ? 'WARNING' : 'NON_CRITICAL',
      isGrave ? kSigns.WARNING : kSigns.NON_CRITICAL,
      'Blind',
      `${blind[0].name} is blind${more}`,
      `no failure is seen, but ${blind[0].text}`
    )
  }
  return told('OK', kSigns.OK, 'Well', 'All is well', detail)
}

export const status = computed((): Status => {
  const fresh = freshness.value
  if (fresh.kind === 'lost' || fresh.kind === 'stuck') {
    const was = can('get', '/api/stream') && state.value ? ` It was: ${ofRobot().headline}.` : ''
    const why = fresh.kind === 'lost' ? 'Disconnected' : 'Nothing new from culprit'
    const wasMode = (m: Mode): Mode => ({ ...m, name: 'bygone', word: `was: ${m.word.replace(/^\S /, '')}` })
    return {
      ...told('lost', kSigns.lost, 'Old', `${why} since ${when(fresh.since)}`, `This view is outdated.${was}`),
      modes: modes.value.filter((m) => m.word).map(wasMode),
    }
  }
  if (!can('get', '/api/stream'))
    return { ...told('unknown', '–', 'No robot', 'No robot is watched here', 'rules and studies only'), modes: [] }
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
