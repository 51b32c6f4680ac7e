// How the robot and its parts look: each state that culprit tells has one sign, one word and one colour on all pages.
import type { Health } from './types'

export type Look =
  | Health
  | 'MISSING' // a REQUIRED component is not there
  | 'BLIND' // no rule about it has a value
  | 'BLIND_ERROR' // one of the blind rules is an ERROR rule
  | 'WATCHING_NOTHING'
  | 'DEAF'
  | 'DEAD'
  | 'STOPPED'
  | 'HUNG'
  | 'UNREACHABLE'
  | 'NEVER_SEEN'
  | 'TIME_HELD' // its simulated time stands still
  | 'UNWATCHED' // no rule is about it
  | 'UNTOLD' // the page does not know

export type Tone = Health | 'blind' | 'unknown' | 'lost'

interface Appearance {
  sign: string
  word: string // of a few letters
  tone: Tone
}

// The worst first: so components are sorted.
export const kLooks: Record<Look, Appearance> = {
  EXHAUSTED: { sign: '✖', word: 'Exhausted', tone: 'EXHAUSTED' },
  ERROR: { sign: '◆', word: 'Error', tone: 'ERROR' },
  MISSING: { sign: '◇', word: 'Missing', tone: 'ERROR' },
  UNREACHABLE: { sign: '⚠', word: 'Unreachable', tone: 'WARNING' },
  DEAD: { sign: '✕', word: 'Down', tone: 'WARNING' },
  HUNG: { sign: '✕', word: 'Hung', tone: 'WARNING' },
  STOPPED: { sign: '✕', word: 'Stopped', tone: 'WARNING' },
  WARNING: { sign: '▲', word: 'Warning', tone: 'WARNING' },
  DEAF: { sign: '?', word: 'Unknown', tone: 'unknown' },
  WATCHING_NOTHING: { sign: '?', word: 'Unknown', tone: 'blind' },
  BLIND_ERROR: { sign: '◌', word: 'Blind', tone: 'blind' },
  NON_CRITICAL: { sign: '○', word: 'Minor', tone: 'NON_CRITICAL' },
  BLIND: { sign: '◌', word: 'Blind', tone: 'blind' },
  NEVER_SEEN: { sign: '?', word: 'Never seen', tone: 'unknown' },
  TIME_HELD: { sign: '◔', word: 'On hold', tone: 'blind' },
  UNWATCHED: { sign: '–', word: 'No rule', tone: 'unknown' },
  UNTOLD: { sign: '…', word: 'No data', tone: 'unknown' },
  OK: { sign: '✓', word: 'Well', tone: 'OK' },
}
const kRanks = new Map(Object.keys(kLooks).map((look, place) => [look, place]))
export const rankOf = (look: Look): number => kRanks.get(look) ?? 0
// Looks of failures; the others are looks of what no rule can judge.
export const isIll = (look: Look): boolean => rankOf(look) <= rankOf('WARNING') || look === 'NON_CRITICAL'
export const toneOf = (look: Look): Tone => kLooks[look]?.tone ?? 'unknown'
