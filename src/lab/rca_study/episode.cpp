#include "rca_study/episode.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <set>

#include <fmt/core.h>

#include "knowledge/describe.h"
#include "manager/manager.h"
#include "manager/runtime.h"
#include "rca_study/rca_robot.h"
#include "rca_study/rules.h"

namespace culprit::study::rca {
namespace {

// Passes everything on, and takes the time.
class TimedPlanner : public Planner {
 public:
  TimedPlanner(std::unique_ptr<const Planner> planner, EpisodeResult& result)
      : planner_(std::move(planner)), result_(result) {}

  std::vector<Decision> plan(std::span<const RuleId> failures,
                             const Knowledge& knowledge) const override {
    if (failures.empty()) return planner_->plan(failures, knowledge);
    const auto begin = std::chrono::steady_clock::now();
    auto decisions = planner_->plan(failures, knowledge);
    const auto took = std::chrono::steady_clock::now() - begin;
    ++result_.plans;
    result_.planning_us += std::chrono::duration<double, std::micro>(took).count();
    return decisions;
  }

 private:
  std::unique_ptr<const Planner> planner_;
  EpisodeResult& result_;
};

// Judges the manager's actions by the truth at the time.
class Judge {
 public:
  Judge(const RcaScenario& scenario, const RuleSet& rules, const Plant& plant,
        EpisodeResult& result)
      : rules_(rules), plant_(plant), result_(result) {
    for (const InjectedFault& fault : scenario.faults) {
      const ComponentId component(fault.component);
      faulty_.insert(component);
      if (!scenario.components[fault.component].is_unwatched) repairable_.insert(component);
    }
    result.faults = static_cast<std::int32_t>(faulty_.size());
  }

  void see(std::span<const Event> events) {
    for (const Event& event : events) {
      if (const auto* chosen = std::get_if<StrategyChosen>(&event.what)) see(*chosen);
      if (const auto* held = std::get_if<FailureHeldBack>(&event.what)) see(*held);
    }
  }

  void conclude() {
    result_.is_exact = adapted_ == repairable_;
    result_.effects = static_cast<std::int32_t>(grounded_.size());
    for (const auto& [rule, is_grounded] : grounded_) result_.grounded += is_grounded ? 1 : 0;
  }

 private:
  void see(const StrategyChosen& chosen) {
    for (const ComponentId component : rules_[chosen.strategy].components) {
      const bool has_fault = plant_.fault(component.index).has_value();
      if (result_.strategies++ == 0) result_.is_first_right = has_fault;
      if (!faulty_.contains(component)) {
        ++result_.wrong_component;
      } else if (!has_fault) {
        ++result_.unnecessary;
      }
      adapted_.insert(component);
    }
  }

  void see(const FailureHeldBack& held) {
    const std::size_t effect = rules_[held.rule].components.front().index;
    if (plant_.fault(effect) || plant_.is_hit(effect) || !plant_.is_ill(effect)) return;
    for (const Candidate& candidate : held.candidates) {
      if (candidate.excluded != Condition::kDependency || !candidate.failure) continue;
      const std::size_t cause = rules_[*candidate.failure].components.front().index;
      // A repaired component may still be reported as failing.
      if (!plant_.is_ill(cause)) break;
      grounded_[held.rule] = plant_.passes(cause, effect);
      return;
    }
    grounded_.emplace(held.rule, false);
  }

  const RuleSet& rules_;
  const Plant& plant_;
  EpisodeResult& result_;
  std::set<ComponentId> faulty_;
  std::set<ComponentId> repairable_;  // of these: those with a rule
  std::set<ComponentId> adapted_;
  std::map<RuleId, bool> grounded_;  // by failure that is only an effect: what it waited for last
};

// For how long the outputs were ill, and when all was well.
class Clock {
 public:
  Clock(const RcaScenario& scenario, const Plant& plant)
      : plant_(plant), is_output_(scenario.components.size(), true), since_(is_output_.size()) {
    for (const RcaTopic& topic : scenario.topics) {
      const bool has_readers = std::any_of(topic.subscribers.begin(), topic.subscribers.end(),
                                           [](const Subscription& s) { return s.passes > 0; });
      for (const std::size_t p : topic.publishers) is_output_[p] = is_output_[p] && !has_readers;
    }
    outputs_ = std::count(is_output_.begin(), is_output_.end(), true);
  }

  void change(std::size_t component) {
    last_change_ = plant_.now();
    if (!is_output_[component]) return;
    if (plant_.is_ill(component)) {
      down_ += plant_.now() - since_[component];
    } else {
      since_[component] = plant_.now();
    }
  }

