// Every page while something is wrong: the status bar says so on each, each can be used by the keyboard alone and with a
// screen reader, and looks as in the pictures beside this. Each page's purpose is tested on the stub.
import { largeRobot } from './large_robot.mjs'
import { isLaidOut } from './layout.mjs'
import { keepsPace } from './pace.mjs'
import { kSizes, pictures } from './pictures.mjs'
import { hinging, kHealed, kIncidentEvents, kIncidents, kNow, kPausedLater, kRobot, kStates, kToday, play, state } from './robots.mjs'
import { expect, expectSoon, file, isAccessible, isFirefox, isUsableByKeyboard, kSchemes, saved, stubbed, suite } from './session.mjs'

const kFindings = [
  { code: 'D001', severity: 'error', who: '/scan: /lidar → /slam', seen: 'reliability: offered is best effort, requested is reliable', matters: '/slam receives nothing from /lidar', remedy: 'let /lidar offer reliable, or /slam request best effort' },
  { code: 'D020', severity: 'warning', who: 'battery', seen: 'its diagnostic status is STALE', matters: 'its node has stopped reporting', remedy: 'look at its values: ros2 topic echo /diagnostics' },
]
let findings = kFindings
let rules = [] // in the form
let pageTrouble = '' // why a page to send cannot be made
const kCalls = {
  'get /api/stream': () => [200, {}],
  'post /api/orders': () => [202, { number: 1, text: 'kept' }],
  'get /api/incidents': () => [200, { journal: '/var/lib/culprit/rover.journal', oldest: kIncidents.at(-1).clock - 3600, incidents: kIncidents }],
  'get /api/incidents/events': ({ first }) => [200, { events: first === '10' ? kIncidentEvents : [] }],
  'get /api/incidents/page': ({ id }) => (pageTrouble ? [409, { error: pageTrouble }] : [200, { what: `page of ${id}` }]),
  'get /api/incidents/recording': ({ name }) => [200, { name }],
  'get /api/component': () => [200, { node: '/camera', process: { pid: 12, memory: 123_000_000, threads: 7 }, usage: [0.25, 0.5, 0.125].map((processor, look) => ({ clock: kToday / 1000 - 15 + 5 * look, processor, memory: 120_000_000 + 1_000_000 * look })), parameters: { gain: 0.5, matrix: null }, log: [{ clock: kToday / 1000 - 13, level: 'warning', text: 'no frame for 200 ms' }] }],
  'post /api/series/past': ({ names, from, to }) => [200, pastOf(names, from, to)],
  'get /api/series': ({ name, since }) => [200, curveOf(name, Number(since ?? 0))],
  'get /api/map': ({ topic, known }) => [200, { ...map, topic: topic || '/map', grid: Number(known) === map.number || !map.number ? null : kHouse }],
  'post /api/doctor': () => [200, { domain: 7, nodes: 5, findings }],
  'get /api/rules': () => [200, { path: 'rover.rules', text: '', version: '1', can_save: true }],
  'post /api/rules/json': () => [200, { version: 1, statements: rules }],
  'post /api/rules/text': () => [200, { text: 'RULE RGBDead' }],
  'post /api/rules/ask': () => [200, { diagnostics: [], result: null }],
  'post /api/rules/replay': () => [404, { error: 'nothing is recorded' }],
  'post /api/what-if': () => [200, { failures: [], near: [], unknown: [] }],
  'get /api/studies': () => [200, { study: null }],
}
const kPages = ['robot', 'map', 'incidents', 'plots', 'doctor', 'rules', 'beliefs', 'simulator', 'studies', 'help']

// A house of two rooms, 12 m wide, of which one is unknown; the robot is in the other.
const kHouse = {
  width: 60, height: 40, resolution: 0.2, coarser: 1, origin: [-2, -1, 0],
  cells: Array.from({ length: 2400 }, (_, i) => {
    const [column, row] = [i % 60, Math.floor(i / 60)]
    const isWall = row === 0 || row === 39 || column === 0 || column === 59 || (column === 30 && (row < 15 || row > 24))
    return isWall ? '9' : column > 30 ? '?' : '0'
  }).join(''),
}
const kMap = {
  topics: ['/map', '/local_costmap/costmap'], topic: '/map', frame: 'map', number: 3, troubles: [],
  robots: [{ frame: 'base_link', at: [0.5, 1.5], yaw: 0.5, age: 0.05 }],
  path: { topic: '/plan', age: 0.4, points: [[0.5, 1.5], [2, 2.5], [4, 3], [6, 3]] },
  scan: { topic: '/scan', age: 0.1, points: Array.from({ length: 30 }, (_, i) => [-1.8, -0.5 + 0.2 * i]) },
}
let map = kMap

