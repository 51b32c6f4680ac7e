// Pictures of the page, compared with those of ui/tests/pictures: scaled down, so that neither another version of the browser
// nor the edges of letters count, and each place is what it is the mean of.
//
// CULPRIT_PICTURES=make makes the references anew (scripts/page-pictures).
import { existsSync, readFileSync, writeFileSync } from 'node:fs'
import { dirname, join } from 'node:path'
import { fileURLToPath } from 'node:url'
import { isFirefox, kSchemes } from './session.mjs'

export const kSizes = {
  desktop: { width: 1440, height: 900 },
  laptop: { width: 1024, height: 768 },
  tablet: { width: 768, height: 1024 },
  phone: { width: 390, height: 844 },
  wall: { width: 1920, height: 1080 }, // its own view
}
const references = join(dirname(fileURLToPath(import.meta.url)), 'pictures')
const isMaking = process.env.CULPRIT_PICTURES === 'make'
const kScale = 0.25
const kPatience = 60_000 // ms, for what is still being drawn
const kCalm = 3 // looks, until a new reference is taken
const kBetween = 200 // ms
const kMostOthers = 0.006 // share of a picture that may differ: less than a button

// One picture for all sizes: side by side, the dark ones below.
const scaled = ({ width, height }) => ({ width: Math.round(width * kScale), height: Math.round(height * kScale) })
const tiles = {}
let left = 0
for (const [size, viewport] of Object.entries(kSizes)) {
  const { width, height } = scaled(viewport)
  for (const [row, scheme] of kSchemes.entries()) tiles[`${size} ${scheme}`] = { x: left, y: row * scaled(kSizes.wall).height, width, height }
  left += width
}
const kSheet = { width: left, height: 2 * scaled(kSizes.wall).height }

// In a page of its own: it has what it takes to read, scale and write pictures.
const lens = () => {
  const load = async (address) => {
    const image = new Image()
    image.src = address
    await image.decode()
    return image
  }
  const canvasOf = ({ width, height }) => Object.assign(document.createElement('canvas'), { width, height }).getContext('2d', { willReadFrequently: true })
  const sheets = new Map()
  let last = null
  window.open_ = async (name, size, address) => {
    const sheet = canvasOf(size)
    if (address) sheet.drawImage(await load(address), 0, 0)
    sheets.set(name, sheet)
  }
  const pixelsOf = async (shot, { width, height }) => {
    const context = canvasOf({ width, height })
    context.imageSmoothingQuality = 'high'
    context.drawImage(await load(`data:image/png;base64,${shot}`), 0, 0, width, height)
    return context.getImageData(0, 0, width, height)
  }
  const kDifferent = 40 // of 255, in a colour
  // By means of four: what compression makes of a single one does not count.
  const difference = (a, b) => {
    const at = ({ data, width }, x, y, c) => data[4 * (y * width + x) + c]
    const mean = (image, x, y, c) => (at(image, x, y, c) + at(image, x + 1, y, c) + at(image, x, y + 1, c) + at(image, x + 1, y + 1, c)) / 4
    let [count, all] = [0, 0]
    for (let y = 0; y + 1 < a.height; y += 2) {
      for (let x = 0; x + 1 < a.width; x += 2) {
        ++all
        if ([0, 1, 2].some((c) => Math.abs(mean(a, x, y, c) - mean(b, x, y, c)) > kDifferent)) ++count
      }
    }
    return count / all
  }
  // The share of the picture that differs: from its reference, or from the picture before.
  window.compare = async (name, tile, shot) => {
    const pixels = await pixelsOf(shot, tile)
    return difference(pixels, sheets.get(name).getImageData(tile.x, tile.y, tile.width, tile.height))
  }
  window.isSettled = async (tile, shot) => {
    const pixels = await pixelsOf(shot, tile)
    const isSame = last !== null && last.width === pixels.width && last.height === pixels.height && difference(last, pixels) === 0
    last = pixels
    return isSame
  }
  window.put = async (name, tile, shot) => sheets.get(name).putImageData(await pixelsOf(shot, tile), tile.x, tile.y)
  window.written = (name) => sheets.get(name).canvas.toDataURL('image/webp', 0.7)
}

// `folder`: where pictures are left that differ. Those of Firefox, which draws letters and controls in its own way, are not compared.
export async function pictures(page, folder) {
  if (isFirefox) return { compare: async () => {}, end: async () => {} }
  const glass = await page.context().newPage()
  await glass.evaluate(lens)
  const names = new Set()
  const file = (name) => join(references, `${name}.webp`)
  const camera = await page.context().newCDPSession(page)
  const shoot = async () => (await camera.send('Page.captureScreenshot', { format: 'png', optimizeForSpeed: true })).data
  const open = async (name) => {
    if (names.has(name)) return
    names.add(name)
    if (!isMaking && !existsSync(file(name))) throw new Error(`there is no picture ${name}.webp to compare with: make it with scripts/page-pictures`)
    const address = isMaking ? null : `data:image/webp;base64,${readFileSync(file(name)).toString('base64')}`
    await glass.evaluate(([n, size, a]) => open_(n, size, a), [name, kSheet, address])
  }
  return {
    // As it is now at this size and in these colours.
    async compare(name, size, scheme) {
      await open(name)
      const tile = tiles[`${size} ${scheme}`]
      const end = Date.now() + kPatience
      let calm = 0 // looks without a change
      for (;;) {
        const shot = await shoot()
        if (isMaking) {
          calm = (await glass.evaluate(([t, p]) => isSettled(t, p), [tile, shot])) ? calm + 1 : 0
          if (calm < kCalm && Date.now() < end) {
            await page.waitForTimeout(kBetween)
            continue
          }
          return void (await glass.evaluate(([n, t, p]) => put(n, t, p), [name, tile, shot]))
        }
        const others = await glass.evaluate(([n, t, p]) => compare(n, t, p), [name, tile, shot])
        if (process.env.CULPRIT_PICTURES === 'tell') console.log(`${name} ${size} ${scheme}: ${(100 * others).toFixed(2)} % differ`)
        if (others <= kMostOthers) return
        await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))))
        if (Date.now() < end) continue
        const left = join(folder, `${name}-${size}-${scheme}.png`)
        writeFileSync(left, Buffer.from(shot, 'base64'))
        throw new Error(`${(100 * others).toFixed(2)} % of ${name} (${size}, ${scheme}) is not as in ui/tests/pictures; it is in ${left}. Where it should be so: scripts/page-pictures`)
      }
    },
    async end() {
      if (isMaking) {
        for (const name of names) {
          const address = await glass.evaluate((n) => written(n), name)
          writeFileSync(file(name), Buffer.from(address.slice(address.indexOf(',') + 1), 'base64'))
        }
      }
      await glass.close()
    },
  }
}
