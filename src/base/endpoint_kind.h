// How a node takes part: it offers or uses a topic (publisher, subscriber) or a service (server,
// client).
#pragma once

#include <cstdint>

namespace culprit {

enum class EndpointKind : std::uint8_t { kPublisher, kSubscriber, kServer, kClient };

}  // namespace culprit
