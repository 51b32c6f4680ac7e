// Triggers as a sentence: simple conditions, all or any of which have to hold. Anything beyond that is an expression.

export const kKinds = {
  silent: 'a topic is silent for longer than',
  slow: 'the rate of a topic, in Hz, is below',
  odd: 'a topic is silent unusually long: φ above',
  dead: 'a component is down',
  state: 'the lifecycle of a component',
  value: 'a signal',
  mean: 'the mean of a signal over',
  least: 'the minimum of a signal over',
  most: 'the maximum of a signal over',
  spread: 'the standard deviation of a signal over',
  frozen: 'a signal repeats its value for',
  changed: 'a signal has changed',
  parameter: 'a parameter of a component',
  level: 'the level of a diagnostic',
  goals: 'the goals of an action that ended within',
  logs: 'the log lines of a component within',
  goalAge: 'the age of the goal of an action',
  cpu: 'the processor cores that a component uses',
  memory: 'the memory that a component uses, in MiB',
  text: 'an expression',
} as const
export type Kind = keyof typeof kKinds

export interface Clause {
  kind: Kind
  name: string
  how: string // an operator of the language; '' where the kind says it
  value: string
  second: string // the time of a window, the name of a parameter
}
export interface Sentence {
  between: '&&' | '||' // all, or any
  clauses: Clause[]
}

export const kComparisons: Record<string, string> = {
  '>': 'is above',
  '>=': 'is at least',
  '<': 'is below',
  '<=': 'is at most',
  '==': 'is',
  '!=': 'is not',
}
export const kCompared: Kind[] = ['state', 'value', 'mean', 'least', 'most', 'spread', 'parameter', 'level', 'goals', 'goalAge', 'logs', 'cpu', 'memory']
export const kWindows: Kind[] = ['mean', 'least', 'most', 'spread', 'frozen', 'goals', 'logs']
const kFunctions: Partial<Record<Kind, string>> = { mean: 'mean', least: 'min', most: 'max', spread: 'stddev' }

const overWindow = ({ kind, name, how, value, second }: Clause) => `${kFunctions[kind]}(${name}, ${second}) ${how} ${value}`
const kWritten: Record<Kind, (c: Clause) => string> = {
  silent: ({ name, value }) => `age(${name}) > ${value}`,
  slow: ({ name, value, second }) => `rate(${name}${second ? `, ${second}` : ''}) < ${value}`,
  odd: ({ name, value }) => `phi(${name}) > ${value}`,
  dead: ({ name }) => `alive(${name}) == false`,
  state: ({ name, how, value }) => `lifecycle(${name}) ${how} "${value}"`,
  value: ({ name, how, value }) => `${name} ${how} ${value}`,
  mean: overWindow,
  least: overWindow,
  most: overWindow,
  spread: overWindow,
  frozen: ({ name, second }) => `frozen(${name}, ${second})`,
  goals: ({ name, how, value, second }) => `goals(${name}, ${second.replace(' in ', ', ')}) ${how} ${value}`,
  logs: ({ name, how, value, second }) => `logs(${name}, ${second.replace(' in ', ', ')}) ${how} ${value}`,
  goalAge: ({ name, how, value }) => `goal_age(${name}) ${how} ${value}`,
  cpu: ({ name, how, value }) => `cpu(${name}) ${how} ${value}`,
  memory: ({ name, how, value }) => `memory(${name}) ${how} ${value}`,
  changed: ({ name }) => `changed(${name})`,
  parameter: ({ name, how, value, second }) => `parameter(${name}, ${second}) ${how} ${value}`,
  level: ({ name, how, value }) => `level(${name}) ${how} ${value}`,
  text: ({ value }) => value,
}

