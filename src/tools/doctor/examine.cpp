#include "doctor/examine.h"

#include <algorithm>
#include <tuple>

namespace culprit::doctor {

void put_worst_first(Findings& findings) {
  std::ranges::sort(findings, [](const Finding& a, const Finding& b) {
    return std::tie(b.gravity, a.code, a.subject, a.seen) <
           std::tie(a.gravity, b.code, b.subject, b.seen);
  });
  findings.erase(std::unique(findings.begin(), findings.end()), findings.end());
}

Findings examine(const Picture& picture) {
  Findings all;
  for (const auto part : {examine_connections, examine_nodes, examine_processes, examine_statuses,
                          examine_reach, examine_flows, examine_transforms, examine_disks})
    part(picture, all);
  put_worst_first(all);
  return all;
}

}  // namespace culprit::doctor
