// Whether the doctor was held up itself: on an overloaded machine its threads wait for a processor, and its sockets overflow. Messages that it missed meanwhile
// prove nothing.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "doctor/finding.h"
#include "doctor/picture.h"

namespace culprit::doctor {

// How long each thread of this process has waited for a processor since it began, by its id. Empty if the kernel does not report it.
std::map<int, Duration> waits_of_own_threads();
// In the text of /proc/<pid>/task/<tid>/schedstat: "<running> <waiting> <turns>", in nanoseconds (proc(5)).
std::optional<Duration> wait_in(const std::string& schedstat);
// The longest wait of one thread between the two.
Duration longest_wait(const std::map<int, Duration>& before, const std::map<int, Duration>& now);

// One of its threads waited for more than a quarter of the look.
bool was_held_up(const Picture& picture);

// Findings with this code are made of something that did not come, or came late.
bool is_of_absence(const std::string& code);

}  // namespace culprit::doctor
