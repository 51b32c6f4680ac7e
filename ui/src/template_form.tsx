// Begins with a template that others have written: choose a failure, name it, and look at it.
import { useEffect, useState } from 'preact/hooks'
import { call, type Refusal } from './api'
import { namesOf } from './declarations'
import type { Props } from './form_fields'
import type { RuleDocument } from './rule_document'
import { kPackGroups, listFor, type TemplateFacts, usualArgument, withUse } from './reuse'
import { usualComponent } from './rule_card'
import { filledIn, kTemplates, namesIn, type Template } from './templates'
import { tell } from './notices'
import { undo } from './rule_edits'
import { robot } from './store'

function Fill({ template, change, close }: { template: Template; change: Props['change']; close: () => void }) {
  const [document, setDocument] = useState<RuleDocument | null>(null)
  const [own, setOwn] = useState<Map<string, string>>(new Map())
  useEffect(() => {
    call<RuleDocument>('POST', '/api/rules/json', { text: template.text }).then(setDocument, (e: Refusal) => tell({ text: e.message, isTrouble: true }))
  }, [template])
  if (!document) return null
  const { nodes, topics } = namesIn(document)
  const add = async () => {
    const why = await change((d) => filledIn(d, document, own))
    if (why !== null) return tell({ text: `Not taken: ${why}`, isTrouble: true })
    tell({ text: `${template.title}: added. Look at its commands and numbers.`, undo })
    close()
  }
  const field = (name: string, what: string, list: string) => (
    <label class="field" key={name}>
      <span>
        {what} {name} is here
      </span>
      <input value={own.get(name) ?? name} list={list} spellcheck={false} onInput={(e) => setOwn(new Map(own).set(name, e.currentTarget.value.trim()))} />
    </label>
  )
  return (
    <section class="banner template" aria-label="Template">
      <h2>{template.title}</h2>
      <div class="row">
        {nodes.map((name) => field(name, 'node', 'nodes'))}
        {topics.map((name) => field(name, 'topic', 'topics'))}
      </div>
      <details>
        <summary>Text of the template</summary>
        <pre class="diff" tabIndex={0}>
          {template.text}
        </pre>
      </details>
      <div class="bar">
        <button type="button" class="primary" onClick={() => void add()}>
          Add it
        </button>
        <button type="button" onClick={close}>
          Cancel
        </button>
      </div>
    </section>
  )
}

// A template of a pack: what it is for, and what its parameters are here.
function FillPack({ template, document, change, close }: Props & { template: TemplateFacts; close: () => void }) {
  const { name, parameters, about, file } = template
  const begin = () => parameters.map((p) => usualArgument(p, usualComponent(document), robot.value?.topics[0] ?? '/topic'))
  const [given, setGiven] = useState(begin)
  const isNew = parameters.some((p, place) => p.name === 'name' && !namesOf(document, 'COMPONENT').includes(given[place]))
  const add = async () => {
    const why = await change((d) => withUse(d, template, given))
    if (why !== null) return tell({ text: `Not taken: ${why}`, isTrouble: true })
    tell({ text: `${name}: added.${isNew ? ' Choose the owner of its component above.' : ''}`, undo })
    close()
  }
  return (
    <section class="banner template" aria-label="Template">
      <h2>
        {name} <small class="muted">of {file}</small>
      </h2>
      {about && <p class="about">{about}</p>}
      <div class="row">
        {parameters.map((parameter, place) => (
          <label class="field" key={parameter.name}>
            <span>{parameter.name}</span>
            <input
              value={given[place]}
              list={listFor(parameter)}
              spellcheck={false}
              onInput={(e) => setGiven(given.map((each, i) => (i === place ? e.currentTarget.value.trim() : each)))}
            />
          </label>
        ))}
      </div>
      <div class="bar">
        <button type="button" class="primary" disabled={given.includes('')} onClick={() => void add()}>
          Add it
        </button>
        <button type="button" onClick={close}>
          Cancel
        </button>
      </div>
    </section>
  )
}

export function Templates({ document, change }: Props) {
  const [chosen, choose] = useState('')
  const close = () => choose('')
  const recipe = kTemplates.find((t) => t.title === chosen)
  const pack = kPackGroups.flatMap(([, all]) => all).find((t) => t.name === chosen)
  return (
    <>
      <label>
        or begin with{' '}
        <select aria-label="Begin with a template" value={chosen} onChange={(e) => choose(e.currentTarget.value)}>
          <option value="">what often goes wrong …</option>
          <optgroup label="Cookbook: rules to adapt">
            {kTemplates.map((t) => (
              <option>{t.title}</option>
            ))}
          </optgroup>
          {kPackGroups.map(([file, all]) => (
            <optgroup label={`Pack ${file.replace(/^packs\/|\.rules$/g, '')}`}>
              {all.map((t) => (
                <option>{t.name}</option>
              ))}
            </optgroup>
          ))}
        </select>
      </label>
      {recipe && <Fill key={chosen} template={recipe} change={change} close={close} />}
      {pack && <FillPack key={chosen} template={pack} {...{ document, change, close }} />}
    </>
  )
}
