// Every state of the robot that an operator may find, on every size of screen, light and dark: what must be seen
// without scrolling is seen, whole and at its place. Positions are compared, not pictures: those differ from one version
// of Chromium and its fonts to the next.
import { readFileSync } from 'node:fs'
import { kForgotten, kHealed, kNow, kStates, play, state } from './robots.mjs'
import { expect, isAccessible, isUsableByKeyboard, picture, stubbed } from './session.mjs'

const kSizes = {
  desktop: { width: 1440, height: 900 },
  laptop: { width: 1024, height: 768 },
  tablet: { width: 820, height: 1180 },
  phone: { width: 390, height: 844 },
}
const kCalls = {
  'get /api/stream': () => [200, {}],
  'post /api/orders': () => [202, { number: 1, text: 'kept' }],
  'get /api/rules': () => [200, { path: 'rover.rules', text: '', version: '1', can_save: true }],
  'post /api/rules/json': () => [200, { version: 1, statements: [] }],
  'post /api/rules/ask': () => [200, { diagnostics: [], result: null }],
  'post /api/what-if': () => [200, { failures: [], near: [], unknown: [] }],
  'get /api/studies': () => [200, { study: null }],
}
const kPages = ['robot', 'incidents', 'rules', 'beliefs', 'simulator', 'studies']

// Is all of `locator` on the screen, and nothing over it?
async function isSeen(page, locator, what) {
  const seen = await locator.evaluate((element) => {
    const box = element.getBoundingClientRect()
    const isWithin = box.width > 0 && box.top >= 0 && box.left >= 0 && box.bottom <= innerHeight && box.right <= innerWidth
    const top = document.elementFromPoint(box.left + box.width / 2, box.top + box.height / 2)
    // Of a sentence as much as of a word: what is cut off is not read.
    const isCut = element.scrollWidth > element.clientWidth + 1 || element.scrollHeight > element.clientHeight + 1
    return { isWithin, isOnTop: element === top || element.contains(top), isCut, box: JSON.stringify(box) }
  })
  expect(seen.isWithin && seen.isOnTop && !seen.isCut, `${what} is not seen: ${JSON.stringify(seen)}`)
  return seen.box
}

// Where the brake is, by size: nothing may move it.
const brakes = new Map()

async function looksRight(page, name, { cause, level, mode, also = [] }) {
  const bar = page.getByRole('region', { name: 'Status' })
  await bar.getByText(cause).first().waitFor()
  await bar.locator('.level').getByText(level).waitFor()
  for (const [size, viewport] of Object.entries(kSizes)) {
    await page.setViewportSize(viewport)
    for (const colorScheme of ['light', 'dark']) {
      await page.emulateMedia({ colorScheme })
      const at = `${name}, ${size}, ${colorScheme}`
      await isSeen(page, bar.locator('.cause p').first(), `the cause (${at})`)
      await isSeen(page, bar.locator('.cause .detail'), `what is done about it (${at})`)
      await isSeen(page, bar.locator('.level'), `the level (${at})`)
      await isSeen(page, bar.locator('.mode').first(), `the mode (${at})`)
      await isSeen(page, bar.locator('.freshness'), `the freshness (${at})`)
      const brake = await isSeen(page, bar.getByRole('button'), `Pause (${at})`)
      expect((brakes.get(size) ?? brake) === brake, `Pause has moved (${at}): ${brakes.get(size)} ${brake}`)
      brakes.set(size, brake)
      expect((await bar.locator('.mode').first().innerText()).includes(mode), `the mode is not ${mode} (${at})`)
      for (const text of also) expect((await bar.locator('.detail').innerText()).includes(text), `the bar does not say ${text} (${at}): ${await bar.innerText()}`)
    }
  }
  await page.setViewportSize(kSizes.desktop)
}

// What nobody told of again would be old: a robot tells its state five times a second.
function keepTelling(server, { state: rules }) {
  const telling = setInterval(() => server.tell('state', state(kNow, rules)), 200)
  telling.unref()
  return () => clearInterval(telling)
}

async function everyState(page, server) {
  for (const [name, wanted] of Object.entries({ ...kStates, forgotten: kForgotten })) {
    server.forget()
    play(server, wanted)
    const stop = keepTelling(server, wanted)
    await page.reload()
    await looksRight(page, name, wanted)
    await picture(page, `state-${name}`)
    if (['ill', 'paused', 'approval'].includes(name)) await isAccessible(page)
    stop()
  }
}