// The last five minutes, as if asked at kToday: the camera's topics went silent 12 s before.
function curveOf(name, since) {
  const now = kToday / 1000
  const clocks = Array.from({ length: 300 }, (_, i) => now - 299 + i).filter((clock) => clock > since)
  const valueAt = { rate: (ago) => (ago < 12 ? 0 : 10), age: (ago) => (ago < 12 ? 12 - ago : 0.1), memory: () => 1.2e8, input: (ago) => 0.04 + 0.01 * Math.sin(ago / 10) }
  const value = valueAt[name.slice(0, name.indexOf(' '))]
  return value && !name.includes('nothing') ? { clocks, values: clocks.map((clock) => value(now - clock)) } : { clocks: [], values: [] }
}

// What the journal has: a day, with a failure an hour ago.
const kHour = 3600
function pastOf(names, from, to) {
  const reach = { oldest: kToday / 1000 - 24 * kHour, why: 'the journal begins then' }
  if (names.length === 0) return reach
  const clocks = Array.from({ length: 200 }, (_, i) => from + ((to - from) * i) / 200)
  const curves = Object.fromEntries(names.map((name) => [name, clocks.map((clock) => (Math.abs(kToday / 1000 - kHour - clock) < 60 ? 0.2 : 0.05))]))
  const mark = { type: 'failure_detected', label: 'detected', severity: 'error', tone: 'alarm', text: 'RGBDead detected an hour ago', rule: 'RGBDead', t: 0, clock: kToday / 1000 - kHour }
  return { ...reach, clocks, curves, events: [mark] }
}

async function become(page, server, wanted, hash) {
  server.anew()
  play(server, wanted)
  await page.evaluate((h) => (location.hash = h), hash)
}

// In the sizes that differ most.
async function photograph(page, album, name) {
  await page.evaluate(() => document.activeElement.blur()) // where the focus was left is no matter of this page
  for (const size of ['desktop', 'phone']) {
    await page.setViewportSize(kSizes[size])
    for (const scheme of kSchemes) {
      await page.emulateMedia({ colorScheme: scheme })
      await album.compare(name, size, scheme)
    }
  }
  await page.setViewportSize(kSizes.desktop)
  await page.emulateMedia({ colorScheme: null })
}

// On every page the same, and the window says it, too.
async function everyPage(page, server, album) {
  await become(page, server, kStates.ill, 'robot')
  for (const name of kPages) {
    await page.evaluate((hash) => (location.hash = hash), name)
    await page.locator('nav a[aria-current="page"]', { hasText: new RegExp(name, 'i') }).waitFor()
    const bar = page.getByRole('region', { name: 'Status' })
    await bar.getByText('camera is down').waitFor()
    await bar.getByRole('button', { name: 'Pause' }).waitFor()
    expect((await page.title()).startsWith('◆ camera is down'), `the title is ${await page.title()}`)
    if (name !== 'robot' && name !== 'plots') await photograph(page, album, `page-${name}`) // these have pictures of their own
    await isAccessible(page)
    await isUsableByKeyboard(page)
    for (const size of isFirefox ? ['phone'] : ['desktop', 'laptop', 'tablet', 'phone']) {
      await page.setViewportSize(kSizes[size])
      await isLaidOut(page, `${name}, ${size}`)
    }
    const isOn = await page.locator('nav a').evaluateAll((links) => links.every((l) => l.getBoundingClientRect().left >= 0 && l.getBoundingClientRect().right <= innerWidth))
    expect(isOn, `on a phone not every page can be reached from ${name}`)
    await page.setViewportSize(kSizes.desktop)
  }
  expect((await page.locator('link[rel="icon"]').getAttribute('href')).startsWith('data:image/svg'), 'the icon does not follow')
}

// A component's panel shows all that is known of it.
async function tellsOfAComponent(page, server, album) {
  await become(page, server, kStates.ill, 'robot')
  await page.getByRole('region', { name: 'Components' }).getByRole('button', { name: 'camera' }).click()
  const panel = page.getByRole('region', { name: 'About camera' })
  for (const text of ['/camera', 'gone', 'culprit, by its LAUNCH command', 'RGBDead.rgb_restart', 'redeploy camera', 'silent for 12 s', 'killed by signal 9', '123 MB', 'no frame for 200 ms'])
    await panel.getByText(text).first().waitFor()
  await panel.getByText('12.5 % of a core').waitFor()
  expect((await panel.getByRole('table', { name: 'process 12' }).locator('polyline').first().getAttribute('points')).split(' ').length === 3, 'what it used before is not drawn')
  await panel.getByText('Parameters (2)').click()
  await panel.getByRole('row', { name: 'gain 0.5' }).waitFor()
  await isAccessible(page)
  await isUsableByKeyboard(page)
  await page.setViewportSize({ width: 1440, height: 1800 })
  await panel.scrollIntoViewIfNeeded()
  await page.setViewportSize(kSizes.desktop)
  await page.getByRole('button', { name: 'Show all', exact: true }).click()
}

