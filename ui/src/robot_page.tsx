import { Components, Explanation } from './explain'
import { Faults } from './faults'
import { GraphView } from './graph_view'
import { EventLog, Timeline } from './timeline'

export function RobotPage() {
  return (
    <main class="robot">
      <Faults />
      <GraphView />
      <aside>
        <Explanation />
        <Components />
        <EventLog />
      </aside>
      <Timeline />
    </main>
  )
}
