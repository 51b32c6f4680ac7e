#include "exemplar_cases/exemplar_cases.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "demo/demo_setup.h"
#include "demo/rover_demo.h"
#include "demo/sunset_demo.h"
#include "exemplars/rover/faults.h"
#include "exemplars/rover/model/rover_model.h"
#include "exemplars/sunset/model/sunset_model.h"
#include "manager/manager.h"
#include "manager/runtime.h"
#include "plan/bayes/bayes_planner.h"
#include "plan/paper_planner.h"
#include "simulation/random.h"
#include "simulation/simulated_robot.h"

namespace culprit::study {
namespace {

using namespace std::chrono_literals;
using rca::RcaCase;
using rca::Repair;

constexpr Duration kReading = 200ms;
constexpr Duration kDiscovery = 200ms;
constexpr Duration kWatched = 20s;  // after the fault
constexpr Duration kBefore = 10s;   // at least, without a failure
constexpr Duration kSpread = 5s;    // of the fault's time

// A fault of an exemplar.
struct Injected {
  std::string name;
  std::size_t component = 0;
  std::vector<Repair> repairs;  // that end it
  Time at;
};

// An exemplar in which the fault comes, and its rules.
struct Exemplar {
  const RuleSet& rules;
  std::string rules_text;
  Injected fault;
  Time begin;  // of watching
  // Calls it with the robot as it is at `begin`, a new one each time.
  std::function<void(const std::function<void(Robot&)>&)> play;
};

ComponentId component_of(const Strategy& strategy) {
  return strategy.adaptations.front().component;
}

// Nothing: the rule only reports.
std::optional<ComponentId> component_of(const Rule& rule, const RuleSet& rules) {
  if (rule.strategies.empty()) return std::nullopt;
  return component_of(rules[rule.strategies.front()]);
}

Repair repair_of(const Strategy& strategy) {
  const auto type = strategy.adaptations.front().type;
  if (type == AdaptationType::kRedeploy) return Repair::kRedeploy;
  return type == AdaptationType::kRestart ? Repair::kRestart : Repair::kConfigure;
}

double since_start_s(Time at) { return seconds(at.time_since_epoch()); }

std::unique_ptr<const Planner> planner_of(const std::string& name) {
  if (name == "paper") return std::make_unique<PaperPlanner>();
  return std::make_unique<BayesPlanner>();
}

// culprit, which only advises, and what it and others see of the robot.
class Watch {
 public:
  Watch(const Exemplar& exemplar, Robot& robot, const std::string& planner, RcaCase& made)
      : rules_(exemplar.rules),
        made_(made),
        looked_(exemplar.begin),
        manager_(rules_, planner_of(planner),
                 {.autonomy = Autonomy::kAdvise, .start = exemplar.begin, .discovery = kDiscovery}),
        runtime_(manager_, robot),
        recorded_(made.events) {
    runtime_.on_step = [this](const Runtime::Step& step) { recorded_.record(step); };
    runtime_.on_events = [this](std::span<const Event> events) {
      for (const Event& event : events) {
        if (const auto* chosen = std::get_if<StrategyChosen>(&event.what))
          propose(rules_[chosen->strategy], event.at);
      }
    };
  }

  // With a reading of each watched component now and then.
  void run_until(Time end) {
    const std::atomic<bool> never = false;
    while (later(looked_, kReading) <= end) {
      looked_ = later(looked_, kReading);
      runtime_.run(never, looked_);
      made_.times_s.push_back(since_start_s(looked_));
      made_.readings.push_back(reading());
    }
  }

  // The channels between components as they are now.
  std::vector<rca::RcaTopic> topics() const {
    const DependencyGraph& graph = manager_.knowledge().graph;
    std::map<std::string, std::pair<std::set<std::size_t>, std::set<std::size_t>>> ends;
    for (const DependencyGraph::Edge& edge : graph.edges()) {
      const auto consumer = graph.component_of(edge.consumer);
      const auto producer = graph.component_of(edge.producer);
      if (!consumer || !producer || *consumer == *producer) continue;
      const std::string name = edge.channel.empty() ? edge.consumer + " (declared)" : edge.channel;
      ends[name].first.insert(producer->index);
      ends[name].second.insert(consumer->index);
    }
    std::vector<rca::RcaTopic> topics;
    for (const auto& [name, both] : ends) {
      rca::RcaTopic& topic = topics.emplace_back();
      topic.name = name;
      topic.publishers.assign(both.first.begin(), both.first.end());
      for (const std::size_t subscriber : both.second) {
        rca::Subscription& subscription = topic.subscribers.emplace_back();
        subscription.component = subscriber;
      }
    }
    return topics;
  }

