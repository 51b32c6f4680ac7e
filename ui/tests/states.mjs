// Every state of the robot that an operator may find, on every size of screen, light and dark: what must be seen without
// scrolling is seen, whole and at its place; nothing is cut off or lies over another thing; all of it says the same as `culprit status --json`
// of the same moment, and looks as in the pictures beside this.
import { isLaidOut } from './layout.mjs'
import { kBlindLongAgo, kBlindStates, kForgotten, kHeld, kNeverSeen, kNow, kRobot, kStates, kToday, play, state } from './robots.mjs'
import { kSizes, pictures } from './pictures.mjs'
import { expect, expectSoon, file, isAccessible, kSchemes, statusOfStub, stubbed, suite } from './session.mjs'

const kCalls = {
  'get /api/stream': () => [200, {}],
  'post /api/orders': () => [202, { number: 1, text: 'kept' }],
}

// The parts of the status bar that are not wholly on the screen, are covered, or are cut off; and the place of Pause.
function look() {
  const bar = document.querySelector('.status-bar')
  const parts = {
    'the cause': bar.querySelector('.cause p'),
    'what is done about it': bar.querySelector('.cause .detail'),
    'the level': bar.querySelector('.level'),
    'the mode': bar.querySelector('.mode'),
    'the freshness': bar.querySelector('.freshness'),
    Pause: bar.querySelector('button'),
  }
  const wrong = Object.entries(parts).flatMap(([what, element]) => {
    if (!element) return [`${what} is missing`]
    const box = element.getBoundingClientRect()
    const isWithin = box.width > 0 && box.top >= 0 && box.left >= 0 && box.bottom <= innerHeight && box.right <= innerWidth
    const top = document.elementFromPoint(box.left + box.width / 2, box.top + box.height / 2)
    // A cut sentence is as unreadable as a cut word.
    const isCut = element.scrollWidth > element.clientWidth + 1 || element.scrollHeight > element.clientHeight + 1
    const isSeen = isWithin && !isCut && (element === top || element.contains(top))
    return isSeen ? [] : [`${what} is not seen: ${JSON.stringify({ box, isCut, top: top?.outerHTML })}`]
  })
  const text = (element) => element?.innerText ?? ''
  const { x, y, width, height } = parts.Pause?.getBoundingClientRect() ?? {}
  return { wrong, brake: [x, y, width, height].join(), words: { cause: text(parts['the cause']), detail: text(parts['what is done about it']), level: text(parts['the level']), mode: text(parts['the mode']) } }
}

// Where the brake is, by size: nothing may move it.
const brakes = new Map()

const kWall = { cause: '.wall h1', level: '.wall-level', mode: '.wall footer' }
const kBar = { cause: '.status-bar .cause', level: '.status-bar .level', mode: '.status-bar .mode' }

async function looksRight(page, at, size, { cause, level, mode, also = [] }) {
  const wanted = { cause, level, mode }
  const isWall = size === 'wall'
  await page.waitForFunction(
    ([all, parts]) => Object.entries(all).every(([part, word]) => document.querySelector(parts[part])?.innerText.includes(word)),
    [wanted, isWall ? kWall : kBar]
  )
  if (isWall) return
  const { wrong, brake, words } = await page.evaluate(look)
  expect(wrong.length === 0, `${at}:\n${wrong.join('\n')}`)
  expect((brakes.get(size) ?? brake) === brake, `Pause has moved (${at}): ${brakes.get(size)} ${brake}`)
  brakes.set(size, brake)
  for (const text of also) expect(words.detail.includes(text), `the bar does not say ${text} (${at}): ${JSON.stringify(words)}`)
}

// What this page shows of the robot, in the words of the state.
function shown() {
  const all = (parts) => [...document.querySelectorAll(parts)]
  const buttons = all('[aria-label="Components"] ul button, .tile').map((each) => [each.innerText.replace(/^\S+\s+/, '').split(/\s/)[0], /look-(\w+)/.exec(each.className)[1]])
  return {
    headline: document.querySelector('.status-bar .cause b, .wall h1').innerText,
    detail: document.querySelector('.status-bar .detail, .wall-detail').innerText,
    incidents: document.querySelector('.wall') ? null : all('[data-incident]').map((each) => each.dataset.incident).join(),
    looks: buttons.map((each) => each.join(' ')).sort().join(),
  }
}

