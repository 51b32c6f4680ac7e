// The graph of a rule file as a person sees it in the extension: its panel and what it runs, with culprit as it is, in
// Chromium in place of Visual Studio Code (vscode.mjs).
//
//     node graph_panel.mjs <culprit> <folder of node_modules> <folder for files>
import { chmodSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs'
import { createServer } from 'node:http'
import { createRequire } from 'node:module'
import { dirname, join } from 'node:path'
import { fileURLToPath, pathToFileURL } from 'node:url'
import { browse, expect, expectSoon, file, isAccessible, isUsableByKeyboard, suite } from '../../../ui/tests/session.mjs'

const [culprit, modules] = process.argv.slice(2)
const extension = dirname(dirname(fileURLToPath(import.meta.url)))
const { buildSync } = createRequire(join(modules, 'package.json'))('esbuild')

// As the extension is built, but for the editor in it.
buildSync({
  stdin: { contents: 'export * from "./src/graph_panel"; export * from "./tests/vscode.mjs"', resolveDir: extension },
  bundle: true, platform: 'node', format: 'esm', outfile: file('panel.mjs'), alias: { vscode: join(extension, 'tests/vscode.mjs') },
})
buildSync({
  entryPoints: [join(extension, 'src/view/graph_view.ts')],
  bundle: true, minify: true, format: 'iife', target: 'es2022', outfile: file('dist/graph_view.js'),
})
const { GraphPanels, Uri, noted, served } = await import(pathToFileURL(file('panel.mjs')))
served.read = (path) => readFileSync(path, 'utf8')

const kRover = `COMPONENT lidar   NODE /lidar    LAUNCH "lidar"
COMPONENT odom    NODE /odom     LAUNCH "odom"
COMPONENT slam    NODE /slam     LAUNCH "slam"
COMPONENT planner NODE /planner  LAUNCH "planner"
DEPENDENCY slam ON lidar odom
DEPENDENCY planner ON slam lidar
RULE NoScan
  POLICIES ERROR
  TRIGGER age(/scan) > 1s
    STRATEGY again 90 10
      ADAPTATION lidar redeploy 10
RULE Lost
  POLICIES WARNING
  TRIGGER lost && lifecycle(slam) == "active"
    STRATEGY level 50 10
      ADAPTATION arm set_parameter level true 5
      ADAPTATION planner restart 5
`

async function serving() {
  const types = { js: 'text/javascript', css: 'text/css' }
  const server = createServer((request, reply) => {
    const name = request.url.slice(1)
    const type = types[name.split('.').pop()]
    if (type) return reply.setHeader('content-type', type).end(readFileSync(file(`dist/${name}`)))
    reply.setHeader('content-type', 'text/html; charset=utf-8').end(name === 'panel' ? noted.panels.at(-1).webview.html : '')
  })
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve))
  served.origin = `http://127.0.0.1:${server.address().port}`
  return { address: Promise.resolve(`${served.origin}/nothing`), end: () => new Promise((resolve) => server.close(resolve)) }
}

let program = culprit
const kScript = file('program')
// What `culprit.path` says.
function runs(script) {
  writeFileSync(kScript, `#!/bin/sh\n${script}\n`)
  chmodSync(kScript, 0o755)
  program = kScript
}

// Opens the panel of `path`, as the command does.
async function open(page, panels, path) {
  await panels.show({ fileName: path }, 1)
  const panel = noted.panels.at(-1)
  await page.goto(`${served.origin}/panel`)
  panel.told = (message) => page.evaluate((m) => postMessage(m), message)
  await page.evaluate(() => tell({ what: 'ready' })) // what it had asked for before it was heard
  return panel
}

async function photograph(page, name) {
  const pictures = process.env.CULPRIT_SCREENSHOTS
  if (pictures) await page.screenshot({ path: join(pictures, `${name}.png`), animations: 'disabled' })
}

