// A task of a person's size: three rules with two strategies each, from nothing. Counted as a person would: each press, each
// choice and each field that is filled in is one action.
import { readFileSync } from 'node:fs'
import { expect, file, session } from './session.mjs'

const kMost = 60
const kWanted = `COMPONENT camera  NODE /camera  LAUNCH "ros2 run my_cameras camera"
COMPONENT lidar   NODE /lidar   UNIT lidar.service
COMPONENT fusion  NODE /fusion

RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/rgb) > 500ms
    STRATEGY wake 60 10
      ADAPTATION camera restart 5
    STRATEGY replace 85 10
      ADAPTATION camera redeploy 10

RULE LidarDead
  POLICIES ERROR
  TRIGGER alive(lidar) == false
    STRATEGY start_anew 90 10
      ADAPTATION lidar redeploy 10
    STRATEGY start 50 10
      ADAPTATION lidar start 10

RULE FusionSlow
  POLICIES WARNING
  TRIGGER rate(/fused) < 5
    STRATEGY lighter 70 10
      ADAPTATION fusion set_parameter scale 0.5 2
    STRATEGY anew 50 10
      ADAPTATION fusion restart 5
`

export async function writesThreeRules() {
  const path = file('three.rules')
  await session(['web', path], async (page) => {
    let actions = 0
    const form = page.getByRole('region', { name: 'Form' })
    const press = async (name, within = form) => {
      ++actions
      await within.getByRole('button', { name, exact: true }).last().click()
    }
    const fill = async (label, value, within = form) => {
      ++actions
      const field = within.getByLabel(label, { exact: true }).last()
      await field.fill(value)
      await field.press('Tab')
    }
    const choose = async (label, value, within = form) => {
      ++actions
      await within.getByLabel(label, { exact: true }).last().selectOption(value)
    }
    const strategy = (name) => form.getByRole('group', { name: `Strategy ${name}`, exact: true })
    await form.getByText('Declared components').click()
    ++actions
    for (const [name, owner, how] of [['camera', 'culprit, by a command', 'ros2 run my_cameras camera'], ['lidar', 'systemd', 'lidar.service'], ['fusion']]) {
      await press('+ Component')
      const own = () => form.getByRole('group', { name: /^Component / }).last()
      await fill('name', name, own())
      if (!owner) continue
      await choose('started by', owner, own())
      await fill(owner === 'systemd' ? 'unit' : 'launch', how, own())
    }
    const one = async (name, percent, type, members = {}) => {
      await fill('name', name)
      await fill('helps in %', percent, strategy(name))
      if (type) await choose('type', type, strategy(name))
      for (const [member, value] of Object.entries(members)) await fill(member, value, strategy(name))
    }
    await press('+ Rule')
    await fill('rule', 'CameraSilent')
    await choose('what is looked at', 'a topic is silent for longer than')
    await fill('its name', '/rgb')
    await one('wake', '60', 'restart')
    await press('+ Strategy')
    await one('replace', '85', 'redeploy')
    await press('+ Rule')
    await one('start_anew', '90')
    await press('+ Strategy')
    await one('start', '50', 'start')
    await press('+ Rule')
    await fill('rule', 'FusionSlow')
    await choose('criticality', 'WARNING')
    await choose('what is looked at', 'the rate of a topic, in Hz, is below')
    await fill('its name', '/fused')
    await one('lighter', '70', 'set_parameter', { parameter: 'scale', value: '0.5' })
    await press('+ Strategy')
    await one('anew', '50')
    await page.getByText('no errors').waitFor()
    await press('Save …', page)
    await press('Save', page.getByRole('dialog'))
    await page.getByText('as saved').waitFor()
    const saved = readFileSync(path, 'utf8')
    expect(saved.trim() === kWanted.trim(), `this was saved:\n${saved}`)
    console.log(`three rules with two strategies each: ${actions} actions (at most ${kMost})`)
    expect(actions <= kMost, `it takes ${actions} actions`)
  })
}
