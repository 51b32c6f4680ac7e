// A person at the page: culprit as it is, its page in Debian's Chromium, and what goes wrong in it.
//
//     node <test>.mjs <culprit> <folder of node_modules> <folder for files>
//
// One browser for all sessions of a test. CULPRIT_SCREENSHOTS=<folder> also takes pictures; CULPRIT_FRESH_PAGE=1 serves the page
// as it is in ui/src, in place of the one that is part of the program.
import { execFile, spawn } from 'node:child_process'
import { readFileSync } from 'node:fs'
import { createRequire } from 'node:module'
import { dirname, join } from 'node:path'
import { fileURLToPath } from 'node:url'
import { promisify } from 'node:util'
import { bundle } from '../bundle.mjs'
import { stub } from './stub.mjs'

const [program, modules, folder] = process.argv.slice(2)
const require = createRequire(join(modules, 'package.json'))
const { chromium } = require('playwright-core')
const axe = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8')

const kPatience = Number(process.env.CULPRIT_PATIENCE ?? 60_000) // ms, for what a robot takes its time for

export const file = (name) => join(folder, name)

// Runs culprit to its end.
export const culprit = (args) => promisify(execFile)(program, args)

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
  const server = await stub(modules, calls)
  await browse({ ...server, address: Promise.resolve(server.address) }, steps, now, hasTour)
}

let browser = null
async function newPage(hasTour) {
  browser ??= await chromium.launch({
    executablePath: '/usr/bin/chromium-headless-shell',
    args: [
      '--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run',
      '--disable-background-networking', '--disable-component-update', '--disable-sync',
    ],
    env: { ...process.env, TMPDIR: folder, TZ: 'UTC', FONTCONFIG_FILE: join(dirname(fileURLToPath(import.meta.url)), 'fonts.conf') },
  })
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 } })
  if (!hasTour) await context.addInitScript(() => localStorage.setItem('culprit-tour', 'ended'))
  if (process.env.CULPRIT_FRESH_PAGE) {
    for (const { path, type, contents } of bundle(modules))
      await context.route((url) => url.pathname === path, (route) => route.fulfill({ contentType: type, body: Buffer.from(contents) }))
  }
  return context.newPage()
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

// axe finds no barrier in either colour scheme.
export async function isAccessible(page) {
  for (const colorScheme of ['light', 'dark']) {
    await page.emulateMedia({ colorScheme })
    if (!(await page.evaluate('!!window.axe'))) await page.evaluate(axe)
    // The second scheme only changes the colours.
    const options = colorScheme === 'light' ? {} : { runOnly: ['color-contrast'] }
    const { violations } = await page.evaluate((o) => window.axe.run(document, o), options)
    const words = violations.map((v) => `${v.id}: ${v.nodes.map((n) => `${n.html} ${n.failureSummary}`).join('; ')}`)
    expect(violations.length === 0, `not accessible (${colorScheme}):\n${words.join('\n')}`)
  }
  await page.emulateMedia({ colorScheme: null })
}

// All that can be used can be reached by the Tab key alone, and one sees where one is.
export async function isUsableByKeyboard(page) {
  const count = await page.evaluate(() => {
    document.activeElement.blur()
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
  // Keys are processed in their order, without waiting for each.
  for (let i = 0; i < 3 && (await page.evaluate('window.unreached.size')) > 0; ++i)
    await Promise.all(Array.from({ length: count + 2 }, () => page.keyboard.press('Tab')))
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
