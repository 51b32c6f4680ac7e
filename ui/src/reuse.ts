// Reuse in rules: included files, templates and their uses, and the packs of templates of culprit (rules/packs), which
// are bundled with the app.
import { placeFor } from './declarations'
import { freeName, inTemplates, plainStatements, replaced, type RuleDocument, type Statement } from './rule_document'

declare const kPacks: Record<string, string> // by file; put in by bundle.mjs

export interface Parameter {
  name: string
  usual?: string // what stands for it where a use says nothing
}
export interface TemplateFacts {
  name: string
  parameters: Parameter[]
  about: string // what it is for
  file?: string // that has to be included for it
}

const kLine = /((?:^[ \t]*#.*\n)*)^TEMPLATE (\w+)(?:\(([^\n]*)\))?[ \t]*$/gm
const kParameter = /(\w+)(?:\s*=\s*("[^"]*"|[^,\s]+))?/g

const parametersOf = (text: string): Parameter[] =>
  [...text.matchAll(kParameter)].map(([, name, usual]) => (usual === undefined ? { name } : { name, usual }))
const withoutSigns = (comments: string) => comments.replace(/^[ \t]*# ?/gm, '').trim()

export const kPackFiles = Object.keys(kPacks).map((file) => `packs/${file}`)
const kPackTemplates: TemplateFacts[] = Object.entries(kPacks).flatMap(([file, text]) =>
  [...text.matchAll(kLine)].map(([, comments, name, parameters = '']) => ({
    name, parameters: parametersOf(parameters), about: withoutSigns(comments), file: `packs/${file}`,
  }))
)
export const kPackGroups: [string, TemplateFacts[]][] = kPackFiles.map((file) => [file, kPackTemplates.filter((t) => t.file === file)])

const ownTemplates = (document: RuleDocument): TemplateFacts[] =>
  document.statements
    .filter((s) => s.statement === 'TEMPLATE')
    .map((s) => ({
      name: String(s.name), about: '',
      parameters: (s.parameters as (string | Parameter)[]).map((p) => (typeof p === 'string' ? { name: p } : p)),
    }))

// The templates of the file itself, and of the packs.
export const templatesFor = (document: RuleDocument) => [...ownTemplates(document), ...kPackTemplates]

// The usual kind of a parameter of this name, for a form to offer names.
export const listFor = ({ name, usual = '' }: Parameter): string | undefined => {
  if (/^(name|server|component|node)$/.test(name)) return 'components'
  if (usual.startsWith('/') || /topic|scan|pose|states/.test(name)) return 'topics'
  return undefined
}
// With what a use begins: `component` and `topic` are some that there are.
export function usualArgument(parameter: Parameter, component: string, topic: string): string {
  if (parameter.usual !== undefined) return parameter.usual
  const list = listFor(parameter)
  if (list) return list === 'components' ? component : topic
  return '10'
}

// A use of it, with what its last parameters usually are left out; the file that it is in is included, and a component of
// which it speaks is declared: who starts it is for a person to say.
export function withUse(document: RuleDocument, template: TemplateFacts, given: string[]): RuleDocument {
  const all = [...given]
  while (all.length > 0 && all[all.length - 1] === template.parameters[all.length - 1].usual) all.pop()
  let changed = document
  const isIncluded = plainStatements(document).some((s) => s.statement === 'INCLUDE' && s.file === template.file)
  if (template.file && !isIncluded) changed = replaced(changed, placeFor(changed, 'INCLUDE'), 0, { statement: 'INCLUDE', file: template.file })
  const declared = new Set(plainStatements(document).filter((s) => s.statement === 'COMPONENT').map((s) => s.name))
  template.parameters.forEach((parameter, place) => {
    const name = given[place]
    if (parameter.name !== 'name' || declared.has(name) || !/^\w+$/.test(name)) return
    changed = replaced(changed, placeFor(changed, 'COMPONENT'), 0, { statement: 'COMPONENT', name, node: `/${name}` })
  })
  return replaced(changed, changed.statements.length, 0, { statement: 'USE', template: template.name, arguments: all })
}

export function newTemplate(document: RuleDocument): Statement[] {
  return [
    { statement: 'TEMPLATE', name: freeName(document, 'TEMPLATE', 'my_template'), parameters: ['name'], above: [''] },
    ...newRuleOf('{name}'),
    { statement: 'END' },
  ]
}
// In a template names are made of its parameter, or a second use would have the same ones.
export function newRuleOf(component: string): Statement[] {
  return [
    { statement: 'RULE', name: `${component}_dead` },
    { statement: 'POLICIES', criticality: 'ERROR' },
    { statement: 'TRIGGER', expression: `alive(${component}) == false` },
    { statement: 'STRATEGY', name: `${component}_restart`, probability: 50, confidence: 10 },
    { statement: 'ADAPTATION', component, type: 'restart', impact: 5 },
  ]
}

// From TEMPLATE to END, both included.
export function endOfTemplate(document: RuleDocument, begin: number): number {
  const end = document.statements.findIndex((s, place) => place > begin && s.statement === 'END')
  return end < 0 ? document.statements.length : end + 1
}
export const firstParameter = (template: Statement) => {
  const [first] = (template.parameters as (string | Parameter)[] | undefined) ?? []
  return first === undefined ? 'my_node' : `{${typeof first === 'string' ? first : first.name}}`
}

export const placesOf = (document: RuleDocument, ...keywords: string[]): number[] => {
  const isInTemplate = inTemplates(document)
  return document.statements.flatMap((s, place) => (keywords.includes(s.statement) && !isInTemplate[place] ? [place] : []))
}
