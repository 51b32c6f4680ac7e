// Whether the doctor was held up itself: on a machine that has too much to do its threads wait for a processor,
// and its sockets overflow. What it did not hear then is no proof that nobody said it.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "doctor/finding.h"
#include "doctor/picture.h"

namespace culprit::doctor {

// How long each thread of this process has waited for a processor since it began, by its id. Empty where the
// kernel does not tell.
std::map<int, Duration> waits_of_own_threads();
// In the text of /proc/<pid>/task/<tid>/schedstat: "<running> <waiting> <turns>", in nanoseconds (proc(5)).
std::optional<Duration> wait_in(const std::string& schedstat);
// Of one thread, between the two.
Duration longest_wait(const std::map<int, Duration>& before, const std::map<int, Duration>& now);

// One of its threads waited for more than a quarter of the look.
bool was_held_up(const Picture& picture);

// Findings with this code are made of something that did not come, or came late.
bool is_of_absence(const std::string& code);

}  // namespace culprit::doctor
