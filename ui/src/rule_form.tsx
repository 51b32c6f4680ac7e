// The form of a rule file: what its rules are about, what it takes from elsewhere, and its rules.
import type { ComponentChildren } from 'preact'
import { Declarations } from './declaration_form'
import { namesOf } from './declarations'
import type { Props } from './form_fields'
import { names, ownName, parametersOf } from './live_names'
import { kPackFiles, templatesFor } from './reuse'
import { Reuse } from './reuse_form'
import { RuleCard, usualComponent } from './rule_card'
import { inTemplates, newRule, replaced, type RuleDocument } from './rule_document'
import { graph, robot } from './store'
import { Templates } from './template_form'

function Suggestions({ document }: { document: RuleDocument }) {
  const declared = namesOf(document, 'COMPONENT')
  const live = [
    ...graph.value.nodes.map((n) => n.component ?? ownName(n.node)),
    ...Object.keys(names.value.nodes).map(ownName),
  ]
  const topics = [...names.value.topics, ...graph.value.edges.map(([, , channel]) => channel), ...(robot.value?.topics ?? [])]
  const list = (id: string, names: string[]): ComponentChildren => (
    <datalist id={id}>
      {[...new Set(names)].filter(Boolean).sort().map((n) => (
        <option value={n} />
      ))}
    </datalist>
  )
  return (
    <>
      {list('components', [...declared, ...live])}
      {list('topics', topics)}
      {list('nodes', [...graph.value.nodes.map((n) => n.node), ...Object.keys(names.value.nodes)])}
      {list('services', names.value.services)}
      {list('signals', namesOf(document, 'SIGNAL'))}
      {list('constants', namesOf(document, 'CONST'))}
      {list('rule files', kPackFiles)}
      {list('templates', templatesFor(document).map((t) => t.name))}
      {[...new Set([...declared, ...live])].map((component) =>
        list(`parameters of ${component}`, parametersOf(component, document))
      )}
    </>
  )
}

export function RuleForm({ document, change }: Props) {
  const isInTemplate = inTemplates(document)
  const rules = document.statements.flatMap((s, i) => (s.statement === 'RULE' && !isInTemplate[i] ? [i] : []))
  return (
    <>
      <Suggestions document={document} />
      <Declarations document={document} change={change} />
      <Reuse document={document} change={change} />
      {rules.map((place) => (
        <RuleCard key={String(place)} {...{ document, change, place }} />
      ))}
      <div class="bar">
        <button
          type="button"
          class="primary"
          onClick={() => void change((d) => replaced(d, d.statements.length, 0, ...newRule(d, usualComponent(d))))}
        >
          + Rule
        </button>
        <Templates document={document} change={change} />
      </div>
    </>
  )
}