async function showsTheGraphAndLeadsToTheFile(page, panels) {
  const path = file('rover.rules')
  writeFileSync(path, kRover)
  await open(page, panels, path)
  for (const says of ['Component lidar, node /lidar', 'Component arm, not declared', 'Rule NoScan, error, adapts lidar', 'Rule Lost, warning, looks at slam, adapts planner, arm'])
    await page.getByRole('link', { name: says, exact: true }).waitFor()
  const lines = await page.locator('main > .graph path.edge').evaluateAll((all) => all.map((e) => e.getAttribute('class')).sort())
  expect(lines.join() === 'edge adapts,edge adapts,edge adapts,edge needs,edge needs,edge needs,edge needs,edge reads', `it draws ${lines}`)
  await photograph(page, 'graph')

  await page.getByRole('link', { name: 'Component slam, node /slam' }).click()
  await expectSoon(() => noted.opened.length === 1, 'a click leads nowhere')
  await page.getByRole('link', { name: 'Rule Lost, warning, looks at slam, adapts planner, arm' }).press('Enter')
  await expectSoon(() => noted.opened.length === 2, 'a key leads nowhere')
  expect(JSON.stringify(noted.opened) === JSON.stringify([{ file: path, line: 2, at: 10, column: 1 }, { file: path, line: 11, at: 5, column: 1 }]), `it leads to ${JSON.stringify(noted.opened)}`)
  await isAccessible(page)
  await isUsableByKeyboard(page)
  await page.evaluate(() => document.activeElement.blur())

  // No parts overlap, however wide the panel is.
  for (const [width, height] of [[1440, 900], [700, 900], [360, 700]]) {
    await page.setViewportSize({ width, height })
    await page.waitForFunction((w) => document.querySelector('.graph > svg').getBoundingClientRect().width <= Math.max(w, 480), width)
    const boxes = await page.locator('.box rect').evaluateAll((all) => all.map((e) => e.getBoundingClientRect()).map(({ x, y, width: w, height: h }) => [x, y, x + w, y + h]))
    const meets = (a, b) => a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
    boxes.forEach((a, i) => boxes.slice(i + 1).forEach((b) => expect(!meets(a, b), `boxes meet where it is ${width} wide`)))
    await photograph(page, `graph-${width}`)
  }
  await page.setViewportSize({ width: 1440, height: 900 })
}

async function followsWhatIsSaved(page, panels) {
  const path = file('rover.rules')
  await open(page, panels, path)
  await page.getByRole('link', { name: 'Component slam, node /slam' }).waitFor()
  writeFileSync(path, `${kRover}COMPONENT gps NODE /gps\n`)
  panels.saved()
  await page.getByRole('link', { name: 'Component gps, node /gps' }).waitFor()

  writeFileSync(path, `${kRover}COMPONENT <img src=x onerror=alert(1)>\n`)
  panels.saved()
  const alert = page.getByRole('alert')
  await alert.getByText('rover.rules:18:').waitFor()
  expect((await alert.textContent()).includes('<img src=x onerror=alert(1)>'), 'it does not show the line that is wrong')
  await page.getByText('This is the graph of before').waitFor()
  await page.getByRole('link', { name: 'Component gps, node /gps' }).waitFor()
  await photograph(page, 'graph-mistakes')
  await isAccessible(page)

  // A page that was hidden is loaded anew.
  const panel = noted.panels.at(-1)
  await page.goto(`${served.origin}/panel`)
  await alert.getByText('rover.rules:18:').waitFor()

  writeFileSync(path, kRover)
  panels.saved()
  await page.getByRole('link', { name: 'Component gps, node /gps' }).waitFor({ state: 'detached' })
  expect((await alert.count()) === 0, 'it still tells of the mistake')

  const count = noted.panels.length
  await panels.show({ fileName: path }, 1)
  expect(noted.panels.length === count && panel.reveals === 1, 'one file has two panels')
  panel.dispose()
  await open(page, panels, path)
  expect(noted.panels.length === count + 1, 'a panel that was closed does not come back')
  noted.panels.at(-1).dispose()
}

async function tellsOfAFileThatWasWrongFromTheStart(page, panels) {
  const path = file('wrong.rules')
  writeFileSync(path, 'RULE\n')
  await open(page, panels, path)
  await page.getByRole('alert').getByText('wrong.rules:1:').waitFor()
  expect((await page.locator('svg').count()) === 0, 'it draws what it has not')
}

