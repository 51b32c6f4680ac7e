// Two changes of one text brought together, line by line, as diff3 does: null where both changed the same lines.

// The places of lines that both texts have, in their order: the longest common subsequence.
function common(a: string[], b: string[]): [number, number][] {
  const longest = Array.from({ length: a.length + 1 }, () => new Uint32Array(b.length + 1))
  for (let i = a.length - 1; i >= 0; --i) {
    for (let j = b.length - 1; j >= 0; --j)
      longest[i][j] = a[i] === b[j] ? longest[i + 1][j + 1] + 1 : Math.max(longest[i + 1][j], longest[i][j + 1])
  }
  const pairs: [number, number][] = []
  for (let i = 0, j = 0; i < a.length && j < b.length; ) {
    if (a[i] === b[j]) pairs.push([i++, j++])
    else if (longest[i + 1][j] >= longest[i][j + 1]) ++i
    else ++j
  }
  return pairs
}

const kMostCells = 4_000_000 // beyond, a person compares: a merge must not hang the page

export function merged(base: string, mine: string, theirs: string): string | null {
  const [o, a, b] = [base, mine, theirs].map((text) => text.split('\n'))
  if (o.length * Math.max(a.length, b.length) > kMostCells) return null
  const inA = new Map(common(o, a))
  const inB = new Map(common(o, b))
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
