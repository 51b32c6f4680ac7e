// Talking to the server: calls with the token, and the stream of changes.

const kTokenKey = 'culprit-token'

// The address that culprit prints ends in #token=...; it must not stay in the history of the browser.
function takeToken(): string {
  const match = /^#token=([^&]+)/.exec(location.hash)
  if (match) {
    sessionStorage.setItem(kTokenKey, decodeURIComponent(match[1]))
    history.replaceState(null, '', location.pathname)
  }
  return sessionStorage.getItem(kTokenKey) ?? ''
}
const token = takeToken()
export const hasToken = token !== ''

function headers(more: Record<string, string> = {}): Record<string, string> {
  return token ? { Authorization: `Bearer ${token}`, ...more } : more
}

export class Refusal extends Error {
  constructor(
    readonly status: number,
    message: string
  ) {
    super(message)
  }
}

async function refusalOf(response: Response): Promise<Refusal> {
  const answer = await response.json().catch(() => ({}))
  const why = response.status === 401 ? 'the token is not valid: open the address that culprit printed' : answer.error
  return new Refusal(response.status, why ?? `error ${response.status}`)
}

async function ask(path: string, init: RequestInit): Promise<Response> {
  let response: Response
  try {
    response = await fetch(path, init)
  } catch {
    throw new Refusal(0, 'culprit does not answer; is it still running?')
  }
  if (response.ok) return response
  throw await refusalOf(response)
}

export async function call<T>(method: string, path: string, body?: unknown): Promise<T> {
  const init: RequestInit = { method, headers: headers() }
  if (body !== undefined) {
    init.headers = headers({ 'Content-Type': 'application/json' })
    init.body = JSON.stringify(body)
  }
  const response = await ask(path, init)
  try {
    return await response.json()
  } catch {
    throw new Refusal(0, 'culprit ended while it answered; is it still running?')
  }
}

export async function textOf(path: string): Promise<string> {
  return (await ask(path, { headers: headers() })).text()
}

export async function fileAt(path: string): Promise<Blob> {
  return (await ask(path, { headers: headers() })).blob()
}

export interface StreamMessage {
  id: string
  event: string
  data: string
}

// A server that lives says something every second.
const kLongestSilence = 5000 // ms, until the connection is given up

// Server-sent events (WHATWG HTML). Not by EventSource, which cannot send the token. Goes on after
// an interruption where it left off, for ever. `onSign` is called for any data that arrives, also if it is no message;
// `onConnection` also gets the reason if culprit refuses the connection.
export async function follow(
  onMessage: (message: StreamMessage) => void,
  onSign: () => void,
  onConnection: (isConnected: boolean, why?: string) => void
): Promise<never> {
  let lastId = ''
  for (;;) {
    // A network that is gone says nothing of it.
    const silence = new AbortController()
    let timer = 0
    const listen = () => {
      clearTimeout(timer)
      timer = window.setTimeout(() => silence.abort(), kLongestSilence)
    }
    let why = ''
    try {
      const more: Record<string, string> = lastId ? { 'Last-Event-ID': lastId } : {}
      listen()
      const response = await fetch('/api/stream', { headers: headers(more), signal: silence.signal })
      if (!response.ok || !response.body) throw await refusalOf(response)
      onConnection(true)
      const reader = response.body.pipeThrough(new TextDecoderStream()).getReader()
      let pending = ''
      for (let part = await reader.read(); !part.done; part = await reader.read()) {
        listen()
        onSign()
        const blocks = (pending + part.value).split('\n\n')
        pending = blocks.pop() ?? ''
        for (const block of blocks) {
          const message = { id: '', event: 'message', data: '' }
          for (const line of block.split('\n')) {
            const colon = line.indexOf(': ')
            const field = line.slice(0, colon)
            if (field === 'id' || field === 'event' || field === 'data')
              message[field] = line.slice(colon + 2)
          }
          if (message.id) lastId = message.id
          if (message.data) onMessage(message)
        }
      }
    } catch (error) {
      if (error instanceof Refusal) why = error.message // of other errors the next attempt says the same again
    }
    clearTimeout(timer)
    onConnection(false, why)
    await new Promise((resolve) => setTimeout(resolve, 1000))
  }
}