  rca::Advice advice() const {
    rca::Advice advice;
    for (const Incident& incident : manager_.incidents().open()) {
      for (const ComponentId component : incident.components) {
        if (std::ranges::find(advice.ranked, component.index) == advice.ranked.end())
          advice.ranked.push_back(component.index);
      }
    }
    advice.causes = advice.ranked;
    advice.repairs = proposals_;
    return advice;
  }

 private:
  std::vector<bool> reading() const {
    std::set<std::size_t> failing;
    for (std::size_t i = 0; i < rules_.rules.size(); ++i) {
      const auto component = component_of(rules_.rules[i], rules_);
      if (component && manager_.knowledge().states[RuleId(i)].phase != RulePhase::kQuiet)
        failing.insert(component->index);
    }
    std::vector<bool> row;
    for (const std::size_t component : made_.watched) row.push_back(failing.contains(component));
    return row;
  }

  // The first for each component counts. A last resort repairs nothing.
  void propose(const Strategy& strategy, Time at) {
    const std::size_t component = component_of(strategy).index;
    const bool is_known = std::ranges::any_of(
        proposals_, [&](const rca::Proposal& each) { return each.component == component; });
    if (!is_known && !strategy.is_last_resort)
      proposals_.push_back({component, repair_of(strategy), since_start_s(at)});
  }