// `culprit status --json`, asked at the same moment, says what the page shows.
async function saysAsTheTerminal(page, at, told) {
  if (!told) return
  const { overview, incidents, components } = told.state
  const [first] = incidents
  const wanted = { headline: (first ?? overview).headline, detail: (first?.doing ?? overview.detail), looks: components.map((each, i) => `${kNames[i]} ${each.look}`).sort().join() }
  let seen = null
  const isSame = async () => {
    seen = await page.evaluate(shown)
    return (
      seen.headline.toLowerCase().startsWith(wanted.headline.toLowerCase()) && seen.detail.includes(wanted.detail) && seen.looks === wanted.looks &&
      (seen.incidents === null || seen.incidents === incidents.map((each) => each.id).join())
    )
  }
  await expectSoon(isSame, '').catch(() => {
    throw new Error(`the page and culprit status do not say the same (${at}):\n${JSON.stringify(seen)}\n${JSON.stringify(wanted)}`)
  })
}
const kNames = kRobot.components.map((each) => each.name)

const kAll = { ...kStates, forgotten: kForgotten, 'time-held': kHeld, ...kBlindStates }
const kDisconnected = { cause: 'Disconnected since 14:03:34', level: 'Old', mode: 'was: Acting', also: ['This view is outdated', 'It was: camera is down'] }
const kLoading = 'Asking culprit how the robot is'

async function inEverySize(page, steps) {
  for (const [size, viewport] of Object.entries(kSizes)) {
    await page.setViewportSize(viewport)
    await page.evaluate((hash) => (location.hash = hash), size === 'wall' ? 'wall' : 'robot')
    for (const scheme of kSchemes) {
      await page.emulateMedia({ colorScheme: scheme })
      await steps(size, scheme)
    }
  }
  await page.setViewportSize(kSizes.desktop)
  await page.evaluate(() => (location.hash = 'robot'))
  await page.emulateMedia({ colorScheme: null })
}

// Before anything is known of the robot, nothing is said of it.
async function loads(page, server) {
  server.anew()
  await page.reload()
  await inEverySize(page, async (size, scheme) => {
    await page.waitForFunction(([part, word]) => document.querySelector(part)?.innerText.includes(word), [(size === 'wall' ? kWall : kBar).cause, kLoading])
    await isLaidOut(page, `loading, ${size}, ${scheme}`)
    const words = await page.evaluate(() => document.body.innerText)
    expect(!/all is well|is down|✓/i.test(words), `something is said of a robot that is not known yet: ${words}`)
  })
}

async function everyState(page, server) {
  const album = await pictures(page, file(''))
  const told = new Map()
  await page.evaluate(() => localStorage.clear())
  await inEverySize(page, async (size, scheme) => {
    for (const [name, wanted] of Object.entries(kAll)) {
      server.anew()
      play(server, wanted)
      const at = `${name}, ${size}, ${scheme}`
      await looksRight(page, at, size, wanted)
      told.set(name, told.get(name) ?? (await statusOfStub())) // the stub says the same in every size
      await saysAsTheTerminal(page, at, told.get(name))
      await album.compare(name, size, scheme)
      await isLaidOut(page, at)
    }
  })
  for (const name of ['ill', 'paused', 'approval', 'exhausted', 'time-held']) {
    server.anew()
    play(server, kAll[name])
    await looksRight(page, name, 'desktop', kAll[name])
    await isAccessible(page)
  }
  for (const [name, each] of Object.entries(kBlindStates)) {
    server.anew()
    play(server, each)
    await looksRight(page, name, 'desktop', each)
    const explanation = page.getByRole('region', { name: 'Explanation' })
    await explanation.getByRole('heading', { name: 'SegmentationBad is blind' }).waitFor()
    expect((await explanation.getByText('All is well').count()) === 0, `it says that all is well (${name})`)
    await isAccessible(page)
  }
  // A blind rule hides no known cause: that stands first.
  server.anew()
  play(server, { ...kStates.warning, state: { ...kStates.warning.state, FusionSilent: kBlindStates['watching-nothing'].state.FusionSilent } })
  const titles = page.getByRole('region', { name: 'Explanation' }).getByRole('heading', { level: 2 })
  await titles.filter({ hasText: 'SegmentationBad fails' }).waitFor() // the state before had the blind one, too
  await titles.filter({ hasText: 'FusionSilent is blind' }).waitFor()
  expect((await titles.first().innerText()).includes('SegmentationBad fails'), `this stands first: ${await titles.first().innerText()}`)
  await loads(page, server)
  // The server is gone: the page says so at once, and turns grey for all readers.
  server.anew()
  play(server, kStates.ill)
  await looksRight(page, 'before the server goes', 'desktop', kStates.ill)
  server.leave()
  await inEverySize(page, async (size, scheme) => {
    await looksRight(page, `disconnected, ${size}, ${scheme}`, size, kDisconnected)
    await album.compare('disconnected', size, scheme)
    await isLaidOut(page, `disconnected, ${size}, ${scheme}`)
  })
  expect((await page.title()).startsWith('⚠ Disconnected'), `the title is ${await page.title()}`)
  expect((await page.locator('main').evaluate((e) => getComputedStyle(e).filter)).includes('grayscale'), 'what is old is in colour')
  expect(await page.getByRole('region', { name: 'Status' }).getByRole('button', { name: 'Pause' }).isDisabled(), 'one can press Pause while nobody would be told')
  await isAccessible(page)
  await album.end()
}

