// The robot of the stub: five components of a camera's pipeline, and the states that an operator may find it in.

const kComponents = ['camera', 'depth', 'image_enhancement', 'fusion', 'segmentation']
const kTopics = ['/rgb', '/depth', '/rgb_enhanced', '/fused', '/segments']
const strategy = (name, components, actions, impact) => ({ name, impact, components, prior: [9, 1], actions })
const kRules = [
  { name: 'RGBDead', criticality: 'ERROR', attempts: 3, components: ['camera'], inputs: [0], strategies: [
    strategy('rgb_restart', ['camera'], ['restart camera'], 5), strategy('rgb_redeploy', ['camera'], ['redeploy camera'], 10)] },
  { name: 'FusionSilent', criticality: 'ERROR', attempts: 3, components: ['fusion'], inputs: [1], strategies: [
    strategy('fusion_restart', ['fusion'], ['restart fusion'], 5)] },
  { name: 'SegmentationBad', criticality: 'WARNING', attempts: 3, components: ['segmentation'], inputs: [2], strategies: [
    strategy('recalibration', ['segmentation'], ['set recalibration of segmentation to true'], 2)] },
]

export const kRobot = {
  robot: 'rover', cycle_s: 0.2,
  components: kComponents.map((name) => ({ name, can_start: true, node: `/${name}`, owner: 'culprit, by its LAUNCH command' })),
  topics: kTopics, inputs: ['alive(camera)', 'age(/fused)', 'segmentation_entropy', 'rate(/depth, 2s)'], thresholds: [[], [0.5], [0.06], [7]], rules: kRules,
}
export const kGraph = {
  nodes: [
    ...kComponents.map((component) => ({ node: `/${component}`, present: true, component })),
    { node: '/rviz', present: true }, { node: '/recorder', present: true },
  ],
  edges: [
    ['/image_enhancement', '/camera', '/rgb'], ['/fusion', '/camera', '/rgb'], ['/fusion', '/depth', '/depth'],
    ['/fusion', '/image_enhancement', '/rgb_enhanced'], ['/segmentation', '/fusion', '/fused'],
    ['/rviz', '/segmentation', '/segments'], ['/recorder', '/camera', '/rgb'],
  ],
}
export const kControl = { paused: false, dry_run: false, hears: true, silences: [], asked: [] }

// At 14:03:22 something broke; 12 s later one looks. Clocks of the tests show UTC (session.mjs).
export const kToday = new Date('2026-11-21T14:03:34Z')
const kBroken = 770
export const kBegan = kToday.getTime() / 1000 - 12 - kBroken // when culprit began to watch

// How the robot and its components look is culprit's to say: the stub says what the real one would.
const kWell = { look: 'OK', headline: 'all is well', detail: 'no failure is seen by 3 rules' }
const healthOf = (name, rules) => {
  const rule = kRules.find((r) => r.components.includes(name) && (rules[r.name]?.phase ?? 'quiet') !== 'quiet')
  return rule ? (rules[rule.name].phase === 'exhausted' ? 'EXHAUSTED' : rule.criticality) : 'OK'
}
function lookOf(name, dead, rules, isDeaf) {
  const about = kRules.filter((r) => r.components.includes(name))
  const health = healthOf(name, rules)
  if (health !== 'OK') return { health, look: health, condition: name === dead ? 'down' : '' }
  if (about.length === 0) return { health, look: 'UNWATCHED', condition: 'no rule' }
  return isDeaf || about.every((r) => rules[r.name]?.blind) ? { health, look: 'BLIND', condition: 'blind' } : { health, look: 'OK', condition: '' }
}
export const state = (t, { dead = null, incidents = [], overview = null, held = {}, ...rules } = {}) => ({
  t, clock: kBegan + t, incidents,
  overview: overview ?? (incidents.length > 0 ? { look: incidents[0].health, headline: incidents[0].headline, detail: incidents[0].doing } : kWell),
  rules: kRules.map(({ name }) => ({ phase: 'quiet', trigger: false, ...rules[name] })),
  components: kComponents.map((name) => ({
    ...lookOf(name, dead, rules, overview?.look === 'DEAF'), present: name !== dead, alive: name !== dead, process: name === dead ? 'gone' : 'running', lifecycle: 'active', ...held[name] })),
  topics: kTopics.map((_, i) => ({ rate: 10 + i, age: dead && i !== 1 ? t - kBroken : 0.05 })),
  inputs: [!dead, 0.1, 0.04, 11], beliefs: kRules.flatMap((r) => r.strategies.map((s) => s.prior)), priors: kRules.flatMap((r) => r.strategies.map((s) => s.prior)),
})

