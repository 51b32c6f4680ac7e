// Failures as people think of them: one cause, and what fails because of it.
import { level, type Failure } from './history'
import type { ComponentState, Health, ManagerEvent } from './types'

export interface Incident {
  root: Failure
  components: string[] // that are held responsible, or are about to be
  host?: string // the computer that is not heard, where they are: it is what is wrong
  isCertain: boolean // the manager blames them, and not only this page
  consequences: Failure[]
  since: number
  sinceClock?: number
  health: Health // of the worst of its failures
}

// The state of a component at the selected moment.
export type Known = (component: string) => { isGone: boolean; state?: ComponentState }

// The failure that `failure` waits for: another one is held to be its cause.
function upstream(failure: Failure, all: Failure[]): Failure | undefined {
  const isThere = (rule: string | undefined) => all.find((f) => f !== failure && f.rule === rule)
  const cause = all.find((f) => f !== failure && f.blame?.explains?.includes(failure.rule))
  if (cause && !isOwn(failure)) return cause
  if (failure.decision?.type !== 'failure_held_back') return undefined
  const named = failure.decision.candidates?.map((c) => isThere(c.excluded?.failure)).find((f) => f)
  return named ?? isThere(failure.decision.suspects?.[0]?.failure)
}

// The manager wants to do something about this very failure.
const isOwn = (failure: Failure) => failure.decision !== undefined && failure.decision === failure.blame

function rootOf(failure: Failure, all: Failure[]): Failure {
  const way = new Set([failure])
  for (let next = upstream(failure, all); next && !way.has(next); next = upstream(next, all)) {
    way.add(next)
    failure = next
  }
  return failure
}

const mostProbable = (decision: ManagerEvent | undefined) => decision?.suspects?.[0]

// The component that the failure waits for, on a computer that is not heard.
const unheardBehind = (failure: Failure) =>
  failure.decision?.type === 'failure_held_back'
    ? failure.decision.candidates?.find((c) => c.excluded?.condition === 'unheard')?.excluded?.component
    : undefined

const hostOf = (component: string, known: Known) => known(component).state?.host

function culpritsOf(root: Failure, components: string[], known: Known): Pick<Incident, 'components' | 'isCertain' | 'host'> {
  const unheard = unheardBehind(root)
  if (unheard) return { components: [unheard], isCertain: true, host: hostOf(unheard, known) ?? 'its computer' }
  if (root.blame?.components?.length) return { components: root.blame.components, isCertain: true }
  const dead = components.filter((c) => known(c).isGone || known(c).state?.alive === false)
  if (dead.length > 0) return { components: dead, isCertain: false }
  const suspect = mostProbable(root.decision)
  return { components: suspect ? [suspect.component] : components, isCertain: false }
}

export const healthOf = (failure: Failure): Health => (failure.phase === 'exhausted' ? 'EXHAUSTED' : failure.criticality)

// Worst first. `componentsOf` gives those that a rule is about.
export function incidentsOf(failures: Failure[], componentsOf: (rule: string) => string[], known: Known): Incident[] {
  const byRoot = new Map<Failure, Failure[]>()
  for (const failure of failures) {
    const root = rootOf(failure, failures)
    byRoot.set(root, [...(byRoot.get(root) ?? []), ...(failure === root ? [] : [failure])])
  }
  // Two rules may point at one component, none of them at the other.
  const byCulprit = new Map<string, Incident>()
  const result: Incident[] = []
  for (const [root, consequences] of byRoot) {
    const blamed = culpritsOf(root, componentsOf(root.rule), known)
    const key = blamed.host ? `host ${blamed.host}` : [...blamed.components].sort().join()
    const same = byCulprit.get(key)
    if (same) {
      if (blamed.host) same.components = [...new Set([...same.components, ...blamed.components])]
      same.consequences.push(root, ...consequences)
      continue
    }
    const incident: Incident = { root, consequences, ...blamed, since: root.since, sinceClock: root.sinceClock, health: 'OK' }
    byCulprit.set(key, incident)
    result.push(incident)
  }
  for (const incident of result) {
    for (const failure of [incident.root, ...incident.consequences]) {
      if (failure.since < incident.since) [incident.since, incident.sinceClock] = [failure.since, failure.sinceClock]
      if (level(healthOf(failure)) > level(incident.health)) incident.health = healthOf(failure)
    }
  }
  return result.sort((a, b) => level(b.health) - level(a.health) || a.since - b.since)
}

export const listed = (words: string[]) =>
  words.length < 2 ? words.join('') : `${words.slice(0, -1).join(', ')} and ${words[words.length - 1]}`

// "camera is dead", "fusion hangs", "camera and fusion are held responsible".
export function headlineOf(incident: Incident, known: Known): string {
  const { components } = incident
  const subject = listed(components) || incident.root.rule
  const are = components.length > 1 ? 'are' : 'is'
  if (incident.host) return `${incident.host}, where ${subject} ran, is unreachable`
  const ways = new Set(components.map((c) => wayOf(known(c))))
  const [way] = ways
  if (ways.size === 1 && way === 'hung') return `${subject} ${components.length > 1 ? 'hang' : 'hangs'}`
  if (ways.size === 1 && way) return `${subject} ${are} ${way}`
  if (incident.isCertain) return `${subject} ${are} held responsible`
  if (components.length > 0 && mostProbable(incident.root.decision)) return `${subject} ${are} suspected`
  return `${incident.root.rule} fails`
}

function wayOf({ isGone, state }: ReturnType<Known>): string {
  if (state?.unheard) return 'not heard'
  if (state?.process === 'stopped') return 'stopped'
  if (state?.process === 'hung') return 'hung'
  return isGone || state?.process === 'gone' || state?.alive === false ? 'dead' : ''
}

// A component's condition in one word, for its node in the graph; nothing if it works.
export const conditionOf = (known: ReturnType<Known>) => wayOf(known).replace('hung', 'hangs')
