#include "journal/session.h"

#include <fstream>

namespace culprit::journal {
namespace {

Json pair(double a, double b) { return Json::array({a, b}); }

std::optional<std::pair<double, double>> pair_from(const Json& json, const char* key) {
  if (!json.is_object()) return std::nullopt;
  const auto found = json.find(key);
  const bool fits = found != json.end() && found->is_array() && found->size() == 2 &&
                    (*found)[0].is_number() && (*found)[1].is_number();
  if (!fits) return std::nullopt;
  return std::pair((*found)[0].get<double>(), (*found)[1].get<double>());
}

// Pseudo-counts are above zero, and no robot runs long enough for the others.
bool is_belief(const Belief& belief) {
  return belief.alpha > 0 && belief.beta > 0 && belief.alpha < 1e15 && belief.beta < 1e15;
}
bool is_count(double count) { return count >= 0 && count < 1e15; }
// No effect is awaited for longer than a year.
bool is_latency(std::int64_t count, double least_s, double most_s) {
  return count >= 0 && count <= Latencies::Learned::kMost && least_s >= 0 && least_s <= most_s &&
         most_s < 366 * 86'400.0;
}

}  // namespace

Json to_json(const Learned& learned) {
  Json json = {
      {"beliefs", Json::array()}, {"couplings", Json::array()}, {"latencies", Json::array()}};
  for (const LearnedBelief& each : learned.beliefs)
    json["beliefs"].push_back({{"rule", each.rule},
                               {"strategy", each.strategy},
                               {"belief", pair(each.belief.alpha, each.belief.beta)},
                               {"prior", pair(each.prior.alpha, each.prior.beta)}});
  for (const LearnedCoupling& each : learned.couplings)
    json["couplings"].push_back({{"cause", each.cause},
                                 {"effect", each.effect},
                                 {"cleared", each.coupling.cleared},
                                 {"stayed", each.coupling.stayed},
                                 {"spared", each.coupling.spared}});
  for (const LearnedLatency& each : learned.latencies)
    json["latencies"].push_back({{"rule", each.rule},
                                 {"count", each.count},
                                 {"least_s", each.least_s},
                                 {"most_s", each.most_s}});
  return json;
}

Expected<Learned> learned_from_json(const Json& json) {
  const Error damaged{"what was learned cannot be read"};
  if (!json.is_object()) return damaged;
  Learned learned;
  const Json beliefs = json.value("beliefs", Json());
  const Json couplings = json.value("couplings", Json());
  const Json latencies = json.value("latencies", Json::array());  // older culprits have none
  if (!beliefs.is_array() || !couplings.is_array() || !latencies.is_array()) return damaged;
  for (const Json& each : beliefs) {
    const auto belief = pair_from(each, "belief");
    const auto prior = pair_from(each, "prior");
    if (!belief || !prior) return damaged;
    learned.beliefs.push_back({text_of(each, "rule"),
                               text_of(each, "strategy"),
                               {belief->first, belief->second},
                               {prior->first, prior->second}});
    if (!is_belief(learned.beliefs.back().belief) || !is_belief(learned.beliefs.back().prior))
      return damaged;
  }
  for (const Json& each : couplings) {
    const Coupling coupling{number_of(each, "cleared", -1), number_of(each, "stayed", -1),
                            number_of(each, "spared", 0)};  // older culprits have none
    if (!is_count(coupling.cleared) || !is_count(coupling.stayed) || !is_count(coupling.spared))
      return damaged;
    learned.couplings.push_back({text_of(each, "cause"), text_of(each, "effect"), coupling});
  }
  for (const Json& each : latencies) {
    const std::int64_t count = integer_of(each, "count", -1);
    const double least = number_of(each, "least_s", -1);
    const double most = number_of(each, "most_s", -1);
    if (!is_latency(count, least, most)) return damaged;
    learned.latencies.push_back({text_of(each, "rule"), static_cast<int>(count), least, most});
  }
  return learned;
}

Json to_json(const Session& session) {
  Json json = {
      {"version", session.version},
      {"robot", session.robot},
      {"domain", session.domain},
      {"process", session.process},
      {"boot", session.boot},
      {"start", session.start.time_since_epoch().count()},
      {"wall", session.wall},
      {"settling", session.discovery.count()},
      {"forgetting", session.forgetting},
      {"advises", session.advises},
      {"planner", session.planner},
      {"governor", session.governor},
      {"learned", to_json(session.learned)},
      {"interrupted", session.interrupted},
      {"past", session.past},
      {"known_robot", session.known_robot},
      {"paused", session.is_paused},
      {"dry_run", session.is_dry_run},
      {"orders_kept", session.orders_kept},
      {"fleet", session.fleet_context ? Json{{"context", *session.fleet_context}} : Json()},
      {"rules_path", session.rules_path},
      {"rules_text", session.rules_text},
      {"occasion", session.occasion},
      {"text", "culprit " + session.version + " began to manage with " + session.rules_path +
                   (session.occasion.empty() ? "" : ", " + session.occasion) +
                   (session.advises ? " (only advising)" : "")}};
  if (session.watched_since)
    json["watched_since"] = session.watched_since->time_since_epoch().count();
  return json;
}

Expected<Session> session_from_json(const Json& json) {
  if (!json.is_object()) return Error{"the beginning of a run cannot be read"};
  const auto learned = learned_from_json(json.value("learned", Json()));
  if (!learned) return Error{learned.error()};
  Session session;
  session.version = text_of(json, "version");
  session.robot = text_of(json, "robot");
  session.rules_path = text_of(json, "rules_path");
  session.rules_text = text_of(json, "rules_text");
  session.occasion = text_of(json, "occasion");
  session.planner = json.value("planner", Json::object());
  session.governor = json.value("governor", Json::object());
  session.advises = flag_of(json, "advises");
  session.continued = flag_of(json, "continued");
  session.domain = static_cast<int>(integer_of(json, "domain", -1));
  session.process = static_cast<int>(integer_of(json, "process"));
  session.boot = text_of(json, "boot");
  session.start = Time(Duration(integer_of(json, "start")));
  session.wall = std::max<std::int64_t>(0, integer_of(json, "wall"));
  if (json.contains("watched_since"))
    session.watched_since = Time(Duration(integer_of(json, "watched_since")));
  session.discovery = Duration(integer_of(json, "settling"));
  session.forgetting = number_of(json, "forgetting", 1);
  session.learned = *learned;
  session.interrupted = json.value("interrupted", Json::array());
  session.past = json.value("past", Json::array());
  session.known_robot = json.value("known_robot", Json());
  session.is_paused = flag_of(json, "paused");
  session.is_dry_run = flag_of(json, "dry_run");
  session.orders_kept = flag_of(json, "orders_kept");
  const Json fleet = json.value("fleet", Json());
  if (fleet.is_object()) session.fleet_context = text_of(fleet, "context");
  if (!(session.forgetting > 0 && session.forgetting <= 1) ||
      session.discovery < Duration::zero() || session.rules_text.size() > (64u << 20))
    return Error{"the beginning of a run cannot be read"};
  return session;
}

std::string boot_id() {
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string id;
  file >> id;
  return id;
}

}  // namespace culprit::journal
