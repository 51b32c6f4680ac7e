// Whether all words of a page can be read: none is cut off, lies over another one or under something else, and the page is no
// wider than its window. What has to be scrolled to is no fault.
import { expectSoon } from './session.mjs'

// Runs in the page.
function faults() {
  const found = []
  for (const each of document.querySelectorAll('*')) if (each.scrollTop > 0) each.scrollTop = 0
  scrollTo(0, 0)
  if (document.documentElement.scrollWidth > innerWidth) found.push(`the page is ${document.documentElement.scrollWidth} pixels wide`)
  const meet = (a, b) => ({ left: Math.max(a.left, b.left), top: Math.max(a.top, b.top), right: Math.min(a.right, b.right), bottom: Math.min(a.bottom, b.bottom) })
  const isSome = ({ left, top, right, bottom }) => right - left > 2 && bottom - top > 2
  const styles = new Map()
  const styleOf = (element) => styles.get(element) ?? styles.set(element, getComputedStyle(element)).get(element)
  const isHidden = (kind) => kind === 'hidden' || kind === 'clip'
  // Marks of a timeline stand where their times are.
  const isForEyes = (element) => element.checkVisibility({ visibilityProperty: true, contentVisibilityAuto: true }) && !element.closest('option, datalist, noscript, style, script, .mark')
  // What one sees of a box within its scrolled ancestors; nothing: it is scrolled out, or only for screen readers.
  const seenOf = (box, element) => {
    let seen = box
    for (let a = element; a && a !== document.body; a = a.parentElement) {
      const { overflowX, overflowY, display } = styleOf(a)
      if (display === 'inline' || (overflowX === 'visible' && overflowY === 'visible')) continue
      const own = a.getBoundingClientRect()
      if (own.width <= 2 || own.height <= 2) return null
      const isCut = (isHidden(overflowX) && (seen.left < own.left - 1 || seen.right > own.right + 1)) || (isHidden(overflowY) && (seen.top < own.top - 3 || seen.bottom > own.bottom + 3))
      if (isCut && a.namespaceURI !== 'http://www.w3.org/2000/svg') return 'cut'
      seen = meet(seen, own)
      if (!isSome(seen)) return null
    }
    return seen
  }
  const words = []
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT)
  while (walker.nextNode()) {
    const node = walker.currentNode
    const element = node.parentElement
    const text = node.data.trim()
    if (!text || !isForEyes(element)) continue
    const range = document.createRange()
    range.selectNodeContents(node)
    for (const rect of range.getClientRects()) {
      const inset = rect.height * 0.18 // above and below the letters
      const box = { left: rect.left, right: rect.right, top: rect.top + inset, bottom: rect.bottom - inset }
      if (!isSome(box)) continue
      const seen = seenOf(box, element)
      if (seen === 'cut') found.push(`“${text}” is cut off`)
      else if (seen) words.push({ ...seen, text, element })
    }
  }
  words.sort((a, b) => a.top - b.top)
  words.forEach((a, i) => {
    for (let j = i + 1; j < words.length && words[j].top < a.bottom; ++j)
      if (isSome(meet(a, words[j]))) found.push(`“${a.text}” and “${words[j].text}” lie over each other`)
    const [x, y] = [(a.left + a.right) / 2, (a.top + a.bottom) / 2]
    if (x < 0 || y < 0 || x > innerWidth || y > innerHeight || styleOf(a.element).pointerEvents === 'none') return
    const top = document.elementFromPoint(x, y)
    if (top && !top.contains(a.element) && !a.element.contains(top) && !a.element.closest('button:disabled, label')?.contains(top)) found.push(`“${a.text}” lies under ${top.outerHTML.slice(0, 80)}`)
  })
  return [...new Set(found)]
}

// As soon as the page is drawn.
export async function isLaidOut(page, at) {
  let found = []
  const holds = async () => (found = await page.evaluate(faults)).length === 0
  await expectSoon(holds, '').catch(() => {
    throw new Error(`not everything can be read (${at}):\n${found.slice(0, 12).join('\n')}`)
  })
}