// Also what comes to it later does not move what is there.
async function keepsItsPlaces(page, server) {
  await become(page, server, kStates.well, 'robot')
  const all = page.getByLabel('all nodes and topics')
  const shown = async (count) => {
    await page.waitForFunction((n) => JSON.parse(localStorage.getItem('culprit-places rover') ?? '[]').length === n, count)
    return new Map(await page.evaluate(() => JSON.parse(localStorage.getItem('culprit-places rover'))))
  }
  await page.evaluate(() => localStorage.clear())
  await page.getByRole('button', { name: 'New layout' }).click()
  await all.check()
  const before = await shown(7)
  await all.uncheck()
  await page.reload()
  await page.getByRole('region', { name: 'Components' }).getByRole('button', { name: 'camera' }).waitFor()
  await all.check()
  const after = await shown(7)
  for (const [node, { x, y }] of before) expect(after.get(node).x === x && after.get(node).y === y, `${node} has moved`)
  expect(new Set([...after.values()].map(({ x, y }) => `${x} ${y}`)).size === after.size, 'two nodes stand at one place')
  // A slip of the finger moves nothing, either.
  await page.evaluate(() => {
    const [[node, at], ...others] = JSON.parse(localStorage.getItem('culprit-places rover'))
    localStorage.setItem('culprit-places rover', JSON.stringify([[node, { ...at, x: at.x - 2000 }], ...others]))
    Storage.prototype.setItem = () => {} // the page that is left says nothing more
  })
  await page.reload()
  await page.getByRole('region', { name: 'Components' }).getByRole('button', { name: 'camera' }).waitFor()
  await all.check()
  const own = await shown(7)
  expect(Math.min(...[...own.values()].map(({ x }) => x)) < Math.min(...[...after.values()].map(({ x }) => x)) - 400, 'where a node stood is forgotten')
  await page.getByRole('button', { name: 'New layout' }).click()
  await page.waitForFunction((was) => localStorage.getItem('culprit-places rover') !== was, JSON.stringify([...own]))
  await page.getByRole('status', { name: 'Notice' }).getByRole('button', { name: 'Undo' }).click()
  await page.waitForFunction((was) => localStorage.getItem('culprit-places rover') === was, JSON.stringify([...own]))
  await all.uncheck()
}

// Names of a real robot are long: the table of beliefs has all its columns on the screen.
async function fitsLongNames(page, server) {
  await become(page, server, kStates.well, 'beliefs')
  const long = (rule) => ({ ...rule, name: 'SegmentationDead', strategies: rule.strategies.map((each, i) => ({ ...each, name: `segmentation_enhancement_${i}` })) })
  server.tell('robot', { ...kRobot, rules: kRobot.rules.map(long) })
  server.tell('state', state(kNow, {}))
  const table = page.getByRole('group', { name: 'Beliefs' })
  await table.getByText('SegmentationDead.segmentation_enhancement_1').waitFor()
  for (const size of ['desktop', 'laptop', 'tablet', 'phone']) {
    await page.setViewportSize(kSizes[size])
    const hidden = await table.evaluate((box) => box.scrollWidth - box.clientWidth)
    expect(hidden <= 0, `${hidden} pixels of the beliefs are not on the screen (${size})`)
  }
  await page.setViewportSize(kSizes.desktop)
}

// For a screen on a wall: the same words, and nothing to press but the way back.
async function hangsOnTheWall(page, server, album) {
  await become(page, server, kStates.ill, 'wall')
  await page.emulateMedia({ colorScheme: 'light' })
  const cause = page.getByRole('heading', { name: 'camera is down' })
  await cause.waitFor()
  for (const viewport of [kSizes.desktop, { width: 1920, height: 1080 }]) {
    await page.setViewportSize(viewport)
    const cut = await page.evaluate(() =>
      ['.wall h1', '.wall footer time', '.tile.is-blamed'].filter((part) => {
        const { top, bottom, left, right } = document.querySelector(part).getBoundingClientRect()
        return top < 0 || left < 0 || bottom > innerHeight || right > innerWidth
      })
    )
    expect(cut.length === 0, `on the wall one does not see ${cut}`)
  }
  expect((await page.getByRole('button').count()) === 0, 'there is something to press on the wall')
  const background = await page.locator('main').evaluate((e) => getComputedStyle(e).backgroundColor)
  expect(background === 'rgb(18, 22, 28)', `the wall is not dark: ${background}`)
  await page.setViewportSize(kSizes.desktop)
  await isAccessible(page)
  await album.compare('page-wall', 'desktop', 'dark')
  await page.getByRole('link', { name: 'Leave' }).click()
  await page.getByRole('navigation').waitFor()
}

