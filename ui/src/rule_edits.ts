// Changes of the form, taken one by one: each is tried on the rules as the server took them last. One that is refused
// is left out, and what was entered before or after it stays.
import { signal } from '@preact/signals'
import { call } from './api'
import type { RuleDocument } from './rule_document'

export type Edit = (document: RuleDocument) => RuleDocument
// Why it was not taken; null if it was.
export type Take = (edit: Edit) => Promise<string | null>

export const form = signal<RuleDocument | null>(null) // as it is shown: with what is on its way
let accepted: { document: RuleDocument; text: string } | null = null

interface Waiting {
  edit: Edit
  settled: Promise<void>
}
let waiting: Waiting[] = [] // in the order that they were made in

// The latest change counts, in form or text: answers to earlier requests are dropped, or a slow one would revert newer
// input.
let asked = 0
export const isNewest = (number: number) => number === asked
export const ask = () => ++asked

// The form of a text that was entered.
export function accept(document: RuleDocument, text: string): void {
  form.value = document
  accepted = { document, text }
  waiting = []
}

const refused = signal<Set<object>>(new Set()) // fields that hold what was not taken
export const refusedFields = () => refused.value.size
export function setRefused(field: object, isRefused: boolean): void {
  if (refused.value.has(field) === isRefused) return
  const next = new Set(refused.value)
  if (isRefused) next.add(field)
  else next.delete(field)
  refused.value = next
}

// "rules: /statements/2/expression: ..." says where to programs; the field says it to people.
const forPeople = (message: string) => message.trim().replace(/^rules: (\/\S+: )?/, '')

let undoing = () => {}
export const undo = () => undoing()
export const onUndo = (how: () => void) => void (undoing = how)

// `show` is given the text that the form stands for.
export async function take(edit: Edit, show: (text: string) => void): Promise<string | null> {
  let settle = () => {}
  const mine: Waiting = { edit, settled: new Promise((resolve) => (settle = resolve)) }
  waiting.push(mine)
  form.value = edit(form.value!)
  const why = await tryOut(mine, show)
  settle()
  return why
}

async function tryOut(mine: Waiting, show: (text: string) => void): Promise<string | null> {
  for (;;) {
    const number = ask()
    const sent = waiting.slice(0, waiting.indexOf(mine) + 1)
    const document = sent.reduce((d, each) => each.edit(d), accepted!.document)
    try {
      const { text } = await call<{ text: string }>('POST', '/api/rules/text', document)
      if (!waiting.includes(mine)) return null // a later answer had it already, or the text was changed
      accepted = { document, text }
      waiting = waiting.filter((each) => !sent.includes(each))
      if (isNewest(number)) show(text)
      return null
    } catch (error) {
      const why = forPeople((error as Error).message)
      if (!waiting.includes(mine)) return why
      // The error may concern an earlier edit, which is answered first.
      if (sent.length > 1) {
        await Promise.all(sent.slice(0, -1).map((each) => each.settled))
        continue
      }
      waiting = waiting.filter((each) => each !== mine)
      form.value = waiting.reduce((d, each) => each.edit(d), accepted!.document)
      if (waiting.length === 0) show(accepted!.text)
      return why
    }
  }
}
