#include <thread>

#include "web/calls.h"

namespace culprit::web {
namespace {

using namespace std::chrono_literals;

// The decision loop has no period: with nothing to do it may rest for long. So it is asked to come
// round, and lives if it does.
bool steps(http::Hub& hub, const Metrics& metrics, std::chrono::milliseconds patience) {
  const std::uint64_t before = metrics.steps();
  hub.wake();
  const auto end = std::chrono::steady_clock::now() + patience;
  while (metrics.steps() == before) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(1ms);
  }
  return true;
}

http::Answer health(bool does_step, const Metrics& metrics) {
  if (!does_step) return http::refuse(503, "the decision loop does not come round");
  if (!metrics.hears())
    return http::refuse(503, "culprit does not receive the robot's messages, and judges nothing");
  return {200, {{"status", "ok"}}};
}

http::Answer readiness(bool does_step, const Metrics& metrics) {
  if (const http::Answer healthy = health(does_step, metrics); healthy.status != 200)
    return healthy;
  if (!metrics.is_discovered())
    return http::refuse(503, "the robot is still given its time to show itself (--settle)");
  return {200, {{"status", "ready"}}};
}

}  // namespace

std::vector<http::Route> status_routes(http::Hub& hub, const Metrics& metrics,
                                       std::chrono::milliseconds patience) {
  const auto does_step = [&hub, &metrics, patience] { return steps(hub, metrics, patience); };
  return {{http::Method::kGet, "/healthz",
           [=, &metrics](const Json&) { return health(does_step(), metrics); }},
          {http::Method::kGet, "/readyz",
           [=, &metrics](const Json&) { return readiness(does_step(), metrics); }},
          {http::Method::kGet, "/metrics", [&metrics](const Json&) {
             http::Answer answer;
             answer.text = {"text/plain; version=0.0.4; charset=utf-8", metrics.text(), {}};
             return answer;
           }}};
}

}  // namespace culprit::web
