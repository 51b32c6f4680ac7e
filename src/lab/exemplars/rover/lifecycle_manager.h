// A lifecycle manager that behaves as Nav2's (nav2_lifecycle_manager of Humble), failures included:
//
// - It configures all servers in their order, then activates them. If one refuses, the start has failed, and it does nothing more.
// - Each active server keeps a bond on /bond. If a bond is broken for 4 s while all are active, the manager deactivates the servers
//   backwards and cleans them up backwards. A server that refuses is passed over. One that is missing ends the reset, and
//   nothing is cleaned up.
// - No request has a timeout: a server that is hung, or whose death the middleware has not noticed, blocks it for ever.
// - After a reset it starts all up again if all answer within 10 s.
// - ~/manage_nodes (startup, pause, resume, reset) is answered once it is done: never, while the manager is blocked.
//
// Its node has parameters and answers while it is blocked.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "ros2/context.h"

namespace culprit::rover {

// Opens the manager's node, and works for ever on a thread of its own, which the process must not wait for.
Expected<void> run_lifecycle_manager(ros2::Context& context, const std::string& name,
                                     std::span<const std::string_view> servers);

}  // namespace culprit::rover