// A list and a timeline of a day; one of them with its decisions; a link that lasts; a file for readers without culprit.
async function tellsIncidents(page, server, album) {
  await become(page, server, kHealed, 'incidents')
  const row = page.getByRole('row', { name: /14:03:22.*camera.*FusionSilent, SegmentationBad.*3\.0 s.*rgb_redeploy/ })
  await row.waitFor()
  expect((await page.getByRole('row').count()) > 10, 'incidents of the day are missing')
  const bars = page.getByRole('region', { name: 'All incidents' }).locator('rect.leads')
  expect((await bars.count()) > 5, 'they are not on a timeline')
  await bars.last().click({ force: true })
  await page.getByRole('heading', { name: /^segmentation, / }).waitFor()
  await row.getByRole('link').click()
  await page.reload() // the link is about this one and no other, also later
  const incident = page.getByRole('region', { name: 'Incident', exact: true })
  await incident.getByRole('heading', { name: 'camera, 14:03:22' }).waitFor()
  expect((await incident.locator('.tick text').count()) > 2, 'the timeline has no axis')
  const list = page.locator('.incident-box')
  expect((await incident.boundingBox()).y < 900, 'the incident that one looks at is not on the screen')
  expect(await list.evaluate((box) => box.scrollHeight >= box.clientHeight), 'the list has no box')
  // From all of it to milliseconds, by its buttons and by the wheel.
  const plot = incident.locator('.plot')
  const box = await plot.boundingBox()
  await page.mouse.move(box.x + box.width / 2, box.y + 10)
  await page.keyboard.down('Control')
  for (let i = 0; i < 12; ++i) await page.mouse.wheel(0, -300)
  await page.keyboard.up('Control')
  await incident.locator('.tick text', { hasText: /^\d\d:\d\d:\d\d\.\d\d\d$/ }).first().waitFor()
  await incident.locator('.timeline select').selectOption('all')
  await incident.locator('summary', { hasText: 'camera is held responsible for RGBDead' }).press('Enter')
  await incident.getByRole('row', { name: /rgb_restart.*it was tried already/ }).waitFor()
  const decision = incident.locator('.why[open]')
  await decision.getByText('depth answered, 20 ms before the decision').waitFor()
  await decision.getByText('Without “camera exited”, fusion would be held responsible.').waitFor()
  await isAccessible(page)
  await isUsableByKeyboard(page)
  // From it to the plots of its time.
  const plots = new URLSearchParams((await incident.getByRole('link', { name: 'Plot what these rules read' }).getAttribute('href')).split('/').slice(1).join('/'))
  const [from, to] = [Number(plots.get('from')), Number(plots.get('to'))]
  expect(from < kIncidents[0].clock && to > kIncidents[0].clock + kIncidents[0].seconds && to - from < 120, `the plots are of another time: ${plots}`)
  expect(plots.getAll('s').includes('age /fused'), `the plots are of other signals: ${plots}`)
  const send = incident.getByRole('button', { name: 'Save as a page to send …' })
  const sent = await saved(page, () => send.click())
  expect(sent.name === `incident-${kIncidents[0].id}.html`, 'the file to send has another name')
  expect(sent.content.includes(`page of ${kIncidents[0].id}`), 'another file is sent')
  pageTrouble = 'another page is being made; ask again in a moment'
  await send.click()
  await page.getByRole('alert').getByText(pageTrouble).waitFor()
  pageTrouble = ''
  // One that is older than what the list shows is looked for where it must be.
  const longAgo = kIncidents.at(-1).clock - 10 * 86_400
  await page.evaluate((id) => (location.hash = `incidents/${id}`), Math.round(longAgo * 1000).toString(36))
  await expectSoon(() => server.received.some(([call, query]) => call === 'get /api/incidents' && Number(query.since) < longAgo), 'the journal was not asked for that time')
  await page.getByText('The journal has no incident with this address').waitFor()
  // The black box's recordings of one.
  await page.evaluate((id) => (location.hash = `incidents/${id}`), kIncidents.at(-1).id)
  await incident.getByText('/var/lib/culprit/recordings/rover_').waitFor()
  const recording = await saved(page, () => incident.getByRole('button', { name: "Save the robot's topics (MCAP, 1.2 MB)" }).click())
  expect(recording.name === kIncidents.at(-1).recordings[0].name, 'the recording has another name')
  expect(recording.content.includes(kIncidents.at(-1).recordings[0].name), 'it is another recording')
  await page.evaluate(() => (location.hash = 'incidents/'))
}

