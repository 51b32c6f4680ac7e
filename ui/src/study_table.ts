// The results of a campaign as a table, from `culprit study --json`: rows of labels, and of numbers with their spread.

type Cell = string | number | boolean | null
export interface StudyTable {
  columns: string[]
  rows: Record<string, string>[]
}
interface Spread {
  mean: number
  sd?: number
}
type Found = Spread | string

const isSpread = (cell: Found | undefined): cell is Spread => typeof cell === 'object'
const found = (value: Cell): Found => {
  if (value === null) return '–'
  if (typeof value === 'number') return { mean: value }
  return value === true ? 'yes' : value === false ? 'no' : value
}

// As many decimals for all of a column: three figures of its largest, none of what is counted.
function decimalsOf(cells: Spread[]): number {
  if (cells.every((c) => Number.isInteger(c.mean) && c.sd === undefined)) return 0
  const largest = Math.max(...cells.map((c) => Math.abs(c.mean)))
  return largest === 0 ? 0 : Math.max(0, Math.min(4, 2 - Math.floor(Math.log10(largest))))
}

export interface StudyResult {
  study?: string
  campaign?: { seed: number; version: string; runs?: number; episodes?: number; scenario?: { seed: number } }
  scenarios?: string[] // run i has the one at i modulo their number
  rows: Record<string, unknown>[]
}

// The name of a row: its manager and its variant.
export function rowName(row: Record<string, unknown>): string {
  if (row.manager) return String(row.manager)
  const parts = [String(row.planner)]
  if (row.dependencies !== undefined) {
    const letters = [row.dependencies && 'D', row.criticality && 'C', row.impact && 'S']
    parts.push(letters.map((letter) => letter || '–').join(' '), `profile ${row.profile}`)
    if (row.probabilities) parts.push(`${row.probabilities} probabilities`)
  } else {
    parts.push(`${row.components} components`, `${row.faults} faults`)
    if (row.noise) parts.push(`noise ${row.noise}`)
    if (row.cyclic) parts.push('cyclic')
  }
  return parts.join(', ')
}

// { mean, sd } is one cell; other objects give a column for each member.
function flatten(row: Record<string, unknown>, prefix: string, into: Record<string, Found>): void {
  for (const [key, value] of Object.entries(row)) {
    const name = (prefix ? `${prefix} ` : '') + key.replace(/_/g, ' ')
    if (value !== null && typeof value === 'object' && !Array.isArray(value)) {
      const { mean, sd } = value as { mean?: Cell; sd?: Cell }
      if (mean === undefined) flatten(value as Record<string, unknown>, name, into)
      else into[name] = typeof mean === 'number' && typeof sd === 'number' ? { mean, sd } : found(mean)
    } else if (!Array.isArray(value)) {
      into[name] = found(value as Cell)
    }
  }
}

// Throws an Error if it is no result of a campaign.
export function studyTable(document: unknown): StudyTable {
  const rows = (document as { rows?: unknown } | null)?.rows
  const isTable = Array.isArray(rows) && rows.length > 0 && rows.every((r) => r !== null && typeof r === 'object')
  if (!isTable) throw new Error('this is not what culprit study --json writes: it has no rows')
  const flat = rows.map((row) => {
    const cells: Record<string, Found> = {}
    flatten(row as Record<string, unknown>, '', cells)
    return cells
  })
  const columns = [...new Set(flat.flatMap((cells) => Object.keys(cells)))]
  const decimals = new Map(columns.map((c) => [c, decimalsOf(flat.map((cells) => cells[c]).filter(isSpread))]))
  const shown = (cell: Found | undefined, column: string): string => {
    if (!isSpread(cell)) return cell ?? ''
    const fixed = (value: number) => value.toFixed(decimals.get(column))
    return cell.sd === undefined ? fixed(cell.mean) : `${fixed(cell.mean)} ± ${fixed(cell.sd)}`
  }
  return { columns, rows: flat.map((cells) => Object.fromEntries(columns.map((c) => [c, shown(cells[c], c)]))) }
}
