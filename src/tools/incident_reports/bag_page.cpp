#include "incident_reports/bag_page.h"

#include <algorithm>

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

// The whole recording as one incident: what failed in it, and which components the rules would have repaired.
class BagCourseOfEvents {
 public:
  explicit BagCourseOfEvents(const RuleSet& rules) : rules_(rules) {}

  void add(const Event& event, double clock) {
    if (const auto* detected = std::get_if<FailureDetected>(&event.what)) {
      const Rule& rule = rules_[detected->rule];
      if (incident_.rules.empty()) incident_.began = clock;
      incident_.worst = std::max(incident_.worst, rule.policies.criticality);
      add_new(incident_.rules, rule.name);
    }
    const auto* chosen = std::get_if<StrategyChosen>(&event.what);
    const auto* held = std::get_if<ActionHeldBack>(&event.what);
    if (chosen != nullptr || held != nullptr) {
      for (const ComponentId each :
           rules_[chosen != nullptr ? chosen->strategy : held->strategy].components)
        add_new(incident_.causes, rules_[each].name);
    }
    Json json = journal::to_json(event, rules_);
    if (events_.size() < kMostTold && !journal::text_of(json, "text").empty())
      events_.push_back(to_json(ToldEvent{0, clock, std::move(json), {}}));
  }

  PageContent content(double begin, double end) {
    if (incident_.rules.empty()) incident_.began = begin;
    incident_.seconds = end - incident_.began;
    incident_.is_over = true;
    for (const Rule& rule : rules_.rules) {
      const bool is_about_cause = std::ranges::any_of(rule.components, [&](ComponentId id) {
        return std::ranges::find(incident_.causes, rules_[id].name) != incident_.causes.end();
      });
      if (!is_about_cause && std::ranges::find(incident_.rules, rule.name) != incident_.rules.end())
        incident_.consequences.push_back(rule.name);
    }
    if (incident_.causes.empty()) incident_.consequences.clear();
    PageContent content;
    content.incident = std::move(incident_);
    content.events = std::move(events_);
    return content;
  }

 private:
  const RuleSet& rules_;
  Incident incident_;
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
  content.robot = rules.robot.empty() ? wish.bag.string() : rules.robot;
  content.recordings = {wish.bag.filename().string()};
  content.written_at = wish.written_at;
  for (const replay::RuleOutcome& each : replay.outcomes()) {
    if (each.was_known) continue;
    std::string why;
    for (const std::string& reason : each.why_unknown) why += (why.empty() ? ": " : "; ") + reason;
    content.remarks.push_back(rules[each.rule].name + " could not be judged" + why + ".");
  }
  auto curves = recorded_curves(wish.bag, {rules, content.incident.rules, content.incident.causes});
  if (curves) {
    content.curves = std::move(*curves);
  } else {
    content.remarks.push_back("There are no plots here: " + curves.error() + ".");
  }
  return incident_page(content);
}

}  // namespace culprit::incident_reports