// Signals of several units on one time axis, with thresholds and marks; the address says it all, and others read it, too.
async function plotsSignals(page, server, album) {
  await become(page, server, kStates.ill, 'robot')
  await page.getByRole('link', { name: 'Plot what these rules read' }).click()
  const chosen = page.getByRole('list', { name: 'Plotted signals' })
  await chosen.getByRole('button', { name: 'Remove age of /fused' }).waitFor()
  await chosen.getByRole('button', { name: 'Remove segmentation_entropy' }).waitFor()
  await page.getByRole('combobox', { name: 'Signal' }).fill('memory of camera')
  await page.getByRole('combobox', { name: 'Signal' }).press('Enter')
  await page.getByLabel('Show a longer time').click()
  await page.getByRole('region', { name: 'Marks' }).getByText('camera is held responsible for RGBDead').waitFor()
  await photograph(page, album, 'plots')
  await isAccessible(page)
  await isUsableByKeyboard(page)
  // By the mouse, to where it broke; the cursor tells the values there.
  const plot = page.locator('.u-over')
  const box = await plot.boundingBox()
  await page.mouse.move(box.x + box.width * 0.9, box.y + 50)
  await page.mouse.down()
  await page.mouse.move(box.x + box.width * 0.999, box.y + 60, { steps: 3 })
  await page.mouse.up()
  await expectSoon(() => page.url().includes('from='), 'dragging does not zoom')
  await page.mouse.move(box.x + box.width * 0.1, box.y + 50)
  await page.locator('.u-legend').getByText('120 MB').waitFor()
  const table = await saved(page, () => page.getByRole('button', { name: 'Save as CSV' }).click())
  const [head, first] = table.content.toString().split('\n')
  expect(head.startsWith('time,clock_s,') && head.includes('age of /fused [s]') && head.includes('memory of camera [MB]'), `the table has these columns: ${head}`)
  expect(first.split(',').length === head.split(',').length && first.includes('120'), `the table has this first row: ${first}`)
  const painted = await saved(page, () => page.getByRole('button', { name: 'Save as picture' }).click())
  expect(painted.content.subarray(1, 4).toString() === 'PNG', 'the picture is none')
  // Rules read a rate over a window of time; the plot is of the topic.
  const address = new URL(page.url()).hash
  await page.evaluate(() => (location.hash = 'plots/s=rate+/depth&s=input+rate(/depth,+2s)&last=120'))
  await page.getByRole('img', { name: 'rate of /depth (threshold 7 Hz), rate(/depth, 2s) (threshold 7 Hz) over time' }).waitFor()
  await page.evaluate((hash) => (location.hash = hash), address)
  await chosen.getByRole('button', { name: 'Remove memory of camera' }).waitFor()
  // A link shows the same to others: signals and time.
  const shown = await page.locator('.plots .muted').first().innerText()
  await page.reload()
  await chosen.getByRole('button', { name: 'Remove memory of camera' }).waitFor()
  expect((await page.locator('.plots .muted').first().innerText()) === shown, 'the link shows another time')
  await chosen.getByRole('button', { name: 'Remove memory of camera' }).press('Enter')
  await expectSoon(() => !page.url().includes('memory'), 'the address keeps what was removed')
  await page.getByRole('button', { name: '● Live' }).click()
  // Longer ago the journal has it, and says how far back.
  await page.getByText('Plots reach back to 2026-11-20 14:03:34: the journal begins then').waitFor()
  await page.locator('.plots select').selectOption({ label: 'the last 6 h' })
  await page.getByRole('region', { name: 'Marks' }).getByText('RGBDead detected an hour ago').waitFor()
  const [, { names, from }] = server.received.filter(([call]) => call === 'post /api/series/past').at(-1)
  expect(names.includes('age /fused') && Math.abs(from - (kToday / 1000 - 6 * kHour)) < 20 * 60, `the journal was asked for ${names} since ${from}`)
  const lines = (await saved(page, () => page.getByRole('button', { name: 'Save as CSV' }).click())).content.toString().split('\n')
  expect(lines.length > 400 && /^2026-11-21T08:[0-2]/.test(lines[1]), `the table begins with ${lines[1]}`)
}

// Six steps on the first visit, which can be ended; terms are explained where they stand.
async function guidesNewcomers(page, server) {
  play(server, kStates.ill)
  const tour = page.getByRole('region', { name: 'Tour' })
  for (let i = 1; i < 6; ++i) {
    await tour.getByText(`(${i} of 6)`).waitFor()
    await page.locator('.toured').first().waitFor()
    if (i === 1) await isAccessible(page)
    await tour.getByRole('button', { name: 'Next' }).press('Enter')
  }
  await tour.getByRole('button', { name: 'Done' }).click()
  await page.reload()
  const term = page.getByRole('button', { name: 'Possible causes' })
  await term.focus()
  await page.getByRole('tooltip').getByText('The component whose fault explains the failures.').waitFor()
  await isAccessible(page)
  await page.keyboard.press('Escape')
  await expectSoon(async () => (await page.getByRole('tooltip').count()) === 0, 'the tooltip does not close')
  expect((await tour.count()) === 0, 'the tour begins again')
  await page.evaluate(() => (location.hash = 'help'))
  for (const end of [() => tour.getByRole('button', { name: 'End the tour' }).click(), () => page.keyboard.press('Escape')]) {
    await page.getByRole('button', { name: 'Start the tour' }).click()
    await tour.getByText('(1 of 6)').waitFor()
    await end()
    await expectSoon(async () => (await tour.count()) === 0, 'the tour does not end')
    await page.evaluate(() => (location.hash = 'help'))
  }
}

