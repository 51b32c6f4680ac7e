// The changes of a text, line by line: those of a save, and those of two people at once.
import { diffArrays, structuredPatch } from 'diff'

export interface DiffLine {
  sign: ' ' | '+' | '-' | '\\' // the last one says that the text ends without a newline
  text: string
}

const kContext = 2
const kMost = { maxEditLength: 4000 } // lines; beyond, all counts as changed: to compare must not hang the page

export function diff(before: string, after: string): DiffLine[] {
  const patch = structuredPatch('', '', before, after, '', '', { context: kContext, ...kMost })
  if (!patch) return [...signed('-', before), ...signed('+', after)]
  return patch.hunks.flatMap(({ lines }, i) => [
    ...(i > 0 ? signed(' ', '…') : []),
    ...lines.map((line) => ({ sign: line[0] as DiffLine['sign'], text: line.slice(1) })),
  ])
}

const signed = (sign: DiffLine['sign'], text: string) => text.split('\n').map((line): DiffLine => ({ sign, text: line }))

// Where the lines of `before` are that `after` has, too. Null: too much changed.
function kept(before: string[], after: string[]): Map<number, number> | null {
  const changes = diffArrays(before, after, kMost)
  if (!changes) return null
  const places = new Map<number, number>()
  let [i, j] = [0, 0]
  for (const { value, added, removed } of changes) {
    if (!added && !removed) value.forEach((_, n) => places.set(i + n, j + n))
    if (!added) i += value.length
    if (!removed) j += value.length
  }
  return places
}

// Two changes of one text brought together, as diff3 does: null where both changed the same lines. Not by node-diff3, which takes
// 26 s for 1,000 rules.
export function merged(base: string, mine: string, theirs: string): string | null {
  const [o, a, b] = [base, mine, theirs].map((text) => text.split('\n'))
  const inA = kept(o, a)
  const inB = kept(o, b)
  if (!inA || !inB) return null
  const result: string[] = []
  let [i, j, k] = [0, 0, 0]
  while (i <= o.length) {
    // The next line that all three have; behind the last, their ends.
    let next = i
    while (next < o.length && !(inA.has(next) && inB.has(next))) ++next
    const [ours, others] = next < o.length ? [inA.get(next)!, inB.get(next)!] : [a.length, b.length]
    const [was, fromA, fromB] = [o.slice(i, next), a.slice(j, ours), b.slice(k, others)].map((lines) => lines.join('\n'))
    if (fromA !== fromB && fromA !== was && fromB !== was) return null
    const chosen = fromA === was ? b.slice(k, others) : a.slice(j, ours)
    result.push(...chosen)
    if (next < o.length) result.push(o[next])
    ;[i, j, k] = [next + 1, ours + 1, others + 1]
  }
  return result.join('\n')
}
