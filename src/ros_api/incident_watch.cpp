#include "ros_api/incident_watch.h"

#include <algorithm>

#include "knowledge/describe.h"

namespace culprit::ros_api {
namespace {

constexpr std::string_view kIncident = "culprit_msgs/msg/Incident";
constexpr std::string_view kComponent = "culprit_msgs/msg/Component";

bool is_one_of(const std::set<std::string>& some, const std::set<std::string>& others) {
  return std::ranges::any_of(some, [&](const std::string& each) { return others.contains(each); });
}

Json names_of(const auto& ids, const RuleSet& rules) {
  Json names = Json::array();
  for (const auto id : ids) names.push_back(rules[id].name);
  return names;
}

// "CameraSilent@1795538700.250": people need not read it, and it is unique.
std::string id_of(const std::string& rule, WallTime since) {
  const auto ms =
      std::chrono::duration_cast<std::chrono::milliseconds>(since.time_since_epoch()).count();
  std::string fraction = std::to_string(1000 + ms % 1000);
  return rule + "@" + std::to_string(ms / 1000) + "." + fraction.substr(1);
}

// A field that changes with the time alone is no news.
Json without_time(Json message) {
  message.erase("stamp");
  message.erase("next");
  return message;
}

}  // namespace

Json stamp_of(WallTime at) {
  const std::int64_t ns =
      std::chrono::duration_cast<std::chrono::nanoseconds>(at.time_since_epoch()).count();
  return {{"sec", ns / 1'000'000'000}, {"nanosec", ns % 1'000'000'000}};
}

void IncidentWatch::note(std::span<const Event> events, const RuleSet& rules) {
  for (const Event& event : events) {
    if (const auto* resolved = std::get_if<FailureResolved>(&event.what)) {
      is_resolved_[rules[resolved->rule].name] = true;
    } else if (const auto* lost = std::get_if<FailureLost>(&event.what)) {
      is_resolved_[rules[lost->rule].name] = false;
    } else if (const auto* detected = std::get_if<FailureDetected>(&event.what)) {
      is_resolved_.erase(rules[detected->rule].name);
    }
  }
}

// Finds the followed incident with the same root cause. Otherwise one that shares a failure, and
// whose root cause no present incident has; otherwise a new one. `taken`: the ids that other
// incidents have.
IncidentWatch::Followed& IncidentWatch::followed(const live::Incident& incident,
                                                 const std::set<std::string>& rules,
                                                 const std::set<std::string>& roots,
                                                 const std::string& root,
                                                 std::set<std::string>& taken, Time now,
                                                 WallTime wall) {
  const auto find = [&](auto is_it) {
    return std::ranges::find_if(
        all_, [&](const Followed& each) { return !taken.contains(each.id) && is_it(each); });
  };
  auto found = find([&](const Followed& each) { return each.message["rule"] == root; });
  if (found == all_.end())
    found = find([&](const Followed& each) {
      return is_one_of(each.rules, rules) &&
             !roots.contains(each.message["rule"].get<std::string>());
    });
  if (found == all_.end()) {
    // A strategy that a person ordered has no failure, and so none that began.
    const Duration lasts = incident.since > now ? Duration() : now - incident.since;
    const WallTime since = wall - std::chrono::duration_cast<WallTime::duration>(lasts);
    all_.push_back({id_of(root, since), since, {}, Json::object(), nullptr});
    found = all_.end() - 1;
  }
  taken.insert(found->id);
  return *found;
}

Json IncidentWatch::ended(const Followed& each, WallTime wall) const {
  std::set<std::string> still;
  for (const Followed& other : all_) {
    if (other.id != each.id) still.insert(other.rules.begin(), other.rules.end());
  }
  const auto word = is_resolved_.find(each.message["rule"].get<std::string>());
  const bool is_resolved = word != is_resolved_.end() && word->second;
  const char* state = is_one_of(each.rules, still) ? "STATE_MERGED"
                      : is_resolved                ? "STATE_RESOLVED"
                                                   : "STATE_LOST";
  Json message = each.message;
  message["stamp"] = stamp_of(wall);
  message["state"] = types_.constant(kIncident, state);
  message["needs_person"] = false;
  message["next"] = "";
  return message;
}

std::vector<Json> IncidentWatch::look(const std::vector<live::Incident>& all, const RuleSet& rules,
                                      Time now, WallTime wall) {
  std::vector<Json> news;
  std::vector<std::string> order;  // of the ids
  std::set<std::string> taken, roots;
  for (const live::Incident& incident : all) roots.insert(rules[incident.root].name);
  due_ = kNever;
  for (const live::Incident& incident : all) {
    const std::string& root = rules[incident.root].name;
    std::set<std::string> failing{root};
    for (const RuleId rule : incident.consequences) failing.insert(rules[rule].name);
    Followed& each = followed(incident, failing, roots, root, taken, now, wall);
    order.push_back(each.id);
    each.rules = failing;
    const std::string health =
        incident.is_exhausted ? "EXHAUSTED" : std::string(to_string(incident.criticality));
    each.message = {{"stamp", stamp_of(wall)},
                    {"id", each.id},
                    {"state", types_.constant(kIncident, "STATE_OPEN")},
                    {"since", stamp_of(each.since)},
                    {"headline", incident.headline},
                    {"health", types_.constant(kComponent, "HEALTH_" + health)},
                    {"rule", root},
                    {"consequences", names_of(incident.consequences, rules)},
                    {"components", names_of(incident.components, rules)},
                    {"is_certain", incident.is_certain},
                    {"needs_person", incident.needs_person()},
                    {"doing", incident.doing},
                    {"next", incident.next}};
    Json as_told = without_time(each.message);
    if (as_told == each.told) continue;
    if (!each.told.is_null() && now < later(each.told_at, kPeriod)) {
      due_ = std::min(due_, later(each.told_at, kPeriod));
      continue;
    }
    each.told = std::move(as_told);
    each.told_at = now;
    news.push_back(each.message);
  }
  std::vector<Followed> over;
  std::erase_if(all_, [&](Followed& each) {
    if (taken.contains(each.id)) return false;
    over.push_back(std::move(each));
    return true;
  });
  for (const Followed& each : over) news.push_back(ended(each, wall));
  std::ranges::sort(all_, {}, [&](const Followed& each) {
    return std::ranges::find(order, each.id) - order.begin();
  });
  return news;
}

std::vector<Json> IncidentWatch::open() const {
  std::vector<Json> messages;
  for (const Followed& each : all_) messages.push_back(each.message);
  return messages;
}

}  // namespace culprit::ros_api