const event = (t, type, label, severity, tone, text, more) => ({ t, clock: kBegan + t, type, label, severity, tone, text, ...more })
const evidence = (source, text, age, log_odds) => ({ source, text, age_ns: age * 1e9, log_odds })
const kSuspects = [
  { component: 'camera', failure: 'RGBDead', probability: 0.97, evidence: [evidence('kernel', 'camera exited', 0.02, 5.1), evidence('alarm', 'RGBDead fires', 0.01, 1.2)] },
  { component: 'fusion', failure: 'FusionSilent', probability: 0.03, evidence: [evidence('measured', 'fusion answered', 0.004, -2.3)] },
]
// As above, where the decision hinges on one piece of evidence, a wait has an end, and a supplier was asked.
const kAnswered = evidence('answer', 'depth answered', 0.02, 0)
const withAnswer = (suspects) => suspects.map((each, place) => (place === 0 ? { ...each, evidence: [...each.evidence, kAnswered] } : each))
const kEnd = 'if camera does not answer within 0.60 s, camera is held responsible'
const ending = (candidates) => candidates?.map((each) => (each.excluded ? { ...each, excluded: { ...each.excluded, ends: kEnd } } : each))
export const hinging = (state) => ({ ...state, events: state.events.map((e) => (e.suspects ? { ...e, candidates: ending(e.candidates), suspects: withAnswer(kSuspects.map((s) => ({ ...s, evidence: s.evidence.map((each) => (each.text === 'camera exited' ? { ...each, without: 'fusion' } : each)) }))) } : e)) })
const because = (failure) => ({ condition: 'dependency', component: 'camera', failure, text: `camera may be the cause, by ${failure}` })
const candidate = (name, excluded = null) => ({ strategy: name, impact: 5, cost: excluded ? 0 : 0.55, value: 0.9, resolves: 0.9, excluded })
const kAll = [candidate('rgb_restart', { condition: 'tried', text: 'it was tried already' }), candidate('rgb_redeploy')]
const detected = (t, rule, criticality) => event(t, 'failure_detected', 'detected', criticality === 'ERROR' ? 'error' : 'warning', 'alarm', `${rule} detected`, { rule, criticality })
const waits = (t, rule, name) => event(t, 'failure_held_back', 'waits', 'info', 'aside', `${rule} waits: it depends on camera, which may be the cause of RGBDead`, { rule, candidates: [candidate(name, because('RGBDead'))], suspects: kSuspects })

const kCause = { id: 'mywpiwzf-0k7', headline: 'camera is down', health: 'ERROR', since: kBroken + 0.01, rule: 'RGBDead', components: ['camera'], certain: true, host: null,
  consequences: ['FusionSilent', 'SegmentationBad'], needs_person: false }
const cause = (doing, next = '', more = {}) => [{ ...kCause, doing, next, ...more }]
const incidentTold = (t, type, { health, doing, next, since, id, ...more } = kCause) => event(t, type, 'incident', 'info', 'aside', '', { incident: id, criticality: health, age_ns: (t - since) * 1e9, ...more })

