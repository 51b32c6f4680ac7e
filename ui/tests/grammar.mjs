// A rule file with every row of the language's grammar (docs/grammar.ebnf), from nothing: by what the form offers, without a
// word in the text editor. Saved, opened again, and equal.
import { cpSync, readFileSync } from 'node:fs'
import { dirname, join } from 'node:path'
import { fileURLToPath } from 'node:url'
import { expect, file, session } from './session.mjs'

// But for blanks between words, which are laid out.
const kWanted = `ROBOT rover
CYCLE 100ms
INCLUDE "packs/driver.rules"
COMPONENT arm NODE /arm LAUNCH "ros2 run arms arm" ENV "SPEED=2" SETUP /opt/arms/setup.bash CWD /srv REQUIRED READY 20s LIFECYCLE managed
COMPONENT lidar NODE /lidar UNIT lidar.service USER HOST robot@rover2 LIFECYCLE launcher
COMPONENT slam NODE /slam CONTAINER podman slam
COMPONENT eye NODE /eye IN /perception PLUGIN detect::Eye PACKAGE detect PARAMETERS /etc/eye.yaml REMAP image:=/rgb
COMPONENT wheel NODE /wheel /wheel/odometry RESPAWNED LIFECYCLE self
DEPENDENCY slam ON lidar eye
IGNORE TOPIC /rosout /clock
INTERLOCK limit == 1
GROUP drives { lidar, wheel } MANAGER arm
ABORT limit == 2
DRILL eye limit 3
DRILL eye without kill
DRILL eye without hang
DRILL eye without slow
DRILL eye set_parameter gain 0
CONST limit = 0.5
SIGNAL load TOPIC /arm/load FIELD data STALE 2s RANGE -1..1
SIGNAL heat DIAGNOSTIC motor KEY temperature
SIGNAL gain PARAMETER eye gain

RULE Silent
POLICIES ERROR FOR 500ms HOLD 3/5 COOLDOWN 10s ATTEMPTS 6
TRIGGER age(/scan FROM lidar) > 500ms && rate(/scan) < 5 && phi(/scan) > 8
STRATEGY strategy 50 10
ADAPTATION arm redeploy 10

RULE Dead
POLICIES WARNING ON_CHANGE
TRIGGER alive(lidar) == false || lifecycle(arm) != "active"
STRATEGY strategy2 50 10
ADAPTATION lidar redeploy 10

RULE Odd
POLICIES NON_CRITICAL
TRIGGER mean(load, 3s) >= limit && min(load, 3s) <= 0.9 && max(load, 3s) < 0.95 && stddev(load, 3s) > 0.1
STRATEGY strategy3 50 10
ADAPTATION slam redeploy 10

RULE Changed
POLICIES OK REPORT
TRIGGER changed(heat) && heat > 80 && frozen(heat, 2s) && cpu(arm) > 1.5 && memory(arm) >= 800 && goals(/go, aborted, 60s) >= 2 && goal_age(/go) > 5min && logs(arm, ERROR, 10s) >= 3

RULE Level
POLICIES DEGRADED
TRIGGER level(motor) >= 2 && parameter(eye, exposure) == 7
STRATEGY strategy4 50 10
ADAPTATION eye redeploy 10

RULE Written
POLICIES FAILURE
TRIGGER load > 0 ? abs(load - 1) * 2 + pow(heat, 2) / 3 > sqrt(heat) : !alive(slam) && +1 % 2 == 1 && true != isnan(heat) && loss(/scan) < 0.5
STRATEGY everything 70 20 LASTRESORT WITHIN 1s WHEN heat < 90
ADAPTATION eye set_parameter gain 0.5 2
ADAPTATION eye increase_parameter exposure 1 2
ADAPTATION arm decrease_parameter speed limit / 2 2
ADAPTATION slam change_communication input /scan 3
ADAPTATION wheel activate 5
ADAPTATION slam deactivate 5
ADAPTATION lidar restart 6
ADAPTATION arm change_mode SLOW 4
ADAPTATION arm call home "data: true" 4
STRATEGY others 50 10
ADAPTATION eye redeploy 10
ADAPTATION lidar start 10
THEN ADAPTATION wheel stop 10
ADAPTATION slam call clear 1
ADAPTATION drives start_group 5

TEMPLATE looked_after(name, topic, patience = 2s, start = 50)
CONST least = 3
RULE {name}_silent
POLICIES ERROR
TRIGGER age({topic}) > {patience} && rate({topic}) < least
STRATEGY {name}_anew 90 10
ADAPTATION {name} redeploy {start}
USE driver_gone({name}, {start})
END
USE looked_after(lidar, /scan, 130s) IN /robot1
`
const withoutLayout = (text) => text.trim().split('\n').map((line) => line.trim().replace(/ +/g, ' ')).join('\n')