// On every page the same, and the window says it, too.
async function everyPage(page, server) {
  server.forget()
  play(server, kStates.ill)
  const stop = keepTelling(server, kStates.ill)
  for (const name of kPages) {
    await page.evaluate((hash) => (location.hash = hash), name)
    await page.locator('nav a[aria-current="page"]', { hasText: new RegExp(name, 'i') }).waitFor()
    await looksRight(page, `ill, on ${name}`, kStates.ill)
    expect((await page.title()).startsWith('◆ camera is dead'), `the title is ${await page.title()}`)
    for (const link of await page.locator('nav a').all()) {
      await page.setViewportSize(kSizes.phone)
      await isSeen(page, link, `on a phone the way to ${await link.innerText()}`)
    }
    await page.setViewportSize(kSizes.desktop)
    await isAccessible(page)
    await isUsableByKeyboard(page)
  }
  expect((await page.locator('link[rel="icon"]').getAttribute('href')).startsWith('data:image/svg'), 'the icon does not follow')
  stop()
}

// Whoever asks about a component is told all that is known of it.
async function tellsOfAComponent(page, server) {
  server.forget()
  play(server, kStates.ill)
  const stop = keepTelling(server, kStates.ill)
  await page.evaluate(() => (location.hash = 'robot'))
  await page.reload()
  await page.getByRole('region', { name: 'Components' }).getByRole('button', { name: 'camera' }).click()
  const panel = page.getByRole('region', { name: 'About camera' })
  for (const text of ['/camera', 'gone', 'RGBDead.rgb_restart and RGBDead.rgb_redeploy', 'silent for 12 s', 'killed by signal 9']) await panel.getByText(text).first().waitFor()
  await isAccessible(page)
  await picture(page, 'component')
  stop()
}

// Also what comes to it later does not move what is there.
async function keepsItsPlaces(page) {
  const places = () => page.evaluate(() => JSON.parse(localStorage.getItem('culprit-places rover') ?? '[]'))
  const all = page.getByLabel('all nodes and topics')
  const shown = async (count) => {
    await page.waitForFunction((n) => JSON.parse(localStorage.getItem('culprit-places rover') ?? '[]').length === n, count)
    return new Map(await places())
  }
  await page.evaluate(() => localStorage.clear())
  await page.evaluate(() => (location.hash = 'robot'))
  await page.reload()
  await page.getByRole('region', { name: 'Components' }).getByRole('button', { name: 'camera' }).waitFor()
  await page.waitForTimeout(300) // until it is drawn: nothing in the page says so
  await all.check()
  const before = await shown(7)
  await all.uncheck()
  await page.reload()
  await all.check()
  await page.waitForTimeout(300)
  const after = await shown(7)
  for (const [node, { x, y }] of before) expect(after.get(node).x === x && after.get(node).y === y, `${node} has moved`)
  const taken = new Set([...after.values()].map(({ x, y }) => `${x} ${y}`))
  expect(taken.size === after.size, 'two nodes stand at one place')
  await all.uncheck()
}

// For a screen on a wall: the same words, and nothing to press but the way back.
async function hangsOnTheWall(page, server) {
  server.forget()
  play(server, kStates.ill)
  const stop = keepTelling(server, kStates.ill)
  await page.evaluate(() => (location.hash = 'wall'))
  await page.emulateMedia({ colorScheme: 'light' })
  const cause = page.getByRole('heading', { name: 'camera is dead' })
  await cause.waitFor()
  for (const viewport of [kSizes.desktop, { width: 1920, height: 1080 }]) {
    await page.setViewportSize(viewport)
    await isSeen(page, cause, 'the cause on the wall')
    await isSeen(page, page.locator('.wall footer time'), 'the freshness on the wall')
    await isSeen(page, page.locator('.tile.is-blamed'), 'the culprit on the wall')
  }
  expect((await page.getByRole('button').count()) === 0, 'there is something to press on the wall')
  const background = await page.locator('main').evaluate((e) => getComputedStyle(e).backgroundColor)
  expect(background === 'rgb(18, 22, 28)', `the wall is not dark: ${background}`)
  await isAccessible(page)
  await picture(page, 'wall')
  await page.setViewportSize(kSizes.desktop)
  await page.getByRole('link', { name: 'Leave' }).click()
  await page.getByRole('navigation').waitFor()
  stop()
}

