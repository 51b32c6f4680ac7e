// A person at the page: culprit as it is, its page in Debian's Chromium or Firefox, and what goes wrong in it.
//
//     node <test>.mjs <culprit> <folder of node_modules> <folder for files>
//
// One browser for all sessions of a test: CULPRIT_BROWSER is chromium, firefox (light) or firefox-dark. CULPRIT_SCREENSHOTS=<folder> also
// takes pictures; CULPRIT_FRESH_PAGE=1 serves the page as it is in ui/src, in place of the one that is part of the program.
import { execFile, spawn } from 'node:child_process'
import { mkdirSync, readdirSync, readFileSync, rmSync, statSync } from 'node:fs'
import { createRequire } from 'node:module'
import { dirname, join } from 'node:path'
import { fileURLToPath } from 'node:url'
import { promisify } from 'node:util'
import { bundle } from '../bundle.mjs'
import { kDomain, stub } from './stub.mjs'

const [program, modules, folder] = process.argv.slice(2)
const require = createRequire(join(modules, 'package.json'))
const { chromium, firefox } = require('playwright-core')
const axe = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8')

const kBrowser = process.env.CULPRIT_BROWSER ?? 'chromium'
export const isFirefox = kBrowser.startsWith('firefox')
// Those that a test can have: Playwright cannot change the colours of Firefox while it runs.
export const kSchemes = isFirefox ? [kBrowser === 'firefox-dark' ? 'dark' : 'light'] : ['light', 'dark']
const kPatience = Number(process.env.CULPRIT_PATIENCE ?? 60_000) // ms, for what a robot takes its time for

const downloads = join(folder, 'downloads')
const sockets = join(folder, 'run', 'culprit')

// What `culprit status --json` says of the stub. It exits with 1 where something is wrong. Null: there is no program to ask.
export async function statusOfStub() {
  if (program === 'none') return null
  const options = { env: { ...process.env, XDG_RUNTIME_DIR: join(folder, 'run') } }
  const { stdout } = await promisify(execFile)(program, ['status', '--json', '--domain', String(kDomain)], options).catch((error) => error)
  const told = JSON.parse(stdout).culprits.find(({ about }) => about.domain === kDomain)
  expect(told, `culprit status does not find the stub: ${stdout}`)
  return told
}

export const file = (name) => join(folder, name)

// Runs culprit to its end.
export const culprit = (args) => promisify(execFile)(program, args)

// What the page saves as a file when `press` is done. Firefox reports no download to Playwright, so its folder is looked at.
export async function saved(page, press) {
  if (!isFirefox) {
    const saving = page.waitForEvent('download')
    await press()
    const download = await saving
    return { name: download.suggestedFilename(), content: readFileSync(await download.path()) }
  }
  const there = () => readdirSync(downloads).filter((name) => !name.endsWith('.part') && statSync(join(downloads, name)).size > 0)
  rmSync(downloads, { recursive: true, force: true })
  mkdirSync(downloads)
  await press()
  await expectSoon(() => there().length === 1, 'nothing is saved')
  const [name] = there()
  return { name, content: readFileSync(join(downloads, name)) }
}

