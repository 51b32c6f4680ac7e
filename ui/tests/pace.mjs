// How soon the page shows what it is told: as a multiple of what else takes its time in the same browser, so that the machine does
// not matter. speed.mjs measures the times themselves.
import { incidentAt, kNow, kStates, kToday, play, state } from './robots.mjs'
import { expect, stubbed } from './session.mjs'

const kRounds = 15
const kDay = 1200 // incidents
const kSlowestCause = 6 // times a bare answer
const kMuchMore = 10 // times the incidents
const kLongerForMore = 6 // times as long

const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)]

function tellsNotMoreThan(most, value, what) {
  console.log(`${what}: ${value.toFixed(1)} times, at most ${most}`)
  expect(value <= most, `${what}: ${value.toFixed(1)} times, at most ${most}`)
}

// In the page: what is drawn is on the screen after the next frame.
function helpers() {
  window.shown = () => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)))
  window.bare = async () => {
    const begin = Date.now()
    await (await fetch('/api/about', { cache: 'no-store' })).json()
    await window.shown()
    return Date.now() - begin
  }
  // When the status bar says so.
  window.watchFor = (words) => {
    const cause = document.querySelector('.status-bar .cause')
    window.said = new Promise((resolve) => {
      const watch = new MutationObserver(() => {
        if (!cause.textContent.includes(words)) return
        watch.disconnect()
        void window.shown().then(() => resolve(Date.now()))
      })
      watch.observe(cause, { childList: true, subtree: true, characterData: true })
    })
  }
}

// From the state that names the cause to the name on the screen, beside a bare answer of the same server.
async function namesTheCauseSoon(page, server) {
  play(server, kStates.well)
  await page.getByRole('region', { name: 'Status' }).getByText('All is well').waitFor()
  await page.evaluate(helpers)
  const [bare, cause] = [[], []]
  for (let i = 0; i < 2 * kRounds; ++i) {
    const isIll = i % 2 === 0
    bare.push(await page.evaluate('window.bare()'))
    await page.evaluate((words) => window.watchFor(words), isIll ? 'camera is down' : 'All is well')
    const told = Date.now()
    server.tell('state', state(kNow + 0.1 + i / 10, (isIll ? kStates.ill : kStates.well).state))
    cause.push((await page.evaluate('window.said')) - told)
  }
  tellsNotMoreThan(kSlowestCause, median(cause) / Math.max(1, median(bare)), 'the cause on the screen, as a multiple of a bare answer')
}

let incidents = []
const kCalls = {
  'get /api/stream': () => [200, {}],
  'get /api/incidents': () => [200, { journal: 'rover.journal', oldest: incidents.at(-1).clock, incidents }],
  'get /api/incidents/events': () => [200, { events: [] }],
}
// Up to a minute before the robot's present.
const dayOf = (count) => Array.from({ length: count }, (_, i) => incidentAt(kToday / 1000 - 60 - (i * 80_000) / count, { seconds: 2, causes: [`node_${i % 4}`] }))

// What one can see of a day has its bounds: ten times the incidents do not take ten times as long.
async function drawsNoMoreThanOneSees(page, server) {
  play(server, kStates.well)
  // In a page that knows none of them yet, from the click to the list and the timeline.
  const opened = async (count) => {
    const times = []
    for (let i = 0; i < 5; ++i) {
      incidents = dayOf(count)
      await page.evaluate(() => (location.hash = 'robot'))
      await page.reload()
      await page.locator('main.robot').waitFor()
      await page.evaluate(helpers)
      times.push(
        await page.evaluate(async () => {
          const isThere = () => document.querySelectorAll('.incident-list tbody tr').length >= 100 && document.querySelectorAll('[aria-label="All incidents"] rect').length > 0
          const begin = performance.now()
          document.querySelector('nav a[href="#incidents"]').click()
          while (!isThere()) await new Promise(requestAnimationFrame)
          await window.shown()
          return performance.now() - begin
        })
      )
    }
    return median(times)
  }
  const day = await opened(kDay)
  tellsNotMoreThan(kLongerForMore, (await opened(kMuchMore * kDay)) / day, `${kMuchMore} times the incidents of a day, as a multiple of the day's time`)
}

export async function keepsPace() {
  await stubbed(kCalls, namesTheCauseSoon)
  await stubbed(kCalls, drawsNoMoreThanOneSees)
}