// Whatever culprit is, and whatever it says: nothing of it becomes more than text.
async function drawsHostileNames(page, panels) {
  const hostile = ['<img src=x onerror=fetch("/stolen")>', '"><script>fetch("/stolen")</script>', '${alert(1)}', "javascript:fetch('/stolen')"]
  const place = { file: file('rover.rules'), line: 1, column: 1 }
  const graph = {
    components: hostile.map((name) => ({ name, node: name, declared: true, ...place })),
    dependencies: [{ consumer: hostile[0], producer: hostile[1] }, { consumer: 'nobody', producer: hostile[0] }],
    rules: [{ name: hostile[0], criticality: '"><b>', reads: [], adapts: [hostile[2], '__proto__'], ...place }],
  }
  writeFileSync(file('hostile.json'), JSON.stringify(graph))
  runs(`cat '${file('hostile.json')}'`)
  const asked = []
  const listen = (request) => asked.push(new URL(request.url()).pathname)
  page.on('request', listen)
  await open(page, panels, file(`"><script>fetch('%2fstolen')<%2fscript>.rules`))
  for (const name of hostile) await page.getByRole('link', { name: `Component ${name}, node ${name}`, exact: true }).waitFor()
  expect((await page.locator('img, b, iframe').count()) === 0, 'a name became an element')
  expect((await page.locator('script').count()) === 1, 'a name became a script')
  page.off('request', listen)
  expect(asked.every((path) => ['/panel', '/graph_view.js', '/graph_view.css'].includes(path)), `it asked for ${asked}`)
  // Nor is there anywhere else to go to.
  const before = noted.opened.length
  for (const message of [{ what: 'component', index: 99 }, { what: 'component', index: '__proto__' }, { what: 'rule', index: -1 }, { what: 'file' }]) noted.panels.at(-1).says(message)
  expect(noted.opened.length === before, 'it went where nobody sent it')
}

async function tellsOfACulpritThatDoesNotRun(page, panels) {
  program = file('no-such-program')
  await open(page, panels, file('1.rules'))
  await page.getByRole('alert').getByText('The setting culprit.path says where culprit is').waitFor()
  runs('echo nonsense')
  await open(page, panels, file('2.rules'))
  await page.getByRole('alert').getByText('is it as new as this extension').waitFor()
  runs('echo "The following argument was not expected: $2" >&2; exit 2')
  await open(page, panels, file('3.rules'))
  await page.getByRole('alert').getByText('The following argument was not expected').waitFor()
}

// The first answer comes when the second one is there.
async function showsTheLastOfSeveralSaves(page, panels) {
  const graph = (name) => JSON.stringify({ components: [{ name, node: '', declared: false }], dependencies: [], rules: [] })
  runs(`if [ -e '${file('second')}' ]; then echo '${graph('newer')}'; exit; fi
touch '${file('second')}'
while [ ! -e '${file('shown')}' ]; do sleep 0.02; done
echo '${graph('older')}'
touch '${file('said')}'`)
  const path = file('several.rules')
  const first = panels.show({ fileName: path }, 1)
  const panel = noted.panels.at(-1)
  await page.goto(`${served.origin}/panel`)
  const told = []
  panel.told = (message) => (told.push(message), page.evaluate((m) => postMessage(m), message))
  await expectSoon(() => existsNow('second'), 'the first was not asked for')
  panels.saved()
  await page.getByRole('link', { name: 'Component newer, not declared' }).waitFor()
  writeFileSync(file('shown'), '')
  await first
  expect(existsNow('said') && told.length === 1, 'what is older came after what is newer')
}
function existsNow(name) {
  try {
    return readFileSync(file(name)) !== null
  } catch {
    return false
  }
}

mkdirSync(file('dist'), { recursive: true })
await suite(async () =>
  browse(await serving(), async (page) => {
    await page.exposeFunction('tell', (message) => noted.panels.at(-1).says(message))
    await page.addInitScript(() => {
      window.acquireVsCodeApi = () => ({ postMessage: (message) => window.tell(message) })
    })
    const panels = new GraphPanels({ extensionUri: Uri.file(extension) }, () => program)
    await showsTheGraphAndLeadsToTheFile(page, panels)
    noted.panels.at(-1).dispose()
    await followsWhatIsSaved(page, panels)
    await tellsOfAFileThatWasWrongFromTheStart(page, panels)
    await drawsHostileNames(page, panels)
    await tellsOfACulpritThatDoesNotRun(page, panels)
    await showsTheLastOfSeveralSaves(page, panels)
  }),
)
