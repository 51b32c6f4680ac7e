// A broken file, mended by what the check says of it.
import { readFileSync, writeFileSync } from 'node:fs'
import { expect, file, isAccessible, picture, session } from './session.mjs'

const kRules = `# A comment that stays where it is.
COMPONENT camera NODE /camera

RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/rgb) > 500ms
    STRATEGY restart 150 10
      ADAPTATION camera restrat 3
`
export async function mendsABrokenFile() {
  const path = file('broken.rules')
  writeFileSync(path, kRules)

  await session(['web', path], async (page) => {
    const found = page.getByRole('list', { name: 'Findings of the check' })
    await found.getByText('line 7').waitFor()
    await found.getByText('line 8').waitFor()
    await picture(page, 'broken')
    await isAccessible(page)

    const replace = async (line, wrong, right) => {
      await found.getByRole('button', { name: new RegExp(`line ${line}`) }).first().click()
      const text = await page.locator('.cm-line').nth(line - 1).innerText()
      await page.keyboard.press('End')
      await page.keyboard.press('Shift+Home')
      await page.keyboard.insertText(text.trim().replace(wrong, right))
    }
    await replace(7, '150', '50')
    await found.getByRole('listitem').filter({ hasText: 'line 8' }).getByRole('button').last().click() // its quick fix
    await page.getByText('no errors').waitFor()
    await page.getByRole('button', { name: 'Format' }).click()
    await page.getByText('Formatting: done').waitFor()
    await page.getByRole('button', { name: 'Save …' }).click()
    await page.getByRole('dialog').getByRole('button', { name: 'Save', exact: true }).click()
    await page.getByText('as saved').waitFor()
    const saved = readFileSync(path, 'utf8')
    const wanted = kRules.replace('150', '50').replace('restrat', 'restart')
    expect(saved.replace(/ +/g, ' ') === wanted.replace(/ +/g, ' '), `this was saved:\n${saved}`)
  })
}
