// A rule file as JSON (docs/rule-json.md), and changes to it. A change gives a new document and
// leaves all that it is not about as it was: comments, order, spelling.

export interface Statement {
  statement: string
  above?: string[]
  comment?: string
  [member: string]: unknown
}
export interface RuleDocument {
  version: number
  statements: Statement[]
  end?: string[]
}

// The parts of a statement follow it, up to the next statement of its own or a higher rank.
const kRanks: Record<string, number> = { POLICIES: 1, TRIGGER: 1, STRATEGY: 1, ADAPTATION: 2 }
export const rankOf = (s: Statement) => kRanks[s.statement] ?? 0

export function endOf(document: RuleDocument, begin: number): number {
  const rank = rankOf(document.statements[begin])
  let end = begin + 1
  while (end < document.statements.length && rankOf(document.statements[end]) > rank) ++end
  return end
}

// Whether each statement is in a template, including its TEMPLATE and END lines: such statements have parameters, and are no rules until the template is used.
export function inTemplates(document: RuleDocument): boolean[] {
  let isIn = false
  return document.statements.map((s) => {
    const isPart = isIn || s.statement === 'TEMPLATE'
    isIn = isPart && s.statement !== 'END'
    return isPart
  })
}

// Those that no template has.
export function plainStatements(document: RuleDocument): Statement[] {
  const isInTemplate = inTemplates(document)
  return document.statements.filter((_, place) => !isInTemplate[place])
}

export function replaced(
  document: RuleDocument,
  begin: number,
  count: number,
  ...by: Statement[]
): RuleDocument {
  const statements = [...document.statements]
  statements.splice(begin, count, ...by)
  return { ...document, statements }
}

// `value` undefined takes the member away.
export function withMember(
  document: RuleDocument,
  place: number,
  member: string,
  value: unknown
): RuleDocument {
  const changed = { ...document.statements[place] }
  if (value === undefined) delete changed[member]
  else changed[member] = value
  return replaced(document, place, 1, changed)
}

// The members of each type of adaptation, in front of its impact.
export const kAdaptations: Record<string, string[]> = {
  set_parameter: ['parameter', 'value'],
  increase_parameter: ['parameter', 'value'],
  decrease_parameter: ['parameter', 'value'],
  change_communication: ['parameter', 'topic'],
  activate: [],
  deactivate: [],
  restart: [],
  redeploy: [],
  start: [],
  stop: [],
  start_group: [],
  change_mode: ['mode'],
  call: ['service', 'request'],
}
// Members that may be missing.
export const kOptional = ['request']

// In cycles, as the rules of the examples have it: a parameter is light, a new process is not.
const kImpacts: Record<string, number> = { activate: 5, deactivate: 5, restart: 5, redeploy: 10, start: 10, stop: 10, start_group: 50 }
const kLightImpact = 2
const kDefaults: Record<string, string> = {
  parameter: 'parameter', value: 'true', topic: 'topic', mode: 'mode', service: 'service',
}

// Keeps the members of `before` that the new type has. An unchanged impact follows the type.
export function newAdaptation(type: string, before: Statement): Statement {
  const statement: Statement = { statement: 'ADAPTATION', component: before.component, type }
  for (const member of kAdaptations[type]) {
    const value = before[member] ?? kDefaults[member]
    if (value !== undefined) statement[member] = value
  }
  const usual = (of: unknown) => kImpacts[String(of)] ?? kLightImpact
  const isUsual = before.impact === undefined || before.impact === usual(before.type)
  statement.impact = isUsual ? usual(type) : before.impact
  if (before.then) statement.then = before.then
  if (before.above) statement.above = before.above
  if (before.comment) statement.comment = before.comment
  return statement
}

export function newStrategy(name: string, component: string, type = 'restart'): Statement[] {
  return [
    { statement: 'STRATEGY', name, probability: 50, confidence: 10 },
    newAdaptation(type, { statement: 'ADAPTATION', component }),
  ]
}

const kOwners = ['launch', 'unit', 'container', 'plugin', 'respawned']

// Every rule set first asks whether the component is alive. Deactivating and activating does not help a process that exited, so a component whose
// process can be started is started again.
export function newRule(document: RuleDocument, component: string): Statement[] {
  const name = component.replace(/(^|_+)([a-z])/g, (_, __, letter: string) => letter.toUpperCase())
  const declared = document.statements.find((s) => s.statement === 'COMPONENT' && s.name === component)
  const type = kOwners.some((owner) => declared?.[owner] !== undefined) ? 'redeploy' : 'restart'
  return [
    { statement: 'RULE', name: freeName(document, 'RULE', `${name}Dead`), above: [''] },
    { statement: 'POLICIES', criticality: 'ERROR' },
    { statement: 'TRIGGER', expression: `alive(${component}) == false` },
    ...newStrategy(freeName(document, 'STRATEGY', 'strategy'), component, type),
  ]
}

// The component that the rule at or around `place` adapts first.
export function componentOf(document: RuleDocument, place: number): string {
  let begin = place
  while (begin > 0 && document.statements[begin].statement !== 'RULE') --begin
  const end = endOf(document, begin)
  const adaptation = document.statements.slice(begin, end).find((s) => s.statement === 'ADAPTATION')
  return String(adaptation?.component ?? 'my_node')
}

// A name that is not taken yet: "rule", "rule2".
export function freeName(document: RuleDocument, keyword: string, wish: string): string {
  const taken = new Set(
    document.statements.filter((s) => s.statement === keyword).map((s) => s.name)
  )
  let name = wish
  for (let i = 2; taken.has(name); ++i) name = wish + i
  return name
}
