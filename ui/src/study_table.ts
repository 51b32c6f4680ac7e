// What a campaign found, as a table: whatever `culprit study --json` writes, rows of labels and of
// numbers with their spread.

type Cell = string | number | boolean | null
export interface StudyTable {
  columns: string[]
  rows: Record<string, string>[]
}

const rounded = (value: number) => (value === 0 ? '0' : Number(value.toPrecision(3)).toString())
const shown = (value: Cell): string => {
  if (value === null) return '–'
  if (typeof value === 'number') return Number.isInteger(value) ? String(value) : rounded(value)
  return value === true ? 'yes' : value === false ? 'no' : value
}

export interface StudyResult {
  study?: string
  campaign?: { seed: number; version: string; runs?: number; episodes?: number; scenario?: { seed: number } }
  scenarios?: string[] // run i has the one at i modulo their number
  rows: Record<string, unknown>[]
}

// What a row is of: whoever managed, and what was special about it.
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
function flatten(row: Record<string, unknown>, prefix: string, into: Record<string, string>): void {
  for (const [key, value] of Object.entries(row)) {
    const name = (prefix ? `${prefix} ` : '') + key.replace(/_/g, ' ')
    if (value !== null && typeof value === 'object' && !Array.isArray(value)) {
      const { mean, sd } = value as { mean?: Cell; sd?: Cell }
      if (mean === undefined) flatten(value as Record<string, unknown>, name, into)
      else into[name] = typeof mean === 'number' && typeof sd === 'number' ? `${rounded(mean)} ± ${rounded(sd)}` : shown(mean)
    } else if (!Array.isArray(value)) {
      into[name] = shown(value as Cell)
    }
  }
}

// Throws an Error if it is no result of a campaign.
export function studyTable(document: unknown): StudyTable {
  const rows = (document as { rows?: unknown } | null)?.rows
  const isTable = Array.isArray(rows) && rows.length > 0 && rows.every((r) => r !== null && typeof r === 'object')
  if (!isTable) throw new Error('this is not what culprit study --json writes: it has no rows')
  const flat = rows.map((row) => {
    const cells: Record<string, string> = {}
    flatten(row as Record<string, unknown>, '', cells)
    return cells
  })
  return { columns: [...new Set(flat.flatMap((cells) => Object.keys(cells)))], rows: flat }
}
