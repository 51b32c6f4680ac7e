#include "rca_study/cases.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "manager/manager.h"
#include "plan/ties.h"
#include "rca_study/campaign.h"
#include "rca_study/plant.h"
#include "rca_study/rca_robot.h"
#include "rca_study/rules.h"

namespace culprit::study::rca {
namespace {

using namespace std::chrono_literals;

constexpr double kAfterLastFailure_s = 5;
constexpr double kSoonestFault_s = 5;  // later than the generator has it
constexpr double kLatestFault_s = 15;
constexpr double kWorks = 0.5;          // probability from which on a repair counts as working
constexpr Duration kStillAdvised = 2s;  // longer than a flapping component is well

// ---- the scenario of a case

// With its components and topics in another order, and named by it.
RcaScenario shuffled(RcaScenario scenario, simulation::Random& random) {
  const std::size_t size = scenario.components.size();
  std::vector<std::size_t> old(size);  // by new place
  std::iota(old.begin(), old.end(), std::size_t{0});
  for (std::size_t i = size; i > 1; --i)
    std::swap(old[i - 1], old[static_cast<std::size_t>(random.next() % i)]);
  std::vector<std::size_t> place(size);  // the other way round
  for (std::size_t i = 0; i < size; ++i) place[old[i]] = i;

  RcaScenario other = scenario;
  for (std::size_t i = 0; i < size; ++i) {
    other.components[i] = std::move(scenario.components[old[i]]);
    other.components[i].name = "c" + std::to_string(i);
    // The generator's first topics are those of its components.
    other.topics[i] = std::move(scenario.topics[old[i]]);
    other.topics[i].name = "/" + other.components[i].name + "/out";
  }
  for (RcaTopic& topic : other.topics) {
    for (std::size_t& publisher : topic.publishers) publisher = place[publisher];
    for (Subscription& s : topic.subscribers) s.component = place[s.component];
    std::sort(topic.publishers.begin(), topic.publishers.end());
    std::sort(
        topic.subscribers.begin(), topic.subscribers.end(),
        [](const Subscription& a, const Subscription& b) { return a.component < b.component; });
  }
  for (InjectedFault& fault : other.faults) fault.component = place[fault.component];
  for (CommonCause& cause : other.common_causes) {
    cause.first = place[cause.first];
    cause.second = place[cause.second];
  }
  return other;
}

RcaScenario as_case(RcaScenario scenario) {
  simulation::Random random(simulation::mix(scenario.seed + 4));
  scenario = shuffled(std::move(scenario), random);
  const double later_s = random.uniform(kSoonestFault_s, kLatestFault_s);
  for (InjectedFault& fault : scenario.faults) fault.at_s += later_s;
  for (CommonCause& cause : scenario.common_causes) cause.at_s += later_s;
  scenario.horizon_s += later_s;
  return scenario;
}

// ---- its truth

// By component: when it first becomes ill.
using Onsets = std::vector<std::optional<double>>;

Onsets onsets_of(const RcaScenario& scenario) {
  Plant plant(scenario);
  Onsets onsets(scenario.components.size());
  plant.on_change = [&](std::size_t c) {
    if (!onsets[c]) onsets[c] = seconds(plant.now().time_since_epoch());
  };
  while (plant.step(Time(from_seconds(scenario.horizon_s)))) continue;
  return onsets;
}

std::vector<Repair> working_repairs(const RcaScenario& scenario, const InjectedFault& fault) {
  std::vector<Repair> all;
  if (fault.is_unfixable) return all;
  for (const Treatment& t : scenario.components[fault.component].treatments) {
    if (t.helps[static_cast<std::size_t>(fault.kind)] >= kWorks) all.push_back(t.repair);
  }
  return all;
}

// ---- what others see of it

// Asks a planner about what the manager knows.
class Adviser {
 public:
  explicit Adviser(std::unique_ptr<const Planner> planner) : planner_(std::move(planner)) {}

  const Planner& planner() const { return *planner_; }

  void look(const Manager& manager, Time now) {
    now_ = now;
    const auto failures = manager.plannable();
    if (failures.empty()) return;
    const RuleSet& rules = manager.knowledge().rules;
    for (Decision& decision : planner_->plan(failures, manager.knowledge())) {
      const ComponentId own = rules[decision.rule].components.front();
      if (decision.chosen) propose(rules[*decision.chosen]);
      latest_.insert_or_assign(own.index, Latest{now, number_++, std::move(decision)});
    }
  }

