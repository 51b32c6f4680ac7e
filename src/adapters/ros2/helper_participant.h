// A participant that speaks the robot's own middleware, whatever that is, through a helper program (helper_options.h;
// docs/link-protocol.md has the frames between the two).
//
// From here the robot looks like DDS: topics and services have their DDS names, the graph comes as discovery and as
// `ros_discovery_info` (helper_graph.h), a request is written and its reply read. So nothing above knows the
// difference, but for what only DDS shows: where datagrams come from, the host and process of a participant, and the
// process that answered.
//
// - The helper is started again when it ends or hangs, after 0.2 s, or up to 10 s if it had not begun to work. Meanwhile culprit is
//   deaf: topics of the package `culprit`, by which it tests its hearing (hearing.h), go only to the
//   helper and back. It stays deaf until the new helper has discovered what the old one knew and
//   receives the topics that the old one received, or for 5 s. The graph stays as it was for so long.
// - A request is handed to one helper once, and never to its successor. A caller that hears nothing has to look.
#pragma once

#include <memory>

#include "ros2/helper_options.h"
#include "ros2/participant_impl.h"

namespace culprit::ros2 {

class HelperParticipant {
 public:
  // Starts the helper, and waits until it has joined the robot, for 20 s at most. Errors: there is no such program, it
  // ends, or it speaks another version.
  static Expected<std::unique_ptr<Participant::Impl>> join(HelperOptions options,
                                                           DiscoveryCallback on_discovery);
};

}  // namespace culprit::ros2
