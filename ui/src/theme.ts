// The device, and the news that it has changed; and the colours of app.css for drawings on a canvas.
import { type ReadonlySignal, signal } from '@preact/signals'

export function isDevice(condition: string): ReadonlySignal<boolean> {
  const query = matchMedia(condition)
  const is = signal(query.matches)
  query.addEventListener('change', () => (is.value = query.matches))
  return is
}
export const isDark = isDevice('(prefers-color-scheme: dark)')

export function colour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim()
}

// Dark whatever the device prefers, until the function that is returned is called.
export function useDark(): () => void {
  const { style } = document.documentElement
  const set: string[] = []
  for (const sheet of document.styleSheets) {
    for (const rule of sheet.cssRules) {
      if (!(rule instanceof CSSMediaRule) || !rule.conditionText.includes('dark')) continue
      for (const own of rule.cssRules) {
        if (!(own instanceof CSSStyleRule) || own.selectorText !== ':root') continue
        for (const name of own.style) {
          style.setProperty(name, own.style.getPropertyValue(name))
          set.push(name)
        }
      }
    }
  }
  return () => set.forEach((name) => style.removeProperty(name))
}
