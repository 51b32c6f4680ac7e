// Triggers that can be said as a sentence: simple conditions, all of which have to hold. Whatever is more than that stays
// text.

export const kKinds = {
  silent: 'a topic is silent for longer than',
  slow: 'a topic comes less often per second than',
  dead: 'a component does not work',
  state: 'the lifecycle of a component',
  value: 'a signal',
} as const
export type Kind = keyof typeof kKinds

export interface Clause {
  kind: Kind
  name: string
  how: string // an operator of the language; '' where the kind says it
  value: string
}

export const kComparisons: Record<string, string> = {
  '>': 'is above',
  '>=': 'is at least',
  '<': 'is below',
  '<=': 'is at most',
  '==': 'is',
  '!=': 'is not',
}

const kWritten: Record<Kind, (c: Clause) => string> = {
  silent: ({ name, value }) => `age(${name}) > ${value}`,
  slow: ({ name, value }) => `rate(${name}) < ${value}`,
  dead: ({ name }) => `alive(${name}) == false`,
  state: ({ name, how, value }) => `lifecycle(${name}) ${how} "${value}"`,
  value: ({ name, how, value }) => `${name} ${how} ${value}`,
}

const kForms: [Kind, RegExp][] = [
  ['silent', /^age\((?<name>[^\s(),]+)\) > (?<value>[\w.]+)$/],
  ['slow', /^rate\((?<name>[^\s(),]+)\) < (?<value>[\w.]+)$/],
  ['dead', /^alive\((?<name>\w+)\) == false$/],
  ['state', /^lifecycle\((?<name>\w+)\) (?<how>==|!=) "(?<value>\w+)"$/],
  ['value', /^(?<name>\w+) (?<how>>=|<=|>|<|==|!=) (?<value>-?[\w.]+|"[^"]*")$/],
]

function clauseOf(text: string): Clause | null {
  for (const [kind, form] of kForms) {
    const groups = form.exec(text)?.groups
    if (groups) return { kind, name: groups.name, how: groups.how ?? '', value: groups.value ?? '' }
  }
  return null
}

export const written = (clauses: Clause[]) => clauses.map((c) => kWritten[c.kind](c)).join(' && ')

// Null if it is more than a sentence can say.
export function sentenceOf(trigger: string): Clause[] | null {
  const clauses = trigger.trim().replace(/\s+/g, ' ').split(' && ').map(clauseOf)
  return clauses.every((c): c is Clause => c !== null) ? clauses : null
}

const kUsual: Record<Kind, Pick<Clause, 'how' | 'value'>> = {
  silent: { how: '', value: '500ms' },
  slow: { how: '', value: '5' },
  dead: { how: '', value: '' },
  state: { how: '!=', value: 'active' },
  value: { how: '>', value: '0' },
}
export const usualClause = (kind: Kind, name: string): Clause => ({ kind, name, ...kUsual[kind] })
