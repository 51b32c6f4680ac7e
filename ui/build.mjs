// Bundles the web app and writes it as one C++ file, and the licences of what it is made of: node build.mjs <folder of node_modules> <output.cpp> <notices>
import { mkdirSync, writeFileSync } from 'node:fs'
import { dirname } from 'node:path'
import { gzipSync } from 'node:zlib'
import { bundleWithNotices } from './bundle.mjs'

const [modules, output, noticesFile] = process.argv.slice(2)
// All of the page as it is served, each file by gzip -9: what a tablet in the field has to load.
const kMostBytes = 350_000

const bundled = bundleWithNotices(modules)
const assets = bundled.assets.map(({ path, type, contents }) => ({ path, type, gzip: gzipSync(contents, { level: 9 }) }))

const size = assets.reduce((sum, asset) => sum + asset.gzip.length, 0)
if (size > kMostBytes) throw new Error(`the app has ${size} bytes; it may have ${kMostBytes}`)

// Bytes as a string literal: octal escapes end after three digits, so nothing can run on.
const literal = (bytes) => {
  const lines = []
  for (let i = 0; i < bytes.length; i += 64) {
    const escapes = Array.from(bytes.subarray(i, i + 64), (b) => '\\' + b.toString(8).padStart(3, '0'))
    lines.push('"' + escapes.join('') + '"')
  }
  return lines.join('\n')
}

const parts = assets.map((asset, i) => `constexpr char kBytes${i}[] =\n${literal(asset.gzip)};\n`)
const table = assets.map(
  (asset, i) => `    {"${asset.path}", "${asset.type}", {kBytes${i}, sizeof kBytes${i} - 1}},\n`
)
mkdirSync(dirname(output), { recursive: true })
writeFileSync(
  output,
  `// Generated from ui/ by build.mjs: ${size} bytes.\n#include "web/app.h"\n\nnamespace culprit::web {\nnamespace {\n\n` +
    `${parts.join('\n')}\nconstexpr http::Asset kAssets[] = {\n${table.join('')}};\n\n}  // namespace\n\n` +
    `std::span<const http::Asset> app() { return kAssets; }\n\n}  // namespace culprit::web\n`
)
writeFileSync(noticesFile, bundled.notices)
console.log(`web app: ${size} bytes compressed`)
