import type { VNode } from 'preact'
import { Approvals, Control } from './control'
import { Components, Explanation } from './explain'
import { Faults } from './faults'
import { GraphView } from './graph_view'
import { MapView } from './map_view'
import { ModeNotes } from './status_bar'
import { live } from './store'
import { EventLog, Timeline } from './timeline'

// The cause stands first also where there is but one column.
function Page({ View }: { View: () => VNode }) {
  return (
    <main class="robot">
      <div class="cause-first">
        <ModeNotes />
        <Approvals />
        <Explanation view={live} />
      </div>
      <div class="scene">
        <View />
        <Timeline view={live} />
      </div>
      <div class="more">
        <Control />
        <Faults />
        <Components />
        <EventLog view={live} />
        <p>
          <a href="#wall">Wall view</a>: big and dark, nothing to press
        </p>
      </div>
    </main>
  )
}

export const RobotPage = () => <Page View={GraphView} />
export const MapPage = () => <Page View={MapView} />
