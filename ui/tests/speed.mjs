// How fast the page is: no test, for it depends on the machine. Prints figures; what is asked for stands behind them.
//
//     node speed.mjs <culprit> <node_modules> <folder>, with SUNSET's camera running in the DDS domain
import { writeFileSync } from 'node:fs'
import { file, session } from './session.mjs'

const kRules = `ROBOT one_camera
COMPONENT camera NODE /managed_subsystem/camera
RULE CameraGone
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY camera_restart 90 10
      ADAPTATION camera restart 5
`
writeFileSync(file('speed.rules'), kRules)
const quantile = (values, q) => [...values].sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(q * values.length))]
const tell = (what, value, asked) => console.log(`${what}: ${value.toFixed(1)} ms (asked for: ${asked})`)

// Also of a browser that has nothing in its cache: the server allows none.
async function firstPaint(page) {
  const paints = []
  for (let i = 0; i < 5; ++i) {
    await page.reload()
    await page.locator('.freshness.well').waitFor()
    paints.push(await page.evaluate(() => performance.getEntriesByName('first-contentful-paint')[0].startTime))
  }
  tell('first contentful paint, median of 5', quantile(paints, 0.5), '< 1000')
}

// From the click to the sentence on the page: the call, the manager's step, the stream and the drawing.
async function event(page) {
  const times = await page.evaluate(async () => {
    const list = document.querySelector('section.log')
    const button = () => document.querySelector('button.brake')
    const times = []
    for (let i = 0; i < 40; ++i) {
      const before = list.querySelectorAll('li').length
      const begin = performance.now()
      await new Promise((resolve) => {
        const watch = new MutationObserver(() => {
          if (list.querySelectorAll('li').length === before) return
          watch.disconnect()
          resolve()
        })
        watch.observe(list, { childList: true, subtree: true })
        button().click()
      })
      times.push(performance.now() - begin)
      await new Promise((resolve) => setTimeout(resolve, 300)) // until the button says the other word
    }
    return times
  })
  tell('an order, from the click to its event on the page, median of 40', quantile(times, 0.5), '< 100')
  tell('the same, p95', quantile(times, 0.95), '< 100')
}

// A robot of 500 nodes that tells its state 30 times a second, in place of the one of the server.
function largeRobot() {
  const kNodes = 500
  const names = Array.from({ length: kNodes }, (_, i) => `node_${i}`)
  const rules = names.map((name, i) => ({
    name: `Rule${i}`, criticality: 'ERROR', attempts: 3, components: [name], inputs: [],
    strategies: [{ name: 's', impact: 5, components: [name], prior: [5, 5], actions: [`restart ${name}`] }],
  }))
  const documents = {
    robot: { robot: 'large', cycle_s: 0.2, components: names.map((name) => ({ name, can_start: true })), topics: names.map((n) => `/${n}`), inputs: [], rules },
    graph: {
      nodes: names.map((name) => ({ node: `/${name}`, present: true, component: name })),
      edges: names.slice(1).map((name, i) => [`/${name}`, `/${names[Math.floor(i / 3)]}`, `/${names[Math.floor(i / 3)]}`]),
    },
    control: { paused: false, dry_run: false, hears: true, silences: [], asked: [] },
  }
  const state = (t) => ({
    t,
    clock: Date.now() / 1000,
    rules: names.map(() => ({ phase: 'quiet', trigger: false })),
    components: names.map((_, i) => ({ health: i === Math.floor(t * 30) % kNodes ? 'ERROR' : 'OK', present: true, alive: true })),
    topics: names.map((_, i) => ({ rate: 10 + ((t * 30 + i) % 7), age: 0.1 })),
    inputs: [], beliefs: names.map(() => [5, 5]), couplings: [],
  })
  const ofServer = window.fetch
  window.fetch = (path, ...rest) => {
    if (path !== '/api/stream') return ofServer(path, ...rest)
    const encoder = new TextEncoder()
    const body = new ReadableStream({
      start(stream) {
        const send = (kind, data) => stream.enqueue(encoder.encode(`event: ${kind}\ndata: ${JSON.stringify(data)}\n\n`))
        for (const [kind, data] of Object.entries(documents)) send(kind, data)
        let step = 0
        setInterval(() => {
          const t = ++step / 30
          send('state', state(t))
          const rule = `Rule${step % kNodes}`
          send('event', step % 2 ? { t, type: 'failure_detected', label: 'detected', severity: 'warning', tone: 'alarm', text: `${rule} detected`, rule, criticality: 'ERROR' } : { t, type: 'failure_resolved', label: 'resolved', severity: 'info', tone: 'relief', text: `${rule} resolved`, rule: `Rule${(step - 1) % kNodes}` })
        }, 1000 / 30)
      },
    })
    return Promise.resolve(new Response(body, { headers: { 'Content-Type': 'text/event-stream' } }))
  }
}

async function frames(page) {
  await page.addInitScript(largeRobot)
  const begin = Date.now()
  await page.reload()
  await page.getByRole('button', { name: 'node_499' }).waitFor()
  tell('500 nodes: until the page shows them', Date.now() - begin, 'no figure')
  await page.waitForTimeout(3000) // the layout
  const times = await page.evaluate(
    () =>
      new Promise((resolve) => {
        const times = []
        let last = performance.now()
        const end = last + 10_000
        const frame = (now) => {
          times.push(now - last)
          last = now
          if (now < end) requestAnimationFrame(frame)
          else resolve(times)
        }
        requestAnimationFrame(frame)
      })
  )
  console.log(`500 nodes, 30 updates a second: ${times.length / 10} frames a second in 10 s`)
  tell('  a frame, median', quantile(times, 0.5), 'fluid: < 33')
  tell('  a frame, p95', quantile(times, 0.95), 'fluid: < 50')
  tell('  a frame, longest', Math.max(...times), 'no figure')
}

await session(['run', file('speed.rules'), '--web', '--no-journal', '--settle', '1'], async (page) => {
  await firstPaint(page)
  await event(page)
  await frames(page)
})
