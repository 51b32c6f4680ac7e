// No text is lost: not by a mistake in a field, a reload, a wrong key, or another client that
// writes the same file.
import { cpSync, readFileSync, writeFileSync } from 'node:fs'
import { dirname, join } from 'node:path'
import { fileURLToPath } from 'node:url'
import { expect, file, isAccessible, picture, session } from './session.mjs'

const kRules = `COMPONENT camera  NODE /camera
COMPONENT lidar   NODE /lidar

RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/rgb) > 500ms
    STRATEGY wake 50 10
      ADAPTATION camera restart 5

RULE LidarSilent
  POLICIES WARNING
  TRIGGER age(/scan) > 1s
    STRATEGY turn 60 10
      ADAPTATION lidar restart 5
`
const path = file('drafts.rules')
writeFileSync(path, kRules)

const formOf = (page) => page.getByRole('region', { name: 'Form' })
const text = (page) => page.locator('.cm-content')
async function enter(field, value) {
  await field.fill(value)
  await field.press('Tab')
}

// A mistake stays in its field, with its message; all other fields work on.
async function mistake(page) {
  const form = formOf(page)
  const trigger = form.getByLabel('trigger').first()
  await enter(trigger, 'nonsense(( > 3')
  const alert = form.getByRole('alert')
  await alert.getByText('Not taken: there is no function').waitFor()
  expect(!(await alert.innerText()).includes('/statements'), 'the message is for programs')
  expect((await trigger.inputValue()) === 'nonsense(( > 3', 'what was entered is gone')
  await isAccessible(page)
  await picture(page, 'mistake')
  await enter(form.getByLabel('helps in %').first(), '77')
  await text(page).filter({ hasText: 'STRATEGY wake 77 10' }).waitFor()
  expect(await page.getByRole('button', { name: 'Save …' }).isDisabled(), 'what was not taken can be saved over')
  await trigger.press('Escape')
  await alert.waitFor({ state: 'detached' })
  expect((await trigger.inputValue()) === 'age(/rgb) > 500ms', 'Escape does not bring back what stood there')
}

async function reload(page) {
  await page.reload()
  const draft = page.getByRole('status', { name: 'Draft' })
  await draft.getByText('is restored').waitFor()
  await text(page).filter({ hasText: 'STRATEGY wake 77 10' }).waitFor()
  await isAccessible(page)
  await draft.getByRole('button', { name: 'Keep it' }).click()
}

async function slip(page) {
  await page.getByRole('button', { name: 'Remove rule LidarSilent' }).click()
  await text(page).filter({ hasNotText: 'LidarSilent' }).waitFor()
  await page.getByRole('status', { name: 'Notice' }).getByRole('button', { name: 'Undo' }).click()
  await text(page).filter({ hasText: 'LidarSilent' }).waitFor()
  await formOf(page).getByRole('group', { name: 'Strategy turn' }).waitFor()
  // The same by keyboard, wherever the focus is.
  await page.getByRole('button', { name: 'Remove rule LidarSilent' }).click()
  await text(page).filter({ hasNotText: 'LidarSilent' }).waitFor()
  await page.keyboard.press('Control+z')
  await text(page).filter({ hasText: 'LidarSilent' }).waitFor()
  await page.keyboard.press('Control+Shift+z')
  await text(page).filter({ hasNotText: 'LidarSilent' }).waitFor()
  await page.keyboard.press('Control+z')
  await text(page).filter({ hasText: 'LidarSilent' }).waitFor()
}

async function save(page) {
  await page.getByRole('button', { name: 'Save …' }).click()
  await page.getByRole('dialog').getByRole('button', { name: 'Save', exact: true }).click()
}

async function conflict(page) {
  writeFileSync(path, kRules.replace('turn 60 10', 'turn 61 10'))
  await save(page)
  const both = page.getByRole('alert', { name: 'Conflict' })
  await both.getByText('+     STRATEGY turn 61 10').waitFor()
  expect((await page.getByRole('dialog').count()) === 0, 'the conflict is behind a dialog')
  expect(!readFileSync(path, 'utf8').includes('wake 77'), 'it was written nevertheless')
  await isAccessible(page)
  await picture(page, 'rules-conflict')
  await page.reload() // the conflict is not forgotten, either
  await both.getByRole('button', { name: 'Merge both' }).click()
  await save(page)
  await page.getByText('as saved').waitFor()
  const saved = readFileSync(path, 'utf8')
  expect(saved === kRules.replace('turn 60', 'turn 61').replace('wake 50', 'wake 77'), `this was saved:\n${saved}`)
}

