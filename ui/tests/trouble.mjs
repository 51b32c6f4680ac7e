// The page while culprit is away, refuses, or has nothing to show: it says so, claims nothing meanwhile, and goes on by itself.
import { kIncidents, kStates, kToday, play } from './robots.mjs'
import { expect, isAccessible, stubbed, suite } from './session.mjs'

const kRules = 'COMPONENT camera NODE /camera\n'
const kCalls = {
  'get /api/stream': () => [200, {}],
  'post /api/orders': () => [202, { number: 1, text: 'kept' }],
  'get /api/incidents': () => [200, { journal: '/var/lib/culprit/rover.journal', incidents: kIncidents }],
  'get /api/incidents/events': () => [200, { events: [] }],
  'get /api/rules': () => [200, { path: 'rover.rules', text: kRules, version: '1', can_save: true }],
  'post /api/rules/json': () => [200, { version: 1, statements: [] }],
  'post /api/rules/ask': () => [200, { diagnostics: [], result: null }],
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

await suite(() =>
  stubbed(
    kCalls,
    async (page, server) => {
      await saysWhyItIsRefused(page, server)
      await readsIncidentsAgain(page, server)
    },
    kToday
  ).then(() => stubbed(kCalls, checksAgain)) // the editor waits by the clock
)