  Advice advice(const RuleSet& rules) {
    std::vector<Weight> weights;
    const auto weight = [&](std::size_t component) -> Weight& {
      for (Weight& its : weights) {
        if (its.component == component) return its;
      }
      return weights.emplace_back(Weight{component});
    };
    bool is_probability = false;
    for (const auto& [own, latest] : latest_) {
      if (later(latest.at, kStillAdvised) < now_) continue;
      const Decision& decision = latest.decision;
      is_probability |= !decision.suspects.empty();
      // Negative numbers of decisions, so that the first weighs most.
      if (decision.suspects.empty() && decision.chosen)
        weight(own).own = -static_cast<double>(latest.number);
      for (const Suspect& suspect : decision.suspects) {
        Weight& its = weight(suspect.component.index);
        const bool is_own = its.component == own && suspect.failure == decision.rule;
        if (!is_own) its.of_others += suspect.probability;
        // A failure of its own says more about a component than those downstream.
        if (is_own || !latest_.contains(its.component))
          its.own = std::max(its.own, suspect.probability);
      }
    }
    std::stable_sort(weights.begin(), weights.end(), [](const Weight& a, const Weight& b) {
      return std::pair(plan::parts(a.own), plan::parts(a.of_others)) >
             std::pair(plan::parts(b.own), plan::parts(b.of_others));
    });
    Advice advice;
    for (const Weight& its : weights) {
      advice.ranked.push_back(its.component);
      if (!is_probability || its.own > 0.5) advice.causes.push_back(its.component);
    }
    for (const std::size_t cause : advice.causes) propose_best(cause, rules);
    advice.repairs = proposals_;
    return advice;
  }

 private:
  struct Weight {
    std::size_t component = 0;
    double own = 0;        // that it has a cause of its own
    double of_others = 0;  // failures that it explains, weighed by probability
  };
  struct Latest {
    Time at;
    std::size_t number = 0;
    Decision decision;
  };

  // The strategy that it would choose for a cause once nothing stands in its way any more.
  void propose_best(std::size_t cause, const RuleSet& rules) {
    const auto latest = latest_.find(cause);
    if (latest == latest_.end()) return;
    for (const Candidate& candidate : latest->second.decision.candidates) {
      const bool is_out =
          candidate.excluded == Condition::kTried || candidate.excluded == Condition::kInvalid;
      if (!is_out) return propose(rules[candidate.strategy]);
    }
  }

  void propose(const Strategy& strategy) {
    const std::size_t component = strategy.components.front().index;
    const bool is_known = std::any_of(proposals_.begin(), proposals_.end(),
                                      [&](const Proposal& p) { return p.component == component; });
    if (is_known) return;
    for (const Repair repair : {Repair::kConfigure, Repair::kRestart, Repair::kRedeploy}) {
      if (strategy.name == to_string(repair))
        proposals_.push_back({component, repair, seconds(now_.time_since_epoch())});
    }
  }

  std::unique_ptr<const Planner> planner_;
  std::map<std::size_t, Latest> latest_;  // by component of the failure
  std::size_t number_ = 0;
  Time now_;
  std::vector<Proposal> proposals_;
};

using Advisers = std::map<std::string, Adviser>;

// Chooses nothing, so that each failure waits; but asks what the advisers want to ask.
class AskingPlanner : public Planner {
 public:
  // `advisers` must outlive it.
  explicit AskingPlanner(const Advisers& advisers) : advisers_(advisers) {}

  std::vector<Decision> plan(std::span<const RuleId> failures,
                             const Knowledge& knowledge) const override {
    std::vector<Decision> decisions;
    for (const RuleId rule : failures) decisions.emplace_back().rule = rule;
    for (const auto& [name, adviser] : advisers_) {
      for (const Decision& theirs : adviser.planner().plan(failures, knowledge)) {
        if (!theirs.asks.empty())
          *std::ranges::find(decisions, theirs.rule, &Decision::rule) = ask(theirs);
      }
    }
    return decisions;
  }

 private:
  static Decision ask(const Decision& theirs) {
    Decision decision;
    decision.rule = theirs.rule;
    decision.asks = theirs.asks;
    Candidate& waiting = decision.candidates.emplace_back();
    waiting.strategy = theirs.candidates.front().strategy;
    waiting.excluded = Condition::kSuspect;
    waiting.component = theirs.asks.front();
    return decision;
  }

  const Advisers& advisers_;
};

// Notes what others may see of a case.
class Recorder {
 public:
  explicit Recorder(RcaCase& made) : made_(made), events_(made.events) {}

  void record(const Runtime::Step& step) {
    for (const Observation& observation : step.observations) {
      if (const auto* read = std::get_if<SignalRead>(&observation.what))
        note(*read, seconds(observation.at.time_since_epoch()));
    }
    events_.record(step);
  }

 private:
  void note(const SignalRead& read, double at_s) {
    if (made_.times_s.empty() || made_.times_s.back() < at_s) {
      made_.times_s.push_back(at_s);
      made_.readings.emplace_back(made_.watched.size(), false);
    }
    made_.readings.back()[read.signal.index] = read.value == Value(true);
  }

