// The paper's rule SegmentationBad, from nothing, in the form.
import { readFileSync, writeFileSync } from 'node:fs'
import { expect, expectSoon, file, isAccessible, picture, session } from './session.mjs'

const kRule = `RULE SegmentationBad
  POLICIES WARNING
  TRIGGER segmentation_entropy > 0.06
    STRATEGY recalibration 80 50
      ADAPTATION fusion set_parameter recalibration true 2
    STRATEGY enhancement_activate 10 50
      ADAPTATION image_enhancement activate 5
      ADAPTATION fusion change_communication camera_input rgb_enhanced 2
    STRATEGY enhancement_deactivate 10 10
      ADAPTATION image_enhancement deactivate 5
      ADAPTATION fusion change_communication camera_input rgb_raw 2
`

export async function buildsThePapersRule() {
  const path = file('new.rules')
  await session(['web', path], async (page) => {
    const form = page.getByRole('region', { name: 'Form' })
    // Enters a value and leaves the field, as a person does; the form follows the file.
    const fill = async (within, label, value) => {
      const field = within.getByLabel(label, { exact: true }).last()
      await field.fill(value)
      await field.press('Tab')
      await page.locator('.cm-content').filter({ hasText: value }).waitFor()
    }
    await form.getByRole('button', { name: '+ Rule' }).click()
    await fill(form, 'rule', 'SegmentationBad')
    await form.getByLabel('criticality').selectOption('WARNING')
    await fill(form, 'trigger', 'segmentation_entropy > 0.06')

    const named = (name) => form.getByRole('group', { name: `Strategy ${name}`, exact: true })
    // Into the strategy that was just added.
    const strategy = async (name, percent, confidence) => {
      await fill(named('strategy'), 'name', name)
      await fill(named(name), 'helps in %', percent)
      await fill(named(name), 'confidence', confidence)
      return named(name)
    }
    // Into the last adaptation.
    const adaptation = async (within, type, members) => {
      await within.getByLabel('type').last().selectOption(type)
      for (const [label, value] of Object.entries(members)) await fill(within, label, value)
    }
    const add = (within, what) => within.getByRole('button', { name: `+ ${what}` }).click()
    const input = (topic) => ({ component: 'fusion', parameter: 'camera_input', topic, impact: '2' })

    const recalibration = await strategy('recalibration', '80', '50')
    const parameter = { component: 'fusion', parameter: 'recalibration', impact: '2' }
    await adaptation(recalibration, 'set_parameter', parameter)
    for (const [type, confidence, topic] of [['activate', '50', 'rgb_enhanced'], ['deactivate', '10', 'rgb_raw']]) {
      await add(form, 'Strategy')
      const enhancement = await strategy(`enhancement_${type}`, '10', confidence)
      await adaptation(enhancement, type, { component: 'image_enhancement', impact: '5' })
      await add(enhancement, 'Adaptation')
      await adaptation(enhancement, 'change_communication', input(topic))
    }
    await page.getByText('no errors').waitFor()
    await picture(page, 'form')
    await isAccessible(page)

    await page.getByRole('button', { name: 'Save …' }).click()
    await page.getByRole('dialog').getByText('+ RULE SegmentationBad').waitFor()
    await picture(page, 'save')
    await page.getByRole('dialog').getByRole('button', { name: 'Save', exact: true }).click()
    await page.getByText('as saved').waitFor()
    const saved = readFileSync(path, 'utf8').trim() + '\n'
    expect(saved === kRule, `this was saved:\n${saved}`)
  })
}

const kHelpful = `COMPONENT camera NODE /camera
COMPONENT viewer NODE /viewer
DEPENDENCY viewer ON camera

RULE CameraSilent
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY again 50 10
      ADAPTATION camera restart 5
`

