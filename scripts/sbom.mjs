// Writes the bill of materials of the Debian packages in a folder, as SPDX 2.3: node scripts/sbom.mjs FOLDER > sbom.spdx.json
//
// The dependencies are the packages' own (Depends), with the versions that they were built with. The contained parts of others are those that are
// compiled into the programs: headers of Debian's -dev packages, and what the web page is bundled from (ui/package-lock.json).
import { execFileSync } from 'node:child_process'
import { createHash } from 'node:crypto'
import { readFileSync, readdirSync } from 'node:fs'
import { join } from 'node:path'

const [folder] = process.argv.slice(2)
const root = new URL('..', import.meta.url).pathname
const run = (...words) => execFileSync(words[0], words.slice(1), { encoding: 'utf8' }).trim()

// By the package of ours that contains them. The licences are what Debian's copyright files and the lock file say.
const kHeaders = { 'libcli11-dev': 'BSD-3-Clause', 'nlohmann-json3-dev': 'MIT', 'libfmt-dev': 'MIT', 'libcpp-httplib-dev': 'MIT', 'libyaml-cpp-dev': 'MIT' }
const kContained = { culprit: kHeaders, 'culprit-lab': { ...kHeaders, 'libboost-math-dev': 'BSL-1.0' } }

const packages = new Map() // by SPDXID
const relationships = []
const id = (...parts) => 'SPDXRef-' + parts.join('-').replace(/[^A-Za-z0-9.]+/g, '-')
const relate = (from, relationshipType, to) =>
  relationships.push({ spdxElementId: from, relationshipType, relatedSpdxElement: to })

const add = (key, name, versionInfo, license, more = {}) => {
  packages.set(key, {
    SPDXID: key, name, versionInfo, downloadLocation: 'NOASSERTION', filesAnalyzed: false,
    licenseConcluded: 'NOASSERTION', licenseDeclared: license, copyrightText: 'NOASSERTION', ...more
  })
  return key
}
const purl = (referenceLocator) => ({
  externalRefs: [{ referenceCategory: 'PACKAGE-MANAGER', referenceType: 'purl', referenceLocator }]
})
const addDebian = (name, license = 'NOASSERTION') => {
  const [version, architecture] = run('dpkg-query', '-W', '-f', '${Version} ${Architecture}\n', name).split('\n')[0].split(' ')
  const place = `pkg:deb/debian/${encodeURIComponent(name)}@${encodeURIComponent(version)}?arch=${architecture}`
  return add(id('deb', name), name, version, license, purl(place))
}

const debs = readdirSync(folder).filter((file) => file.endsWith('.deb')).sort()
const fields = new Map(debs.map((file) => {
  const field = (name) => run('dpkg-deb', '-f', join(folder, file), name)
  return [file, { name: field('Package'), version: field('Version'), depends: field('Depends') }]
}))
const ours = new Map([...fields.values()].map(({ name }) => [name, id('package', name)]))
const digest = createHash('sha256')

for (const file of debs) {
  const { name, version, depends } = fields.get(file)
  const sha256 = createHash('sha256').update(readFileSync(join(folder, file))).digest('hex')
  digest.update(sha256)
  const own = add(ours.get(name), name, version, 'Apache-2.0', {
    packageFileName: file, checksums: [{ algorithm: 'SHA256', checksumValue: sha256 }]
  })
  relate('SPDXRef-DOCUMENT', 'DESCRIBES', own)
  for (const clause of depends.split(',').filter(Boolean)) {
    const needed = clause.trim().split(/[ |(]/)[0] // the first of several
    relate(own, 'DEPENDS_ON', ours.get(needed) ?? addDebian(needed))
  }
  for (const [header, license] of Object.entries(kContained[name] ?? {})) relate(own, 'CONTAINS', addDebian(header, license))
  if (name !== 'culprit' && name !== 'culprit-lab') continue // both serve the page
  const { packages: locked } = JSON.parse(readFileSync(join(root, 'ui/package-lock.json')))
  for (const [place, { version, license, dev }] of Object.entries(locked)) {
    if (!place || dev) continue
    const module = place.replace(/^.*node_modules\//, '')
    relate(own, 'CONTAINS',
      add(id('npm', module), module, version, license ?? 'NOASSERTION', purl(`pkg:npm/${module.replace('@', '%40')}@${version}`)))
  }
}

const created = new Date(Number(process.env.SOURCE_DATE_EPOCH ?? Date.now() / 1000) * 1000)
console.log(JSON.stringify({
  spdxVersion: 'SPDX-2.3', dataLicense: 'CC0-1.0', SPDXID: 'SPDXRef-DOCUMENT', name: 'culprit',
  documentNamespace: `https://spdx.org/spdxdocs/culprit-${digest.digest('hex')}`,
  creationInfo: { created: created.toISOString().replace(/\.\d+Z/, 'Z'), creators: ['Tool: culprit-sbom'] },
  packages: [...packages.values()], relationships
}, null, 1))
