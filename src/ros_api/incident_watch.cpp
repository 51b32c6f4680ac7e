#include "ros_api/incident_watch.h"

#include <algorithm>

#include "knowledge/describe.h"
#include "web/event_json.h"

namespace culprit::ros_api {
namespace {

constexpr std::string_view kIncident = "culprit_msgs/msg/Incident";
constexpr std::string_view kComponent = "culprit_msgs/msg/Component";

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

std::vector<Json> IncidentWatch::note(std::span<const Event> events, WallTime wall) {
  std::vector<Json> news;
  for (const Event& event : events) {
    const auto* closed = std::get_if<IncidentClosed>(&event.what);
    if (closed == nullptr) continue;
    const auto each = std::ranges::find(all_, closed->id, &Followed::id);
    if (each == all_.end()) continue;
    news.push_back(ended(*each, closed->how, wall));
    all_.erase(each);
  }
  return news;
}

Json IncidentWatch::ended(const Followed& each, IncidentEnd how, WallTime wall) const {
  const char* state = how == IncidentEnd::kMerged     ? "STATE_MERGED"
                      : how == IncidentEnd::kResolved ? "STATE_RESOLVED"
                                                      : "STATE_LOST";
  Json message = each.message;
  message["stamp"] = stamp_of(wall);
  message["state"] = types_.constant(kIncident, state);
  message["needs_person"] = false;
  message["next"] = "";
  return message;
}

Json IncidentWatch::message_of(const Incident& incident, const Manager& manager, WallTime since,
                               WallTime wall) const {
  const RuleSet& rules = manager.knowledge().rules;
  const Incidents::Course course = manager.course_of(incident);
  const std::string health =
      incident.is_exhausted ? "EXHAUSTED" : std::string(to_string(incident.criticality));
  return {{"stamp", stamp_of(wall)},
          {"id", incident.id},
          {"state", types_.constant(kIncident, "STATE_OPEN")},
          {"since", stamp_of(since)},
          {"headline", incident.headline},
          {"health", types_.constant(kComponent, "HEALTH_" + health)},
          {"rule", rules[incident.root].name},
          {"consequences", web::names_of(incident.consequences, rules)},
          {"components", web::names_of(incident.components, rules)},
          {"is_certain", incident.is_certain},
          {"needs_person", incident.needs_person()},
          {"doing", course.doing},
          {"next", course.next}};
}

std::vector<Json> IncidentWatch::look(const Manager& manager, Time now, WallTime wall) {
  std::vector<Json> news;
  std::vector<Followed> before = std::exchange(all_, {});
  due_ = kNever;
  for (const Incident& incident : manager.incidents().open()) {
    const auto known = std::ranges::find(before, incident.id, &Followed::id);
    if (known == before.end()) {
      const WallTime since =
          wall - std::chrono::duration_cast<WallTime::duration>(now - incident.since);
      all_.push_back({incident.id, since, nullptr, nullptr});
    } else {
      all_.push_back(std::move(*known));
      before.erase(known);
    }
    Followed& each = all_.back();
    each.message = message_of(incident, manager, each.since, wall);
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
  for (const Followed& each : before) news.push_back(ended(each, IncidentEnd::kLost, wall));
  return news;
}

std::vector<Json> IncidentWatch::open() const {
  std::vector<Json> messages;
  for (const Followed& each : all_) messages.push_back(each.message);
  return messages;
}

}  // namespace culprit::ros_api
