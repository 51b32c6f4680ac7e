import { Approvals, Control } from './control'
import { Components, Explanation } from './explain'
import { Faults } from './faults'
import { GraphView } from './graph_view'
import { EventLog, Timeline } from './timeline'

export function RobotPage() {
  return (
    <main class="robot">
      <Faults />
      <div class="scene">
        <GraphView />
        <Timeline />
      </div>
      <aside>
        <Approvals />
        <Explanation />
        <Control />
        <Components />
        <EventLog />
      </aside>
    </main>
  )
}