async function tellsWhatWouldChange(page, server) {
  await become(page, server, kStates.ill, 'robot')
  const why = page.getByRole('region', { name: 'Explanation' }).locator('.incident > .why').first() // of the root cause
  await why.getByText('camera exited').first().waitFor()
  expect((await why.getByText('What would change this').count()) === 0, 'something would change a decision that hinges on nothing')
  await become(page, server, hinging(kStates.ill), 'robot')
  await why.getByText('Without “camera exited”, fusion would be held responsible.').waitFor()
  await why.getByText('If camera does not answer within 0.60 s, camera is held responsible.').waitFor()
  await why.getByRole('heading', { name: 'Asked and answered' }).waitFor()
  await why.getByText('depth answered, 20 ms before the decision').waitFor()
  await why.getByText('What began first').click()
  await why.getByRole('rowheader', { name: 'camera: camera exited' }).waitFor()
  expect((await why.getByRole('rowheader', { name: 'depth answered' }).count()) === 0, 'an answer is shown as the onset of a failure')
  for (const [width, height] of [[1024, 768], [1440, 900]]) {
    await page.setViewportSize({ width, height })
    await isLaidOut(page, `the evidence of a decision, ${width} × ${height}`)
    const hidden = await page.locator('.cause-first').evaluate((column) => column.scrollWidth - column.clientWidth)
    expect(hidden <= 0, `the right column is ${hidden} pixels too wide at ${width} pixels`)
  }
  await become(page, server, kPausedLater, 'robot')
  await why.getByText('camera hangs').first().waitFor()
}

// The robot is drawn where it is, for as long as somebody looks; what is old looks old.
async function drawsTheMap(page, server) {
  await become(page, server, kStates.ill, 'map')
  await page.getByRole('img', { name: 'Map /map: base_link at x 0.5 m, y 1.5 m, 29°' }).waitFor()
  const place = page.locator('canvas.map')
  // The colour at a place of the map, in metres.
  const colourAt = (x, y) =>
    place.evaluate((canvas, [px, py]) => {
      const { clientWidth: wide, clientHeight: high } = canvas
      const scale = Math.min((wide - 24) / 12, (high - 24) / 8)
      const sharp = canvas.width / wide
      const at = [wide / 2 + scale * (px - 4), high / 2 - scale * (py - 3)].map((p) => Math.round(p * sharp))
      return [...canvas.getContext('2d').getImageData(...at, 1, 1).data].join()
    }, [x, y])
  const [wall, free, unknown, door] = [await colourAt(-1.9, 3), await colourAt(1, 5), await colourAt(8, 5), await colourAt(4.1, 5)]
  expect(wall === door && new Set([wall, free, unknown]).size === 3, `walls, free and unknown places look alike: ${[wall, door, free, unknown]}`)
  const robot = await colourAt(0.5, 1.5)
  expect(![wall, free].includes(robot), 'the robot is not there')
  await page.getByRole('region', { name: 'Explanation' }).getByRole('heading', { name: 'camera is down' }).waitFor()
  const asked = () => server.received.filter(([call]) => call === 'get /api/map')
  await expectSoon(() => asked().at(-1)[1].known === '3', 'the map is sent again and again')

  map = { ...kMap, robots: [{ ...kMap.robots[0], age: 4.2 }], scan: null, troubles: ['/scan is not drawn: no transform on /tf leads from lazer to map'] }
  await page.getByText('as of 4.2 s ago').waitFor()
  await page.getByRole('status').getByText('no transform on /tf leads from lazer to map').waitFor()
  await expectSoon(async () => (await colourAt(0.5, 1.5)) !== robot, 'a robot that was lost looks as one that is there')
  await isAccessible(page)
  await page.getByLabel('Topic of the map').selectOption('/local_costmap/costmap')
  await expectSoon(() => asked().at(-1)[1].topic === '/local_costmap/costmap', 'the other map is not asked for')
  map = { ...kMap, topics: [], topic: '', number: 0, robots: [], path: null, scan: null }
  await page.getByText('Looking for a map').waitFor()
  map = kMap
  await page.evaluate(() => (location.hash = 'robot'))
  await page.locator('.graph canvas').first().waitFor()
  const count = asked().length
  await page.waitForTimeout(1000) // five times as long as between two calls
  expect(asked().length - count <= 1, 'it asks on while nobody looks at the map')
}

