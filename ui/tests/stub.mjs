// A simulated culprit for the page: the calls of the API that the page needs, and a stream of messages
// that a test chooses. Beside the tests with the real program, it reaches the states that a robot is seldom in.
import { createServer } from 'node:http'
import { bundle } from '../bundle.mjs'

export const kDomain = 231 // that the stub is said to be on

// By module folder: bundling takes a second. `socket`: where `culprit status` finds it, too.
export async function stub(modules, calls = {}, socket = null) {
  const assets = new Map(bundle(modules).map((a) => [a.path, a]))
  const readers = new Set()
  const said = [] // messages for late readers
  const received = []
  let isSilent = false
  const json = (response, status, body) => {
    const text = JSON.stringify(body)
    response.writeHead(status, { 'Content-Type': 'application/json', 'Content-Length': Buffer.byteLength(text) }) // culprit status reads no chunks
    response.end(text)
  }
  const block = ({ kind, data }) => `event: ${kind}\ndata: ${JSON.stringify(data)}\n\n`
  const stream = (response) => {
    response.writeHead(200, { 'Content-Type': 'text/event-stream', 'Cache-Control': 'no-store' })
    response.write(block({ kind: 'hello', data: { resumed: false } }))
    for (const each of said) response.write(block(each))
    readers.add(response)
    response.on('close', () => readers.delete(response))
  }
  const answer = async (request, response) => {
    const asset = assets.get(request.url)
    if (asset) {
      response.writeHead(200, { 'Content-Type': asset.type })
      return response.end(asset.contents)
    }
    const [path, query = ''] = request.url.split('?')
    const name = `${request.method.toLowerCase()} ${path}`
    if (name === 'get /api/stream') return stream(response)
    if (name === 'get /api/about') return json(response, 200, { calls: Object.keys(calls), robot: 'rover', node: 'culprit', domain: kDomain })
    const document = /^get \/api\/(robot|state|control)$/.exec(name)
    if (document) return json(response, 200, said.find((each) => each.kind === document[1])?.data ?? null)
    if (name === 'get /api/events') return json(response, 200, said.filter((each) => each.kind === 'event').map((each) => each.data))
    let body = ''
    for await (const part of request) body += part
    const sent = body ? JSON.parse(body) : query ? Object.fromEntries(new URLSearchParams(query)) : null
    received.push([name, sent])
    if (!calls[name]) return json(response, 404, { error: 'there is no such page or call' })
    const [status, reply] = calls[name](sent)
    json(response, status, reply)
  }
  const server = createServer((request, response) => void answer(request, response))
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve))
  const local = createServer((request, response) => void answer(request, response))
  if (socket) await new Promise((resolve) => local.listen(socket, resolve))
  const { port } = server.address()
  const write = (text) => readers.forEach((r) => r.write(text))
  const heart = setInterval(() => isSilent || write(': nothing new\n\n'), 500)
  heart.unref()
  return {
    address: `http://127.0.0.1:${port}/#token=a-token-of-the-stub`,
    received,
    tell(kind, data) {
      if (kind !== 'event') said.splice(0, said.length, ...said.filter((each) => each.kind !== kind))
      said.push({ kind, data })
      write(block({ kind, data }))
    },
    // A late reader receives at most the last `count` events.
    keepEvents(count) {
      const events = said.filter((each) => each.kind === 'event')
      const old = new Set(events.slice(0, events.length - count))
      said.splice(0, said.length, ...said.filter((each) => !old.has(each)))
    },
    // Readers receive the message that earlier data is void, as from a culprit that has just begun.
    anew() {
      isSilent = false
      said.length = 0
      write(block({ kind: 'hello', data: { resumed: false } }))
    },
    // Connections end, and all data is dropped; readers that reconnect receive only later messages.
    forget() {
      isSilent = false
      said.length = 0
      readers.forEach((r) => r.end())
      readers.clear()
    },
    // From now on the connections are open, but nothing comes.
    fallSilent() {
      isSilent = true
    },
    // Ends the connections and takes no more of them.
    leave() {
      readers.forEach((r) => r.destroy())
      server.close()
      server.closeAllConnections()
    },
    async end() {
      clearInterval(heart)
      local.close()
      local.closeAllConnections()
      readers.forEach((r) => r.end())
      server.close()
      server.closeAllConnections()
    },
  }
}