// Starts culprit and waits for the address that it prints. again(): once more at that address.
function serve(args) {
  let said = ''
  let server
  const begin = (port) => {
    server = spawn(program, [...args, '--port', port], { stdio: ['ignore', 'pipe', 'inherit'] })
    const from = said.length
    return new Promise((resolve, reject) => {
      server.stdout.on('data', (data) => {
        said += data
        const match = /(http:\/\/\S+#token=\S+)/.exec(said.slice(from))
        if (match) resolve(match[1])
      })
      server.on('exit', () => reject(new Error(`culprit ended: ${said}`)))
    })
  }
  const address = begin('0')
  const end = (signal = 'SIGINT') =>
    new Promise((resolve) => {
      if (server.exitCode !== null || server.signalCode !== null) return resolve()
      server.on('exit', resolve)
      server.kill(signal)
    })
  const again = async () => begin(new URL(await address).port)
  return { address, end, again, said: () => said }
}

export function expect(condition, message) {
  if (!condition) throw new Error(message)
}

// Waits until `holds`.
export async function expectSoon(holds, message) {
  const end = Date.now() + kPatience
  while (!(await holds())) {
    expect(Date.now() < end, message)
    await new Promise((resolve) => setTimeout(resolve, 10))
  }
}

// Runs `steps` with a page of `culprit <args>`, and what it prints.
export const session = (args, steps) => browse(serve(args), steps)

// Runs `steps` with a page of a stub that answers these calls (stub.mjs). `now`: what all clocks show, also as time passes. `hasTour`: as on a
// first visit.
export async function stubbed(calls, steps, now = null, hasTour = false) {
  mkdirSync(sockets, { recursive: true, mode: 0o700 })
  const server = await stub(modules, calls, join(sockets, `${kDomain}-${process.pid}.sock`))
  await browse({ ...server, address: Promise.resolve(server.address) }, steps, now, hasTour)
}

const env = { ...process.env, TMPDIR: folder, TZ: 'UTC', FONTCONFIG_FILE: join(dirname(fileURLToPath(import.meta.url)), 'fonts.conf') }
const kFirefox = {
  'browser.download.alwaysOpenPanel': false, // it would take the keys
  'messaging-system.rsexperimentloader.enabled': false, // it would ask the network
  'layout.css.prefers-color-scheme.content-override': kSchemes[0] === 'dark' ? 0 : 1,
}
const launch = () =>
  isFirefox
    ? firefox.launch({ channel: 'moz-firefox', executablePath: '/usr/bin/firefox-esr', downloadsPath: downloads, firefoxUserPrefs: kFirefox, env: { ...env, HOME: folder } })
    : chromium.launch({
        executablePath: '/usr/bin/chromium-headless-shell',
        args: [
          '--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run',
          '--disable-background-networking', '--disable-component-update', '--disable-sync',
        ],
        env,
      })

let browser = null
async function newPage(hasTour) {
  browser ??= await launch()
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 } })
  if (!hasTour) await context.addInitScript(() => location.protocol.startsWith('http') && localStorage.setItem('culprit-tour', 'ended'))
  if (process.env.CULPRIT_FRESH_PAGE) {
    for (const { path, type, contents } of bundle(modules))
      await context.route((url) => url.pathname === path, (route) => route.fulfill({ contentType: type, body: Buffer.from(contents) }))
  }
  const page = await context.newPage()
  if (isFirefox) typeAsPeople(page)
  return page
}

// What Playwright enters into Firefox at once leaves the browser without the events that a person's keys give.
function typeAsPeople(page) {
  page.keyboard.insertText = (text) => page.keyboard.type(text)
  Object.getPrototypeOf(page.locator('body')).fill = async function (text) {
    await this.press('Control+a')
    if (text) await this.pressSequentially(text)
    else await this.press('Delete')
  }
}

// All sessions of a test. Any error that a page logs is a failure.
export async function suite(sessions) {
  try {
    await sessions()
    console.log('the session passed')
  } catch (error) {
    console.error(error)
    process.exitCode = 1
  } finally {
    await browser?.close()
  }
}

// Runs `steps` with a page of any server: its address is a promise, and it has an end().
export async function browse(server, steps, now = null, hasTour = false) {
  const complaints = []
  let page
  try {
    const address = await server.address
    page = await newPage(hasTour)
    page.setDefaultTimeout(kPatience)
    page.on('pageerror', (error) => complaints.push(String(error)))
    page.on('console', (message) => {
      // The page itself reports refusals of the server, and its absence.
      const isRefusal = /responded with a status of 4|ERR_INCOMPLETE_CHUNKED|ERR_CONTENT_LENGTH_MISMATCH|ERR_CONNECTION_(REFUSED|RESET)|ERR_EMPTY_RESPONSE/.test(message.text())
      if (message.type() === 'error' && !isRefusal) complaints.push(message.text())
    })
    if (now) await page.clock.setFixedTime(now)
    await page.goto(address)
    await steps(page, server)
    expect(complaints.length === 0, `the page complains: ${complaints.join('\n')}`)
    await page.context().close()
  } catch (error) {
    if (complaints.length > 0) console.error(complaints)
    await page?.screenshot({ path: join(folder, 'failed.png') }).catch(() => {})
    throw error
  } finally {
    await server.end()
  }
}