// Findings without a rule; and which of them are new since the last time.
async function examines(page, server, album) {
  await become(page, server, kStates.well, 'doctor')
  await page.getByRole('button', { name: 'Examine' }).click()
  const report = page.getByRole('region', { name: 'Findings' })
  await report.getByText('1 error, 1 less severe').waitFor()
  await report.getByRole('article').filter({ hasText: '/scan: /lidar → /slam' }).getByText('let /lidar offer reliable').waitFor()
  expect(server.received.find(([call]) => call === 'post /api/doctor')[1].seconds === 8, 'it looks for another time than was chosen')
  await photograph(page, album, 'doctor-findings')
  await isAccessible(page)
  await isUsableByKeyboard(page)
  await report.getByLabel('Find a finding').fill('battery')
  expect((await report.getByRole('article').count()) === 1, 'the others are still there')
  await report.getByLabel('Find a finding').fill('')
  findings = [kFindings[0], { ...kFindings[1], who: 'motor' }]
  await page.getByRole('button', { name: 'Examine' }).click()
  await report.getByText('Gone since the last time: D020 battery').waitFor()
  await report.getByRole('article').filter({ hasText: 'motor' }).getByText('new').waitFor()
}

// The input of a condition is drawn with its threshold, which can be dragged, or moved by keys.
async function dragsAThreshold(page, server, album) {
  rules = [
    { statement: 'RULE', name: 'RGBDead' },
    { statement: 'POLICIES', criticality: 'ERROR' },
    { statement: 'TRIGGER', expression: 'age(/rgb) > 500ms && segmentation_entropy > limit' },
    { statement: 'STRATEGY', name: 'wake', probability: 50, confidence: 10 },
    { statement: 'ADAPTATION', component: 'camera', type: 'restart', impact: 5 },
  ]
  await become(page, server, kStates.well, 'robot')
  for (let i = 0; i < 14; ++i) {
    const now = state(kNow + i, {})
    now.topics[0].age = 0.1 + 0.05 * (i % 7) + (i === 10 ? 0.6 : 0)
    server.tell('state', now)
    await page.waitForFunction((t) => document.querySelector('.scrub')?.max >= t, kNow + i, { polling: 20 })
  }
  await page.evaluate(() => (location.hash = 'rules'))
  const threshold = page.getByRole('slider', { name: 'threshold of /rgb' })
  await threshold.waitFor()
  await page.getByText('limit is a constant').waitFor()
  await threshold.scrollIntoViewIfNeeded()
  await photograph(page, album, 'sketch')
  await isAccessible(page)
  const taken = () => server.received.filter(([call]) => call === 'post /api/rules/text').map(([, body]) => body.statements[2].expression)
  const box = await threshold.boundingBox()
  await page.mouse.move(box.x + 50, box.y + box.height / 2)
  await page.mouse.down()
  await page.mouse.move(box.x + 60, box.y + box.height * 0.25, { steps: 3 })
  await page.mouse.up()
  await expectSoon(() => taken().length === 1, 'dragging was not taken')
  const [, dragged] = /^age\(\/rgb\) > (\d+)ms && segmentation_entropy > limit$/.exec(taken()[0]) ?? []
  expect(Number(dragged) > 500 && Number(dragged) < 1200, `this was dragged to: ${taken()[0]}`)
  await threshold.press('ArrowDown')
  await expectSoon(() => taken().length === 2, 'a key was not taken')
  expect(Number(/> (\d+)ms/.exec(taken()[1])[1]) < Number(dragged), `a key down led from ${dragged} to ${taken()[1]}`)
  rules = []
}

// The simulator begins with the robot's present state: with its dead camera.
async function imaginesTheRobotAsItIs(page, server) {
  await become(page, server, kStates.ill, 'simulator')
  await page.getByRole('button', { name: 'As the robot is now' }).click()
  const camera = page.locator('label', { hasText: /^camera/ }).getByRole('combobox')
  expect((await camera.inputValue()) === 'killed', `a dead camera is imagined to be ${await camera.inputValue()}`)
  expect(await page.getByLabel('/rgb is silent').isChecked(), 'a topic that is silent is imagined to be heard')
  expect(!(await page.getByLabel('/depth is silent').isChecked()), 'a topic that is heard is imagined to be silent')
  await expectSoon(() => server.received.some(([call, body]) => call === 'post /api/what-if' && /COMPONENT camera .*KILLED/.test(body.state)), 'the planner is asked about another robot')
}

