#include "sunset_study/study.h"

#include <algorithm>

#include "base/invariant.h"
#include "knowledge/describe.h"
#include "language/checker.h"
#include "managers/one_by_one_planner.h"
#include "managers/paced_manager.h"
#include "managers/style_planner.h"
#include "plan/bayes/bayes_planner.h"
#include "plan/paper_planner.h"
#include "reference/reference_manager.h"
#include "reference/sunset_blackboard.h"
#include "study/published.h"
#include "sunset_study/detectors.h"
#include "sunset_study/rules.h"

namespace culprit::study {
namespace {

// When managing begins everything has run for a while, so what is not seen is not there.
constexpr Duration kDiscovery = std::chrono::milliseconds(200);

std::string rules_of(const std::string& planner, const sunset::model::Profile& profile,
                     Detectors detectors) {
  if (planner == "reference") return kReferenceRules;
  if (planner == "oracle") return kOracleRules;
  if (detectors == Detectors::kPhi) return with_phi(kLiveRules);
  if (detectors == Detectors::kKnown) return with_faults_known(kLiveRules);
  return detectors == Detectors::kAge || !profile.has_blackboard ? kLiveRules : kStudyRules;
}

// 20 % off, as in the paper, which does not say in which direction: every other strategy of a rule
// is believed in too much, the rest too little. The cheap one of two looks as good as the dear one
// then.
void misspecify(RuleSet& rules) {
  for (const Rule& rule : rules.rules) {
    double factor = 1.2;
    for (const StrategyId id : rule.strategies) {
      Probability& success = rules.strategies[id.index].success;
      success.value = std::min(1.0, success.value * factor);
      factor = factor > 1 ? 0.8 : 1.2;
    }
  }
}

Happening kind_of(const Event& event) {
  if (std::holds_alternative<FailureDetected>(event.what)) return Happening::kFailure;
  if (std::holds_alternative<StrategyChosen>(event.what)) return Happening::kBlame;
  if (std::holds_alternative<AdaptationDone>(event.what)) return Happening::kAdaptation;
  if (std::holds_alternative<FailureResolved>(event.what)) return Happening::kResolved;
  if (std::holds_alternative<StrategyFailed>(event.what) ||
      std::holds_alternative<RuleExhausted>(event.what))
    return Happening::kGaveUp;
  return Happening::kNote;
}

// The component that an event is about; empty if it is about none or several.
std::string component_of(const Event& event, const RuleSet& rules) {
  if (const auto* chosen = std::get_if<StrategyChosen>(&event.what)) {
    const auto& components = rules[chosen->strategy].components;
    return components.size() == 1 ? rules[components.front()].name : "";
  }
  if (const auto* done = std::get_if<AdaptationDone>(&event.what))
    return rules[rules[done->strategy].adaptations[done->adaptation].component].name;
  if (const auto* lost = std::get_if<ComponentLost>(&event.what))
    return rules[lost->component].name;
  if (const auto* found = std::get_if<ComponentFound>(&event.what))
    return rules[found->component].name;
  return "";
}

// The objective of "bayes" or "bayes:downtime"; empty for other planners.
std::optional<Objective> objective_of(std::string_view planner) {
  constexpr std::string_view kBayes = "bayes";
  if (!planner.starts_with(kBayes)) return std::nullopt;
  planner.remove_prefix(kBayes.size());
  return planner.empty() ? Objective::kBalanced : *parse_objective(planner.substr(1));
}

// A component's name in the rules, from its node's.
std::string component_of(sunset::Member member, const RuleSet& rules) {
  const std::string node = sunset::node_of(member).full();
  const auto found = std::find_if(rules.components.begin(), rules.components.end(),
                                  [&](const Component& c) { return c.node == node; });
  return found == rules.components.end() ? node : found->name;
}

double seconds_of(Time t) { return seconds(t.time_since_epoch()); }

std::vector<TimelineEntry> injected(const SunsetRun& run, const RuleSet& rules) {
  std::vector<TimelineEntry> entries;
  for (const auto& injection : run.injections) {
    std::string component = component_of(injection.fault->member, rules);
    std::string text = "fault: " + std::string(injection.fault->name) + " of " + component;
    entries.push_back(
        {seconds_of(injection.at), Happening::kFault, std::move(component), std::move(text)});
  }
  return entries;
}

}  // namespace

std::vector<std::string_view> sunset_planners() {
  return {"paper",
          "reference",
          "bayes",
          "bayes:downtime",
          "bayes:adaptations",
          "bayes:redeployments",
          "bt",
          "metacontrol",
          "rosa",
          "rebet",
          "rebet-ucb",
          "rebet-greedy",
          "rebet-random",
          "ac-ros",
          "vogel",
          "ghahremani",
          "bandit",
          "random",
          "oracle"};
}

bool has_switches(std::string_view planner) { return planner == "paper" || planner == "reference"; }

bool can_learn(std::string_view planner) { return planner == "paper" || objective_of(planner); }

Expected<SunsetStudy> SunsetStudy::make(std::vector<Configuration> rows, std::uint64_t seed,
                                        const Variation& variation) {
  std::vector<Setting> settings;
  for (Configuration& row : rows) {
    const auto planners = sunset_planners();
    if (std::find(planners.begin(), planners.end(), row.planner) == planners.end())
      return Error{"there is no planner '" + row.planner +
                   "'; there are paper, reference, bayes, bayes with an objective "
                   "(bayes:downtime), bt, metacontrol, rosa, rebet, rebet-ucb, rebet-greedy, "
                   "rebet-random, ac-ros, vogel, ghahremani, bandit, random, oracle"};
    const auto named = parse_profile(row.profile);
    if (!named) return Error{named.error()};
    const bool is_live = row.profile == kLiveRobot;
    if (is_live && row.planner == "oracle")
      return Error{"the oracle knows what only a model can tell: it plays no live robot"};
    const auto profile =
        sunset::model::find_profile(is_live ? std::string(kModelOfLiveRobot) : named->first);
    if (!profile) return Error{profile.error()};
    if (row.planner == "reference" &&
        (!(*profile)->has_blackboard || named->second != Detectors::kOwn))
      return Error{"the reference planner reads SUNSET's blackboard, and profile '" + row.profile +
                   "' has none"};
    const Checked checked = check(Source(
        "study.rules", variation.rules.empty() ? rules_of(row.planner, **profile, named->second)
                                               : variation.rules));
    // A test checks what is built in.
    if (!checked.rules) return Error{"the rules have errors; culprit check shows them"};
    RuleSet rules = varied(*checked.rules, variation);
    if (row.probabilities == Probabilities::kMisspecified) misspecify(rules);
    settings.push_back(
        {std::move(row),
         std::make_unique<const sunset::model::Profile>(varied(**profile, variation)),
         std::make_unique<const RuleSet>(std::move(rules)),
         {}});
  }
  SunsetStudy study(std::move(settings), seed);
  for (Setting& setting : study.settings_) study.train(setting);
  return study;
}

void SunsetStudy::train(Setting& setting) const {
  constexpr std::uint64_t kTraining = 0x7ea1;
  const BanditKind* kind = find_bandit(setting.configuration.planner);
  if (kind == nullptr) return;
  setting.experience = no_experience(*setting.rules);
  if (!kind->learns()) return;
  for (std::uint32_t run = 0; run < published::kRuns; ++run) {
    const std::uint64_t seed = simulation::mix(simulation::mix(seed_ ^ kTraining) + run);
    sunset::model::SunsetModel model(*setting.profile, seed);
    BanditManager manager(*setting.rules, *kind, setting.experience, seed,
                          manager_options(*setting.profile));
    (void)study::play(model, *setting.rules, manager, scenario_of({0, run}));
    setting.experience = manager.experience();
  }
}

std::uint64_t SunsetStudy::seed_of(RunId id) const {
  return simulation::mix(simulation::mix(seed_) + (std::uint64_t{id.row} << 32U) + id.run);
}

Manager::Options SunsetStudy::manager_options(const sunset::model::Profile& profile) {
  Manager::Options options;
  options.start = Time{profile.manager_start};
  options.discovery = kDiscovery;
  return options;
}

std::unique_ptr<ManagingSystem> SunsetStudy::manager(RunId id,
                                                     const Manager::Options& options) const {
  const Setting& setting = settings_[id.row];
  if (setting.configuration.planner == "reference") {
    ReferenceOptions reference;
    reference.switches = setting.configuration.switches;
    reference.start = reference.graph_frozen_at = options.start;
    reference.initial = sunset_blackboard();
    // The rules are made for it.
    return std::move(*ReferenceManager::make(*setting.rules, std::move(reference)));
  }
  std::unique_ptr<ManagingSystem> manager;
  if (const BanditKind* kind = find_bandit(setting.configuration.planner)) {
    manager = std::make_unique<BanditManager>(*setting.rules, *kind, setting.experience,
                                              seed_of(id), options);
  } else {
    manager = std::make_unique<Manager>(*setting.rules, planner_of(setting.configuration), options);
  }
  if (const Pace* pace = find_pace(setting.configuration.planner))
    return std::make_unique<PacedManager>(std::move(manager), *pace, options.start, seed_of(id));
  return manager;
}

std::unique_ptr<const Planner> SunsetStudy::planner_of(const Configuration& configuration) {
  if (const auto style = find_style(configuration.planner))
    return std::make_unique<StylePlanner>(*style);
  if (find_pace(configuration.planner) != nullptr) return std::make_unique<OneByOnePlanner>();
  if (const auto objective = objective_of(configuration.planner))
    return std::make_unique<BayesPlanner>(*objective);
  // The oracle knows each fault, so it need not ask which failure is an effect of which.
  if (configuration.planner == "oracle")
    return std::make_unique<PaperPlanner>(PaperSwitches{false, false, false});
  return std::make_unique<PaperPlanner>(configuration.switches);
}

const sunset::Scenario& SunsetStudy::scenario_of(RunId id) {
  static const std::vector<sunset::Scenario> kScenarios = sunset::scenarios();
  return kScenarios[id.run % kScenarios.size()];
}

SunsetRun SunsetStudy::play(RunId id) const {
  const Setting& setting = settings_[id.row];
  CULPRIT_ASSERT(setting.configuration.profile != kLiveRobot);
  sunset::model::SunsetModel model(*setting.profile, seed_of(id));
  const auto managing = manager(id, manager_options(*setting.profile));
  return study::play(model, *setting.rules, *managing, scenario_of(id));
}

RunMetrics SunsetStudy::run(RunId id) const { return measured(id, play(id)); }

RunMetrics SunsetStudy::measured(RunId id, const SunsetRun& run) const {
  const Setting& setting = settings_[id.row];
  const PaperSwitches& on = setting.configuration.switches;
  return measure(run, *setting.rules, on.dependencies && !on.criticality && !on.impact);
}

SingleRun SunsetStudy::single_run(RunId id) const {
  const RuleSet& rules = this->rules(id.row);
  SunsetRun run = play(id);
  return {run.scenario.name(), rules, injected(run, rules), std::move(run.events),
          seconds_of(run.end)};
}

Timeline SunsetStudy::explain(RunId id) const {
  const Setting& setting = settings_[id.row];
  const RuleSet& rules = *setting.rules;
  const SunsetRun run = play(id);
  Timeline timeline{setting.configuration, id.run, run.scenario.name(), injected(run, rules)};
  for (const Event& event : run.events) {
    std::string text = describe(event, rules);
    if (!text.empty())
      timeline.entries.push_back(
          {seconds_of(event.at), kind_of(event), component_of(event, rules), std::move(text)});
  }
  std::stable_sort(
      timeline.entries.begin(), timeline.entries.end(),
      [](const TimelineEntry& a, const TimelineEntry& b) { return a.time_s < b.time_s; });
  return timeline;
}

}  // namespace culprit::study
