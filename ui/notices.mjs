// The licences of what the web app is bundled from, as they have to go with it: of each package of npm whose code is in it, the texts that it comes with;
// then what stands in comments of that code, which may be of others again.
import { readdirSync, readFileSync } from 'node:fs'
import { join, resolve } from 'node:path'

const kTexts = /^(licen[cs]e|copying|notice)([.-].*)?$/i
// The innermost package: what another one brings along is in that one's own node_modules.
const kPackage = /^(.*node_modules[\\/](?:@[^\\/]+[\\/])?[^\\/]+)[\\/]/

const section = (title, text) => `\n${'='.repeat(80)}\n${title}\n\n${text}\n`

// `metafile` is esbuild's, with paths from this process's folder. A package that left no code in the bundle is not in it. Fails for a package without a text.
// `comments`: what esbuild took out of the code.
export function noticesOf(metafile, comments) {
  const folders = new Set()
  for (const { inputs } of Object.values(metafile.outputs))
    for (const [path, { bytesInOutput }] of Object.entries(inputs)) {
      const found = bytesInOutput > 0 && resolve(path).match(kPackage)
      if (found) folders.add(found[1])
    }
  const sections = [...folders].map((folder) => {
    const { name, version, license } = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8'))
    const texts = readdirSync(folder).filter((file) => kTexts.test(file)).sort()
    if (texts.length === 0) throw new Error(`${name} ${version} (${license}) comes without the text of its licence: it cannot be bundled`)
    const text = texts.map((file) => readFileSync(join(folder, file), 'utf8').replaceAll('\r\n', '\n').trim()).join('\n\n')
    return { name, version, license, text }
  })
  sections.sort((a, b) => (a.name < b.name ? -1 : a.name > b.name ? 1 : 0))
  return (
    'The web app that culprit serves contains code of these packages of npm, each under its own licence.\n' +
    sections.map(({ name, version, license, text }) => section(`${name} ${version} (${license})`, text)).join('') +
    comments.map((text) => text.trim()).filter(Boolean).map((text) => section('From comments in their code', text)).join('')
  )
}
