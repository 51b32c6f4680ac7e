// Every state of the robot that an operator may find, on every size of screen, light and dark: what must be seen without
// scrolling is seen, whole and at its place, and all of it looks as in the pictures beside this.
import { kBlindStates, kForgotten, kNow, kStates, kToday, play, state } from './robots.mjs'
import { kSizes, pictures } from './pictures.mjs'
import { expect, file, isAccessible, kSchemes, stubbed, suite } from './session.mjs'

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

async function looksRight(page, at, size, { cause, level, mode, also = [] }) {
  const wanted = { cause, level, mode }
  await page.waitForFunction(
    (all) => {
      const words = { cause: '.cause', level: '.level', mode: '.mode' }
      return Object.entries(all).every(([part, word]) => document.querySelector(`.status-bar ${words[part]}`)?.innerText.includes(word))
    },
    wanted
  )
  const { wrong, brake, words } = await page.evaluate(look)
  expect(wrong.length === 0, `${at}:\n${wrong.join('\n')}`)
  expect((brakes.get(size) ?? brake) === brake, `Pause has moved (${at}): ${brakes.get(size)} ${brake}`)
  brakes.set(size, brake)
  for (const text of also) expect(words.detail.includes(text), `the bar does not say ${text} (${at}): ${JSON.stringify(words)}`)
}

const kAll = { ...kStates, forgotten: kForgotten }
const kDisconnected = { cause: 'Disconnected since 14:03:34', level: 'Old', mode: 'was: Acting', also: ['This view is outdated', 'It was: camera is dead'] }

async function inEverySize(page, steps) {
  for (const [size, viewport] of Object.entries(kSizes)) {
    await page.setViewportSize(viewport)
    for (const scheme of kSchemes) {
      await page.emulateMedia({ colorScheme: scheme })
      await steps(size, scheme)
    }
  }
  await page.setViewportSize(kSizes.desktop)
  await page.emulateMedia({ colorScheme: null })
}

async function everyState(page, server) {
  const album = await pictures(page, file(''))
  await page.evaluate(() => localStorage.clear())
  await inEverySize(page, async (size, scheme) => {
    for (const [name, wanted] of Object.entries(kAll)) {
      server.anew()
      play(server, wanted)
      await looksRight(page, `${name}, ${size}, ${scheme}`, size, wanted)
      await album.compare(name, size, scheme)
    }
  })
  for (const name of ['ill', 'paused', 'approval', 'exhausted']) {
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
  // The server is gone: the page says so at once, and turns grey for all readers.
  server.anew()
  play(server, kStates.ill)
  await looksRight(page, 'before the server goes', 'desktop', kStates.ill)
  server.leave()
  await inEverySize(page, async (size, scheme) => {
    await looksRight(page, `disconnected, ${size}, ${scheme}`, size, kDisconnected)
    await album.compare('disconnected', size, scheme)
  })
  expect((await page.title()).startsWith('⚠ Disconnected'), `the title is ${await page.title()}`)
  expect((await page.locator('main').evaluate((e) => getComputedStyle(e).filter)).includes('grayscale'), 'what is old is in colour')
  expect(await page.getByRole('region', { name: 'Status' }).getByRole('button', { name: 'Pause' }).isDisabled(), 'one can press Pause while nobody would be told')
  await isAccessible(page)
  await album.end()
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

await suite(async () => {
  await stubbed(kCalls, everyState, kToday)
  await stubbed(kCalls, isNeverOldInSecret)
})
