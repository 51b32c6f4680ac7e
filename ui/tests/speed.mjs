// How fast the page is: no test, for it depends on the machine. Prints what was measured beside what is asked for, and fails
// if that is missed, as make bench does.
//
//     node speed.mjs <culprit> <node_modules> <folder> [<journal of a day>]
//
// with SUNSET's camera running in the DDS domain and sunset-node in PATH. culprit-bench-day (bench/day_main.cpp) writes the journal.
import { cpSync, writeFileSync } from 'node:fs'
import { dirname, join } from 'node:path'
import { fileURLToPath } from 'node:url'
import { largeRobot } from './large_robot.mjs'
import { expect, file, session, stubbed, suite } from './session.mjs'

const kSunset = join(dirname(fileURLToPath(import.meta.url)), '../../rules/sunset.rules')
const kRules = `ROBOT one_camera
COMPONENT camera NODE /managed_subsystem/camera LAUNCH "sunset-node camera"
RULE CameraGone
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY camera_redeploy 90 10
      ADAPTATION camera redeploy 5
`
writeFileSync(file('speed.rules'), kRules)
const quantile = (values, q) => [...values].sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(q * values.length))]
let missed = 0
function tell(what, value, most = Infinity) {
  if (value > most) ++missed
  const asked = most === Infinity ? '' : value > most ? `MISSED, at most ${most} ms` : `at most ${most} ms`
  console.log(`${what}: ${value.toFixed(1)} ms  ${asked}`)
}

// Also of a browser that has nothing in its cache: the server allows none.
async function firstPaint(page) {
  const paints = []
  for (let i = 0; i < 5; ++i) {
    await page.reload()
    await page.locator('.freshness.well').waitFor()
    paints.push(await page.evaluate(() => performance.getEntriesByName('first-contentful-paint')[0].startTime))
  }
  tell('first contentful paint, median of 5', quantile(paints, 0.5), 1000)
}

// From the click to the sentence on the page: the call, the manager's step, the stream and the drawing.
async function event(page) {
  const times = await page.evaluate(async () => {
    const list = document.querySelector('section.log')
    const button = () => document.querySelector('button.brake')
    const times = []
    for (let i = 0; i < 40; ++i) {
      const before = list.querySelectorAll('li').length
      const said = button().title
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
      // Until the button says the other word, and can be pressed.
      while (button().title === said || button().disabled) await new Promise((resolve) => setTimeout(resolve, 20))
    }
    return times
  })
  tell('an order, from the click to its event on the page, median of 40', quantile(times, 0.5), 100)
  tell('the same, p95', quantile(times, 0.95), 100)
}

// From the kill to the cause's name on the page, and how much of it is beyond the detection: the event says when that was,
// by the same clock, to 10 ms.
async function cause(page, program) {
  const beyond = []
  const whole = []
  const bar = page.getByRole('region', { name: 'Status' })
  for (let i = 0; i < 10; ++i) {
    await bar.getByText('All is well').waitFor()
    const pid = Number([...program.said().matchAll(/camera is there \(process (\d+)/g)].at(-1)[1])
    const read = page.evaluate(
      () =>
        new Promise((resolve) => {
          const cause = document.querySelector('.status-bar .cause')
          const watch = new MutationObserver(() => {
            if (!cause.textContent.includes('camera')) return
            watch.disconnect()
            // Drawn is what is on the screen after the next frame.
            requestAnimationFrame(() => requestAnimationFrame(() => resolve(Date.now())))
          })
          watch.observe(cause, { childList: true, subtree: true, characterData: true })
        })
    )
    const killed = Date.now()
    process.kill(pid, 'SIGKILL')
    const seen = await read
    const line = page.locator('section.log li', { hasText: 'CameraGone detected' }).first()
    const [h, m, s] = (await line.getByRole('button').innerText()).split(':').map(Number)
    const day = new Date(seen).setUTCHours(0, 0, 0, 0)
    beyond.push(seen - (day + 1000 * (3600 * h + 60 * m + s)))
    whole.push(seen - killed)
  }
  tell('from the detection to the cause’s name on the page, median of 10', quantile(beyond, 0.5), 300)
  tell('the same, the slowest', Math.max(...beyond), 300)
  tell('from the kill to the cause’s name on the page, median of 10', quantile(whole, 0.5))
}

// A journal of a day (bench/day_main.cpp), served by the program: from the address in a new window, and from a click, to all
// that one sees first: the timeline of the day, the list, and the newest incident with its own timeline and its decisions.
async function aDayOfJournal(page) {
  const isThere = () => {
    const rows = document.querySelectorAll('.incident-list tbody tr').length
    const bars = document.querySelectorAll('[aria-label="All incidents"] rect').length
    const own = document.querySelectorAll('.incident-details .timeline rect').length
    const told = document.querySelectorAll('.incident-details .log li').length
    return rows >= 100 && bars > 0 && own > 0 && told > 0 && document.querySelector('[aria-label="Decisions"]') !== null
  }
  // Drawn is what is on the screen after the next frame.
  const drawn = async () => {
    await page.waitForFunction(isThere, undefined, { polling: 'raf' })
    return page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(() => resolve(Date.now())))))
  }
  const clicked = []
  const opened = []
  for (let i = 0; i < 5; ++i) {
    await page.evaluate(() => (location.hash = 'robot'))
    await page.locator('main.robot').waitFor()
    const click = await page.evaluate(() => {
      const now = Date.now()
      document.querySelector('nav a[href="#incidents"]').click()
      return now
    })
    clicked.push((await drawn()) - click)
    const load = Date.now()
    await page.reload({ waitUntil: 'commit' })
    opened.push((await drawn()) - load)
  }
  const count = Number(/\d+/.exec(await page.getByRole('button', { name: /^Show all/ }).innerText()))
  console.log(`a journal of a day, with ${count} incidents:`)
  tell('  opened by its address in a new window, median of 5', quantile(opened, 0.5), 1000)
  tell('  the same, the slowest', Math.max(...opened), 1000)
  tell('  from the click to all of it, median of 5', quantile(clicked, 0.5), 1000)
}