  RcaCase& made_;
  CaseEvents events_;
};

}  // namespace

std::string_view to_string(CaseEventKind kind) {
  switch (kind) {
    case CaseEventKind::kExited:
      return "exited";
    case CaseEventKind::kAnswered:
      return "answered";
    case CaseEventKind::kUnanswered:
      break;
  }
  return "unanswered";
}

void CaseEvents::record(const Runtime::Step& step) {
  for (const Observation& observation : step.observations) {
    const double at_s = seconds(observation.at.time_since_epoch());
    const auto* seen = std::get_if<ProcessSeen>(&observation.what);
    if (seen != nullptr && seen->state == ProcessState::kGone)
      events_.push_back({at_s, seen->component.index, CaseEventKind::kExited});
    const auto* reply = std::get_if<Reply>(&observation.what);
    const auto asked = reply != nullptr ? asked_.find(reply->command) : asked_.end();
    if (asked == asked_.end()) continue;
    const bool has_answered = reply->outcome == Outcome::kDone;
    events_.push_back({at_s, asked->second,
                       has_answered ? CaseEventKind::kAnswered : CaseEventKind::kUnanswered});
    asked_.erase(asked);
  }
  for (const Command& command : step.commands) {
    if (std::holds_alternative<Probe>(command.what)) asked_[command.id] = command.component.index;
  }
}

std::optional<CaseTruth> truth_of(const RcaScenario& scenario) {
  const auto& components = scenario.components;
  const Onsets onsets = onsets_of(scenario);
  CaseTruth truth;
  for (const InjectedFault& fault : scenario.faults)
    truth.causes.push_back(
        {fault, std::string(to_string(fault.kind)), working_repairs(scenario, fault)});
  std::sort(truth.causes.begin(), truth.causes.end(), [](const CaseCause& a, const CaseCause& b) {
    return a.fault.component < b.fault.component;
  });

  std::map<std::size_t, CaseEffect> effects;
  for (const CaseCause& cause : truth.causes) {
    const std::size_t faulty = cause.fault.component;
    RcaScenario alone = scenario;
    alone.faults = {cause.fault};
    alone.common_causes.clear();
    RcaScenario without = scenario;
    std::erase_if(without.faults, [&](const InjectedFault& f) { return f.component == faulty; });
    const Onsets if_alone = onsets_of(alone);
    const Onsets if_without = onsets_of(without);
    bool has_shown = false;
    for (std::size_t c = 0; c < components.size(); ++c) {
      const bool is_faulty = std::any_of(scenario.faults.begin(), scenario.faults.end(),
                                         [&](const InjectedFault& f) { return f.component == c; });
      if (is_faulty || !onsets[c] || (!if_alone[c] && if_without[c])) continue;
      CaseEffect& effect = effects[c];
      effect.component = c;
      effect.causes.push_back(faulty);
      effect.since_s = *onsets[c];
      has_shown |= !components[c].is_unwatched;
    }
    if (!has_shown || components[faulty].is_unwatched) return std::nullopt;
  }
  for (auto& [component, effect] : effects) truth.effects.push_back(std::move(effect));

  for (std::size_t c = 0; c < components.size(); ++c) {
    if (onsets[c])
      truth.end_s = std::max(truth.end_s, *onsets[c] + components[c].detector.latency_s);
  }
  // It ends with a reading.
  truth.end_s =
      std::ceil((truth.end_s + kAfterLastFailure_s) / scenario.reading_s) * scenario.reading_s;
  return truth;
}

std::optional<RcaCase> case_of(RcaScenario scenario, std::span<const std::string> advisers,
                               Objective objective) {
  RcaCase made;
  made.scenario = as_case(std::move(scenario));
  auto truth = truth_of(made.scenario);
  if (!truth) return std::nullopt;
  made.truth = std::move(*truth);
  made.scenario.horizon_s = made.truth.end_s;
  for (std::size_t c = 0; c < made.scenario.components.size(); ++c) {
    if (!made.scenario.components[c].is_unwatched) made.watched.push_back(c);
  }

  const RuleSet rules = rules_of(made.scenario);
  RcaRobot robot(made.scenario, rules);
  Manager::Options options;
  options.discovery = Duration::zero();
  Advisers asked;
  for (const std::string& name : advisers)
    asked.emplace(name, std::move(*make_planner(name, objective, made.scenario)));
  Manager manager(rules, std::make_unique<AskingPlanner>(asked), options);
  Recorder recorder(made);
  Runtime runtime(manager, robot);
  runtime.on_step = [&](const Runtime::Step& step) {
    recorder.record(step);
    for (auto& [name, adviser] : asked) adviser.look(manager, step.now);
  };
  runtime.run(robot.is_over(), Time(from_seconds(made.truth.end_s)));
  for (auto& [name, adviser] : asked) made.advice[name] = adviser.advice(rules);
  made.rules = rules_text(made.scenario);
  return made;
}

}  // namespace culprit::study::rca
