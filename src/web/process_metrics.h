// What the operating system says of this process, under the names that Prometheus' own client
// libraries use: CPU time, memory, file descriptors, threads, start.
#pragma once

#include <string>

namespace culprit::web {

// In Prometheus' text format. What cannot be read is left out.
std::string process_metrics();

}  // namespace culprit::web
