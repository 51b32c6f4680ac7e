#include "fleet/priors.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "fleet/clean.h"
#include "journal/json.h"

namespace culprit::fleet {
namespace {

StrategyName name_of(const Strategy& strategy, const RuleSet& rules) {
  return {clean(rules[strategy.rule].name), clean(strategy.name)};
}

// Without this robot.
RobotOutcomes others_of(const StrategyKnowledge& known, const std::string& model) {
  const auto found = known.models.find(model);
  if (found == known.models.end()) return {};
  RobotOutcomes sums = found->second;
  sums.remove(known.recent_helped, known.recent_failed);
  return sums;
}

std::vector<RobotOutcomes> other_models(const StrategyKnowledge& known, const std::string& model) {
  std::vector<RobotOutcomes> all;
  for (const auto& [name, sums] : known.models) {
    if (name != model) all.push_back(sums);
  }
  return all;
}

Belief prior_of(const Strategy& strategy, const RuleSet& rules, const FleetKnowledge& knowledge,
                const Pooling& pooling) {
  const Belief designer = initial_belief(strategy.success, strategy.confidence);
  const auto known = knowledge.strategies.find(name_of(strategy, rules));
  if (known == knowledge.strategies.end()) return designer;
  return pooled_prior(designer, others_of(known->second, knowledge.model),
                      other_models(known->second, knowledge.model), pooling);
}

// "12 robots of sunset and 3 of other models"; empty: nobody learned anything.
std::string source_of(const RuleSet& rules, const FleetKnowledge& knowledge) {
  double alike = 0;
  double others = 0;
  for (const Strategy& strategy : rules.strategies) {
    const auto known = knowledge.strategies.find(name_of(strategy, rules));
    if (known == knowledge.strategies.end()) continue;
    alike = std::max(alike, others_of(known->second, knowledge.model).robots);
    double sum = 0;
    for (const RobotOutcomes& each : other_models(known->second, knowledge.model))
      sum += each.robots;
    others = std::max(others, sum);
  }
  const auto robots = [](double count) {
    return fmt::format("{:.0f} {}", count, std::lround(count) == 1 ? "robot" : "robots");
  };
  const std::string model = knowledge.model.empty() ? "this model" : knowledge.model;
  if (alike + others < 0.5) return "";
  if (others < 0.5) return robots(alike) + " of " + model;
  if (alike < 0.5) return robots(others) + " of other models";
  return fmt::format("{} of {} and {:.0f} of other models", robots(alike), model, others);
}

bool is_nearly(const PriorsTold::Prior& a, const PriorsTold::Prior& b) {
  const double mean_a = a.alpha / (a.alpha + a.beta);
  const double mean_b = b.alpha / (b.alpha + b.beta);
  const double strength = (a.alpha + a.beta) / (b.alpha + b.beta);
  return std::abs(mean_a - mean_b) < 0.01 && strength > 0.9 && strength < 1.1;
}

}  // namespace

PriorsTold priors_for(const RuleSet& rules, const FleetKnowledge& knowledge) {
  PriorsTold told;
  for (std::size_t s = 0; s < rules.strategies.size(); ++s) {
    const Belief prior = prior_of(rules.strategies[s], rules, knowledge, {});
    told.priors.push_back({StrategyId(s), prior.alpha, prior.beta});
  }
  told.source = source_of(rules, knowledge);
  return told;
}

PriorsTold changes(const PriorsTold& known, const PriorsTold& news) {
  PriorsTold changed{{}, news.source};
  for (const PriorsTold::Prior& each : news.priors) {
    const bool is_known = std::ranges::any_of(known.priors, [&](const PriorsTold::Prior& old) {
      return old.strategy == each.strategy && is_nearly(old, each);
    });
    if (!is_known) changed.priors.push_back(each);
  }
  return changed;
}

std::vector<Deviation> deviations(const RuleSet& rules, const FleetKnowledge& knowledge) {
  constexpr std::int64_t kFewest = 5;  // outcomes; fewer prove nothing
  // Not capped: how sure the fleet is of what it knows is the question here.
  constexpr Pooling kAll{.most = 1000};
  std::vector<Deviation> all;
  for (const Strategy& strategy : rules.strategies) {
    const auto known = knowledge.strategies.find(name_of(strategy, rules));
    if (known == knowledge.strategies.end()) continue;
    const Counts& own = known->second.own;
    const bool has_others = others_of(known->second, knowledge.model).tried > 0;
    if (own.helped + own.failed < kFewest || !has_others) continue;
    const Belief prior = prior_of(strategy, rules, knowledge, kAll);
    const double probability =
        agreement(prior, static_cast<double>(own.helped), static_cast<double>(own.failed));
    if (probability < kHardly) all.push_back({known->first, own, prior.mean().value, probability});
  }
  return all;
}

std::string describe(const Deviation& deviation) {
  const std::int64_t tried = deviation.own.helped + deviation.own.failed;
  return fmt::format(
      "this robot is not like the others of the fleet: {} for {} helped {} of {} times here, and "
      "{:.0f} % of the times elsewhere",
      deviation.name.strategy, deviation.name.rule, deviation.own.helped, tried,
      100 * deviation.fleet);
}

std::string to_text(const FleetKnowledge& knowledge) {
  Json json = {{"model", knowledge.model}, {"strategies", Json::array()}};
  for (const auto& [name, known] : knowledge.strategies) {
    Json models = Json::object();
    for (const auto& [model, sums] : known.models)
      models[model] = {sums.robots, sums.tried, sums.helped, sums.spread, sums.square};
    json["strategies"].push_back({{"rule", name.rule},
                                  {"strategy", name.strategy},
                                  {"models", std::move(models)},
                                  {"recent", {known.recent_helped, known.recent_failed}},
                                  {"own", {known.own.helped, known.own.failed}}});
  }
  return to_line(json);
}

FleetKnowledge knowledge_from_text(const std::string& text) {
  const Json json = parse_json(text);
  FleetKnowledge knowledge;
  if (!json.is_object()) return knowledge;
  knowledge.model = journal::text_of(json, "model");
  const Json strategies = json.value("strategies", Json::array());
  const auto numbers = [](const Json& from, std::size_t count) {
    std::vector<double> all;
    if (!from.is_array() || from.size() != count) return all;
    for (const Json& each : from) all.push_back(each.is_number() ? each.get<double>() : 0);
    return all;
  };
  if (!strategies.is_array()) return knowledge;
  for (const Json& each : strategies) {
    if (!each.is_object()) continue;
    StrategyKnowledge known;
    const Json models = each.value("models", Json::object());
    if (!models.is_object()) continue;
    for (const auto& [model, sums] : models.items()) {
      const auto n = numbers(sums, 5);
      if (!n.empty()) known.models[model] = {n[0], n[1], n[2], n[3], n[4]};
    }
    const auto recent = numbers(each.value("recent", Json()), 2);
    const auto own = numbers(each.value("own", Json()), 2);
    if (recent.empty() || own.empty()) continue;
    const auto is_count = [](double count) { return count >= 0 && count < 1e12; };
    if (!is_count(recent[0]) || !is_count(recent[1]) || !is_count(own[0]) || !is_count(own[1]))
      continue;
    known.recent_helped = recent[0];
    known.recent_failed = recent[1];
    known.own = {static_cast<std::int64_t>(own[0]), static_cast<std::int64_t>(own[1])};
    knowledge.strategies[{journal::text_of(each, "rule"), journal::text_of(each, "strategy")}] =
        std::move(known);
  }
  return knowledge;
}

}  // namespace culprit::fleet