// The camera died, and two others suffer from it.
const kCameraDead = [
  event(1, 'component_found', 'found', 'info', 'aside', 'camera is there (process 12)', { component: 'camera' }),
  event(kBroken, 'component_lost', 'lost', 'warning', 'warning', 'camera is gone: killed by signal 9', { component: 'camera', remark: 'killed by signal 9' }),
  detected(kBroken + 0.01, 'RGBDead', 'ERROR'),
  detected(kBroken + 0.4, 'FusionSilent', 'ERROR'),
  waits(kBroken + 0.41, 'FusionSilent', 'fusion_restart'),
  detected(kBroken + 0.9, 'SegmentationBad', 'WARNING'),
  waits(kBroken + 0.91, 'SegmentationBad', 'recalibration'),
  incidentTold(kBroken + 0.92, 'incident_opened'),
]
const reasons = { rule: 'RGBDead', strategy: 'rgb_redeploy', components: ['camera'], candidates: kAll, suspects: kSuspects }
const chosen = (dry_run) => event(kBroken + 0.02, 'strategy_chosen', 'decided', 'warning', 'action', 'camera is held responsible for RGBDead: redeploy camera', { ...reasons, explains: ['FusionSilent', 'SegmentationBad'], actions: ['redeploy camera'], dry_run })
const heldBack = (reason) => event(kBroken + 0.02, 'action_held_back', 'held back', 'warning', 'warning', `RGBDead.rgb_redeploy is held back: ${reason}`, { rule: 'RGBDead', strategy: 'rgb_redeploy', components: ['camera'], reason })
const heldBackWithReasons = event(kBroken + 0.03, 'failure_held_back', 'waits', 'info', 'aside', '', { rule: 'RGBDead', candidates: [kAll[0], candidate('rgb_redeploy', { condition: 'withheld', text: 'paused by a person' })], suspects: kSuspects })

const failing = { phase: 'failing', since: kBroken + 0.01, attempts: 1 }
const kSuffering = { dead: 'camera', FusionSilent: { phase: 'failing', since: kBroken + 0.4, attempts: 0 }, SegmentationBad: { phase: 'failing', since: kBroken + 0.9, attempts: 0 } }
const kAttempting = { phase: 'attempting', since: kBroken + 0.01, attempts: 1, attempt: { strategy: 'rgb_redeploy', stage: 'adapting', chosen: kBroken + 0.02, deadline: kBroken + 9 } }

const kMinor = { ...kCause, id: 'mywpiwzf-1aa', headline: 'SegmentationBad fails', health: 'WARNING', since: kBroken, rule: 'SegmentationBad', components: ['segmentation'], certain: false, consequences: [], doing: 'nothing is done yet', next: '' }