// Both changed the same line: a person says which it shall be.
async function choice(page) {
  await enter(formOf(page).getByLabel('helps in %').first(), '78')
  await text(page).filter({ hasText: 'wake 78' }).waitFor()
  writeFileSync(path, readFileSync(path, 'utf8').replace('wake 77', 'wake 70'))
  await save(page)
  const both = page.getByRole('alert', { name: 'Conflict' })
  await both.getByText('cannot be merged').waitFor()
  expect((await both.getByRole('button', { name: 'Merge both' }).count()) === 0, 'a wrong merge is offered')
  await both.getByRole('button', { name: 'Keep mine' }).click()
  await save(page)
  await page.getByText('as saved').waitFor()
  expect(readFileSync(path, 'utf8').includes('wake 78'), 'mine was not kept')
}

async function aNewRule(page) {
  await page.getByRole('button', { name: '+ Rule' }).click()
  await text(page).filter({ hasText: 'alive(' }).waitFor()
  await page.getByText('no errors').waitFor()
  // Its trigger, said as a sentence by choosing and typing, and read back from what was typed as text.
  const sentence = formOf(page).getByRole('group', { name: 'Sentence' }).last()
  const clause = (place) => sentence.locator('.clause').nth(place)
  await clause(0).getByLabel('what is looked at').selectOption('a topic is silent for longer than')
  await enter(clause(0).getByLabel('its name'), '/scan')
  await enter(clause(0).getByLabel('how much'), '2s')
  await sentence.getByRole('button', { name: '+ condition' }).click()
  await clause(1).getByLabel('what is looked at').selectOption('the lifecycle of a component')
  await enter(clause(1).getByLabel('its name'), 'lidar')
  await clause(1).getByLabel('how it compares').selectOption('is')
  await clause(1).getByLabel('which state').selectOption('inactive')
  await text(page).filter({ hasText: 'TRIGGER age(/scan) > 2s && lifecycle(lidar) == "inactive"' }).waitFor()
  await isAccessible(page)
  await picture(page, 'sentence')
  const trigger = formOf(page).getByLabel('trigger').last()
  await enter(trigger, 'rate(/scan) < 3')
  await page.waitForFunction(() => [...document.querySelectorAll('.clause select')].at(-1).value === 'slow') // it follows the text
  await enter(trigger, 'age(/scan) > 2s || alive(lidar) == false')
  await page.waitForFunction(() => [...document.querySelectorAll('.sentence')].at(-1).querySelector('[aria-label="how many have to hold"]')?.value === '||')
}

// Each kind of declaration by clicks alone: written, and read back as it was entered.
async function declarations(page) {
  const form = formOf(page)
  await form.getByText('Declared components').click()
  const group = (name) => form.getByRole('group', { name, exact: true })
  const add = (title) => form.getByRole('button', { name: `+ ${title}`, exact: true }).click()
  const wrote = (line) => text(page).filter({ hasText: line }).waitFor()
  await add('Component')
  await enter(group('Component my_node').getByLabel('node', { exact: true }), '/arm')
  await group('Component my_node').getByLabel('started by').selectOption('systemd')
  await enter(group('Component my_node').getByLabel('unit'), 'arm.service')
  await enter(group('Component my_node').getByLabel('name'), 'arm')
  await wrote(/COMPONENT arm\s+NODE \/arm\s+UNIT arm\.service/)
  await add('Signal')
  await enter(group('Signal my_signal').getByLabel('topic'), '/arm/load')
  await group('Signal my_signal').getByLabel('say more').selectOption('stale')
  await wrote(/SIGNAL my_signal\s+TOPIC \/arm\/load FIELD data\s+STALE 1s/)
  await add('Constant')
  await enter(group('Constant limit').getByLabel('value'), '0.8')
  await wrote(/CONST limit\s*= 0\.8/)
  await add('Dependency')
  await enter(group('Dependency camera').getByLabel('producers'), 'lidar arm')
  await wrote(/DEPENDENCY camera ON lidar arm/)
  await add('Interlock')
  await enter(group('Interlock').getByLabel('expression'), 'my_signal > limit')
  await wrote('INTERLOCK my_signal > limit')
  const wake = group('Strategy wake')
  await wake.getByLabel('as a last resort').check()
  await wrote('STRATEGY wake 78 10 LASTRESORT')
  await wake.getByLabel('as a last resort').uncheck()
  await form.getByLabel('on change').first().check()
  await wrote('POLICIES ERROR ON_CHANGE')
  await form.getByLabel('on change').first().uncheck()
  await page.getByText('no errors').waitFor()
  await isAccessible(page)
  await picture(page, 'declarations')
}