// axe finds no barrier in any colour scheme.
export async function isAccessible(page) {
  for (const colorScheme of kSchemes) {
    await page.emulateMedia({ colorScheme })
    // The second scheme only changes the colours.
    const options = colorScheme === kSchemes[0] ? {} : { runOnly: ['color-contrast'] }
    // Brought and run in one call: between two calls the page could load anew, and be without it.
    const { violations } = await page.evaluate(`if (!window.axe) { ${axe} }\naxe.run(document, ${JSON.stringify(options)})`)
    const words = violations.map((v) => `${v.id}: ${v.nodes.map((n) => `${n.html} ${n.failureSummary}`).join('; ')}`)
    expect(violations.length === 0, `not accessible (${colorScheme}):\n${words.join('\n')}`)
  }
  await page.emulateMedia({ colorScheme: null })
}

// All that can be used can be reached by the Tab key alone, and one sees where one is.
export async function isUsableByKeyboard(page) {
  const kMostRounds = 30
  const count = await page.evaluate(() => {
    // From the top of the page.
    document.body.tabIndex = -1
    document.body.focus()
    document.body.removeAttribute('tabindex')
    const controls = 'a[href], button:enabled, select:enabled, input:enabled, summary, [tabindex="0"]'
    const isShown = (e) => e.checkVisibility({ visibilityProperty: true }) && !e.closest('[aria-hidden="true"]') && e.tabIndex >= 0
    window.unreached = new Set([...document.querySelectorAll(controls)].filter(isShown))
    window.unseen = []
    window.arrive = () => {
      let here = document.activeElement
      while (here.shadowRoot?.activeElement) here = here.shadowRoot.activeElement
      window.unreached.delete(here)
      const framed = here.closest('.cm-editor') ?? here // the editor shows its focus around itself
      if (here !== document.body && getComputedStyle(framed).outlineStyle === 'none') window.unseen.push(here.outerHTML)
    }
    addEventListener('focusin', window.arrive)
    return window.unreached.size
  })
  // Keys are processed in their order, without waiting for each. Never more of them than there are controls left: behind the last one Firefox leaves the page.
  for (let i = 0, left = count; i < kMostRounds && left > 0; ++i) {
    await Promise.all(Array.from({ length: left }, () => page.keyboard.press('Tab')))
    left = await page.evaluate('window.unreached.size')
  }
  // The message about an order disappears by itself.
  const left = await page.evaluate('removeEventListener("focusin", window.arrive), [...window.unreached].filter((e) => e.isConnected).map((e) => e.outerHTML)')
  expect(left.length === 0, `cannot be reached by keyboard:\n${left.join('\n')}`)
  const unseen = await page.evaluate('window.unseen')
  expect(unseen.length === 0, `one does not see the focus:\n${unseen.join('\n')}`)
}

export async function picture(page, name) {
  const pictures = process.env.CULPRIT_SCREENSHOTS
  if (!pictures) return
  for (const colorScheme of ['light', 'dark']) {
    for (const [size, viewport] of [
      ['desktop', { width: 1440, height: 900 }],
      ['tablet', { width: 820, height: 1180 }],
    ]) {
      await page.emulateMedia({ colorScheme })
      await page.setViewportSize(viewport)
      await page.waitForTimeout(300) // a picture of what settles is no test
      await page.screenshot({ path: join(pictures, `${name}-${colorScheme}-${size}.png`) })
    }
  }
  await page.emulateMedia({ colorScheme: null })
  await page.setViewportSize({ width: 1440, height: 900 })
}