const kNodes = 1000
// A large robot with a state and an event 30 times a second, seen from far away by groups, and from near with the names of nodes.
async function frames(page, server) {
  const { documents, stateAt } = largeRobot(kNodes)
  for (const [kind, document] of Object.entries(documents)) server.tell(kind, document)
  let step = 0
  const telling = setInterval(() => {
    const t = ++step / 30
    const clock = Date.now() / 1000
    server.tell('state', stateAt(t, clock))
    const rule = `Rule${(step - (step % 2)) % kNodes}`
    const both = { t, clock, rule, severity: 'info' }
    server.tell('event', step % 2
      ? { ...both, type: 'failure_resolved', label: 'resolved', tone: 'relief', text: `${rule} resolved` }
      : { ...both, type: 'failure_detected', label: 'detected', tone: 'alarm', text: `${rule} detected`, criticality: 'ERROR' })
    server.keepEvents(0)
  }, 1000 / 30)
  await page.getByText(`and ${kNodes - 60} more`).waitFor()
  await page.waitForTimeout(3000) // the layout
  await count(page, 'groups from far away')
  for (let i = 0; i < 4; ++i) await page.getByRole('button', { name: 'Larger' }).click()
  await count(page, 'nodes within their groups')
  await page.getByLabel('Group nodes by').selectOption('none')
  await page.getByRole('button', { name: 'Show all of the graph' }).click()
  await count(page, 'all nodes without groups')
  const { x, y, width, height } = await page.locator('.graph canvas').first().boundingBox()
  const [middle, level] = [x + width / 2, y + height / 2]
  await count(page, 'all nodes, while one drags and zooms', async () => {
    await page.mouse.move(middle, level)
    await page.mouse.down()
    await page.mouse.move(middle + 80, level + 50, { steps: 20 })
    await page.mouse.move(middle - 80, level - 50, { steps: 40 })
    await page.mouse.up()
    for (const way of [-40, 40]) for (let i = 0; i < 10; ++i) await page.mouse.wheel(0, way)
  })
  clearInterval(telling)
}
// Also the processor time of the page's main thread, which does not depend on what else the machine does.
// `moves` is done again and again meanwhile.
async function count(page, what, moves = null) {
  const meter = await page.context().newCDPSession(page)
  await meter.send('Performance.enable', { timeDomain: 'threadTicks' })
  const used = async () => (await meter.send('Performance.getMetrics')).metrics.find((m) => m.name === 'TaskDuration').value
  const before = await used()
  let isOver = false
  const counting = page.evaluate(
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
  void counting.then(() => (isOver = true))
  while (moves && !isOver) await moves()
  const times = await counting
  console.log(`${kNodes} nodes, 30 updates a second, ${what}: ${times.length / 10} frames a second in 10 s`)
  tell('  processor time of the main thread a frame', (1000 * (await used() - before)) / times.length, 1000 / 30)
  tell('  a frame, median', quantile(times, 0.5), 1000 / 30)
  tell('  a frame, p95', quantile(times, 0.95), 1000 / 30)
  tell('  a frame, longest', Math.max(...times))
}

await suite(async () => {
  await session(['run', file('speed.rules'), '--web', '--no-journal', '--settle', '1', '--healthy', '0', '--intensity', 'none', '--intensity-kind', 'none', '--intensity-component', 'none', '--restarts', 'none'], async (page, program) => {
    await firstPaint(page)
    await event(page)
    await cause(page, program)
  })
  const day = process.argv[5]
  const copy = file('day.journal') // for culprit writes on
  if (day) cpSync(day, copy)
  if (day) await session(['run', kSunset, '--web', '--journal', copy, '--dry-run'], aDayOfJournal)
  await stubbed({ 'get /api/stream': () => [200, {}] }, frames)
  expect(missed === 0, `${missed} of what is asked for is missed`)
})
