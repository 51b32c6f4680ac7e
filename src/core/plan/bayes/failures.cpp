#include "plan/bayes/failures.h"

#include <algorithm>
#include <cassert>

#include "plan/bayes/suspicion.h"

namespace culprit::plan {
namespace {

std::vector<RuleId> by_name(const Knowledge& knowledge) {
  std::vector<RuleId> rules = knowledge.states.active();
  std::copy_if(knowledge.states.exhausted().begin(), knowledge.states.exhausted().end(),
               std::back_inserter(rules),
               [&](RuleId id) { return knowledge.states.awaits_person(id); });
  std::sort(rules.begin(), rules.end(),
            [&](RuleId a, RuleId b) { return knowledge.rules[a].name < knowledge.rules[b].name; });
  return rules;
}

// Visits what can be reached from `root` through `rows` and is still in `open`, which it leaves.
// Calls `done` for each when all that it leads to was visited.
template <class Done>
void search(std::size_t root, const BitRows& rows, std::span<Word> open,
            std::vector<std::size_t>& path, Done done) {
  clear(open, root);
  path.assign(1, root);
  while (!path.empty()) {
    const auto next = first_common(rows[path.back()], open);
    if (!next) {
      done(path.back());
      path.pop_back();
      continue;
    }
    clear(open, *next);
    path.push_back(*next);
  }
}

std::size_t level_of(const Rule& rule) {
  return static_cast<std::size_t>(rule.policies.criticality);
}

// Does a strategy of its rule begin anew what it is about?
bool may_be_broken(RuleId rule, const RuleSet& rules) {
  const auto begins_anew = [](const Adaptation& adaptation) {
    return adaptation.type == AdaptationType::kRestart ||
           adaptation.type == AdaptationType::kRedeploy ||
           adaptation.type == AdaptationType::kStart;
  };
  return std::any_of(
      rules[rule].strategies.begin(), rules[rule].strategies.end(), [&](StrategyId s) {
        return std::any_of(rules[s].adaptations.begin(), rules[s].adaptations.end(), begins_anew);
      });
}

}  // namespace

Failures::Failures(const Knowledge& knowledge, const Reach& reach, const FailurePaths& paths)
    : rules_(by_name(knowledge)),
      places_(knowledge.rules.rules.size(), kAbsent),
      causes_(rules_.size(), rules_.size()),
      circle_of_(rules_.size()) {
  const RuleSet& rules = knowledge.rules;
  for (std::size_t i = 0; i < rules_.size(); ++i) places_[rules_[i].index] = i;
  BitRows touching(reach.size(), rules_.size());  // by place: which failures touch it
  for (std::size_t i = 0; i < rules_.size(); ++i) {
    for (const ComponentId c : rules[rules_[i]].components) set(touching[reach.place_of(c)], i);
  }
  // By level: what is less critical and no outage, and is only ever reconfigured. That is no cause:
  // its author finds nothing broken there, and what is bad may be old, for who would tell a better
  // value is out.
  BitRows slight(kLevels, rules_.size());
  for (std::size_t i = 0; i < rules_.size(); ++i) {
    if (symptom_of(rules_[i], knowledge) == Symptom::kOutage || may_be_broken(rules_[i], rules))
      continue;
    for (std::size_t level = level_of(rules[rules_[i]]) + 1; level < kLevels; ++level)
      set(slight[level], i);
  }
  for (std::size_t i = 0; i < rules_.size(); ++i) {
    const auto row = causes_[i];
    for (const ComponentId c : rules[rules_[i]].components) {
      for_each(paths.upstream(reach.place_of(c), rules_[i]),
               [&](std::size_t place) { add(row, touching[place]); });
    }
    clear(row, i);
    for_each(slight[level_of(rules[rules_[i]])], [&](std::size_t cause) { clear(row, cause); });
  }
  find_circles(transposed(causes_, rules_.size()));
}

// Kosaraju: what is visited first from the last of one search, backwards, is a circle.
void Failures::find_circles(const BitRows& effects) {
  BitRows open(1, rules_.size());
  std::vector<std::size_t> path;
  std::vector<std::size_t> order;
  const auto open_all = [&] {
    for (std::size_t i = 0; i < rules_.size(); ++i) set(open[0], i);
  };
  open_all();
  for (std::size_t i = 0; i < rules_.size(); ++i) {
    if (has(open[0], i))
      search(i, causes_, open[0], path, [&](std::size_t done) { order.push_back(done); });
  }
  open_all();
  for (auto root = order.rbegin(); root != order.rend(); ++root) {
    if (!has(open[0], *root)) continue;
    auto& circle = circles_.emplace_back();
    search(*root, effects, open[0], path, [&](std::size_t done) { circle.push_back(done); });
    std::sort(circle.begin(), circle.end());
    for (const std::size_t member : circle) circle_of_[member] = circles_.size() - 1;
  }
  for (const auto& circle : circles_) {
    if (circle.size() == 1) continue;
    for (const std::size_t member : circle) {
      for (const std::size_t other : circle) clear(causes_[member], other);
    }
  }
}

std::size_t Failures::index_of(RuleId rule) const {
  assert(holds(rule));
  return places_[rule.index];
}

}  // namespace culprit::plan