async function theKeyPauses(page, server) {
  await become(page, server, kStates.ill, 'robot')
  server.received.length = 0
  await page.keyboard.press('Alt+KeyP')
  await page.getByRole('status', { name: 'Notice' }).getByText('Pausing: kept').waitFor()
  server.tell('control', { paused: true, dry_run: false, hears: true, silences: [], asked: [] })
  await page.getByRole('button', { name: 'Resume' }).waitFor()
  await page.keyboard.press('Alt+KeyP') // a hurried user presses twice
  const orders = server.received.filter(([call]) => call === 'post /api/orders').map(([, body]) => body.order)
  expect(orders.join() === 'pause', `these were ordered: ${orders}`)
}

// By the words that the terminal has, too.
async function mutesAComponent(page, server) {
  await become(page, server, kStates.muted, 'robot')
  await page.getByText('More control').click()
  await page.getByText('camera is muted by ada until 14:13:22, 9 min 48 s more: the lens is cleaned').waitFor()
  server.received.length = 0
  await page.getByRole('combobox', { name: 'what' }).selectOption('rule RGBDead')
  await page.getByLabel('minutes').fill('5')
  await page.getByRole('button', { name: 'Mute', exact: true }).click()
  await page.getByRole('button', { name: 'Unmute camera' }).click()
  await page.getByRole('status', { name: 'Notice' }).getByText('Unmuting camera: kept').waitFor()
  const [muted, unmuted] = server.received.filter(([call]) => call === 'post /api/orders').map(([, body]) => body)
  expect(muted.order === 'silence' && muted.rule === 'RGBDead' && muted.seconds === 300, `this was ordered: ${JSON.stringify(muted)}`)
  expect(unmuted.order === 'lift' && unmuted.component === 'camera', `this was ordered: ${JSON.stringify(unmuted)}`)
  await isAccessible(page)
  await page.getByText('More control').click()
}

// 500 nodes: from far away groups with the one that is at fault, from near its nodes, and all of it in a corner.
async function staysUsableWhenLarge(page, server, album) {
  server.anew()
  const { documents, stateAt } = largeRobot(500)
  for (const [kind, document] of Object.entries(documents)) server.tell(kind, document)
  server.tell('state', stateAt(2, kToday / 1000))
  await page.evaluate(() => (location.hash = 'robot'))
  await page.getByText('and 440 more').waitFor()
  await page.getByRole('button', { name: 'New layout' }).click()
  await photograph(page, album, 'large')
  for (let i = 0; i < 7; ++i) await page.getByRole('button', { name: 'Larger' }).click()
  expect(await page.locator('.minimap').isVisible(), 'there is no map of what is not on the screen')
  const before = await page.locator('.minimap').evaluate((map) => map.toDataURL())
  await page.locator('.minimap').click({ position: { x: 20, y: 55 } })
  await page.waitForFunction((was) => document.querySelector('.minimap').toDataURL() !== was, before)
  await page.getByLabel('Find a node').fill('node_499')
  await page.getByRole('region', { name: 'Components' }).getByRole('button', { name: 'node_499' }).waitFor()
  await page.getByLabel('Find a node').fill('')
  await page.getByRole('combobox', { name: 'Host' }).selectOption('rover1')
  await page.getByRole('combobox', { name: 'Namespace' }).selectOption('/area_03')
  await page.getByRole('combobox', { name: 'Level' }).selectOption('well')
  await page.getByText('1 of 500').waitFor()
  for (const [name, all] of [['Host', 'all hosts'], ['Namespace', 'all namespaces'], ['Level', 'all levels']]) await page.getByRole('combobox', { name }).selectOption(all)
  for (const by of ['host', 'container', 'none', 'auto']) {
    await page.getByLabel('Group nodes by').selectOption(by)
    await page.getByRole('button', { name: 'Show all of the graph' }).click()
  }
  await isAccessible(page)
}

await suite(() =>
  stubbed(
    kCalls,
    async (page, server) => {
      const album = await pictures(page, file(''))
      await everyPage(page, server, album)
      await tellsOfAComponent(page, server, album)
      await tellsWhatWouldChange(page, server)
      await keepsItsPlaces(page, server)
      await fitsLongNames(page, server)
      await hangsOnTheWall(page, server, album)
      await tellsIncidents(page, server, album)
      await examines(page, server, album)
      await dragsAThreshold(page, server, album)
      await imaginesTheRobotAsItIs(page, server)
      await plotsSignals(page, server, album)
      await drawsTheMap(page, server)
      await theKeyPauses(page, server)
      await mutesAComponent(page, server)
      await staysUsableWhenLarge(page, server, album)
      await album.end()
    },
    kToday
  ).then(() => isFirefox || stubbed(kCalls, guidesNewcomers, kToday, true).then(keepsPace))
)