// A rule that cannot help is an error as soon as it is written, before anybody saves it; and it is gone with its cause.
export async function saysThatARuleCannotHelp() {
  const path = file('helpless.rules')
  writeFileSync(path, kHelpful)
  await session(['web', path], async (page) => {
    const form = page.getByRole('region', { name: 'Form' })
    const found = page.getByRole('list', { name: 'Findings of the check' })
    const strategy = form.getByRole('group', { name: 'Strategy again', exact: true })
    await page.getByText('no errors').waitFor()
    await strategy.getByLabel('type').last().selectOption('redeploy')
    await found.getByText("no strategy of rule 'CameraSilent' can ever run: component 'camera' has no LAUNCH command").waitFor()
    await page.locator('.bar [role="status"]').filter({ hasText: '1 error' }).waitFor()
    await isAccessible(page)
    await strategy.getByLabel('type').last().selectOption('restart')
    await page.getByText('no errors, 0 warnings').waitFor()
    // A restart of what only depends on the camera leaves the failure as it is.
    const component = strategy.getByLabel('component', { exact: true }).last()
    await component.fill('viewer')
    await component.press('Tab')
    await found.getByText("strategy 'again' adapts only 'viewer', which depends on 'camera'").waitFor()
  })
}

// The server's answers come late and in the wrong order: nothing that was entered is lost.
export async function losesNothingToASlowServer() {
  const slow = file('slow.rules')
  await session(['web', slow], async (page) => {
    const form = page.getByRole('region', { name: 'Form' })
    const text = page.locator('.cm-content')
    await form.getByRole('button', { name: '+ Rule' }).click()
    await text.filter({ hasText: 'RULE' }).waitFor()

    const held = []
    const isHeld = (count) => expectSoon(() => held.length === count, `not ${count} requests`)
    await page.route('**/api/rules/text', (route) => held.push(route))
    const enter = async (label, value) => {
      const field = form.getByLabel(label, { exact: true })
      await field.fill(value)
      await field.press('Tab')
    }
    const answer = async (route) => {
      const answered = page.waitForResponse((response) => response.request() === route.request())
      await route.continue()
      await (await answered).finished()
    }
    await enter('rule', 'Slow')
    await isHeld(1)
    await enter('trigger', 'segmentation_entropy > 0.06')
    await isHeld(2)
    await answer(held[1])
    await text.filter({ hasText: 'segmentation_entropy > 0.06' }).waitFor()
    await answer(held[0])
    await page.unroute('**/api/rules/text')
    await enter('helps in %', '77')
    await text.filter({ hasText: '77' }).waitFor()
    const written = await text.innerText()
    for (const entered of ['RULE Slow', 'segmentation_entropy > 0.06', '77']) expect(written.includes(entered), `without ${entered}:\n${written}`)
  })
}

// The check's answer about an older text comes last; the answer about the newest text stays.
export async function showsWhatIsSaidOfTheNewestText() {
  await session(['web', file('late.rules')], async (page) => {
    const text = page.locator('.cm-content')
    const status = page.locator('.bar [role="status"]').last()
    await status.filter({ hasText: 'no errors' }).waitFor()
    // Before the first answer it is not said to be right.
    const first = []
    await page.route('**/api/rules/ask', (route) => first.push(route))
    await page.reload()
    await expectSoon(() => first.length > 0, 'the file is not checked')
    await status.filter({ hasText: 'being checked' }).waitFor()
    await Promise.all(first.splice(0).map((route) => route.continue()))
    await status.filter({ hasText: 'no errors' }).waitFor()
    await page.unroute('**/api/rules/ask')
    const held = []
    await page.route('**/api/rules/ask', (route) => (route.request().postDataJSON().method === 'textDocument/codeAction' ? held.push(route) : route.continue()))
    // Gives the question whether what was written is right.
    const write = async (all) => {
      await text.click()
      await page.keyboard.press('Control+A')
      await page.keyboard.press('Delete') // over what is selected the browser writes in its style, which the policy forbids
      await page.keyboard.insertText(all)
      const question = () => held.find((route) => route.request().postDataJSON().text === all)
      await expectSoon(() => question() !== undefined, `${all} is not checked`)
      return question()
    }
    const answer = async (route) => {
      const answered = page.waitForResponse((response) => response.request() === route.request())
      await route.continue()
      await (await answered).finished()
    }
    const right = await write('ROBOT rover')
    const wrong = await write('RULE')
    await answer(wrong)
    await status.filter({ hasText: /\d error/ }).waitFor()
    await answer(right)
    await page.evaluate(() => new Promise((resolve) => setTimeout(resolve)))
    const said = await status.innerText()
    expect(/\d error/.test(said), `of the newest text it says: ${said}`)
  })
}
