// Rules that others have written for what often goes wrong, to be filled in with one's own names: those of the cookbook
// (rules/cookbook), which the app brings along.
import { placeFor } from './declarations'
import { freeName, type RuleDocument, type Statement } from './rule_document'

declare const kCookbook: Record<string, string> // by file; put in by bundle.mjs

export interface Template {
  title: string
  text: string
}
// Their first line says what each is for.
export const kTemplates: Template[] = Object.values(kCookbook).map((text) => ({
  title: text.slice(0, text.indexOf('\n')).replace(/^#\s*/, '').replace(/\.$/, ''),
  text,
}))

// The names in a template, which may differ on the user's robot.
export interface Names {
  nodes: string[]
  topics: string[]
}

const kTopicsIn = /\b(?:rate|age|phi)\(\s*"?(\/[\w/]+)/g
const unique = (names: unknown[]) => [...new Set(names.map(String))]

export function namesIn(template: RuleDocument): Names {
  const { statements } = template
  const written = statements.flatMap((s) => [s.topic, ...((s.topics as string[] | undefined) ?? [])]).filter((t) => String(t).startsWith('/'))
  const read = statements.flatMap((s) => [...String(s.expression ?? s.when ?? '').matchAll(kTopicsIn)].map((m) => m[1]))
  return {
    nodes: unique(statements.filter((s) => s.statement === 'COMPONENT' && s.node).map((s) => s.node)),
    topics: unique([...read, ...written]),
  }
}

const renamed = (text: string, name: string, by: string) => text.replace(new RegExp(`(?<![\\w/])${name}(?![\\w/])`, 'g'), by)
// In each member that names it or reads it.
function withNames(statement: Statement, names: Map<string, string>): Statement {
  const changed = { ...statement }
  for (const [member, value] of Object.entries(statement)) {
    const put = (text: unknown) => (typeof text === 'string' ? [...names].reduce((t, [name, by]) => renamed(t, name, by), text) : text)
    if (member !== 'statement' && member !== 'above' && member !== 'comment') changed[member] = Array.isArray(value) ? value.map(put) : put(value)
  }
  return changed
}

const kNamed = ['COMPONENT', 'CONST', 'SIGNAL', 'RULE']

// The document with the template in it: `own` maps the template's nodes and topics to names here. Existing statements
// keep their names; a component of the same node is reused.
export function filledIn(document: RuleDocument, template: RuleDocument, own: Map<string, string>): RuleDocument {
  const names = new Map(own)
  const left = new Set<Statement>()
  for (const statement of template.statements) {
    if (!kNamed.includes(statement.statement)) continue
    const name = String(statement.name)
    const node = own.get(String(statement.node)) ?? statement.node
    const same = document.statements.find((s) => s.statement === 'COMPONENT' && s.node !== undefined && s.node === node)
    if (statement.statement === 'COMPONENT' && same) {
      names.set(name, String(same.name))
      left.add(statement)
    } else {
      const free = freeName(document, statement.statement, name)
      if (free !== name) names.set(name, free)
    }
  }
  let filled = document
  const add = (place: number, statement: Statement) => {
    const statements = [...filled.statements]
    statements.splice(place, 0, withNames(statement, names))
    filled = { ...filled, statements }
  }
  const first = template.statements.findIndex((s) => s.statement === 'RULE')
  template.statements.forEach((statement, place) => {
    if (left.has(statement) || ['ROBOT', 'CYCLE'].includes(statement.statement)) return
    if (first >= 0 && place >= first) add(filled.statements.length, statement)
    else add(placeFor(filled, statement.statement), { ...statement, above: undefined })
  })
  return filled
}
