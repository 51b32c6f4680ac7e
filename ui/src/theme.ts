// Colours of app.css for what is drawn on a canvas, and the news that they have changed.
import { signal } from '@preact/signals'

const query = matchMedia('(prefers-color-scheme: dark)')
export const isDark = signal(query.matches)
query.addEventListener('change', () => (isDark.value = query.matches))

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