// The words of the language, as its grammar has them: none may be missing in what the form has written.
const grammar = readFileSync(join(dirname(fileURLToPath(import.meta.url)), '../../docs/grammar.ebnf'), 'utf8')
export function missingWords(text) {
  const productions = grammar.slice(grammar.indexOf('(* Declarations *)'), grammar.indexOf('(* Tokens.')).replace(/\(\*[^]*?\*\)/g, '')
  const words = new Set([...productions.matchAll(/"([A-Za-z_]+|[-+*/%<>=!?:|&]+)"/g)].map((m) => m[1]))
  const isThere = (word) => (/\w/.test(word) ? new RegExp(`(?<!\\w)${word}(?!\\w)`).test(text) : text.includes(word))
  return [...words].filter((word) => !isThere(word))
}

export async function writesEveryRow() {
  const path = file('every.rules')
  cpSync(join(dirname(fileURLToPath(import.meta.url)), '../../rules/packs'), file('packs'), { recursive: true })
  await session(['web', path], async (page) => {
    const form = page.getByRole('region', { name: 'Form' })
    const group = (name) => form.getByRole('group', { name, exact: true })
    const add = (what, within = form) => within.getByRole('button', { name: `+ ${what}`, exact: true }).click()
    const enter = async (within, label, value) => {
      const field = within.getByLabel(label, { exact: true }).last()
      await field.fill(value)
      await field.press('Tab')
    }
    const choose = (within, label, value) => within.getByLabel(label, { exact: true }).last().selectOption(value)
    const check = (within, label) => within.getByLabel(label, { exact: true }).last().check()
    // { member: value }: those that it has not yet are added first.
    const say = async (name, members) => {
      for (const [member, value] of Object.entries(members)) {
        const field = group(name).getByLabel(member, { exact: true })
        if ((await field.count()) === 0) await choose(group(name), 'say more', member)
        if (value !== true) await enter(group(name), member, value)
      }
    }
    await form.getByText('Declared components').click()

    await add('Robot')
    await say('Robot my_robot', { name: 'rover' })
    await add('Cycle')
    await say('Cycle', { length: '100ms' })

    const component = async (name, owner, members) => {
      await add('Component')
      await say('Component my_node', { name }) // and so its node
      if (owner) await choose(group(`Component ${name}`), 'started by', owner)
      const { lifecycle, ...others } = members
      await say(`Component ${name}`, others)
      if (!lifecycle) return
      await choose(group(`Component ${name}`), 'say more', 'lifecycle')
      await choose(group(`Component ${name}`), 'lifecycle', lifecycle)
    }
    await component('arm', 'culprit, by a command', { launch: 'ros2 run arms arm', env: 'SPEED=2', setup: '/opt/arms/setup.bash', cwd: '/srv', required: true, ready: '20s', lifecycle: 'managed' })
    await component('lidar', 'systemd', { unit: 'lidar.service', user: true, host: 'robot@rover2', lifecycle: 'launcher' })
    await component('slam', 'docker or podman', { container: 'podman slam' })
    await component('eye', 'a component container', { in: '/perception', plugin: 'detect::Eye', package: 'detect', parameters: '/etc/eye.yaml', remap: 'image:=/rgb' })
    await component('wheel', 'its launcher, again and again', { node: '/wheel /wheel/odometry', lifecycle: 'self' })

    await add('Dependency')
    await say('Dependency arm', { producers: 'lidar eye', consumer: 'slam' })
    await add('Topics to ignore')
    await say('Topics to ignore', { topics: '/rosout /clock' })
    await add('Interlock')
    await say('Interlock', { expression: 'limit == 1' })
    await add('Group with a lifecycle manager')
    await say('Group with a lifecycle manager my_group', { members: 'lidar wheel', manager: 'arm', name: 'drives' })
    await add('End of a drill')
    await say('End of a drill', { expression: 'limit == 2' })
    // Each becomes the one before the next is added: they are called alike.
    const drill = async (way, members) => {
      await add('Drill')
      const own = group('Drill').last()
      await enter(own, 'component', 'eye')
      if (way) await choose(own, 'what it says', way)
      for (const [label, value] of Object.entries(members)) await (label === 'fault' ? choose : enter)(own, label, value)
    }
    await drill(null, { times: '3' })
    await drill('leaves a fault out', {})
    await drill('leaves a fault out', { fault: 'hang' })
    await drill('leaves a fault out', { fault: 'slow' })
    await drill('sets a parameter', { parameter: 'gain' })
    await add('Constant')
    await say('Constant limit', { value: '0.5' })
    await add('Signal')
    await say('Signal my_signal', { topic: '/arm/load', field: 'data', stale: '2s', range: '-1..1', name: 'load' })
    await add('Signal')
    await choose(group('Signal my_signal'), 'read from', 'a key of a diagnostic')
    await say('Signal my_signal', { diagnostic: 'motor', key: 'temperature', name: 'heat' })
    await add('Signal')
    await choose(group('Signal my_signal'), 'read from', 'a parameter')
    await say('Signal my_signal', { component: 'eye', parameter: 'gain', name: 'gain' })

    // Rules: each with a criticality, a policy and conditions of its own.
    const clause = async (rule, place, kind, members) => {
      const sentence = rule.getByRole('group', { name: 'Sentence' })
      if (place > 0) await add('condition', sentence)
      const own = sentence.locator('.clause').nth(place)
      await own.getByLabel('what is looked at').selectOption({ value: kind })
      for (const [label, value] of Object.entries(members)) {
        const field = own.getByLabel(label, { exact: true })
        if ((await field.evaluate((e) => e.tagName)) === 'SELECT') await field.selectOption(value)
        else {
          await field.fill(value)
          await field.press('Tab')
        }
      }
    }
    const newRule = async (name, criticality) => {
      await add('Rule')
      await enter(form, 'rule', name)
      const rule = form.locator('details.rule', { has: page.getByText(name, { exact: true }) })
      await rule.getByLabel('criticality').selectOption(criticality)
      return rule
    }
    const name = 'its name'
    const much = 'how much'
    let rule = await newRule('Silent', 'ERROR')
    await enter(rule, 'for', '500ms')
    await enter(rule, 'hold n/k', '3/5')
    await enter(rule, 'cooldown', '10s')
    await enter(rule, 'attempts', '6')
    await clause(rule, 0, 'silent', { [name]: '/scan FROM lidar', [much]: '500ms' })
    await clause(rule, 1, 'slow', { [name]: '/scan', [much]: '5' })
    await clause(rule, 2, 'odd', { [name]: '/scan', [much]: '8' })
    rule = await newRule('Dead', 'WARNING')
    await check(rule, 'on change')
    await clause(rule, 0, 'dead', { [name]: 'lidar' })
    await clause(rule, 1, 'state', { [name]: 'arm', 'how it compares': '!=', 'which state': 'active' })
    await rule.getByLabel('how many have to hold').selectOption('||')
    rule = await newRule('Odd', 'NON_CRITICAL')
    await clause(rule, 0, 'mean', { 'over how long': '3s', [name]: 'load', 'how it compares': '>=', [much]: 'limit' })
    await clause(rule, 1, 'least', { 'over how long': '3s', [name]: 'load', 'how it compares': '<=', [much]: '0.9' })
    await clause(rule, 2, 'most', { 'over how long': '3s', [name]: 'load', 'how it compares': '<', [much]: '0.95' })
    await clause(rule, 3, 'spread', { 'over how long': '3s', [name]: 'load', 'how it compares': '>', [much]: '0.1' })
    rule = await newRule('Changed', 'OK')
    await check(rule, 'only report')
    await clause(rule, 0, 'changed', { [name]: 'heat' })
    await clause(rule, 1, 'value', { [name]: 'heat', 'how it compares': '>', [much]: '80' })
    await clause(rule, 2, 'frozen', { 'over how long': '2s', [name]: 'heat' })
    await clause(rule, 3, 'cpu', { [name]: 'arm', 'how it compares': '>', [much]: '1.5' })
    await clause(rule, 4, 'memory', { [name]: 'arm', 'how it compares': '>=', [much]: '800' })
    await clause(rule, 5, 'goals', { 'how they ended, in how long': 'aborted in 60s', [name]: '/go', 'how it compares': '>=', [much]: '2' })
    await clause(rule, 6, 'goalAge', { [name]: '/go', 'how it compares': '>', [much]: '5min' })
    await clause(rule, 7, 'logs', { 'from which level on, in how long': 'ERROR in 10s', [name]: 'arm', 'how it compares': '>=', [much]: '3' })
    rule = await newRule('Level', 'DEGRADED')
    await clause(rule, 0, 'level', { [name]: 'motor', 'how it compares': '>=', [much]: '2' })
    await clause(rule, 1, 'parameter', { [name]: 'eye', 'which parameter': 'exposure', 'how it compares': '==', [much]: '7' })
    rule = await newRule('Written', 'FAILURE')
    await clause(rule, 0, 'text', { 'the expression': 'load > 0 ? abs(load - 1) * 2 + pow(heat, 2) / 3 > sqrt(heat) : !alive(slam) && +1 % 2 == 1 && true != isnan(heat) && loss(/scan) < 0.5' })

    // Strategies with every adaptation.
    const strategy = (which) => form.getByRole('group', { name: `Strategy ${which}`, exact: true })
    await enter(form, 'name', 'everything')
    await enter(strategy('everything'), 'helps in %', '70')
    await enter(strategy('everything'), 'confidence', '20')
    await enter(strategy('everything'), 'only when', 'heat < 90')
    await check(strategy('everything'), 'as a last resort')
    await enter(strategy('everything'), 'within (2s)', '1s')
    const kAdaptations = [
      ['eye', 'set_parameter', { parameter: 'gain', value: '0.5' }, '2'],
      ['eye', 'increase_parameter', { parameter: 'exposure', value: '1' }, '2'],
      ['arm', 'decrease_parameter', { parameter: 'speed', value: 'limit / 2' }, '2'],
      ['slam', 'change_communication', { parameter: 'input', topic: '/scan' }, '3'],
      ['wheel', 'activate', {}, '5'],
      ['slam', 'deactivate', {}, '5'],
      ['lidar', 'restart', {}, '6'],
      ['arm', 'change_mode', { mode: 'SLOW' }, '4'],
      ['arm', 'call', { service: 'home', request: 'data: true' }, '4'],
    ]
    const kAlone = [['eye', 'redeploy', {}, '10'], ['lidar', 'start', {}, '10'], ['wheel', 'stop', {}, '10', 'then'], ['slam', 'call', { service: 'clear' }, '1'], ['drives', 'start_group', {}, '5']]
    const adaptations = async (within, all) => {
      for (const [place, [who, type, members, impact, step]] of all.entries()) {
        if (place > 0) await add('Adaptation', within)
        if (step) await check(within, step)
        await enter(within, 'component', who)
        await choose(within, 'type', type)
        for (const [member, value] of Object.entries(members)) await enter(within, member, value)
        await enter(within, 'impact', impact)
      }
    }
    await adaptations(strategy('everything'), kAdaptations)
    await rule.getByRole('button', { name: '+ Strategy' }).click()
    await enter(form, 'name', 'others')
    await adaptations(strategy('others'), kAlone)

    // Parts from elsewhere: a pack, a template of the user's own with a rule and a use in it, and its use.
    await form.getByText('From other files and templates').click()
    await add('Include')
    await say('Include packs/cameras.rules', { file: 'packs/driver.rules' })
    await add('Template')
    const template = form.locator('details.template-body')
    await enter(group('Template my_template'), 'parameters, with what they usually are', 'name, topic, patience = 2s, start = 50')
    await enter(group('Template my_template'), 'template', 'looked_after')
    await choose(group('Template looked_after'), 'add to it', 'Constant')
    await enter(template.getByRole('group', { name: /^Constant / }), 'value', '3')
    await enter(template.getByRole('group', { name: /^Constant / }), 'name', 'least')
    await enter(template, 'rule', '{name}_silent')
    await clause(template, 0, 'silent', { [name]: '{topic}' })
    await enter(template, 'how much', '{patience}')
    await add('condition', template)
    await template.getByLabel('what is looked at').last().selectOption({ value: 'slow' })
    await enter(template, 'its name', '{topic}')
    await enter(template, 'how much', 'least')
    await enter(template, 'name', '{name}_anew')
    await enter(template, 'helps in %', '90')
    await choose(template, 'type', 'redeploy')
    await enter(template, 'impact', '{start}')
    await choose(group('Template looked_after'), 'add to it', 'Use')
    await enter(template, 'with name, start = 50', '{name}, {start}')
    await add('Use')
    await enter(group('Use looked_after').last(), 'with name, topic, patience = 2s, start = 50', 'lidar, /scan, 130s')
    await enter(group('Use looked_after').last(), 'in the namespace', '/robot1')

    await page.getByText('changed', { exact: true }).waitFor()
    expect((await form.locator('[aria-invalid="true"]').count()) === 0, `not taken: ${await form.getByRole('alert').allInnerTexts()}`)
    const fields = () => form.evaluate((f) => [...f.querySelectorAll('input, select')].map((e) => (e.type === 'checkbox' ? e.checked : e.value)))
    const before = await fields()
    await page.getByRole('button', { name: 'Save …' }).click()
    await page.getByRole('dialog').getByRole('button', { name: 'Save', exact: true }).click()
    await page.getByText('as saved').waitFor()
    const saved = readFileSync(path, 'utf8')
    const missing = missingWords(saved)
    expect(missing.length === 0, `the form has not written ${missing.join(' ')}:\n${saved}`)
    expect(withoutLayout(saved) === kWanted.trim(), `this was saved:\n${saved}`)
    await page.reload()
    await form.getByRole('group', { name: 'Strategy others' }).waitFor()
    await form.getByText('Declared components').click()
    await form.getByText('From other files and templates').click()
    const after = await fields()
    expect(JSON.stringify(after) === JSON.stringify(before), `opened again it says\n${after}\nand was\n${before}`)
  })
}
