#include <thread>

#include "web/calls.h"

namespace culprit::web {
namespace {

using namespace std::chrono_literals;

// The decision loop has no period: with nothing to do it may rest for long. So it is asked to come
// round, and lives if it does.
bool steps(Hub& hub, const Metrics& metrics, std::chrono::milliseconds patience) {
  const std::uint64_t before = metrics.steps();
  hub.wake();
  const auto end = std::chrono::steady_clock::now() + patience;
  while (metrics.steps() == before) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(1ms);
  }
  return true;
}

Answer health(bool does_step, const Metrics& metrics) {
  if (!does_step) return refuse(503, "the decision loop does not come round");
  if (!metrics.hears())
    return refuse(503, "culprit does not receive the robot's messages, and judges nothing");
  return {200, {{"status", "ok"}}};
}

Answer readiness(bool does_step, const Metrics& metrics) {
  if (const Answer healthy = health(does_step, metrics); healthy.status != 200) return healthy;
  if (!metrics.is_discovered())
    return refuse(503, "the robot is still given its time to show itself (--settle)");
  return {200, {{"status", "ready"}}};
}

}  // namespace

std::vector<Route> status_routes(Hub& hub, const Metrics& metrics,
                                 std::chrono::milliseconds patience) {
  const auto does_step = [&hub, &metrics, patience] { return steps(hub, metrics, patience); };
  return {{Method::kGet, "/healthz",
           [=, &metrics](const Json&) { return health(does_step(), metrics); }},
          {Method::kGet, "/readyz",
           [=, &metrics](const Json&) { return readiness(does_step(), metrics); }},
          {Method::kGet, "/metrics", [&metrics](const Json&) {
             Answer answer;
             answer.text = {"text/plain; version=0.0.4; charset=utf-8", metrics.text(), {}};
             return answer;
           }}};
}

}  // namespace culprit::web
