// The declarations in the form: components with their starters, signals, constants, dependencies, interlocks.
import { canAdd, type FieldKind, inWay, kDeclarations, makesSense, type Member, namesOf, placeFor, wayOf } from './declarations'
import { Check, Choice, Field, More, type Props, Remove } from './form_fields'
import { inTemplates, replaced, type Statement, withMember } from './rule_document'
import type { Take } from './rule_edits'

function MemberField({ document, change, place, member, facts }: Props & { place: number; member: string; facts: Member }) {
  const label = facts.label ?? member
  const props = { document, change, place, member, label }
  if (facts.kind === 'flag') return <Check {...props} />
  if (facts.of) {
    const take = (chosen: string) => void change((d) => withMember(d, place, member, chosen === kNone ? undefined : chosen))
    const all = facts.begins === undefined ? facts.of : [...facts.of, kNone]
    return <Choice label={label} value={String(document.statements[place][member])} of={all} take={take} />
  }
  return <Field key={member} {...props} kind={facts.kind as FieldKind | undefined} optional={facts.begins !== undefined} wider={facts.wide} list={facts.list} />
}
const kNone = '(not said)'

// A node that is called as its component goes on to be.
const withNode =
  (change: Take): Take =>
  (edit) =>
    change((d) => {
      const changed = edit(d)
      const place = d.statements.findIndex((s, i) => s !== changed.statements[i])
      const [before, after] = [d.statements[place], changed.statements[place]]
      const isRenamed = before?.statement === 'COMPONENT' && after?.statement === 'COMPONENT' && before.name !== after.name
      return isRenamed && before.node === `/${before.name}` ? withMember(changed, place, 'node', `/${after.name}`) : changed
    })

export function DeclarationForm({ document, change: plainly, place }: Props & { place: number }) {
  const change = withNode(plainly)
  const statement = document.statements[place]
  const declaration = kDeclarations[statement.statement]
  const { title, members, ways } = declaration
  const has = (member: string) => statement[member] !== undefined
  const label = `${title} ${statement.name ?? statement.consumer ?? ''}`.trim()
  const more = Object.keys(members).filter((m) => members[m].begins !== undefined && !has(m) && makesSense(members[m], statement))
  return (
    <div class="adaptation" role="group" aria-label={label}>
      <b class="keyword">{title}</b>
      <MemberFields names={Object.keys(members).filter((m) => has(m) && (m === 'name' || !ways))} {...{ document, change, place, members }} />
      {ways && (
        <Choice
          label={ways.label}
          value={wayOf(ways.all, statement).words}
          of={ways.all.map((w) => w.words)}
          take={(words) => void change((d) => replaced(d, place, 1, inWay(declaration, d.statements[place], words)))}
        />
      )}
      {ways && <MemberFields names={Object.keys(members).filter((m) => has(m) && m !== 'name' && m !== 'respawned')} {...{ document, change, place, members }} />}
      <More words="say more" of={more} add={(member) => void change((d) => withMember(d, place, member, members[member].begins))} />
      <Remove what={label} onClick={() => change((d) => replaced(d, place, 1))} />
    </div>
  )
}

function MemberFields({ names, members, ...props }: Props & { place: number; names: string[]; members: Record<string, Member> }) {
  return (
    <>
      {names.map((member) => (
        <MemberField key={member} {...props} member={member} facts={members[member]} />
      ))}
    </>
  )
}

export function Declarations({ document, change }: Props) {
  const isInTemplate = inTemplates(document)
  const places = document.statements.flatMap((s, place) => (kDeclarations[s.statement] && !isInTemplate[place] ? [place] : []))
  const add = (keyword: string) =>
    change((d) => {
      const fresh: Statement = { statement: keyword, ...kDeclarations[keyword].fresh(d) }
      return replaced(d, placeFor(d, keyword), 0, fresh)
    })
  return (
    <details class="rule declarations">
      <summary>Declared components: {namesOf(document, 'COMPONENT').join(', ') || 'none'}</summary>
      {places.map((place) => (
        <DeclarationForm key={place} {...{ document, change, place }} />
      ))}
      <div class="bar">
        {Object.entries(kDeclarations)
          .filter(([keyword]) => canAdd(document, keyword))
          .map(([keyword, { title }]) => (
            <button type="button" onClick={() => void add(keyword)}>
              + {title}
            </button>
          ))}
      </div>
    </details>
  )
}
