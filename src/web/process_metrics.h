// Metrics of this process from the operating system, under the names that Prometheus' own client
// libraries use: CPU time, memory, file descriptors, threads, start.
#pragma once

#include <string>

namespace culprit::web {

// In Prometheus' text format. Unreadable values are left out.
std::string process_metrics();

}  // namespace culprit::web
