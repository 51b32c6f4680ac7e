// A campaign that is started, watched and read; a result that is opened; and rules in one another's way, drawn.
import { writeFileSync } from 'node:fs'
import { culprit, expect, file, isAccessible, isUsableByKeyboard, picture, session, suite } from './session.mjs'

const kRules = `COMPONENT lamp NODE /lamp
SIGNAL brightness TOPIC /light FIELD data
RULE TooDark
  POLICIES WARNING
  TRIGGER brightness < 0.3
    STRATEGY light 90 10
      ADAPTATION lamp activate 5
RULE TooBright
  POLICIES WARNING
  TRIGGER brightness > 0.2
    STRATEGY dark 90 10
      ADAPTATION lamp deactivate 5
`
const kGuestPatience = 150_000 // ms: a campaign gets what others leave it of the machine
const path = file('lamp.rules')
writeFileSync(path, kRules)

async function conflicts(page) {
  const drawing = page.getByText('Conflicting rules')
  await drawing.waitFor()
  await page.getByText('TooDark, TooBright', { exact: true }).waitFor()
  expect((await page.locator('path.arc-undo').count()) === 1, 'the oscillation is not drawn')
  await isAccessible(page)
  await isUsableByKeyboard(page)
  await picture(page, 'conflicts')
  const trigger = page.getByRole('region', { name: 'Form' }).getByLabel('trigger').last()
  await trigger.fill('brightness > 0.7')
  await trigger.press('Tab')
  await page.getByText('Rules that adapt the same components').waitFor() // a band lies between them
}

async function campaign(page) {
  await page.getByRole('link', { name: 'Studies' }).click()
  await page.getByLabel('campaign').selectOption('sunset')
  await page.getByLabel('runs of each configuration').fill('1')
  await page.getByRole('button', { name: 'Start', exact: true }).click()
  await page.getByText(/sunset .*is running|sunset .*is done/).waitFor()
  await page.getByText('✓ is done').waitFor({ timeout: kGuestPatience })
  const findings = page.getByRole('region', { name: 'Findings' })
  await findings.getByText('sunset, 1 runs of each configuration, seed 1').waitFor()
  expect((await findings.getByRole('row').count()) > 8, 'rows are missing')
  await isAccessible(page)
  await picture(page, 'studies')

  const [report] = await Promise.all([page.waitForEvent('popup'), page.getByRole('link', { name: 'Open the report' }).click()])
  await report.getByRole('heading', { level: 1 }).waitFor()
  expect((await report.evaluate('self.origin')) === 'null', 'the report has the origin of the app')
  await report.close()
}

// A run of what was found, on the timeline: who was broken, what was done, and a moment of it.
async function run(page) {
  const single = page.getByRole('region', { name: 'Single run' })
  await single.getByRole('combobox', { name: 'manager' }).selectOption('paper, D C S, profile paper')
  await single.getByLabel('run, from 0').fill('0')
  await single.getByRole('button', { name: 'Play it again' }).click()
  const timeline = single.getByRole('region', { name: 'Timeline' })
  await timeline.getByText('faults', { exact: true }).waitFor()
  expect((await timeline.locator('rect').count()) > 0, 'no failure is on the timeline')
  expect((await timeline.getByText('▼').count()) > 0, 'no strategy is on the timeline')
  const log = single.getByRole('region', { name: 'Event log' })
  const resolved = log.locator('li', { hasText: / resolved/ })
  expect((await resolved.count()) > 0, 'no outcome is told')
  await log.locator('li', { hasText: 'is held responsible' }).last().getByRole('button').click()
  await single.getByRole('region', { name: 'Explanation' }).getByRole('row', { name: /chosen/ }).first().waitFor()
  await isAccessible(page)
  await isUsableByKeyboard(page)
  await picture(page, 'single-run')
  const slider = single.getByRole('slider')
  await slider.press('Home')
  await single.getByText('No events yet.').waitFor()
  await slider.press('End')
  await resolved.first().waitFor()
}

async function result(page) {
  const input = page.getByLabel('or open a result')
  writeFileSync(file('result.json'), JSON.stringify({ rows: [{ planner: 'mine', wrong_component: { mean: 0.25, sd: 0.5 } }] }))
  await input.setInputFiles(file('result.json'))
  await page.getByRole('cell', { name: '0.250 ± 0.500' }).waitFor()
  writeFileSync(file('nonsense.json'), '{"rows": 1}')
  await input.setInputFiles(file('nonsense.json'))
  await page.getByText('it has no rows').waitFor()
  await page.getByText('does not say which campaign').waitFor() // of the one before, which stays
}

// A file that culprit study wrote: its runs can be played, too, also those of a manager that reports no events.
async function opened(page) {
  await culprit(['study', 'suave', '--managers', 'bt,culprit', '--runs', '2', '--json', '-o', file('suave.json')])
  await page.getByLabel('or open a result').setInputFiles(file('suave.json'))
  const single = page.getByRole('region', { name: 'Single run' })
  await single.getByRole('button', { name: 'Play it again' }).click()
  await single.getByText('This manager reports no events').waitFor()
  const log = single.getByRole('region', { name: 'Event log' })
  await log.getByText('it inspects').waitFor()
  await single.getByRole('combobox', { name: 'manager' }).selectOption('culprit')
  await single.getByRole('button', { name: 'Play it again' }).click()
  await single.getByText('No rule sees a failure').waitFor()
  await log.getByText('thruster 1 fails').waitFor()
  await log.getByText(/ resolved by /).first().waitFor()
}

process.env.XDG_STATE_HOME = file('studies') // where campaigns leave their results
await suite(() =>
  session(['web', path], async (page) => {
    await conflicts(page)
    await campaign(page)
    await run(page)
    await result(page)
    await opened(page)
  })
)
