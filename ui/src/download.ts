// Files that the page offers for download.

const kRead = 60_000 // ms: Firefox reads the content after the click

export function download(name: string, content: BlobPart, type: string): void {
  const link = document.createElement('a')
  link.href = URL.createObjectURL(new Blob([content], { type }))
  link.download = name
  link.click()
  setTimeout(() => URL.revokeObjectURL(link.href), kRead)
}
