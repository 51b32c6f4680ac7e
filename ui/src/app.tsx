import './app.css'
import { effect, signal } from '@preact/signals'
import { render } from 'preact'
import { hasToken, Refusal } from './api'
import { IncidentsPage, showIncident } from './incidents_page'
import { BeliefsPage } from './beliefs_page'
import { DoctorPage } from './doctor_page'
import { HelpPage, Meaning } from './glossary'
import { hasMap } from './map'
import { Notices } from './notices'
import { fromAddress } from './plotted'
import { PlotsPage } from './plots_page'
import { MapPage, RobotPage } from './robot_page'
import { RulesPage } from './rules_page'
import { SimulatorPage } from './simulator_page'
import { isOld } from './freshness'
import { followInTitle, StatusBar } from './status_bar'
import { calls, can, robot, start } from './store'
import { StudiesPage } from './studies_page'
import { Tour } from './tour'
import { WallPage } from './wall_page'

const kPages = [
  { name: 'robot', title: 'Robot', needs: 'get /api/stream', Page: RobotPage },
  { name: 'map', title: 'Map', needs: 'get /api/map', Page: MapPage },
  { name: 'incidents', title: 'Incidents', needs: 'get /api/incidents', Page: IncidentsPage },
  { name: 'plots', title: 'Plots', needs: 'get /api/series', Page: PlotsPage },
  { name: 'doctor', title: 'Doctor', needs: 'post /api/doctor', Page: DoctorPage },
  { name: 'rules', title: 'Rules', needs: 'get /api/rules', Page: RulesPage },
  { name: 'beliefs', title: 'Beliefs', needs: 'get /api/stream', Page: BeliefsPage },
  { name: 'simulator', title: 'Simulator', needs: 'post /api/what-if', Page: SimulatorPage },
  { name: 'studies', title: 'Studies', needs: 'get /api/studies', Page: StudiesPage },
  { name: 'help', title: 'Help', needs: '', Page: HelpPage },
]

const page = signal('')
// "#incidents/m9k2" is a place within a page, "#plots/s=…" what it shows.
function follow(): void {
  const [name, ...rest] = location.hash.slice(1).split('/')
  const place = rest.join('/') // people and chats write the slash of a topic as it is
  page.value = name
  if (name === 'incidents') showIncident(place)
  if (name === 'plots') fromAddress(place)
}
addEventListener('hashchange', follow)
follow()
const trouble = signal('')
const kAgain = 1000 // ms

function App() {
  const isThere = (name: string) => name !== 'map' || hasMap.value || page.value === 'map'
  const offered = kPages.filter((p) => isThere(p.name) && (calls.value.has(p.needs) || (!p.needs && calls.value.size > 0)))
  if (page.value === 'wall' && can('get', '/api/stream')) return <WallPage />
  const current = offered.find((p) => p.name === page.value) ?? offered[0]
  return (
    <>
      <StatusBar />
      <header>
        <h1>
          culprit <small>{robot.value?.robot}</small>
        </h1>
        <nav aria-label="Pages">
          {offered.map((p) => (
            <a href={`#${p.name}`} aria-current={p === current ? 'page' : undefined}>
              {p.title}
            </a>
          ))}
        </nav>
        {!hasToken && calls.value.size > 0 && (
          <p class="view-only">Read-only. To control culprit, open the address that it printed, with its token.</p>
        )}
      </header>
      {current ? (
        <current.Page />
      ) : (
        <main>
          <p>{trouble.value || 'Asking culprit …'}</p>
        </main>
      )}
      <Notices />
      <Meaning />
      {current?.name === 'robot' && <Tour />}
    </>
  )
}

render(<App />, document.getElementById('app')!)
followInTitle()
effect(() => void document.body.classList.toggle('is-old', isOld.value))

// Until culprit answers: it may start a moment later than the page is opened, or refuse a call among too many.
async function begin(): Promise<void> {
  try {
    await start()
  } catch (error) {
    trouble.value = (error as Error).message
    const isForbidden = error instanceof Refusal && [401, 403].includes(error.status)
    if (!isForbidden) setTimeout(() => void begin(), kAgain)
  }
}
void begin()
