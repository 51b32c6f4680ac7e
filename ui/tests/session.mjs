// A person at the page: culprit as it is, its page in Debian's Chromium, and what goes wrong in it.
//
//     node <test>.mjs <culprit> <folder of node_modules> <folder for files>
//
// CULPRIT_SCREENSHOTS=<folder> also takes pictures.
import { execFile, spawn } from 'node:child_process'
import { mkdtempSync, readFileSync, rmSync } from 'node:fs'
import { createRequire } from 'node:module'
import { join } from 'node:path'
import { promisify } from 'node:util'
import { stub } from './stub.mjs'

const [program, modules, folder] = process.argv.slice(2)
const require = createRequire(join(modules, 'package.json'))
const { chromium } = require('playwright-core')
const axe = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8')

const kPatience = Number(process.env.CULPRIT_PATIENCE ?? 60_000) // ms, for what a robot takes its time for

export const file = (name) => join(folder, name)

// Runs culprit to its end.
export const culprit = (args) => promisify(execFile)(program, args)

// Starts culprit and waits for the address that it prints.
function serve(args) {
  const server = spawn(program, args, { stdio: ['ignore', 'pipe', 'inherit'] })
  let said = ''
  const address = new Promise((resolve, reject) => {
    server.stdout.on('data', (data) => {
      said += data
      const match = /(http:\/\/\S+#token=\S+)/.exec(said)
      if (match) resolve(match[1])
    })
    server.on('exit', () => reject(new Error(`culprit ended: ${said}`)))
  })
  const end = () =>
    new Promise((resolve) => {
      if (server.exitCode !== null) return resolve()
      server.on('exit', resolve)
      server.kill('SIGINT')
    })
  return { address, end, said: () => said }
}

export function expect(condition, message) {
  if (!condition) throw new Error(message)
}

// Waits until `holds`.
export async function expectSoon(holds, message) {
  const end = Date.now() + kPatience
  while (!holds() && Date.now() < end) await new Promise((resolve) => setTimeout(resolve, 10))
  expect(holds(), message)
}

// Runs `steps` with a page of `culprit <args>`, and what it prints.
export const session = (args, steps) => browse(serve([...args, '--port', '0']), steps)

// Runs `steps` with a page of a stub that answers these calls (stub.mjs).
export async function stubbed(calls, steps) {
  const server = await stub(modules, calls)
  await browse({ ...server, address: Promise.resolve(server.address) }, steps)
}

// Whatever the page complains of is a failure.
async function browse(server, steps) {
  const profile = mkdtempSync(join(folder, 'browser-'))
  const complaints = []
  let browser
  try {
    const address = await server.address
    browser = await chromium.launchPersistentContext(profile, {
      executablePath: '/usr/bin/chromium',
      args: [
        '--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run',
        '--disable-background-networking', '--disable-component-update', '--disable-sync',
      ],
      viewport: { width: 1440, height: 900 },
    })
    const page = browser.pages()[0] ?? (await browser.newPage())
    page.setDefaultTimeout(kPatience)
    page.on('pageerror', (error) => complaints.push(String(error)))
    page.on('console', (message) => {
      // What the server refuses, and that it is gone, is told to the person by the page itself.
      const isRefusal = /responded with a status of 4|ERR_INCOMPLETE_CHUNKED|ERR_CONNECTION_(REFUSED|RESET)|ERR_EMPTY_RESPONSE/.test(message.text())
      if (message.type() === 'error' && !isRefusal) complaints.push(message.text())
    })
    await page.goto(address)
    await steps(page, server)
    expect(complaints.length === 0, `the page complains: ${complaints.join('\n')}`)
    console.log('the session passed')
  } catch (error) {
    console.error(error, complaints)
    process.exitCode = 1
  } finally {
    await browser?.close()
    await server.end()
    rmSync(profile, { recursive: true, force: true })
  }
}

// No serious issue of accessibility, in either colour scheme.
export async function isAccessible(page) {
  for (const colorScheme of ['light', 'dark']) {
    await page.emulateMedia({ colorScheme })
    await page.evaluate(axe)
    const { violations } = await page.evaluate('axe.run()')
    const serious = violations.filter((v) => v.impact === 'serious' || v.impact === 'critical')
    const words = serious.map((v) => `${v.id}: ${v.nodes.map((n) => `${n.html} ${n.failureSummary}`).join('; ')}`)
    expect(serious.length === 0, `not accessible (${colorScheme}):\n${words.join('\n')}`)
  }
  await page.emulateMedia({ colorScheme: null })
}

// All that can be used can be reached by the Tab key alone, and one sees where one is.
export async function isUsableByKeyboard(page) {
  const kControls = 'a[href], button:enabled, select:enabled, input:enabled, summary, [tabindex="0"]'
  await page.evaluate((controls) => {
    document.activeElement.blur()
    const isShown = (e) => e.checkVisibility({ visibilityProperty: true }) && !e.closest('[aria-hidden="true"]')
    window.unreached = new Set([...document.querySelectorAll(controls)].filter(isShown))
    window.unseen = []
  }, kControls)
  const most = 3 * (await page.evaluate('window.unreached.size'))
  for (let i = 0; i < most && (await page.evaluate('window.unreached.size')) > 0; ++i) {
    await page.keyboard.press('Tab')
    await page.evaluate(() => {
      let here = document.activeElement
      while (here.shadowRoot?.activeElement) here = here.shadowRoot.activeElement
      window.unreached.delete(here)
      const framed = here.closest('.cm-editor') ?? here // the editor shows its focus around itself
      if (here !== document.body && getComputedStyle(framed).outlineStyle === 'none') window.unseen.push(here.outerHTML)
    })
  }
  // What is told of an order leaves by itself.
  const left = await page.evaluate('[...window.unreached].filter((e) => e.isConnected).map((e) => e.outerHTML)')
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
