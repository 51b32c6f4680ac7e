// The page while culprit is away, refuses, or has nothing to show: it says so, claims nothing meanwhile, and goes on by itself.
import { largeRobot } from './large_robot.mjs'
import { kIncidents, kNow, kStates, kToday, play } from './robots.mjs'
import { expect, expectSoon, isAccessible, stubbed, suite } from './session.mjs'

const kRules = 'COMPONENT camera NODE /camera\n'
const kDay = 86_400
let pastTrouble = '' // why the journal cannot be read
const kCalls = {
  'get /api/stream': () => [200, {}],
  'post /api/orders': () => [202, { number: 1, text: 'kept' }],
  'get /api/incidents': () => [200, { journal: '/var/lib/culprit/rover.journal', incidents: kIncidents }],
  'get /api/incidents/events': () => [200, { events: [] }],
  'get /api/series': () => [200, { clocks: [], values: [] }],
  'post /api/series/past': ({ from, to }) => (pastTrouble ? [409, { error: pastTrouble }] : [200, pastOf(from, to)]),
  'get /api/rules': () => [200, { path: 'rover.rules', text: kRules, version: '1', can_save: true }],
  'post /api/rules/json': () => [200, { version: 1, statements: [] }],
  'post /api/rules/ask': () => [200, { diagnostics: [], result: null }],
}

function pastOf(from, to) {
  const clocks = [from, (from + to) / 2, to]
  const mark = { type: 'failure_detected', label: 'detected', severity: 'error', tone: 'alarm', text: 'RGBDead detected in the night', rule: 'RGBDead', t: 0, clock: (from + to) / 2 }
  return { oldest: kToday / 1000 - 2 * kDay, why: 'the journal begins then', clocks, curves: { 'rate /rgb': [1, 2, 3] }, events: [mark] }
}

const statusOf = (page) => page.getByRole('region', { name: 'Status' })
const goTo = (page, hash) => page.evaluate((h) => (location.hash = h), hash)

// Runs `steps` while no call arrives at culprit.
async function whileItIsAway(page, server, steps) {
  await page.route('**/api/**', (route) => route.abort('connectionrefused'))
  server.forget()
  await statusOf(page).getByText('Disconnected').waitFor()
  await steps()
  await page.unroute('**/api/**')
}

// A page that was open while culprit began anew with another token, or one too many.
async function saysWhyItIsRefused(page, server) {
  play(server, kStates.ill)
  await statusOf(page).getByText('camera is down').waitFor()
  for (const [status, error, words] of [[401, 'this needs the token', 'The token is not valid: open the address that culprit printed.'], [429, 'too many pages are open; close some', 'Too many pages are open; close some.']]) {
    await page.route('**/api/stream', (route) => route.fulfill({ status, contentType: 'application/json', body: JSON.stringify({ error }) }))
    server.forget()
    await statusOf(page).getByText(words).waitFor()
    await isAccessible(page)
    await page.unroute('**/api/stream')
    play(server, kStates.ill)
    await statusOf(page).getByText('being repaired').waitFor()
  }
}

// A text that nobody has checked is not called right, and the form is there again once culprit is.
async function checksAgain(page, server) {
  play(server, kStates.well)
  await goTo(page, 'rules')
  const main = page.getByRole('main')
  await main.getByText('✓ no errors').waitFor()
  await whileItIsAway(page, server, async () => {
    await page.locator('.cm-content').click()
    await page.keyboard.type('#')
    await main.getByText('not checked: culprit does not answer').waitFor()
    await main.getByRole('alert').getByText('The form is off: culprit does not answer').waitFor()
    expect((await main.getByText('no errors').count()) === 0, 'a text that was not checked is called right')
  })
  await main.getByText('✓ no errors').waitFor()
  await main.getByRole('alert').waitFor({ state: 'detached' })
  expect(!(await page.locator('.form').evaluate((form) => form.inert)), 'the form stays off')
  await page.keyboard.press('Backspace')
  await main.getByText('as saved').waitFor()
}

async function readsIncidentsAgain(page, server) {
  await goTo(page, 'robot')
  await whileItIsAway(page, server, async () => {
    await goTo(page, 'incidents')
    await page.getByRole('alert').getByText('culprit does not answer').waitFor()
  })
  await page.getByRole('row', { name: /14:03:22.*camera/ }).waitFor()
  expect((await page.getByRole('alert').count()) === 0, 'an old error is still there')
}

// An error of the journal lasts as long as it is true, beside values in memory that come each second.
async function asksTheJournalAgain(page) {
  pastTrouble = 'another replay is running; ask again in a moment'
  const midnight = Math.floor(kToday / 1000 / kDay) * kDay
  await page.evaluate(() => {
    window.drawn = new Set()
    const { fillText } = CanvasRenderingContext2D.prototype
    CanvasRenderingContext2D.prototype.fillText = function (...all) {
      window.drawn.add(all[0])
      return fillText.apply(this, all)
    }
  })
  await goTo(page, `plots/s=rate+/rgb&from=${midnight - 3600}&to=${midnight + 3600}`)
  const alert = page.getByRole('alert')
  await alert.getByText(pastTrouble).waitFor()
  await page.waitForTimeout(2200) // twice as long as between two looks at the memory
  expect((await alert.count()) === 1, 'the error is gone though the journal was not read')
  pastTrouble = ''
  await page.getByRole('region', { name: 'Marks' }).getByText('RGBDead detected in the night').waitFor()
  expect((await alert.count()) === 0, 'an old error is still there')
  // Two days on one axis are told apart.
  await page.getByText('2026-11-20 23:00:00 to 2026-11-21 01:00:00').waitFor()
  await expectSoon(() => page.evaluate(() => window.drawn.has('2026-11-20') && window.drawn.has('2026-11-21')), 'the axis does not say which day it is')
  // Without a clipboard, as over plain HTTP, the link can be copied by hand.
  await page.evaluate(() => Object.defineProperty(navigator, 'clipboard', { value: undefined }))
  await page.getByRole('button', { name: 'Copy link' }).click()
  const notice = page.getByRole('status', { name: 'Notice' })
  await notice.getByText('Copy this link: http://').waitFor()
  await isAccessible(page)
  await notice.getByRole('button', { name: 'Dismiss' }).click()
}

// A filter that is not shown hides nothing, and an empty list says why.
async function filtersWhatItShows(page, server) {
  server.anew()
  const { documents, stateAt } = largeRobot(20)
  for (const [kind, document] of Object.entries(documents)) server.tell(kind, document)
  server.tell('state', stateAt(2, kToday / 1000))
  await goTo(page, 'robot')
  const components = page.getByRole('region', { name: 'Components' })
  await components.getByLabel('Level').selectOption('well')
  server.anew()
  play(server, kStates.ill, kNow)
  await components.getByRole('button', { name: 'camera' }).waitFor()
  expect((await components.getByRole('listitem').count()) === 5, 'a filter that is not shown hides components')
  await page.getByLabel('Find a node').fill('no such node')
  await components.getByText('No component matches.').waitFor()
  await page.getByLabel('Find a node').fill('')
}

await suite(() =>
  stubbed(
    kCalls,
    async (page, server) => {
      await saysWhyItIsRefused(page, server)
      await readsIncidentsAgain(page, server)
      await asksTheJournalAgain(page)
      await filtersWhatItShows(page, server)
    },
    kToday
  ).then(() => stubbed(kCalls, checksAgain)) // the editor waits by the clock
)
