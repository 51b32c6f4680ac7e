// A robot of many nodes in 20 namespaces: data flows from each namespace to the next ones.
const kSpaces = 20

export function largeRobot(count) {
  const spaceOf = (i) => `/area_${String(Math.floor(i / (count / kSpaces))).padStart(2, '0')}`
  const names = Array.from({ length: count }, (_, i) => `node_${i}`)
  const full = (i) => `${spaceOf(i)}/${names[i]}`
  const rules = names.map((name, i) => ({
    name: `Rule${i}`, criticality: 'ERROR', attempts: 3, components: [name], inputs: [],
    strategies: [{ name: 's', impact: 5, components: [name], prior: [5, 5], actions: [`restart ${name}`] }],
  }))
  const documents = {
    robot: {
      robot: 'large', cycle_s: 0.2, inputs: [], rules, topics: names.map((n) => `/${n}`),
      components: names.map((name, i) => ({ name, can_start: true, ...(i % 5 ? {} : { host: `rover${i % 3}` }), ...(i % 7 ? {} : { container: `/container_${i % 4}` }) })),
    },
    graph: {
      nodes: names.map((name, i) => ({ node: full(i), present: true, component: name })),
      edges: names.slice(1).map((name, i) => [full(i + 1), full(Math.floor(i / 3)), `/${names[Math.floor(i / 3)]}`]),
    },
    control: { paused: false, dry_run: false, hears: true, silences: [], asked: [] },
  }
  // One of them fails, another one 30 times a second.
  const stateAt = (t, clock = Date.now() / 1000) => {
    const ill = Math.floor(t * 30) % count
    const isIll = (i) => i === ill
    const incident = {
      id: 'mywpiwzf-0k7', headline: `${names[ill]} is suspected`, health: 'ERROR', since: 0, rule: `Rule${ill}`, components: [names[ill]], certain: false, host: null,
      consequences: [], needs_person: false, doing: 'nothing is done yet', next: '',
    }
    return {
      t, clock, incidents: [incident], overview: { look: 'ERROR', headline: incident.headline, detail: incident.doing },
      rules: names.map((_, i) => (isIll(i) ? { phase: 'failing', trigger: true, since: 0, attempts: 0 } : { phase: 'quiet', trigger: false })),
      components: names.map((_, i) => ({ health: isIll(i) ? 'ERROR' : 'OK', look: isIll(i) ? 'ERROR' : 'OK', condition: '', present: true, alive: true })),
      topics: names.map((_, i) => ({ rate: 10 + ((t * 30 + i) % 7), age: 0.1 })),
      inputs: [], beliefs: names.map(() => [5, 5]), priors: names.map(() => [5, 5]),
    }
  }
  return { documents, stateAt }
}
