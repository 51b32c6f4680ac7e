// The terms of culprit where they stand on the page: a tooltip for mouse, finger and keyboard, and a page of all of them. Their
// source is docs/glossary.md, as for `culprit explain TERM`.
import { signal } from '@preact/signals'
import type { ComponentChildren } from 'preact'
import { beginTour } from './tour'

declare const kGlossary: { section: string; name: string; meaning: string }[] // put in by bundle.mjs

const byWord = new Map(kGlossary.flatMap((term) => term.name.split(/[,()]/).map((word): [string, string] => [word.trim().toLowerCase(), term.meaning])))

const told = signal<{ text: string; left: number; top: number } | null>(null)
const kWide = 320 // pixels

function tell(meaning: string, at: Element): void {
  const { left, bottom } = at.getBoundingClientRect()
  told.value = { text: meaning, left: Math.max(8, Math.min(left, innerWidth - kWide - 8)), top: bottom + 6 }
}
const hide = () => void (told.value = null)

// `word`: the glossary's, if other words stand here.
export function Term({ word, children }: { word?: string; children: string }) {
  const meaning = byWord.get((word ?? children).toLowerCase())
  if (!meaning) return <>{children}</>
  const show = (e: { currentTarget: Element }) => tell(meaning, e.currentTarget)
  return (
    <button type="button" class="term" aria-description={meaning} onMouseEnter={show} onMouseLeave={hide} onFocus={show} onBlur={hide} onClick={show} onKeyDown={(e) => e.key === 'Escape' && hide()}>
      {children}
    </button>
  )
}

// Once on each page.
export function Meaning() {
  if (!told.value) return null
  const { text, left, top } = told.value
  return (
    <aside class="meaning" aria-label="Meaning" style={{ left: `${left}px`, top: `${top}px` }}>
      <p role="tooltip">{text}</p>
    </aside>
  )
}

function Section({ title, children }: { title: string; children: ComponentChildren }) {
  return (
    <section>
      <h2>{title}</h2>
      <dl class="glossary">{children}</dl>
    </section>
  )
}

export function HelpPage() {
  const sections = [...new Set(kGlossary.map((t) => t.section))]
  return (
    <main class="help">
      <p>
        <button type="button" onClick={beginTour}>
          Start the tour
        </button>{' '}
        <span class="muted">
          <code>culprit explain TERM</code> shows the same terms at a terminal.
        </span>
      </p>
      {sections.map((section) => (
        <Section title={section}>
          {kGlossary.filter((t) => t.section === section).map(({ name, meaning }) => [<dt>{name}</dt>, <dd>{meaning}</dd>])}
        </Section>
      ))}
    </main>
  )
}
