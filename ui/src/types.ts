// The documents of the API (docs/web.md).
import type { Incident } from './incidents'
import type { Look } from './looks'

export type Criticality = 'NON_CRITICAL' | 'WARNING' | 'ERROR'
export type Health = 'OK' | Criticality | 'EXHAUSTED'

export interface Strategy {
  name: string
  impact: number
  components: string[]
  prior: [number, number]
  actions: string[]
}
export interface Rule {
  name: string
  criticality: Criticality
  attempts: number
  components: string[]
  inputs: number[]
  strategies: Strategy[]
}
export interface ComponentFacts {
  name: string
  can_start: boolean
  node?: string
  owner?: string // who starts and ends it
  host?: string
  container?: string
  required?: boolean
}
export interface Robot {
  robot: string
  cycle_s: number
  components: ComponentFacts[]
  topics: string[]
  inputs: string[]
  thresholds?: number[][] // of each input: the constants that rules compare it with
  rules: Rule[]
}

export interface Graph {
  nodes: { node: string; present: boolean; component?: string; host?: string }[]
  edges: [consumer: string, producer: string, channel: string][]
}

export interface RuleState {
  phase: 'quiet' | 'failing' | 'attempting' | 'exhausted'
  trigger?: boolean | null
  blind?: { since: number; why: string; text: string; input?: string; near?: string } // its trigger has no value
  since?: number
  attempts?: number
  retry_at?: number
  settling?: { with: string; until: number }
  attempt?: { strategy: string; stage: string; chosen: number; deadline: number | null }
}
export interface ComponentState {
  health: Health
  look: Look
  condition: string // in a word or two; empty: it works
  present: boolean
  alive: boolean | null
  process?: 'running' | 'stopped' | 'hung' | 'gone'
  pid?: number
  lifecycle?: string
  remark?: string
  host?: string // another host, where its node runs or ran last
  unheard?: boolean // its host is unreachable: nobody knows what became of it
  adapting?: string
}
export interface TopicState {
  rate: number | null // Hz
  age: number | null // s
}
export interface State {
  t: number
  clock: number // on the wall, seconds since 1970
  overview: { look: Look; headline: string; detail: string } // as culprit status says it
  incidents: Incident[] // in the order of all views
  rules: RuleState[]
  components: ComponentState[]
  topics: TopicState[]
  inputs: (number | string | boolean | null)[]
  beliefs: [number, number][]
  priors: [number, number][] // that they began from: what the rules say, or a fleet learned
}

export interface ControlState {
  paused: boolean
  dry_run: boolean
  hears: boolean // the robot
  held_back?: string | null // why nothing at all is begun now
  silences: { component?: string; rule?: string; until: number | null; author: string; reason: string }[]
  asked: { rule: string; strategy: string }[]
}

export interface Candidate {
  strategy: string
  impact: number
  cost: number
  value: number
  resolves: number
  excluded: { condition: string; text: string; component?: string; failure?: string; ends?: string } | null
}
export interface Suspect {
  component: string
  failure: string
  probability: number
  evidence?: Evidence[]
}
export interface Evidence {
  source: string
  text: string
  age_ns?: number
  log_odds: number // below 0 it speaks against the suspect
  without?: string // the component that would be held responsible without it; none: the same one
}
export interface ManagerEvent {
  number: number // of this page's counting
  t: number
  clock?: number // on the wall, seconds since 1970; runs that are played have none
  type: string // the name that the journal has for it, too
  label: string // for people
  severity: 'info' | 'warning' | 'error'
  tone: string // the colour of the label
  text: string
  rule?: string
  strategy?: string | null
  component?: string
  components?: string[]
  criticality?: Criticality
  explains?: string[]
  actions?: string[]
  dry_run?: boolean
  candidates?: Candidate[]
  suspects?: Suspect[]
  retry_at?: number | null
  reaction_s?: number
  reason?: string
  remark?: string
  link?: string // to what it stands for
  incident?: string // the id; these events have no text
  headline?: string
  consequences?: string[]
  certain?: boolean
  exhausted?: boolean
  needs_person?: boolean
  host?: string
  age_ns?: number
}
