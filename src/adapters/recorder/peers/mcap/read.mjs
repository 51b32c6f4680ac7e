// read.mjs FILE: reads a recording as Foxglove does, and prints a line for each topic: its name, type, encoding, how many messages, and
// the last one as it is decoded by the schema in the file. --streamed: from the beginning to the end, without the index, as one
// reads a file whose recorder was killed.
import { open } from 'node:fs/promises'
import { readFileSync } from 'node:fs'
import { parse } from '@foxglove/rosmsg'
import { MessageReader } from '@foxglove/rosmsg2-serialization'
import { McapIndexedReader, McapStreamReader } from '@mcap/core'
import { decompress } from 'fzstd'

const decompressHandlers = { zstd: (bytes, size) => decompress(bytes, new Uint8Array(Number(size))) }
const path = process.argv[2]
const schemas = new Map()
const channels = new Map()
const topics = new Map()

function take(channel, message) {
  const known = topics.get(channel.topic) ?? { channel, count: 0 }
  topics.set(channel.topic, { channel, count: known.count + 1, last: message.data })
}

if (process.argv[3] === '--streamed') {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true })
  reader.append(readFileSync(path))
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === 'Schema') schemas.set(record.id, record)
    if (record.type === 'Channel') channels.set(record.id, record)
    if (record.type === 'Message') take(channels.get(record.channelId), record)
  }
} else {
  const file = await open(path)
  const readable = {
    size: async () => BigInt((await file.stat()).size),
    read: async (offset, size) => {
      const { buffer } = await file.read(new Uint8Array(Number(size)), 0, Number(size), Number(offset))
      return buffer
    },
  }
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers })
  if (reader.header.profile !== 'ros2') throw new Error(`profile ${reader.header.profile}`)
  for (const schema of reader.schemasById.values()) schemas.set(schema.id, schema)
  let last = 0n
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    if (message.logTime < last) throw new Error('times go back')
    last = message.logTime
    take(reader.channelsById.get(message.channelId), message)
  }
  let count = 0
  for (const topic of topics.values()) count += topic.count
  if (BigInt(count) !== reader.statistics.messageCount) throw new Error('its statistics are wrong')
  for await (const metadata of reader.readMetadata()) console.log(`metadata ${metadata.name}`)
}

for (const [name, { channel, count, last }] of [...topics].sort()) {
  const schema = schemas.get(channel.schemaId)
  let content = '-'
  if (schema.encoding === 'ros2msg') {
    const definitions = parse(new TextDecoder().decode(schema.data), { ros2: true })
    content = JSON.stringify(new MessageReader(definitions).readMessage(last), (key, value) => (typeof value === 'bigint' ? Number(value) : ArrayBuffer.isView(value) ? [...value] : value))
  }
  console.log(`${name} ${schema.name} ${channel.messageEncoding} ${count} ${content}`)
}
