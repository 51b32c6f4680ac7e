// The changes of a save, line by line: the longest common subsequence between the common prefix and the common suffix.

export interface DiffLine {
  sign: ' ' | '+' | '-'
  text: string
}

const kContext = 2
const kMostCells = 4_000_000 // beyond, the middle counts as replaced: a diff must not hang the page

export function diff(before: string, after: string): DiffLine[] {
  const a = before.split('\n')
  const b = after.split('\n')
  let head = 0
  while (head < a.length && head < b.length && a[head] === b[head]) ++head
  let tail = 0
  while (tail < a.length - head && tail < b.length - head && a[a.length - 1 - tail] === b[b.length - 1 - tail]) ++tail
  const middle = changed(a.slice(head, a.length - tail), b.slice(head, b.length - tail))
  const same = (lines: string[]) => lines.map((text): DiffLine => ({ sign: ' ', text }))
  return [
    ...same(a.slice(Math.max(0, head - kContext), head)),
    ...middle,
    ...same(a.slice(a.length - tail, a.length - tail + kContext)),
  ]
}

function changed(a: string[], b: string[]): DiffLine[] {
  const minus = a.map((text): DiffLine => ({ sign: '-', text }))
  const plus = b.map((text): DiffLine => ({ sign: '+', text }))
  if (a.length * b.length > kMostCells) return [...minus, ...plus]
  // longest[i][j]: of a from i on and b from j on
  const longest = Array.from({ length: a.length + 1 }, () => new Uint32Array(b.length + 1))
  for (let i = a.length - 1; i >= 0; --i) {
    for (let j = b.length - 1; j >= 0; --j)
      longest[i][j] = a[i] === b[j] ? longest[i + 1][j + 1] + 1 : Math.max(longest[i + 1][j], longest[i][j + 1])
  }
  const lines: DiffLine[] = []
  let i = 0
  let j = 0
  while (i < a.length || j < b.length) {
    if (i < a.length && j < b.length && a[i] === b[j]) {
      lines.push({ sign: ' ', text: a[i] })
      ++i
      ++j
    } else if (i < a.length && (j === b.length || longest[i + 1][j] >= longest[i][j + 1])) {
      lines.push(minus[i++])
    } else {
      lines.push(plus[j++])
    }
  }
  return lines
}
