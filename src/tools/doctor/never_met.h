// The topics whose readers and writers a look never needs, however long it lasts: it reads topics and calls a few services, it publishes nothing and serves
// nothing.
#pragma once

#include <string_view>

#include "rtps/endpoint_info.h"

namespace culprit::doctor {

// ros2::ParticipantOptions::never_meets. Services that asking.h calls, and topics that wanted_topics.h and the other listeners may need, must not be in here.
bool never_meets(std::string_view dds_topic, rtps::EndpointRole role);

}  // namespace culprit::doctor