  double downtime_s(Time end) {
    for (std::size_t c = 0; c < is_output_.size(); ++c) {
      if (is_output_[c] && plant_.is_ill(c)) down_ += end - since_[c];
    }
    return outputs_ == 0 ? 0 : seconds(down_) / static_cast<double>(outputs_);
  }
  Time last_change() const { return last_change_; }

 private:
  const Plant& plant_;
  std::vector<bool> is_output_;
  std::vector<Time> since_;
  std::int64_t outputs_ = 0;
  Duration down_{};
  Time last_change_{};
};

// `telling` may be null.
EpisodeResult play(const RcaScenario& scenario, const RuleSet& rules,
                   std::unique_ptr<const Planner> planner, Experience& experience,
                   SingleRun* telling) {
  EpisodeResult result;
  RcaRobot robot(scenario, rules);
  Clock clock(scenario, robot.plant());
  robot.plant().on_change = [&](std::size_t component) { clock.change(component); };
  Judge judge(scenario, rules, robot.plant(), result);
  Manager::Options options;
  options.discovery = Duration::zero();
  Manager manager(rules, std::make_unique<TimedPlanner>(std::move(planner), result), options);
  for (std::size_t r = 0; r < experience.size(); ++r) {
    manager.set_latency(RuleId(r), experience[r].latencies);
    manager.add_transients(RuleId(r), experience[r].transients);
  }
  Runtime runtime(manager, robot);
  runtime.on_events = [&](std::span<const Event> events) {
    judge.see(events);
    if (telling != nullptr)
      telling->events.insert(telling->events.end(), events.begin(), events.end());
  };
  runtime.run(robot.is_over(), Time(from_seconds(scenario.horizon_s)));

  experience.clear();
  const Knowledge& knowledge = manager.knowledge();
  for (std::size_t r = 0; r < rules.rules.size(); ++r)
    experience.push_back(
        {knowledge.latencies.learned(RuleId(r)), knowledge.transients.seen(RuleId(r))});
  judge.conclude();
  result.is_recovered = robot.plant().is_well();
  for (std::size_t c = 0; c < scenario.components.size(); ++c)
    result.unresolved += robot.plant().fault(c) ? 1 : 0;
  double first_s = scenario.horizon_s;
  for (const InjectedFault& fault : scenario.faults) first_s = std::min(first_s, fault.at_s);
  for (const CommonCause& cause : scenario.common_causes) first_s = std::min(first_s, cause.at_s);
  const Time end = result.is_recovered ? clock.last_change() : robot.now();
  result.recovery_s = std::max(0.0, seconds(end.time_since_epoch()) - first_s);
  result.downtime_s = clock.downtime_s(robot.now());
  if (telling != nullptr) telling->end_s = seconds(robot.now().time_since_epoch());
  return result;
}

}  // namespace

EpisodeResult play(const RcaScenario& scenario, std::unique_ptr<const Planner> planner) {
  Experience none;
  return play(scenario, rules_of(scenario), std::move(planner), none);
}

EpisodeResult play(const RcaScenario& scenario, const RuleSet& rules,
                   std::unique_ptr<const Planner> planner, Experience& experience) {
  return play(scenario, rules, std::move(planner), experience, nullptr);
}

SingleRun single_run(const RcaScenario& scenario, std::unique_ptr<const Planner> planner,
                     Experience experience) {
  SingleRun run;
  run.rules = rules_of(scenario);
  for (const InjectedFault& fault : scenario.faults) {
    const std::string& component = scenario.components[fault.component].name;
    run.incidents.push_back({fault.at_s, Happening::kFault, component,
                             fmt::format("fault: {} {}", component, to_string(fault.kind))});
  }
  for (const CommonCause& cause : scenario.common_causes) {
    for (const std::size_t hit : {cause.first, cause.second}) {
      const std::string& component = scenario.components[hit].name;
      run.incidents.push_back(
          {cause.at_s, Happening::kFault, component,
           fmt::format("common cause: {} for {:.1f} s", component, cause.lasts_s)});
    }
  }
  std::stable_sort(
      run.incidents.begin(), run.incidents.end(),
      [](const TimelineEntry& a, const TimelineEntry& b) { return a.time_s < b.time_s; });
  play(scenario, run.rules, std::move(planner), experience, &run);
  return run;
}

std::string tell(const SingleRun& run) {
  std::string text;
  for (const TimelineEntry& fault : run.incidents)
    text += fmt::format("{:9.3f}  {}\n", fault.time_s, fault.text);
  for (const Event& event : run.events) {
    const std::string what = describe(event, run.rules);
    if (!what.empty())
      text += fmt::format("{:9.3f}  {}\n", seconds(event.at.time_since_epoch()), what);
  }
  return text;
}

}  // namespace culprit::study::rca
