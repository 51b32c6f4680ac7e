// The first five minutes: open, see, break it, watch it heal, understand why, look back, take control.
import { expect, expectSoon, isAccessible, isUsableByKeyboard, picture, session, suite } from './session.mjs'

await suite(() =>
  session(['demo', '--stay', '--speed', '2'], async (page) => {
    const explanation = page.getByRole('region', { name: 'Explanation' })
    const well = explanation.getByText('All is well')
    await well.waitFor()
    for (const component of ['camera', 'depth', 'image_enhancement', 'fusion', 'segmentation'])
      await page.getByRole('button', { name: component, exact: false }).first().waitFor()
    await picture(page, 'well')

    await page.getByLabel('Break it:').selectOption('kill:camera')
    await page.getByRole('button', { name: 'Inject fault' }).click()
    // It may be well again before one has looked: what happened stays. On a machine that is too busy for the robot,
    // pictures are late and more happens; a dead camera is helped by nothing but a new process.
    const log = page.getByRole('region', { name: 'Event log' })
    await log.getByText(/^RGBDead resolved by rgb_redeploy/).first().waitFor()
    await well.waitFor()

    // Why was that? The moment of the decision, again.
    const look = (text) => log.locator('li', { hasText: text }).first().getByRole('button').click()
    await look('camera is held responsible for RGBDead: redeploy')
    await explanation.getByText('camera is held responsible').first().waitFor()
    const failure = explanation.locator('article', { hasText: 'RGBDead' })
    await failure.getByRole('row', { name: /rgb_redeploy.*chosen/ }).waitFor()
    expect((await page.locator('output.moment').innerText()).startsWith('at '), 'no moment is shown')
    const slider = page.getByRole('slider')
    await slider.press('ArrowLeft')
    const newest = Number(await log.getByRole('button').first().getAttribute('data-t'))
    expect(newest <= Number(await slider.inputValue()), 'what came later is shown')
    await slider.press('Home')
    await explanation.getByText('No rule sees a failure at this moment').waitFor() // as it was before it was broken
    const live = page.getByRole('button', { name: 'Live' })
    await live.click()
    await well.waitFor()
    if (await log.getByText('waits: it depends on').count()) await look('waits: it depends on')
    await picture(page, 'sick')
    await live.click()

    await page.getByRole('button', { name: 'Pause' }).click()
    await page.getByText('Paused: nothing is changed').waitFor()
    // While paused, the page still names the root cause, and says that nothing is done.
    await page.getByRole('button', { name: 'Inject fault' }).click()
    const bar = page.getByRole('region', { name: 'Status' })
    await bar.getByText('camera is down').waitFor()
    await bar.getByText('nothing is done: culprit is paused').waitFor()
    await explanation.getByRole('heading', { name: 'camera is down' }).waitFor()
    await picture(page, 'paused')
    await page.getByRole('button', { name: 'Resume' }).click()
    await well.waitFor()
    await page.getByRole('button', { name: 'Pause' }).waitFor()
    await isAccessible(page)
    await isUsableByKeyboard(page)

    await page.getByRole('link', { name: 'Incidents' }).click()
    // The newest is shown: on a busy machine another one, of a topic that was just late.
    await page.getByRole('row', { name: /camera.*rgb_redeploy/ }).first().getByRole('link').first().click()
    await page.getByRole('region', { name: 'Incident', exact: true }).locator('summary', { hasText: 'camera is held responsible' }).first().waitFor()

    await page.getByRole('link', { name: 'Beliefs' }).click()
    const learned = page.getByRole('row', { name: /RGBDead\.rgb_redeploy/ }).filter({ hasText: /\d outcome/ })
    await learned.getByRole('button').click()
    await page.getByRole('region', { name: 'Outcomes' }).getByText('✓ helped').first().waitFor()
    await isAccessible(page)
    await isUsableByKeyboard(page)
    await picture(page, 'beliefs')

    await page.getByRole('link', { name: 'Simulator' }).click()
    const plan = page.getByRole('region', { name: 'Plan' })
    // Imagined is the robot of the moment in which one came: on a busy machine a topic was perhaps just late.
    const fine = plan.getByText('Nothing would fail')
    await expectSoon(async () => {
      if (await fine.isVisible()) return true
      await page.getByRole('button', { name: 'As the robot is now' }).click()
      await page.waitForTimeout(2000) // its plan is on its way
      return fine.isVisible()
    }, 'the robot is never imagined to be well')
    await page.locator('label', { hasText: /^camera/ }).getByRole('combobox').selectOption('killed')
    await plan.getByText('camera is held responsible').waitFor()
    await plan.getByText('It would be chosen if').first().waitFor()
    await isAccessible(page)
    await isUsableByKeyboard(page)
    await picture(page, 'simulator')
  })
)