  const RuleSet& rules_;
  RcaCase& made_;
  Time looked_;  // the latest reading
  Manager manager_;
  Runtime runtime_;
  rca::CaseEvents recorded_;
  std::vector<rca::Proposal> proposals_;
};

// The robot as the case has it, without its topics.
RcaCase empty_case(const Exemplar& exemplar) {
  RcaCase made;
  made.rules = exemplar.rules_text;
  std::set<std::size_t> watched;
  for (const Rule& rule : exemplar.rules.rules) {
    if (const auto component = component_of(rule, exemplar.rules)) watched.insert(component->index);
  }
  made.watched.assign(watched.begin(), watched.end());
  for (std::size_t c = 0; c < exemplar.rules.components.size(); ++c) {
    rca::RcaComponent& component = made.scenario.components.emplace_back();
    component.name = exemplar.rules.components[c].name;
    component.is_unwatched = !watched.contains(c);
  }
  return made;
}

// When each watched component first failed, by its place.
std::vector<std::optional<double>> onsets_of(const RcaCase& made) {
  std::vector<std::optional<double>> onsets(made.watched.size());
  for (std::size_t t = 0; t < made.times_s.size(); ++t) {
    for (std::size_t i = 0; i < onsets.size(); ++i) {
      if (made.readings[t][i] && !onsets[i]) onsets[i] = made.times_s[t];
    }
  }
  return onsets;
}

// Nothing: no other component shows an effect, or something failed before the fault.
std::optional<rca::CaseTruth> truth_of(const RcaCase& made, const Injected& fault) {
  rca::CaseTruth truth;
  const double at_s = since_start_s(fault.at);
  truth.causes.push_back(
      {{fault.component, rca::FaultKind::kSilent, at_s}, fault.name, fault.repairs});
  truth.end_s = made.times_s.back();
  const auto onsets = onsets_of(made);
  for (std::size_t i = 0; i < onsets.size(); ++i) {
    if (!onsets[i]) continue;
    if (*onsets[i] < at_s) return std::nullopt;
    if (made.watched[i] != fault.component)
      truth.effects.push_back({made.watched[i], {fault.component}, *onsets[i]});
  }
  const bool is_watched = std::ranges::find(made.watched, fault.component) != made.watched.end();
  if (truth.effects.empty() || !is_watched) return std::nullopt;
  return truth;
}

std::optional<RcaCase> case_of(const Exemplar& exemplar) {
  RcaCase made = empty_case(exemplar);
  const Time at = exemplar.fault.at;
  for (const std::string planner : {"bayes", "paper"}) {
    RcaCase seen = empty_case(exemplar);
    exemplar.play([&](Robot& robot) {
      Watch watch(exemplar, robot, planner, seen);
      watch.run_until(at);
      seen.scenario.topics = watch.topics();
      watch.run_until(later(at, kWatched));
      made.advice[planner] = watch.advice();
    });
    if (!made.times_s.empty()) continue;  // others see what there was with the first
    seen.advice = std::move(made.advice);
    made = std::move(seen);
  }
  auto truth = truth_of(made, exemplar.fault);
  if (!truth) return std::nullopt;
  made.truth = std::move(*truth);
  return made;
}

// Those that count, of `count` faults.
std::vector<RcaCase> cases_of(std::size_t count, std::uint64_t seed, std::size_t of_each,
                              Faults faults,
                              const std::function<Exemplar(std::size_t, std::uint64_t)>& exemplar) {
  std::vector<RcaCase> cases;
  simulation::Random random(simulation::mix(seed));
  for (std::size_t i = 0; i < count * of_each; ++i) {
    const std::size_t fault =
        faults == Faults::kDrawn ? static_cast<std::size_t>(random.next() % count) : i % count;
    if (auto made = case_of(exemplar(fault, simulation::mix(simulation::mix(seed) + i))))
      cases.push_back(std::move(*made));
  }
  return cases;
}

// ---- SUNSET

const sunset::model::Profile& sunset_profile() {
  static const sunset::model::Profile kProfile = [] {
    sunset::model::Profile profile = **sunset::model::find_profile("live");
    profile.injection = {profile.manager_start + kBefore, kSpread};
    return profile;
  }();
  return kProfile;
}

std::size_t component_of(sunset::Member member, const RuleSet& rules) {
  const std::string node = sunset::node_of(member).full();
  const auto found = std::ranges::find(rules.components, node, &Component::node);
  return static_cast<std::size_t>(found - rules.components.begin());
}

Exemplar sunset_exemplar(const sunset::Fault& fault, std::uint64_t seed) {
  static const RuleSet kRules = lab::embedded_rules("sunset.rules", lab::SunsetDemo::rule_text());
  const sunset::model::Profile& profile = sunset_profile();
  const sunset::Scenario scenario{1, {&fault, &fault, &fault}};
  Injected injected{std::string(fault.name), component_of(fault.member, kRules), {}, {}};
  injected.at = sunset::model::SunsetModel(profile, seed).inject(scenario).front().at;
  for (const Strategy& strategy : kRules.strategies) {
    const bool helps =
        std::ranges::find(fault.resolved_by, strategy.name) != fault.resolved_by.end();
    if (helps && component_of(strategy).index == injected.component)
      injected.repairs.push_back(repair_of(strategy));
  }
  const Time begin{profile.manager_start};
  return {kRules, lab::SunsetDemo::rule_text(), std::move(injected), begin,
          [&profile, scenario, seed, begin](const std::function<void(Robot&)>& with) {
            sunset::model::SunsetModel model(profile, seed);
            (void)model.inject(scenario);
            model.world().run(begin);
            simulation::SimulatedRobot robot(kRules, model.world());
            with(robot);
          }};
}

// ---- the rover

// As the fault's remedies say, which are for people.
std::vector<Repair> repairs_of(const rover::Fault& fault) {
  const auto says = [&](const char* word) {
    return fault.remedies.find(word) != std::string::npos;
  };
  std::vector<Repair> repairs;
  if (says("activate") || says("set_parameter") || says("call"))
    repairs.push_back(Repair::kConfigure);
  if (says("restart")) repairs.push_back(Repair::kRestart);
  if (says("redeploy")) repairs.push_back(Repair::kRedeploy);
  return repairs;
}

Exemplar rover_exemplar(const rover::Fault& fault, std::uint64_t seed) {
  static const RuleSet kRules = lab::embedded_rules("rover.rules", lab::RoverDemo::rule_text());
  simulation::Random random(seed);
  const auto cause = std::ranges::find(kRules.components, fault.cause, &Component::name);
  Injected injected{fault.name, static_cast<std::size_t>(cause - kRules.components.begin()),
                    repairs_of(fault), Time(kBefore + from_seconds(random.uniform(0, 5)))};
  return {kRules, lab::RoverDemo::rule_text(), injected, Time{},
          [&fault, seed, at = injected.at](const std::function<void(Robot&)>& with) {
            rover::model::RoverModel model(kRules, {.seed = seed});
            model.at(at, [&] { model.inject(fault); });
            with(model);
          }};
}

}  // namespace

std::vector<RcaCase> sunset_cases(std::uint64_t seed, std::size_t of_each, Faults faults) {
  return cases_of(sunset::faults().size(), seed, of_each, faults,
                  [](std::size_t i, std::uint64_t own_seed) {
                    return sunset_exemplar(sunset::faults()[i], own_seed);
                  });
}

std::vector<RcaCase> rover_cases(std::uint64_t seed, std::size_t of_each, Faults faults) {
  std::vector<const rover::Fault*> all;  // without a stranger's, for which no component is to blame
  for (const rover::Fault& fault : rover::faults()) {
    if (!fault.cause.empty()) all.push_back(&fault);
  }
  return cases_of(all.size(), seed, of_each, faults, [&](std::size_t i, std::uint64_t own_seed) {
    return rover_exemplar(*all[i], own_seed);
  });
}

}  // namespace culprit::study
