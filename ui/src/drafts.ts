// Unsaved text, kept in this browser: it survives a reload, a crash and a stopped server.

export interface Draft {
  text: string
  base: { text: string; version: string } // the file that it was begun with
  at: number // ms since 1970
}

const key = (path: string) => `culprit-draft ${path}`

export function keepDraft(path: string, draft: Draft | null): void {
  if (draft) localStorage.setItem(key(path), JSON.stringify(draft))
  else localStorage.removeItem(key(path))
}

export function draftOf(path: string): Draft | null {
  try {
    return JSON.parse(localStorage.getItem(key(path)) ?? 'null')
  } catch {
    return null
  }
}
