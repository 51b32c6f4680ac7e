// Reuse in the form: included files, templates and their uses.
import { DeclarationForm } from './declaration_form'
import { canAdd, kDeclarations, placeFor } from './declarations'
import { Field, More, type Props, Remove } from './form_fields'
import { endOfTemplate, firstParameter, kPackFiles, newRuleOf, newTemplate, placesOf, templatesFor, usualArgument, withUse } from './reuse'
import { RuleCard, usualComponent } from './rule_card'
import { replaced, type RuleDocument, type Statement } from './rule_document'
import { robot } from './store'

function IncludeForm(props: Props & { place: number }) {
  const { document, change, place } = props
  const label = `Include ${document.statements[place].file}`
  return (
    <div class="adaptation" role="group" aria-label={label}>
      <b class="keyword">Include</b>
      <Field {...props} member="file" label="file" list="rule files" wider />
      <Remove what={label} onClick={() => change((d) => replaced(d, place, 1))} />
    </div>
  )
}

function UseForm(props: Props & { place: number }) {
  const { document, change, place } = props
  const { template } = document.statements[place]
  const facts = templatesFor(document).find((t) => t.name === template)
  const words = facts?.parameters.map(({ name, usual }) => (usual === undefined ? name : `${name} = ${usual}`)).join(', ')
  return (
    <div class="adaptation" role="group" aria-label={`Use ${template}`}>
      <b class="keyword">Use</b>
      <Field {...props} member="template" label="template" list="templates" wider />
      <Field {...props} member="arguments" label={words ? `with ${words}` : 'with'} kind="arguments" wide />
      <Field {...props} member="in" label="in the namespace" optional />
      <Remove what={`use of ${template}`} onClick={() => change((d) => replaced(d, place, 1))} />
      {facts?.about && <p class="muted about">{facts.about}</p>}
    </div>
  )
}

// The content of a template: statements of each kind, with its parameters as {name}.
function TemplateForm(props: Props & { place: number }) {
  const { document, change, place } = props
  const end = endOfTemplate(document, place)
  const { statements } = document
  const name = String(statements[place].name)
  const within = statements.slice(place + 1, end).map((s, i): [Statement, number] => [s, place + 1 + i])
  // In front of its rules and uses, whose lines end with the next of them.
  const firstPart = (d: RuleDocument) => {
    const found = d.statements.findIndex((s, i) => i > place && ['RULE', 'USE', 'END'].includes(s.statement))
    return found < 0 ? d.statements.length : found
  }
  const add = (what: string) =>
    void change((d) => {
      const last = endOfTemplate(d, place) - 1
      const subject = firstParameter(d.statements[place])
      if (what === 'Rule') return replaced(d, last, 0, ...newRuleOf(subject))
      if (what === 'Use') return replaced(d, last, 0, { statement: 'USE', template: 'driver_gone', arguments: [subject] })
      const keyword = Object.keys(kDeclarations).find((k) => kDeclarations[k].title === what)!
      return replaced(d, firstPart(d), 0, { statement: keyword, ...kDeclarations[keyword].fresh(d) })
    })
  const titles = Object.entries(kDeclarations).filter(([keyword]) => !['ROBOT', 'CYCLE'].includes(keyword) && canAdd(document, keyword)).map(([, d]) => d.title)
  return (
    <details class="rule template-body" open>
      <summary>Template {name}</summary>
      <div class="row" role="group" aria-label={`Template ${name}`}>
        <Field {...props} member="name" label="template" wider />
        <Field {...props} member="parameters" label="parameters, with what they usually are" kind="parameters" wider />
        <More words="add to it" of={['Rule', 'Use', ...titles]} add={add} />
        <Remove what={`template ${name}`} onClick={() => change((d) => replaced(d, place, endOfTemplate(d, place) - place))} />
      </div>
      {within.map(([{ statement }, i]) => {
        const own = { document, change, place: i }
        if (statement === 'RULE') return <RuleCard key={i} {...own} isTemplate />
        if (statement === 'USE') return <UseForm key={i} {...own} />
        return kDeclarations[statement] && <DeclarationForm key={i} {...own} />
      })}
    </details>
  )
}

// Uses its own templates first, else those of an included file.
function newUse(document: RuleDocument): RuleDocument {
  const included = placesOf(document, 'INCLUDE').map((place) => document.statements[place].file)
  const all = templatesFor(document)
  const template = all.find((t) => !t.file) ?? all.find((t) => included.includes(t.file)) ?? all[0]
  const topic = robot.value?.topics[0] ?? '/topic'
  return withUse(document, template, template.parameters.map((p) => usualArgument(p, usualComponent(document), topic)))
}

function newInclude(document: RuleDocument): RuleDocument {
  const included = placesOf(document, 'INCLUDE').map((place) => document.statements[place].file)
  const file = kPackFiles.find((each) => !included.includes(each)) ?? 'my.rules'
  return replaced(document, placeFor(document, 'INCLUDE'), 0, { statement: 'INCLUDE', file })
}

export function Reuse({ document, change }: Props) {
  const name = (place: number) => String(document.statements[place].file ?? document.statements[place].template)
  const parts = placesOf(document, 'INCLUDE', 'USE')
  const templates = document.statements.flatMap((s, place) => (s.statement === 'TEMPLATE' ? [place] : []))
  return (
    <>
      <details class="rule declarations">
        <summary>From other files and templates: {parts.map(name).join(', ') || 'nothing'}</summary>
        {parts.map((place) =>
          document.statements[place].statement === 'USE' ? <UseForm key={place} {...{ document, change, place }} /> : <IncludeForm key={place} {...{ document, change, place }} />
        )}
        <div class="bar">
          <button type="button" onClick={() => void change(newInclude)}>
            + Include
          </button>
          <button type="button" onClick={() => void change(newUse)}>
            + Use
          </button>
          <button type="button" onClick={() => void change((d) => replaced(d, d.statements.length, 0, ...newTemplate(d)))}>
            + Template
          </button>
        </div>
      </details>
      {templates.map((place) => (
        <TemplateForm key={place} {...{ document, change, place }} />
      ))}
    </>
  )
}
