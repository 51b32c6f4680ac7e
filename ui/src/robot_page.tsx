import { Approvals, Control } from './control'
import { Components, Explanation } from './explain'
import { Faults } from './faults'
import { GraphView } from './graph_view'
import { live } from './store'
import { EventLog, Timeline } from './timeline'

export function RobotPage() {
  return (
    <main class="robot">
      <Faults />
      <div class="scene">
        <GraphView />
        <Timeline view={live} />
      </div>
      <aside>
        <Approvals />
        <Explanation view={live} />
        <Control />
        <Components />
        <EventLog view={live} />
      </aside>
    </main>
  )
}
