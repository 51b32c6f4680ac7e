// A person in charge of a robot that runs: approves a repair, changes a rule and reloads it, takes what was learned
// along; and names that are meant to harm are only names.
//
//     node operator.mjs <culprit> <node_modules> <folder>, with SUNSET's camera running in the DDS domain
import { readFileSync, writeFileSync } from 'node:fs'
import { culprit, expect, expectSoon, file, isAccessible, picture, saved, session, suite } from './session.mjs'

const kRules = `ROBOT one_camera
COMPONENT camera NODE /managed_subsystem/camera LAUNCH "sunset-node camera"
RULE CameraGone
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY camera_redeploy 90 10
      ADAPTATION camera redeploy 5
`
const path = file('operator.rules')
writeFileSync(path, kRules)
writeFileSync(file('token'), 'a-token-that-lasts\n', { mode: 0o600 })
const kArguments = ['run', path, '--web', '--approve', '--settle', '2', '--healthy', '0', '--record', '--record-after', '0', '--state-dir', file('state'), '--token-file', file('token')]

// The process that culprit says the camera to be, newest last.
const cameras = (said) => [...said.matchAll(/camera is there \(process (\d+)/g)].map((m) => Number(m[1]))

// The page decides nothing: at the same moment it shows what `culprit status --json` says, and no other incident.
async function saysAsTheTerminal(page, moment) {
  const region = (name) => page.getByRole('region', { name })
  let seen = ''
  await expectSoon(async () => {
    const output = await culprit(['status', '--json']).catch((error) => error) // it exits with 1 where something is wrong
    const { state } = JSON.parse(output.stdout).culprits[0]
    const shown = {
      headline: await region('Status').locator('.cause b').innerText(),
      incidents: await region('Explanation').locator('[data-incident]').evaluateAll((all) => all.map((each) => each.dataset.incident)),
      looks: await region('Components').locator('ul button').evaluateAll((all) => all.map((each) => each.className.replace('look-', '')).sort()),
    }
    const told = { headline: (state.incidents[0] ?? state.overview).headline, incidents: state.incidents.map((each) => each.id), looks: state.components.map((each) => each.look).sort() }
    seen = JSON.stringify({ shown, told })
    return shown.headline.toLowerCase().startsWith(told.headline.toLowerCase()) && shown.incidents.join() === told.incidents.join() && shown.looks.join() === told.looks.join()
  }, `the page and the terminal do not say the same (${moment})`).catch((error) => {
    throw new Error(`${error.message}: ${seen}`)
  })
}

async function approve(page, program) {
  const log = page.getByRole('region', { name: 'Event log' })
  await log.getByText('camera is there').first().waitFor()
  await saysAsTheTerminal(page, 'all is well')
  process.kill(cameras(program.said()).at(-1), 'SIGKILL')
  const question = page.getByRole('alert', { name: 'Approve camera_redeploy?' })
  await question.getByText('redeploy camera').waitFor()
  await saysAsTheTerminal(page, 'it waits for approval')
  await isAccessible(page)
  await picture(page, 'approval')
  await question.getByRole('button', { name: 'Approve' }).click()
  await log.getByText('CameraGone resolved by camera_redeploy').waitFor()
  await question.waitFor({ state: 'detached' })
  await saysAsTheTerminal(page, 'it is healed')
}

async function reload(page) {
  await page.getByRole('link', { name: 'Rules', exact: true }).click()
  const percent = page.getByRole('group', { name: 'Strategy camera_redeploy' }).getByLabel('helps in %')
  await percent.fill('70')
  await percent.press('Tab')
  await page.getByText('changed', { exact: true }).waitFor()
  expect(await page.getByRole('button', { name: 'Reload', exact: true }).isDisabled(), 'what is not saved is reloaded')
  await page.getByRole('button', { name: 'Save …' }).click()
  const dialog = page.getByRole('dialog')
  await dialog.getByText('+     STRATEGY camera_redeploy 70 10').waitFor()
  await dialog.getByRole('button', { name: 'Save and reload' }).click()
  await page.getByText('Reloading the rules: done').waitFor()
  await page.getByRole('link', { name: 'Robot' }).click()
  const log = page.getByRole('region', { name: 'Event log' })
  await log.getByText(`${path} is reloaded, with 1 rule`).waitFor()
  expect(readFileSync(path, 'utf8').includes('camera_redeploy 70 10'), 'the file was not saved')
  await page.getByRole('region', { name: 'Explanation' }).getByText('All is well').waitFor()
}

// The designer's number is the new one, and what was learned is still known.
async function beliefs(page) {
  await page.getByRole('link', { name: 'Beliefs' }).click()
  const row = page.getByRole('row', { name: /CameraGone\.camera_redeploy/ })
  await row.getByText('70 %').first().waitFor()
  await row.getByText('1 outcome').waitFor()
  const learned = JSON.parse((await saved(page, () => page.getByRole('button', { name: 'Export …' }).click())).content)
  expect(learned.format === 'culprit-beliefs', 'another format is exported')
  expect(learned.beliefs[0].strategy === 'camera_redeploy', JSON.stringify(learned))
  await page.getByRole('button', { name: 'Reset all …' }).click()
  await isAccessible(page)
  await page.getByRole('button', { name: 'Forget', exact: true }).click()
  await row.getByText('nothing yet').waitFor()
}

// The incidents come from the journal: also from the next culprit, at the same address.
async function lookBack(page, program) {
  await page.getByRole('link', { name: 'Incidents' }).click()
  const row = page.getByRole('row', { name: /camera.*camera_redeploy/ })
  await row.getByRole('link').click()
  const address = new URL(page.url()).hash
  const incident = page.getByRole('region', { name: 'Incident', exact: true })
  await incident.getByText('camera is lost').waitFor()
  await program.end('SIGKILL')
  await page.getByRole('region', { name: 'Status' }).getByText('Disconnected').waitFor()
  await program.again()
  await page.getByRole('region', { name: 'Status' }).getByText('All is well').waitFor()
  await page.reload()
  expect(new URL(page.url()).hash === address, 'the link is another')
  await incident.getByText('camera is lost').waitFor()
  await incident.getByText('Outcome: camera_redeploy').waitFor()
}

// The next culprit has nothing of it in memory: the plot comes from the journal, which says how far back it reaches.
async function plotThePast(page) {
  const address = new URL(page.url()).hash
  await page.evaluate(() => (location.hash = 'plots/s=input+alive(camera)&last=600'))
  await page.getByText(/^Plots reach back to .*: the journal begins then/).waitFor()
  const values = async () => {
    const { content } = await saved(page, () => page.getByRole('button', { name: 'Save as CSV' }).click())
    return new Set(content.toString().trim().split('\n').slice(1).map((row) => row.split(',').at(-1)))
  }
  await expectSoon(async () => (await values()).has('0'), 'the plot does not show that the camera was dead')
  await page.getByRole('region', { name: 'Marks' }).getByText('CameraGone resolved by camera_redeploy').first().waitFor()
  await page.evaluate((hash) => (location.hash = hash), address)
}

// One file for readers without the robot or culprit, made by a process of its own from journal and recording.
async function send(page) {
  const incident = page.getByRole('region', { name: 'Incident', exact: true })
  const html = (await saved(page, () => incident.getByRole('button', { name: 'Save as a page to send …' }).click())).content.toString()
  expect(!/<script|src=|href=|@import|url\(/.test(html), 'the file needs something beside itself')
  const reader = await page.context().newPage()
  await reader.setContent(html)
  await reader.getByRole('heading', { name: /^camera, / }).waitFor()
  await reader.getByRole('heading', { name: 'What was recorded' }).waitFor()
  await reader.getByText(/The plots are from one-camera_.*_CameraGone\.mcap/).waitFor()
  await reader.getByRole('cell', { name: 'CameraGone resolved by camera_redeploy' }).waitFor()
  await isAccessible(reader)
  await picture(reader, 'incident-page')
  await reader.setViewportSize({ width: 390, height: 844 })
  expect(await reader.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'on a phone the file is wider than the screen')
  await reader.close()
}

// Before a rule is saved: what it would have done when the camera died.
async function hindsight(page) {
  await page.getByRole('link', { name: 'Rules', exact: true }).click()
  const form = page.getByRole('region', { name: 'Form' })
  const rule = form.getByLabel('rule', { exact: true })
  await rule.fill('CameraDead')
  await rule.press('Tab')
  await page.locator('.cm-content').filter({ hasText: 'RULE CameraDead' }).waitFor()
  await form.getByText('What would these rules have done?').click()
  await form.getByRole('button', { name: 'Look back' }).click()
  await form.getByRole('row', { name: /CameraDead one failure.*camera_redeploy 1 × no failure/ }).waitFor()
  await form.getByRole('row', { name: /CameraGone no failure one failure/ }).waitFor()
  await form.getByText(/it would have seen one failure/).waitFor()
  await isAccessible(page)
  await picture(page, 'hindsight')
}

// The doctor examines the node, and a component's panel shows its usage.
async function examine(page) {
  await page.getByRole('link', { name: 'Doctor' }).click()
  await page.getByLabel('look for').selectOption('4 s')
  await page.getByRole('button', { name: 'Examine' }).click()
  await page.getByText(/nodes? on domain/).waitFor()
  await page.getByRole('link', { name: 'Robot' }).click()
  await page.getByRole('region', { name: 'Components' }).getByRole('button', { name: 'camera' }).click()
  const panel = page.getByRole('region', { name: 'About camera' })
  await panel.getByText('% of a core').waitFor()
  await panel.getByText(/Parameters \(\d+\)/).waitFor()
  await page.getByRole('button', { name: 'Show all', exact: true }).click()
}

const kEvil = '<img src=x onerror="window.wasHarmed = true">'
const kEvilStream = {
  robot: { robot: kEvil, cycle_s: 0.2, components: [{ name: kEvil, can_start: false }], topics: [kEvil], inputs: [], rules: [] },
  graph: { nodes: [{ node: kEvil, present: true, component: kEvil }], edges: [[kEvil, `${kEvil}2`, kEvil]] },
  state: { t: 1, clock: 1, rules: [], incidents: [], overview: { look: 'OK', headline: kEvil, detail: kEvil }, components: [{ health: 'OK', look: 'DEAD', condition: kEvil, present: true, alive: true, remark: kEvil }], topics: [{ rate: 1, age: 0 }], inputs: [], beliefs: [], priors: [] },
  event: { t: 1, type: 'trouble', label: kEvil, severity: 'warning', tone: kEvil, text: kEvil },
}

async function isHarmless(page) {
  const body = Object.entries(kEvilStream).map(([kind, data]) => `event: ${kind}\ndata: ${JSON.stringify(data)}\n\n`)
  await page.route('**/api/stream', (route) => route.fulfill({ contentType: 'text/event-stream', body: body.join('') }))
  await page.goto(`${new URL(page.url()).origin}/#robot`)
  await page.reload()
  await page.getByRole('heading', { name: kEvil }).waitFor()
  const component = page.getByRole('button', { name: kEvil }).first()
  await component.click()
  await page.getByRole('region', { name: 'Event log' }).getByText(kEvil).first().waitFor()
  expect((await page.locator('img').count()) === 0, 'a name became an element')
  expect(!(await page.evaluate('window.wasHarmed')), 'a name was run')
}

await suite(() =>
  session(kArguments, async (page, program) => {
    try {
      await approve(page, program)
      await reload(page)
      await beliefs(page)
      await examine(page)
      await lookBack(page, program)
      await plotThePast(page)
      await send(page)
      await hindsight(page)
      await isHarmless(page)
    } finally {
      for (const pid of cameras(program.said())) {
        try {
          process.kill(pid, 'SIGKILL') // culprit leaves the robot running
        } catch {
          // It ended before.
        }
      }
    }
  })
)
