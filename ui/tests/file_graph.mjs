// The graph of the file beside its text: it follows what one writes, also while that has mistakes, and a press leads to the line, as the list of its nodes does.
import { writeFileSync } from 'node:fs'
import { isLaidOut } from './layout.mjs'
import { expect, expectSoon, file, isAccessible, session } from './session.mjs'

const kRules = `# A comment.
COMPONENT camera NODE /camera
`
const kMore = `COMPONENT fusion NODE /fusion
DEPENDENCY fusion ON camera

RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/rgb) > 500ms
    STRATEGY restart 50 10
      ADAPTATION camera restart 3
`

export async function drawsTheFile() {
  const path = file('graph.rules')
  writeFileSync(path, kRules)
  await session(['web', path], async (page) => {
    const graph = page.locator('.file-graph')
    const text = page.locator('.cm-content')
    const says = (counts) => graph.locator('summary').getByText(counts).waitFor()
    const write = async (lines) => {
      await text.click()
      await page.keyboard.press('Control+End')
      await page.keyboard.insertText(lines)
    }
    await says('1 component, 0 rules')
    await graph.locator('canvas').click() // the node stands in the middle
    const isAtItsLine = async () => (await page.locator('.cm-activeLine').first().innerText()).startsWith('COMPONENT camera')
    await expectSoon(isAtItsLine, 'a press on the node does not lead to its line')

    await write(kMore)
    await says('2 components, 1 rule')
    await write('RULE Second\n  TRIGGER age(/fused) > "long"\n')
    await says('2 components, 2 rules')
    await page.getByRole('list', { name: 'Findings of the check' }).getByText('line 11').first().waitFor()
    const nodes = graph.getByLabel('Node of the graph')
    const toLine = graph.getByRole('button', { name: 'Go to its line' })
    await nodes.focus()
    await nodes.selectOption('')
    await expectSoon(() => toLine.isDisabled(), 'the button leads to a line although no node is chosen')
    await nodes.selectOption('rule CameraSilent')
    await graph.getByText('CameraSilent adapts camera; may spread to fusion.').waitFor()
    await page.keyboard.press('Tab')
    await page.keyboard.press('Enter')
    const isAtTheRule = async () => (await page.locator('.cm-activeLine').first().innerText()).startsWith('RULE CameraSilent')
    await expectSoon(isAtTheRule, 'the button does not lead to the line of the node')
    expect((await nodes.locator('option[value="rule Second"]').textContent()) === 'Second (error)', 'the list does not name a mistake')
    await isAccessible(page)
    for (const [width, height] of [[1440, 900], [1024, 768], [390, 844]]) {
      await page.setViewportSize({ width, height })
      await isLaidOut(page, `the graph of the file, ${width} × ${height}`)
    }
    await page.setViewportSize({ width: 1440, height: 900 })
    await write('USE nothing(camera)\n')
    await graph.getByText('This graph is of an earlier text').waitFor()
    await says('2 components, 2 rules')
  })
}
