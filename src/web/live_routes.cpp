#include "web/live_routes.h"

namespace culprit::web {
namespace {

using namespace std::chrono_literals;

// The state is told while somebody reads, so whoever asks for it once reads for a moment.
Answer newest(Hub& hub, Kind kind) {
  constexpr auto kPatience = 1s;
  const Hub::Reader reader(hub);
  const auto known = hub.latest(kind);
  const auto end = std::chrono::steady_clock::now() + kPatience;
  auto newest = known;
  for (std::uint64_t seen = 0; newest == known && std::chrono::steady_clock::now() < end;) {
    const Hub::Batch batch = hub.wait(seen, 50ms);
    if (!batch.messages.empty()) seen = batch.messages.back().number;
    newest = hub.latest(kind);
    if (kind != Kind::kState && newest) break;
  }
  if (!newest) return refuse(503, "the manager has not said anything yet; ask again");
  return {200, Json::parse(*newest)};
}

Answer events(Hub& hub) {
  Json list = Json::array();
  std::uint64_t seen = 0;
  while (true) {
    const Hub::Batch batch = hub.wait(seen, 0ms);
    if (batch.messages.empty()) return {200, list};
    seen = batch.messages.back().number;
    for (const Message& message : batch.messages) {
      if (message.kind == Kind::kEvent) list.push_back(Json::parse(*message.data));
    }
  }
}

}  // namespace

std::vector<Route> live_routes(Hub& hub) {
  return {
      {Method::kGet, "/api/robot", [&hub](const Json&) { return newest(hub, Kind::kRobot); }},
      {Method::kGet, "/api/graph", [&hub](const Json&) { return newest(hub, Kind::kGraph); }},
      {Method::kGet, "/api/state", [&hub](const Json&) { return newest(hub, Kind::kState); }},
      {Method::kGet, "/api/control", [&hub](const Json&) { return newest(hub, Kind::kControl); }},
      {Method::kGet, "/api/events", [&hub](const Json&) { return events(hub); }}};
}

}  // namespace culprit::web