// The messages of each state, and the words that an operator must read at once: cause, level, mode.
export const kStates = {
  well: { events: [], control: {}, state: {}, cause: 'All is well', level: 'Well', mode: 'Acting' },
  ill: { events: [...kCameraDead, chosen(false)], control: {}, state: { ...kSuffering, RGBDead: kAttempting, incidents: cause('being repaired: redeploy camera', 'rgb_redeploy is being carried out') },
    cause: 'camera is down', level: 'Error', mode: 'Acting', also: ['since 14:03:22', 'being repaired: redeploy camera'] },
  paused: { events: [...kCameraDead, heldBack('paused by a person'), heldBackWithReasons], control: { paused: true }, state: { ...kSuffering, RGBDead: failing, incidents: cause('nothing is done: culprit is paused') },
    cause: 'camera is down', level: 'Error', mode: 'Paused', also: ['since 14:03:22', 'nothing is done'] },
  muted: { events: [...kCameraDead, heldBack('camera is muted by ada: the lens is cleaned')], control: { silences: [{ component: 'camera', until: kBroken + 600, author: 'ada', reason: 'the lens is cleaned' }] }, state: { ...kSuffering, RGBDead: failing, incidents: cause('not repaired: camera is muted by ada: the lens is cleaned') },
    cause: 'camera is down', level: 'Error', mode: 'Muted', also: ['since 14:03:22', 'muted by ada'] },
  'dry-run': { events: [...kCameraDead, chosen(true)], control: { dry_run: true }, state: { ...kSuffering, RGBDead: failing, incidents: cause('would be repaired: redeploy camera') },
    cause: 'camera is down', level: 'Error', mode: 'Dry run', also: ['would be repaired: redeploy camera'] },
  approval: { events: [...kCameraDead, event(kBroken + 0.02, 'approval_asked', 'asks', 'warning', 'person', 'RGBDead.rgb_redeploy waits for approval: redeploy camera', reasons)],
    control: { asked: [{ rule: 'RGBDead', strategy: 'rgb_redeploy' }] }, state: { ...kSuffering, RGBDead: failing, incidents: cause('waits for approval: redeploy camera', '', { needs_person: true }) },
    cause: 'camera is down', level: 'Error', mode: 'Approval', also: ['waits for approval: redeploy camera'] },
  warning: { events: [detected(kBroken, 'SegmentationBad', 'WARNING')], control: {}, state: { SegmentationBad: { phase: 'failing', since: kBroken, attempts: 0 }, incidents: [kMinor] },
    cause: 'SegmentationBad fails', level: 'Warning', mode: 'Acting', also: ['since 14:03:22'] },
  exhausted: { events: [...kCameraDead, chosen(false), event(kBroken + 5, 'rule_exhausted', 'exhausted', 'error', 'alarm', 'RGBDead is exhausted', { rule: 'RGBDead' })], control: {}, state: { ...kSuffering, RGBDead: { ...failing, phase: 'exhausted' }, incidents: cause('nothing helped', 'nothing more is tried: a person must look', { health: 'EXHAUSTED', needs_person: true }) },
    cause: 'camera is down', level: 'Exhausted', mode: 'Acting', also: ['nothing helped'] },
  deaf: { events: [], control: { hears: false }, state: { overview: { look: 'DEAF', headline: "culprit does not receive the robot's messages", detail: 'nothing is judged, and nothing is done' } }, cause: "Culprit does not receive the robot's messages", level: 'Unknown', mode: 'Deaf' },
}
// A person paused culprit after a strategy that did not help: the suspects are those of now.
export const kPausedLater = { ...kStates.paused, events: [...kCameraDead, chosen(false),
  event(kBroken + 5, 'strategy_failed', 'no help', 'warning', 'warning', 'rgb_redeploy did not help', { rule: 'RGBDead', strategy: 'rgb_redeploy' }),
  { ...heldBack('paused by a person'), t: kBroken + 6, clock: kBegan + kBroken + 6, candidates: [candidate('rgb_redeploy')], suspects: [{ ...kSuspects[0], evidence: [evidence('measured', 'camera hangs', 2, 3.1)] }] }] }
// It is over: 3 s later all of it was well. Names are only text.
const kHealing = [...kCameraDead, chosen(false), ...kRules.map(({ name }) => event(kBroken + 3.01, 'failure_resolved', 'resolved', 'info', 'relief', `${name} resolved <b>rover</b>`, { rule: name, strategy: name === 'RGBDead' ? 'rgb_redeploy' : null, reaction_s: 3 })), event(kBroken + 3.01, 'incident_closed', 'incident', 'info', 'aside', '', { incident: kCause.id, rule: 'RGBDead', how: 'resolved' })]
export const kHealed = { events: kHealing, control: {}, state: {} }

// The journal's incidents of it, and of a day before.
const idOf = (clock) => Math.round(clock * 1000).toString(36)
export const incidentAt = (clock, more) => ({ id: idOf(clock), first: 10, last: 20, clock, seconds: 3, over: true, cut: false, given_up: false, worst: 'ERROR',
  causes: ['camera'], rules: ['RGBDead', 'FusionSilent', 'SegmentationBad'], consequences: ['FusionSilent', 'SegmentationBad'], helped: ['rgb_redeploy'], ...more })
