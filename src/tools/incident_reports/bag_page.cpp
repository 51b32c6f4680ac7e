#include "incident_reports/bag_page.h"

#include <algorithm>
#include <map>

#include <fmt/core.h>

#include "bag/bag_file.h"
#include "bag/bag_reading.h"
#include "incident_reports/incident_json.h"
#include "incident_reports/incident_page.h"
#include "incident_reports/journal_incidents.h"
#include "journal/event_json.h"
#include "replay/bag_replay.h"

namespace culprit::incident_reports {
namespace {

constexpr double kSecondOfNanoseconds = 1e-9;

void add_new(std::vector<std::string>& names, const std::string& name) {
  if (std::ranges::find(names, name) == names.end()) names.push_back(name);
}

// The incidents of a recording, the rules that fired in it, and its events.
class BagCourseOfEvents {
 public:
  explicit BagCourseOfEvents(const RuleSet& rules) : rules_(rules) {}

  void add(const Event& event, double clock) {
    if (const auto* detected = std::get_if<FailureDetected>(&event.what)) {
      const Rule& rule = rules_[detected->rule];
      incident_.worst = std::max(incident_.worst, rule.policies.criticality);
      add_new(incident_.rules, rule.name);
    }
    if (const auto* opened = std::get_if<IncidentOpened>(&event.what)) {
      open_.emplace(opened->incident.id, whole_.incidents.size());
      whole_.incidents.push_back({.began = clock, .seconds = -1});
      describe(opened->incident);
    }
    if (const auto* changed = std::get_if<IncidentChanged>(&event.what))
      describe(changed->incident);
    if (const auto* closed = std::get_if<IncidentClosed>(&event.what)) {
      if (const auto found = open_.find(closed->id); found != open_.end()) {
        WholeRecording::Line& line = whole_.incidents[found->second];
        line.seconds = clock - line.began;
        line.end = closed->how == IncidentEnd::kMerged ? "part of another incident"
                                                       : std::string(to_string(closed->how));
        open_.erase(found);
      }
    }
    Json json = journal::to_json(event, rules_);
    if (events_.size() < kMostTold && !journal::text_of(json, "text").empty())
      events_.push_back(to_json(ToldEvent{0, clock, std::move(json), {}}));
  }

  PageContent content(double begin, double end) {
    incident_.began = begin;
    incident_.seconds = end - begin;
    incident_.is_over = true;
    for (WholeRecording::Line& each : whole_.incidents) {
      if (each.seconds >= 0) continue;
      each.seconds = end - each.began;
      each.end = "still there at the end";
    }
    whole_.rules =
        fmt::format("{}, of which {} fired", rules_.rules.size(), incident_.rules.size());
    PageContent content;
    content.incident = std::move(incident_);
    content.whole = std::move(whole_);
    content.events = std::move(events_);
    return content;
  }

 private:
  void describe(const culprit::Incident& incident) {
    const auto found = open_.find(incident.id);
    if (found == open_.end()) return;
    WholeRecording::Line& line = whole_.incidents[found->second];
    line.headline = incident.headline;
    line.effects.clear();
    for (const RuleId each : incident.consequences)
      line.effects += (line.effects.empty() ? "" : ", ") + rules_[each].name;
    for (const ComponentId each : incident.components) add_new(incident_.causes, rules_[each].name);
  }

  const RuleSet& rules_;
  Incident incident_;
  WholeRecording whole_;
  std::map<std::string, std::size_t> open_;  // by id, its place in whole_.incidents
  std::vector<Json> events_;
};

}  // namespace

Expected<std::string> bag_page(const RuleSet& rules, std::unique_ptr<const Planner> planner,
                               const BagPageWish& wish) {
  auto bag = bag::BagFile::open(wish.bag);
  if (!bag) return Error{bag.error()};
  ros2::MessageLibrary library(wish.message_path);
  bag::BagReading reading(rules, bag->contents(), library);
  BagCourseOfEvents course(rules);
  replay::BagReplay replay(rules, std::move(planner), reading,
                           {.on_event = [&](const Event& event, std::int64_t clock) {
                             course.add(event, kSecondOfNanoseconds * static_cast<double>(clock));
                           }});
  for (bag::BagMessage message; bag->next(message);) replay.step(message);
  if (!replay.start()) return Error{"the bag '" + wish.bag.string() + "' has no message"};
  const double begin = kSecondOfNanoseconds * static_cast<double>(replay.start_clock());
  PageContent content = course.content(begin, begin + seconds(replay.end() - *replay.start()));
  content.robot = rules.robot;
  const auto name = wish.bag.filename();  // none: "my_bag/"
  content.recordings = {(name.empty() ? wish.bag.parent_path().filename() : name).string()};
  content.written_at = wish.written_at;
  for (const replay::RuleOutcome& each : replay.outcomes()) {
    if (each.was_known) continue;
    std::string why;
    for (const std::string& reason : each.why_unknown) why += (why.empty() ? ": " : "; ") + reason;
    content.remarks.push_back(rules[each.rule].name + " could not be judged" + why + ".");
  }
  std::vector<std::string> drawn = content.incident.rules;
  if (drawn.empty()) {
    for (const Rule& each : rules.rules) drawn.push_back(each.name);
  }
  auto curves = recorded_curves(wish.bag, {rules, std::move(drawn), content.incident.causes});
  if (curves) {
    content.curves = std::move(*curves);
  } else {
    content.remarks.push_back("There are no plots here: " + curves.error() + ".");
  }
  return incident_page(content);
}

}  // namespace culprit::incident_reports