// A component that was never seen is neither well nor down: it has its own look in the list, the panel and the wall view.
async function neverCallsWellWhatWasNeverSeen(page, server) {
  await inEverySize(page, async (size, scheme) => {
    server.anew()
    play(server, kNeverSeen)
    const at = `never seen, ${size}, ${scheme}`
    await looksRight(page, at, size, kNeverSeen)
    await saysAsTheTerminal(page, at, await statusOfStub())
    await isLaidOut(page, at)
    const entry = page.locator(size === 'wall' ? '.tile' : '[aria-label="Components"] ul button').filter({ hasText: 'image_enhancement' })
    const { text, style, colour } = await entry.evaluate((e) => ({ text: e.innerText.replace(/\s+/g, ' '), style: getComputedStyle(e).borderTopStyle, colour: getComputedStyle(e).borderTopColor }))
    expect(text === '? image_enhancement never seen', `this is said of it: ${text} (${at})`)
    expect(style === 'dashed', `its frame is ${style} (${at})`)
    const wellColour = await page.locator(size === 'wall' ? '.tile.look-OK' : '[aria-label="Components"] ul .look-OK').first().evaluate((e) => getComputedStyle(e).borderTopColor + getComputedStyle(e).borderTopStyle)
    expect(wellColour !== colour + style, `it looks as what is well (${at})`)
  })
  await page.getByRole('region', { name: 'Components' }).getByRole('button', { name: 'image_enhancement' }).click()
  const panel = page.getByRole('region', { name: 'About image_enhancement' })
  await panel.getByText('/image_enhancement, not discovered now').waitFor()
  await panel.getByText('never seen', { exact: true }).waitFor()
  expect((await panel.getByText('running').count()) === 0, 'a process that was never seen is said to run')
  await isAccessible(page)
  // In the graph, too.
  await page.evaluate(() => {
    window.drawn = new Set()
    const { fillText } = CanvasRenderingContext2D.prototype
    CanvasRenderingContext2D.prototype.fillText = function (...all) {
      window.drawn.add(all[0])
      return fillText.apply(this, all)
    }
  })
  server.tell('graph', kNeverSeen.graph)
  await page.waitForFunction(() => [...window.drawn].some((text) => text.startsWith('? image_')) && window.drawn.has('never seen'))
}

// Of an earlier moment, too, nobody can say that a robot was well while a rule was blind.
async function callsNoPastWell(page, server) {
  play(server, kBlindLongAgo)
  const explanation = page.getByRole('region', { name: 'Explanation' })
  await explanation.getByRole('heading', { name: 'SegmentationBad is blind' }).waitFor()
  const slider = page.getByRole('slider', { name: 'Moment to look at' })
  await page.waitForFunction(() => Number(document.querySelector('input.scrub').max) > 100) // the state has come
  await slider.evaluate((input) => {
    input.value = String(Number(input.max) - 5) // s
    input.dispatchEvent(new Event('input', { bubbles: true }))
  })
  await explanation.getByText('No rule sees a failure at this moment. SegmentationBad is blind.').waitFor()
  await slider.press('Home')
  await explanation.getByText('No rule sees a failure at this moment.', { exact: true }).waitFor()
  expect((await explanation.getByText('All is well').count()) === 0, 'a moment that nobody can judge is called well')
  await isAccessible(page)
}