// A template of others for a common failure, with the user's own names in it.
async function template(page) {
  const form = formOf(page)
  await form.getByLabel('Begin with a template').selectOption({ label: 'A camera stalls: its node lives, its pictures stop' })
  const fill = form.getByRole('region', { name: 'Template' })
  await fill.getByLabel('node /front/camera_driver is here').fill('/camera')
  await fill.getByLabel('topic /front/image_raw is here').fill('/rgb')
  await fill.getByText('Text of the template').click()
  await isAccessible(page)
  await picture(page, 'template')
  await fill.getByRole('button', { name: 'Add it' }).click()
  await text(page).filter({ hasText: 'TRIGGER age(/rgb) > silence' }).waitFor()
  await text(page).filter({ hasText: 'CONST silence' }).waitFor()
  await page.getByText('no errors').waitFor()
  expect(!(await text(page).innerText()).includes('/front/'), 'a name of the template is left')
}

// A template of a pack: included, its component declared, used; and all of it taken back by one Undo.
async function pack(page) {
  const form = formOf(page)
  const before = await text(page).innerText()
  await form.getByLabel('Begin with a template').selectOption('sick_scan_xd')
  const fill = form.getByRole('region', { name: 'Template' })
  await fill.getByText('sick_scan_xd reconnects').waitFor() // what its author says of it
  await fill.getByLabel('name').fill('sick')
  await fill.getByLabel('topic').fill('/sick/scan')
  await fill.getByLabel('hz').fill('15')
  await isAccessible(page)
  await picture(page, 'pack')
  await fill.getByRole('button', { name: 'Add it' }).click()
  for (const line of [/INCLUDE "packs\/lidars.rules"/, /COMPONENT sick\s+NODE \/sick/, /USE sick_scan_xd\(sick, \/sick\/scan, 15\)/]) await text(page).filter({ hasText: line }).waitFor()
  await page.getByText("no strategy of rule 'sick_gone' can ever run").waitFor() // no owner is named yet
  await form.getByText('From other files and templates: packs/lidars.rules, sick_scan_xd').waitFor()
  await page.getByRole('status', { name: 'Notice' }).getByRole('button', { name: 'Undo' }).click()
  await text(page).filter({ hasNotText: 'USE sick_scan_xd' }).waitFor()
  expect((await text(page).innerText()) === before, 'not all of it was taken back')
}

// The server goes while one writes, and comes back: what was written is there, and is saved.
async function noServer(page, server) {
  await enter(formOf(page).getByLabel('helps in %').first(), '55')
  await text(page).filter({ hasText: 'wake 55' }).waitFor()
  await server.end()
  const bar = page.getByRole('region', { name: 'Status' })
  await bar.getByText('Disconnected').waitFor()
  await page.getByRole('button', { name: 'Save …' }).click()
  const dialog = page.getByRole('dialog')
  await dialog.getByRole('button', { name: 'Save', exact: true }).click()
  await dialog.getByText('is kept in this browser').waitFor()
  await server.again()
  await bar.getByText('Disconnected').waitFor({ state: 'detached' })
  await dialog.getByRole('button', { name: 'Save', exact: true }).click()
  await page.getByText('as saved').waitFor()
  expect(readFileSync(path, 'utf8').includes('wake 55'), 'it was not saved')
}

export async function losesNothingThatWasWritten() {
  cpSync(join(dirname(fileURLToPath(import.meta.url)), '../../rules/packs'), file('packs'), { recursive: true })
  writeFileSync(file('token'), 'a-token-that-lasts\n', { mode: 0o600 })
  await session(['web', path, '--token-file', file('token')], async (page, server) => {
    await mistake(page)
    await reload(page)
    await slip(page)
    await conflict(page)
    await choice(page)
    await aNewRule(page)
    await declarations(page)
    await template(page)
    await pack(page)
    await noServer(page, server)
  })
}
