#include "web/calls.h"

namespace culprit::web {
namespace {

using namespace std::chrono_literals;

// The state is published while a client reads, so a single call reads for a moment.
http::Answer newest(http::Hub& hub, http::Kind kind) {
  constexpr auto kPatience = 1s;
  const http::Hub::Reader reader(hub);
  const auto known = hub.latest(kind);
  const auto end = std::chrono::steady_clock::now() + kPatience;
  auto newest = known;
  for (std::uint64_t seen = 0; newest == known && std::chrono::steady_clock::now() < end;) {
    const http::Hub::Batch batch = hub.wait(seen, 50ms);
    if (!batch.messages.empty()) seen = batch.messages.back().number;
    newest = hub.latest(kind);
    if (kind != http::Kind::kState && newest) break;
  }
  if (!newest) return http::refuse(503, "the manager has not said anything yet; ask again");
  return {200, parse_json(*newest)};
}

http::Answer events(http::Hub& hub) {
  Json list = Json::array();
  std::uint64_t seen = 0;
  while (true) {
    const http::Hub::Batch batch = hub.wait(seen, 0ms);
    if (batch.messages.empty()) return {200, list};
    seen = batch.messages.back().number;
    for (const http::Message& message : batch.messages) {
      if (message.kind == http::Kind::kEvent) list.push_back(parse_json(*message.data));
    }
  }
}

// As culprit beliefs export writes it (docs/journal.md): what differs from what it began from.
http::Answer beliefs(http::Hub& hub) {
  const http::Answer robot = newest(hub, http::Kind::kRobot);
  const http::Answer state = newest(hub, http::Kind::kState);
  if (robot.status != 200 || state.status != 200) return robot.status != 200 ? robot : state;
  const auto pairs = hub.latest(http::Kind::kLearned);
  const Json learned = pairs ? parse_json(*pairs) : Json::object();
  const Json& rules = robot.body["rules"];
  const Json& now = state.body["beliefs"];
  const Json& priors = state.body["priors"];
  Json document{{"format", "culprit-beliefs"}, {"format_version", 1},
                {"beliefs", Json::array()},    {"couplings", Json::array()},
                {"latencies", Json::array()},  {"coincidences", Json::array()}};
  std::size_t place = 0;
  for (const Json& rule : rules) {
    for (const Json& strategy : rule["strategies"]) {
      // A reload may have come between the two.
      if (place >= now.size()) return http::refuse(503, "the rules are being reloaded; ask again");
      const Json& belief = now[place];
      const Json& prior = priors[place++];
      if (belief == prior) continue;
      document["beliefs"].push_back({{"rule", rule["name"]},
                                     {"strategy", strategy["name"]},
                                     {"belief", belief},
                                     {"prior", prior}});
    }
  }
  for (const Json& each : learned.value("couplings", Json::array())) {
    const auto cause = each[0].get<std::size_t>();
    const auto effect = each[1].get<std::size_t>();
    if (cause >= rules.size() || effect >= rules.size()) continue;
    document["couplings"].push_back({{"cause", rules[cause]["name"]},
                                     {"effect", rules[effect]["name"]},
                                     {"cleared", each[2]},
                                     {"stayed", each[3]},
                                     {"spared", each[4]}});
  }
  for (const Json& each : learned.value("latencies", Json::array())) {
    const auto rule = each[0].get<std::size_t>();
    if (rule >= rules.size()) continue;
    document["latencies"].push_back({{"rule", rules[rule]["name"]},
                                     {"count", each[1]},
                                     {"least_s", each[2]},
                                     {"most_s", each[3]}});
  }
  for (const Json& each : learned.value("coincidences", Json::array())) {
    const auto rule = each[0].get<std::size_t>();
    const auto other = each[1].get<std::size_t>();
    if (rule >= rules.size() || other >= rules.size()) continue;
    document["coincidences"].push_back(
        {{"rule", rules[rule]["name"]}, {"other", rules[other]["name"]}, {"count", each[2]}});
  }
  return {200, document};
}

}  // namespace

std::vector<http::Route> live_routes(http::Hub& hub) {
  return {{http::Method::kGet, "/api/robot",
           [&hub](const Json&) { return newest(hub, http::Kind::kRobot); }},
          {http::Method::kGet, "/api/graph",
           [&hub](const Json&) { return newest(hub, http::Kind::kGraph); }},
          {http::Method::kGet, "/api/state",
           [&hub](const Json&) { return newest(hub, http::Kind::kState); }},
          {http::Method::kGet, "/api/control",
           [&hub](const Json&) { return newest(hub, http::Kind::kControl); }},
          {http::Method::kGet, "/api/beliefs", [&hub](const Json&) { return beliefs(hub); }},
          {http::Method::kGet, "/api/events", [&hub](const Json&) { return events(hub); }}};
}

}  // namespace culprit::web
