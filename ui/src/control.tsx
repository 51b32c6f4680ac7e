// Orders of people to the manager: pause, resume, mute, run a strategy. Each is one call (POST /api/orders); its
// result is an event.
import { useState } from 'preact/hooks'
import { lasting, when } from './clock'
import { Author, order, canOrder } from './order'
import { can, clockAt, control, now, robot } from './store'

// Strategies that wait for a person's word: in front of all else.
export function Approvals() {
  const asked = control.value?.asked ?? []
  const rules = new Map(robot.value?.rules.map((r) => [r.name, r]) ?? [])
  return (
    <>
      {asked.map(({ rule, strategy }) => {
        const actions = rules.get(rule)?.strategies.find((s) => s.name === strategy)?.actions ?? []
        return (
          <section class="approval" role="alert" aria-label={`Approve ${strategy}?`}>
            <h2>? May culprit do this?</h2>
            <p>
              <b>{strategy}</b> against {rule}: {actions.join(', ')}
            </p>
            <div class="bar">
              <button
                type="button"
                class="primary"
                disabled={!canOrder()}
                onClick={() => void order(`Approving ${strategy}`, { order: 'approve', rule, strategy })}
              >
                Approve
              </button>
              <button
                type="button"
                disabled={!canOrder()}
                onClick={() => void order(`Refusing ${strategy}`, { order: 'refuse', rule, strategy })}
              >
                Refuse
              </button>
            </div>
          </section>
        )
      })}
    </>
  )
}

function Mutes() {
  const [what, choose] = useState('')
  const [minutes, setMinutes] = useState('10')
  const [reason, setReason] = useState('')
  const subject = (chosen: string) => {
    const [kind, name] = [chosen.slice(0, chosen.indexOf(' ')), chosen.slice(chosen.indexOf(' ') + 1)]
    return { [kind]: name }
  }
  const options = [
    ...(robot.value?.components ?? []).map((c) => `component ${c.name}`),
    ...(robot.value?.rules ?? []).map((r) => `rule ${r.name}`),
  ]
  const chosen = what || options[0] || ''
  return (
    <form
      onSubmit={(e) => {
        e.preventDefault()
        void order(`Muting ${chosen}`, {
          order: 'silence',
          ...subject(chosen),
          seconds: Number(minutes) * 60,
          reason,
        })
      }}
    >
      <h3>Mute a component or a rule</h3>
      <div class="row">
        <label class="field wider">
          <span>what</span>
          <select value={chosen} onChange={(e) => choose(e.currentTarget.value)}>
            {options.map((o) => (
              <option>{o}</option>
            ))}
          </select>
        </label>
        <label class="field short">
          <span>minutes</span>
          <input
            type="number"
            min="0.1"
            max="10000"
            step="any"
            required
            value={minutes}
            onInput={(e) => setMinutes(e.currentTarget.value)}
          />
        </label>
        <label class="field">
          <span>why</span>
          <input value={reason} maxLength={200} onInput={(e) => setReason(e.currentTarget.value)} />
        </label>
        <button type="submit" disabled={!canOrder()}>
          Mute
        </button>
      </div>
      <ul>
        {(control.value?.silences ?? []).map((s) => {
          const kind = s.component ? 'component' : 'rule'
          const name = s.component ?? s.rule
          return (
            <li class="bar">
              <span>
                <b>{name}</b> is muted by {s.author}
                {s.until !== null && ` until ${when(clockAt(s.until))}, ${lasting(s.until - now.value)} more`}
                {s.reason && `: ${s.reason}`}
              </span>
              <button
                type="button"
                aria-label={`Unmute ${name}`}
                disabled={!canOrder()}
                onClick={() => void order(`Unmuting ${name}`, { order: 'lift', [kind]: name })}
              >
                Unmute
              </button>
            </li>
          )
        })}
      </ul>
    </form>
  )
}

function ByHand() {
  const all = (robot.value?.rules ?? []).flatMap((r) =>
    r.strategies.map((s) => ({ rule: r.name, strategy: s.name, actions: s.actions }))
  )
  const [place, choose] = useState(0)
  const chosen = all[place]
  if (!chosen) return null
  return (
    <form
      onSubmit={(e) => {
        e.preventDefault()
        const { rule, strategy } = chosen
        void order(`Running ${strategy}`, { order: 'run', rule, strategy })
      }}
    >
      <h3>Run a strategy now</h3>
      <div class="row">
        <label class="field">
          <span>strategy</span>
          <select value={String(place)} onChange={(e) => choose(Number(e.currentTarget.value))}>
            {all.map((s, i) => (
              <option value={String(i)}>
                {s.rule}.{s.strategy}
              </option>
            ))}
          </select>
        </label>
        <button type="submit" disabled={!canOrder()}>
          Run
        </button>
      </div>
      <p class="muted">{chosen.actions.join(', ')}</p>
    </form>
  )
}

export function Control() {
  if (!can('post', '/api/orders') || !control.value) return null
  return (
    <section class="control" aria-label="Control">
      <label>
        <input
          type="checkbox"
          disabled={!canOrder()}
          checked={control.value.dry_run}
          onChange={(e) => {
            const on = e.currentTarget.checked
            void order(on ? 'Dry run' : 'Acting again', { order: 'dry_run', on })
          }}
        />{' '}
        dry run: report decisions, change nothing
      </label>
      <details>
        <summary>More control</summary>
        <Author />
        <Mutes />
        <ByHand />
      </details>
    </section>
  )
}
