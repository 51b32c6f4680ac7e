// The web app as files: what culprit serves, and the tests of the page that need no robot.
import { readdirSync, readFileSync } from 'node:fs'
import { createRequire } from 'node:module'
import { dirname, join } from 'node:path'
import { fileURLToPath } from 'node:url'
import { noticesOf } from './notices.mjs'

const source = join(dirname(fileURLToPath(import.meta.url)), 'src')
const rules = join(source, '../../rules')
const rulesIn = (folder) =>
  Object.fromEntries(readdirSync(join(rules, folder)).filter((f) => f.endsWith('.rules')).sort().map((f) => [f, readFileSync(join(rules, folder, f), 'utf8')]))

// The rows of the glossary's tables, without markup: src/cli/glossary.cpp reads the same file.
const plain = (markdown) => markdown.replace(/\[([^\]]*)\]\([^)]*\)/g, '$1').replace(/[`*]/g, '').replace(/\\\|/g, '|').trim()
function glossary() {
  const terms = []
  let section = ''
  for (const line of readFileSync(join(source, '../../docs/glossary.md'), 'utf8').split('\n')) {
    if (line.startsWith('## ')) section = line.slice(3)
    const [, name, meaning] = /^\| (.*?) \| (.*) \|$/.exec(line) ?? []
    if (name && name !== 'word' && !name.startsWith('---')) terms.push({ section, name: plain(name), meaning: plain(meaning) })
  }
  return terms
}

const isLegal = (file) => file.path.endsWith('.LEGAL.txt')

// `modules` is the folder of node_modules.
export const bundle = (modules) => bundleWithNotices(modules).assets

// The files, and the licences that go with them.
export function bundleWithNotices(modules) {
  const require = createRequire(join(modules, 'package.json'))
  const { buildSync } = require('esbuild')
  const { outputFiles, metafile } = buildSync({
    entryPoints: [join(source, 'app.tsx')],
    nodePaths: [join(modules, 'node_modules')],
    bundle: true,
    mainFields: ['module', 'main'],
    minify: true,
    write: false,
    metafile: true,
    outdir: '/',
    format: 'esm',
    target: 'es2021',
    jsx: 'automatic',
    jsxImportSource: 'preact',
    legalComments: 'external', // into the notices
    define: { kCookbook: JSON.stringify(rulesIn('cookbook')), kPacks: JSON.stringify(rulesIn('packs')), kGlossary: JSON.stringify(glossary()) },
  })
  const assets = [
    ['/', 'text/html; charset=utf-8', readFileSync(join(source, 'index.html'))],
    ['/icon.svg', 'image/svg+xml', readFileSync(join(source, 'icon.svg'))],
    ...outputFiles.filter((file) => !isLegal(file)).map((file) =>
      file.path.endsWith('.css')
        ? ['/app.css', 'text/css; charset=utf-8', file.contents]
        : ['/app.js', 'text/javascript; charset=utf-8', file.contents]
    ),
  ].map(([path, type, contents]) => ({ path, type, contents }))
  return { assets, notices: noticesOf(metafile, outputFiles.filter(isLegal).map((file) => file.text)) }
}