// Notes each frame in which the status bar and a star disagree, as it is painted: observers of sizes come after all else of a frame.
function watchFrames() {
  const seen = (window.seenFrames = { count: 0, wrong: [] })
  let labels = [] // of the graph, since it was drawn last
  const { clearRect, fillText } = CanvasRenderingContext2D.prototype
  const isGraph = ({ canvas }) => canvas.matches('.graph canvas:not(.minimap)')
  CanvasRenderingContext2D.prototype.clearRect = function (...all) {
    if (isGraph(this)) labels = []
    return clearRect.apply(this, all)
  }
  CanvasRenderingContext2D.prototype.fillText = function (...all) {
    if (isGraph(this)) labels.push(all[0])
    return fillText.apply(this, all)
  }
  const probe = document.body.appendChild(document.createElement('i'))
  probe.style.cssText = 'position: fixed; visibility: hidden; height: 1px; width: 1px'
  new ResizeObserver(() => {
    ++seen.count
    const said = document.querySelector('.status-bar .cause b').textContent
    const isBlamed = { bar: said.startsWith('camera is down'), graph: labels.some((each) => each.startsWith('★')), list: !!document.querySelector('[aria-label="Components"] ul')?.textContent.includes('★') }
    if (labels.length > 0 && new Set(Object.values(isBlamed)).size > 1) seen.wrong.push(JSON.stringify({ said, ...isBlamed }))
    requestAnimationFrame(() => (probe.style.width = probe.style.width === '1px' ? '2px' : '1px'))
  }).observe(probe)
}

// A robot that falls ill and recovers again and again: no frame blames a node beside "All is well".
async function neverSaysTwoThings(page, server) {
  play(server, kStates.ill)
  await page.getByRole('region', { name: 'Status' }).getByText('camera is down').waitFor()
  await page.getByRole('region', { name: 'Components' }).getByText('★').waitFor()
  await page.waitForTimeout(500) // the graph is laid out
  await page.evaluate(watchFrames)
  for (let i = 0; i < 40; ++i) {
    server.tell('state', state(kNow + i / 100, i % 2 ? kStates.ill.state : kStates.well.state))
    await page.waitForTimeout(20 + 7 * (i % 5))
  }
  await expectSoon(() => page.evaluate('seenFrames.count > 30'), 'hardly a frame was painted')
  const { count, wrong } = await page.evaluate('seenFrames')
  expect(wrong.length === 0, `${wrong.length} of ${count} frames say two things, as ${wrong[0]}`)
}

// The page says so soon if the connection only falls silent. By clocks that run.
async function isNeverOldInSecret(page, server) {
  const bar = page.getByRole('region', { name: 'Status' })
  const soon = () => state(kNow + (Date.now() - kToday) / 1000, {})
  play(server, kStates.well)
  server.tell('state', soon())
  await bar.getByText('All is well').waitFor()
  await bar.getByText('Nothing new from culprit since').waitFor() // the server runs, its manager reports nothing
  server.tell('state', soon())
  await bar.getByText('All is well').waitFor()
  server.fallSilent()
  await bar.getByText('Disconnected since').waitFor()
  await bar.getByText('It was: All is well').waitFor()
}

// Opened when culprit refuses a call among too many, the page asks again.
async function asksAgain(page, server) {
  play(server, kStates.well)
  let isFirst = true
  await page.route('**/api/about', (route) => {
    if (!isFirst) return route.continue()
    isFirst = false
    return route.fulfill({ status: 429, json: { error: 'too many requests' } })
  })
  await page.reload()
  await page.getByRole('region', { name: 'Status' }).getByText('All is well').waitFor()
  expect(!isFirst, 'no call was refused')
}

await suite(async () => {
  await stubbed(kCalls, asksAgain, kToday)
  await stubbed(kCalls, everyState, kToday)
  await stubbed(kCalls, neverCallsWellWhatWasNeverSeen, kToday)
  await stubbed(kCalls, callsNoPastWell, kToday)
  await stubbed(kCalls, neverSaysTwoThings, kToday)
  await stubbed(kCalls, isNeverOldInSecret)
})
