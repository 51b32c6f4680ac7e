// Colours of app.css for what is drawn on a canvas, and the news that they have changed.
import { signal } from '@preact/signals'

const query = matchMedia('(prefers-color-scheme: dark)')
export const isDark = signal(query.matches)
query.addEventListener('change', () => (isDark.value = query.matches))

export function colour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim()
}