const kName = String.raw`(?<name>[^\s(),]+|"[^"]*")`
const kTopic = String.raw`(?<name>(?:[^\s(),]+|"[^"]*")(?: FROM [^\s(),]+)?)` // of one publisher
const kWord = String.raw`(?<name>\w+)`
const kHow = String.raw`(?<how>>=|<=|>|<|==|!=)`
const kValue = String.raw`(?<value>-?[\w.]+|"[^"]*")`
const kSecond = String.raw`(?<second>[^\s(),]+|"[^"]*")`
const kForms = (
  [
    ['silent', `age\\(${kTopic}\\) > (?<value>[\\w.]+)`],
    ['slow', `rate\\(${kTopic}(?:, ${kSecond})?\\) < (?<value>[\\w.]+)`],
    ['odd', `phi\\(${kTopic}\\) > (?<value>[\\w.]+)`],
    ['dead', `alive\\(${kWord}\\) == false`],
    ['state', `lifecycle\\(${kWord}\\) (?<how>==|!=) "(?<value>\\w+)"`],
    ['mean', `mean\\(${kWord}, ${kSecond}\\) ${kHow} ${kValue}`],
    ['least', `min\\(${kWord}, (?<second>[\\d.]+[a-z]+)\\) ${kHow} ${kValue}`],
    ['most', `max\\(${kWord}, (?<second>[\\d.]+[a-z]+)\\) ${kHow} ${kValue}`],
    ['spread', `stddev\\(${kWord}, ${kSecond}\\) ${kHow} ${kValue}`],
    ['frozen', `frozen\\(${kWord}, ${kSecond}\\)`],
    ['goals', `goals\\(${kName}, (?<second>\\w+, [\\d.]+[a-z]+)\\) ${kHow} ${kValue}`],
    ['logs', `logs\\(${kWord}, (?<second>\\w+, [\\d.]+[a-z]+)\\) ${kHow} ${kValue}`],
    ['goalAge', `goal_age\\(${kName}\\) ${kHow} ${kValue}`],
    ['cpu', `cpu\\(${kWord}\\) ${kHow} ${kValue}`],
    ['memory', `memory\\(${kWord}\\) ${kHow} ${kValue}`],
    ['changed', `changed\\(${kWord}\\)`],
    ['parameter', `parameter\\(${kName}, ${kSecond}\\) ${kHow} ${kValue}`],
    ['level', `level\\(${kName}\\) ${kHow} ${kValue}`],
    ['value', `${kWord} ${kHow} ${kValue}`],
  ] as [Kind, string][]
).map(([kind, form]): [Kind, RegExp] => [kind, new RegExp(`^${form}$`)])

const kEmpty = { name: '', how: '', value: '', second: '' }

function clauseOf(text: string): Clause {
  for (const [kind, form] of kForms) {
    const groups = form.exec(text)?.groups
    if (groups) return { kind, name: groups.name, how: groups.how ?? '', value: groups.value ?? '', second: kind === 'goals' || kind === 'logs' ? groups.second.replace(', ', ' in ') : (groups.second ?? '') }
  }
  return { ...kEmpty, kind: 'text', value: text }
}

// Where `sign` stands outside of brackets and quotes.
function split(text: string, sign: string): string[] {
  const parts: string[] = []
  let [depth, from, isQuoted] = [0, 0, false]
  for (let i = 0; i < text.length; ++i) {
    if (text[i] === '\\' && isQuoted) ++i
    else if (text[i] === '"') isQuoted = !isQuoted
    else if (isQuoted) continue
    else if (text[i] === '(') ++depth
    else if (text[i] === ')') --depth
    else if (depth === 0 && text.startsWith(sign, i)) {
      parts.push(text.slice(from, i))
      from = i + sign.length
    }
  }
  return [...parts, text.slice(from)].map((part) => part.trim())
}
const has = (text: string, sign: string) => split(text, sign).length > 1

// Brackets enclose an expression that binds less tightly than the word between the conditions.
const bracketed = (text: string, between: Sentence['between']) => (has(text, '?') || (between === '&&' && has(text, '||')) ? `(${text})` : text)

export function written({ between, clauses }: Sentence): string {
  const texts = clauses.map((c) => kWritten[c.kind](c))
  return texts.length === 1 ? texts[0] : texts.map((t) => bracketed(t, between)).join(` ${between} `)
}

export function sentenceOf(trigger: string): Sentence {
  const text = trigger.trim()
  if (has(text, '?')) return { between: '&&', clauses: [clauseOf(text)] }
  const between = has(text, '||') ? '||' : '&&'
  return { between, clauses: split(text, between).map((part) => clauseOf(part.replace(/ +/g, ' '))) }
}

const kUsual: Partial<Record<Kind, Partial<Clause>>> = {
  silent: { value: '500ms' },
  slow: { value: '5' },
  odd: { value: '8' },
  state: { how: '!=', value: 'active' },
  value: { how: '>', value: '0' },
  mean: { how: '>', value: '0', second: '2s' },
  least: { how: '<', value: '0', second: '2s' },
  most: { how: '>', value: '0', second: '2s' },
  spread: { how: '>', value: '1', second: '2s' },
  frozen: { second: '2s' },
  goals: { how: '>=', value: '2', second: 'aborted in 60s' },
  goalAge: { how: '>', value: '5min' },
  logs: { how: '>=', value: '3', second: 'ERROR in 10s' },
  cpu: { how: '>', value: '0.9' },
  memory: { how: '>', value: '1000' },
  parameter: { how: '==', value: '0', second: 'my_parameter' },
  level: { how: '>=', value: '2' },
  text: { value: 'true' },
}
export const usualClause = (kind: Kind, name: string): Clause => ({ ...kEmpty, kind, name, ...kUsual[kind] })