const kBrokenAt = kBegan + kBroken
const kRecording = 'rover_20261125T140322.042Z_FusionSilent.mcap'
export const kIncidents = [
  incidentAt(kBrokenAt + 0.01, {}),
  ...Array.from({ length: 9 }, (_, n) => 8 - n).map((i) => incidentAt(kBrokenAt - 80_000 + i * 8000, { first: 4, last: 4, seconds: 2 + i, worst: i % 2 ? 'WARNING' : 'ERROR', causes: [i % 3 ? 'segmentation' : 'camera'], rules: ['SegmentationBad'], consequences: [], helped: ['recalibration'] })),
  incidentAt(kBrokenAt - 86_000, { first: 1, last: 3, seconds: 7200, causes: ['fusion'], rules: ['FusionSilent'], consequences: [], helped: [], given_up: true, recordings: [{ name: kRecording, path: `/var/lib/culprit/recordings/${kRecording}`, bytes: 1_200_000 }] }),
]
export const kIncidentEvents = hinging(kHealed).events.filter((e) => e.t >= kBroken).sort((a, b) => a.t - b.t).map((e) => ({ ...e, t: e.clock }))
export const kNow = kBroken + 12

// A rule whose trigger has no value says nothing, and that is not health.
const blind = (text) => ({ trigger: null, blind: { since: kBroken, why: 'never_seen', input: 'entropy', text } })
const kEntropy = "signal entropy was never seen; did you mean 'segmentation_entropy'?"
export const kBlindStates = {
  blind: { events: [], control: {}, state: { SegmentationBad: blind(kEntropy), overview: { look: 'BLIND', headline: 'no failure is seen, but SegmentationBad is blind', detail: kEntropy } }, cause: 'SegmentationBad is blind', level: 'Blind', mode: 'Acting', also: ['signal entropy was never seen'] },
  'watching-nothing': { events: [], control: {}, state: { ...Object.fromEntries(kRules.map(({ name }) => [name, blind(kEntropy)])), overview: { look: 'WATCHING_NOTHING', headline: 'watching nothing: no rule can see', detail: kEntropy } }, cause: 'Watching nothing', level: 'Unknown', mode: 'Acting', also: ['signal entropy was never seen'] },
}

// The same with the event that began it, for an earlier moment.
export const kBlindLongAgo = { ...kBlindStates.blind, events: [event(kBroken, 'rule_blind', 'BLIND', 'warning', 'warning', `SegmentationBad is blind: ${kEntropy}`, { rule: 'SegmentationBad' })] }

// The simulation is paused, and with it the time of two nodes.
const held = { health: 'OK', look: 'TIME_HELD', condition: 'clock paused' }
export const kHeld = { events: [], control: {}, state: { held: { camera: held, depth: held }, overview: { look: 'TIME_HELD', headline: 'the simulated time of camera and depth stands still', detail: '/clock is paused: nothing is judged about them' } },
  cause: 'The simulated time of camera and depth stands still', level: 'On hold', mode: 'Acting', also: ['/clock is paused'] }

// No rule reads what this component does, and it was never seen: no failure is seen, and the component is not well.
const neverSeen = { health: 'OK', look: 'NEVER_SEEN', condition: 'never seen', present: false, alive: null, process: undefined, lifecycle: undefined }
export const kNeverSeen = { events: [], control: {}, state: { held: { image_enhancement: neverSeen }, overview: { look: 'NEVER_SEEN', headline: 'image_enhancement was never seen', detail: 'no failure is seen; was it started, and is its NODE right?' } },
  graph: { ...kGraph, nodes: kGraph.nodes.map((each) => (each.component === 'image_enhancement' ? { ...each, present: false } : each)) },
  cause: 'image_enhancement was never seen', level: 'Never seen', mode: 'Acting', also: ['was it started'] }

// Events forgotten long ago: the failure itself is not.
export const kForgotten = { events: [], control: {}, state: { RGBDead: failing, incidents: [{ ...kCause, headline: 'RGBDead fails', components: [], certain: false, consequences: [], doing: 'nothing is done yet', next: '' }] }, cause: 'RGBDead fails', level: 'Error', mode: 'Acting' }

export function play(server, { events, control, state: rules, graph = kGraph }, t = kNow) {
  server.tell('robot', kRobot)
  server.tell('graph', graph)
  server.tell('control', { ...kControl, ...control })
  for (const each of [...events].sort((a, b) => a.t - b.t)) server.tell('event', each)
  server.tell('state', state(t, rules))
}
