// Looks at a robot for some seconds, and changes nothing: it joins as a hidden node, asks what
// changes nothing, and its readers are best effort, but for what is latched.
#pragma once

#include <functional>
#include <stop_token>

#include "base/expected.h"
#include "base/time.h"
#include "doctor/picture.h"
#include "doctor/wanted_topics.h"
#include "ros2/options.h"

namespace culprit::doctor {

struct LookOptions {
  ros2::ParticipantOptions participant{};
  Duration time = std::chrono::seconds(8);
  Extent extent = Extent::kFindings;
};

// The calling thread waits. Errors: the domain cannot be joined; it was stopped.
Expected<Picture> look(const LookOptions& options, const std::stop_token& stop = {});

// One look after the other, until it is stopped. `on_picture` is called on the calling thread.
Expected<void> watch(const LookOptions& options, std::function<void(const Picture&)> on_picture,
                     const std::stop_token& stop);

}  // namespace culprit::doctor