// One time that it was not well, with what was decided; a link that lasts; and a file for somebody who has no culprit.
async function tellsAnIncident(page, server) {
  server.forget()
  play(server, kHealed)
  const stop = keepTelling(server, kHealed)
  await page.goto(`${new URL(page.url()).origin}/#incidents`)
  await page.reload()
  const link = page.getByRole('row', { name: /14:03:22.*camera.*FusionSilent, SegmentationBad.*3\.0 s.*rgb_redeploy/ }).getByRole('link')
  await link.click()
  await page.reload() // the link is about this one and no other, also later
  const incident = page.getByRole('region', { name: 'Incident', exact: true })
  await incident.getByRole('heading', { name: 'camera, 14:03:22' }).waitFor()
  expect((await incident.locator('.tick text').count()) > 2, 'the timeline has no axis')
  await incident.locator('summary', { hasText: 'camera is held responsible for RGBDead' }).click()
  await incident.getByRole('row', { name: /rgb_restart.*it was tried already/ }).waitFor()
  await isAccessible(page)
  await picture(page, 'incident')
  const saving = page.waitForEvent('download')
  await incident.getByRole('button', { name: 'Save as a page to send …' }).click()
  const html = readFileSync(await (await saving).path(), 'utf8')
  for (const text of ['<title>camera', 'rgb_redeploy', 'it was tried already', 'killed by signal 9', '<svg']) expect(html.includes(text), `the file is without ${text}`)
  expect(!/<script|src=|href=/.test(html), 'the file needs something beside itself')
  expect(html.includes('&lt;b&gt;rover') && !html.includes('<b>rover'), 'a name is not only text')
  stop()
}

// What one begins to imagine with is the robot as it is: with its dead camera.
async function imaginesTheRobotAsItIs(page, server) {
  server.forget()
  play(server, kStates.ill)
  const stop = keepTelling(server, kStates.ill)
  await page.reload()
  await page.evaluate(() => (location.hash = 'simulator'))
  await page.getByRole('button', { name: 'As the robot is now' }).click()
  const camera = page.locator('label', { hasText: /^camera/ }).getByRole('combobox')
  expect((await camera.inputValue()) === 'killed', `a dead camera is imagined to be ${await camera.inputValue()}`)
  expect(await page.getByLabel('/rgb is silent').isChecked(), 'a topic that is silent is imagined to be heard')
  expect(!(await page.getByLabel('/depth is silent').isChecked()), 'a topic that is heard is imagined to be silent')
  const asked = server.received.filter(([call]) => call === 'post /api/what-if').at(-1)[1].state
  expect(/COMPONENT camera .*KILLED/.test(asked), `the planner is asked about\n${asked}`)
  stop()
}

async function theKeyPauses(page, server) {
  server.received.length = 0
  await page.keyboard.press('Alt+KeyP')
  await page.getByRole('status', { name: 'Notice' }).getByText('Pausing: kept').waitFor()
  server.tell('control', { paused: true, dry_run: false, hears: true, silences: [], asked: [] })
  await page.getByRole('button', { name: 'Resume' }).waitFor()
  await page.keyboard.press('Alt+KeyP') // whoever is in a hurry presses twice
  const orders = server.received.filter(([call]) => call === 'post /api/orders').map(([, body]) => body.order)
  expect(orders.join() === 'pause', `these were ordered: ${orders}`)
}

// The page says so at once if the connection ends, and soon if it only falls silent.
async function isNeverOldInSecret(page, server) {
  const bar = page.getByRole('region', { name: 'Status' })
  server.forget()
  play(server, kStates.well)
  await page.reload()
  await bar.getByText('All is well').waitFor()
  await bar.getByText('Nothing new from culprit since 14:03:34').waitFor() // the server lives, its manager tells nothing
  server.tell('state', state(kNow + 1, {}))
  await bar.getByText('All is well').waitFor()
  server.fallSilent()
  await bar.getByText('Disconnected since 14:03:35').waitFor()
  await looksRight(page, 'silent', { cause: 'Disconnected since 14:03:35', level: 'Old', mode: 'was: Acting', also: ['What you see is old', 'It was: All is well'] })
  expect((await page.title()).startsWith('⚠ Disconnected'), `the title is ${await page.title()}`)
  expect((await page.locator('main').evaluate((e) => getComputedStyle(e).filter)).includes('grayscale'), 'what is old is in colour')
  server.forget()
  play(server, kStates.ill)
  await bar.getByText('camera is dead').waitFor()
  server.leave()
  await bar.getByText('Disconnected since 14:03:34').waitFor()
  await picture(page, 'state-disconnected')
  await isAccessible(page)
}

await stubbed(kCalls, async (page, server) => {
  await page.getByRole('region', { name: 'Status' }).waitFor()
  await everyState(page, server)
  await everyPage(page, server)
  await tellsOfAComponent(page, server)
  await keepsItsPlaces(page)
  await hangsOnTheWall(page, server)
  await tellsAnIncident(page, server)
  await imaginesTheRobotAsItIs(page, server)
  await theKeyPauses(page, server)
  await isNeverOldInSecret(page, server)
})
