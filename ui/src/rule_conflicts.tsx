// How rules act on one another, drawn: those whose strategies can undo one another for ever, those that
// another one covers, and those that adapt the same component, one at a time.
import type { Found } from './editor'
import { plainStatements, type RuleDocument } from './rule_document'

type Kind = 'undo' | 'covers' | 'shares'
export interface Relation {
  kind: Kind
  from: string
  to: string
  text: string
}

const kWords: Record<Kind, string> = {
  undo: '⇄ can undo one another for ever',
  covers: '⊃ one covers the other',
  shares: '– adapt the same component, so one at a time',
}

// By rule, the components that its strategies adapt.
function componentsOf(document: RuleDocument): Map<string, Set<string>> {
  const rules = new Map<string, Set<string>>()
  let components = new Set<string>()
  for (const s of plainStatements(document)) {
    if (s.statement === 'RULE') rules.set(String(s.name), (components = new Set()))
    if (s.statement === 'ADAPTATION') components.add(String(s.component))
  }
  return rules
}

// The rule that line `line` of the text is in, counted from 1.
function ruleAt(text: string, line: number): string | undefined {
  const before = text.split('\n').slice(0, line)
  for (const each of before.reverse()) {
    const match = /^\s*RULE\s+(\S+)/.exec(each)
    if (match) return match[1]
  }
  return undefined
}

// The relations that the check finds (docs/diagnostics.md, R052 and R056), and those that the form shows.
export function relations(document: RuleDocument, text: string, found: Found[]): Relation[] {
  const list: Relation[] = []
  for (const { code, message, line } of found) {
    const names = [...message.matchAll(/'([^']+)'/g)].map((m) => m[1])
    const own = ruleAt(text, line)
    if (code === 'R052') list.push({ kind: 'undo', from: names[0], to: names[1], text: message })
    if (code === 'R056' && own) list.push({ kind: 'covers', from: names[0], to: own, text: message })
  }
  const rules = [...componentsOf(document)]
  rules.forEach(([from, ours], i) => {
    for (const [to, theirs] of rules.slice(i + 1)) {
      const shared = [...ours].filter((c) => theirs.has(c))
      const isTold = list.some((r) => [r.from, r.to].includes(from) && [r.from, r.to].includes(to))
      if (shared.length > 0 && !isTold) list.push({ kind: 'shares', from, to, text: `both adapt ${shared.join(', ')}` })
    }
  })
  return list
}

const kRow = 30
const kStep = 40 // between two arcs that start side by side

export function RuleConflicts({ list }: { list: Relation[] }) {
  if (list.length === 0) return null
  const names = [...new Set(list.flatMap((r) => [r.from, r.to]))]
  const y = (name: string) => names.indexOf(name) * kRow + kRow / 2
  const reach = (r: Relation) => kStep * Math.max(1, Math.abs(names.indexOf(r.from) - names.indexOf(r.to)))
  const width = 8 + Math.max(...list.map(reach))
  const kinds = (Object.keys(kWords) as Kind[]).filter((k) => list.some((r) => r.kind === k))
  const isGrave = list.some((r) => r.kind !== 'shares')
  return (
    <details class="conflicts" open={isGrave}>
      <summary>{isGrave ? '▲ Conflicting rules' : 'Rules that adapt the same components'}</summary>
      <div class="drawing">
        <ul>
          {names.map((name) => (
            <li>{name}</li>
          ))}
        </ul>
        <svg width={width} height={names.length * kRow} role="img" aria-label="Rules and arcs between them; the list below says the same">
          {list.map((r) => {
            const [a, b, out] = [y(r.from), y(r.to), reach(r)]
            return (
              <path class={`arc-${r.kind}`} d={`M 2 ${a} C ${out * 1.3} ${a}, ${out * 1.3} ${b}, 2 ${b}`}>
                <title>{`${r.from}, ${r.to}: ${r.text}`}</title>
              </path>
            )
          })}
        </svg>
      </div>
      {kinds.map((kind) => (
        <div class={`kind-${kind}`}>
          <h2>{kWords[kind]}</h2>
          <ul>
            {list
              .filter((r) => r.kind === kind)
              .map((r) => (
                <li title={r.text}>
                  {r.from}, {r.to}
                  {r.kind === 'shares' ? `: ${r.text}` : ''}
                </li>
              ))}
          </ul>
        </div>
      ))}
    </details>
  )
}
