#include "drill/hidden.h"

#include <algorithm>
#include <cmath>

#include "journal/json.h"

namespace culprit::drill {
namespace {

// A silence of fewer faults may be chance.
constexpr int kFaults = 3;
// So probable may it be that a component fell silent by chance in all faults of another one.
constexpr double kChance = 1e-3;

// When culprit began to adapt the component; nothing: it did not.
std::optional<double> adapted_at(const Trial& trial, const std::string& component) {
  for (const Json& event : trial.events) {
    if (journal::text_of(event, "type") != "strategy_chosen" || !event.contains("components") ||
        journal::flag_of(event, "dry_run"))
      continue;
    const Json& names = event["components"];
    if (std::ranges::find(names, Json(component)) != names.end())
      return journal::number_of(event, "clock");
  }
  return std::nullopt;
}

// The components that fell silent beside the broken ones. A repair makes a component silent, too.
std::set<std::string> silent_in(const Trial& trial) {
  std::set<std::string> silent = finding_of(trial).silent;
  std::erase_if(silent, [&](const std::string& each) {
    const auto adapted = adapted_at(trial, each);
    return adapted && trial.silent.at(each) >= *adapted;
  });
  return silent;
}

class Search {
 public:
  Search(const std::vector<Trial>& trials, const Paths& paths) : paths_(paths) {
    for (const Trial& trial : trials) {
      if (!trial.trouble.empty()) continue;
      Group& group = groups_[to_string(trial.faults)];
      group.faults = trial.faults;
      group.silent.push_back(silent_in(trial));
    }
  }

  std::vector<HiddenDependency> found() const {
    std::map<std::pair<std::string, std::string>, int> needs;  // how often
    for (const auto& [name, group] : groups_) {
      if (group.faults.size() != 1 || group.times() < kFaults) continue;
      const std::string& producer = group.faults.front().component;
      for (const std::string& consumer : group.silent.front()) {
        if (group.times(consumer) < group.times() || paths_.contains({consumer, producer}) ||
            may_be_chance(consumer, producer, group.times()))
          continue;
        int& most = needs[{consumer, producer}];
        most = std::max(most, group.times());
      }
    }
    return direct(needs);
  }

 private:
  // The trials of one fault, or of one pair.
  struct Group {
    std::vector<Fault> faults;
    std::vector<std::set<std::string>> silent;

    int times() const { return static_cast<int>(silent.size()); }
    int times(const std::string& component) const {
      return static_cast<int>(std::ranges::count_if(
          silent, [&](const auto& each) { return each.contains(component); }));
    }
  };

  // A consumer that falls silent in most other faults, too, follows none of them: the robot stopped safely, say. One that
  // does so now and then may have done so here.
  bool may_be_chance(const std::string& consumer, const std::string& producer, int faults) const {
    const auto explains = [&](const Fault& fault) {
      return fault.component == producer || fault.component == consumer ||
             paths_.contains({consumer, fault.component}) ||
             paths_.contains({producer, fault.component});
    };
    int others = 0, always = 0, silent = 0, trials = 0;
    for (const auto& [name, group] : groups_) {
      if (std::ranges::any_of(group.faults, explains)) continue;
      ++others;
      if (group.times(consumer) == group.times()) {
        ++always;
        continue;
      }
      silent += group.times(consumer);
      trials += group.times();
    }
    if (2 * always > others) return true;
    const double share = (silent + 1.0) / (trials + 2);
    return silent > 0 && std::pow(share, faults) > kChance;
  }

  // Without those that follow from the others and the graph.
  std::vector<HiddenDependency> direct(
      const std::map<std::pair<std::string, std::string>, int>& needs) const {
    std::vector<std::pair<std::string, std::string>> edges(paths_.begin(), paths_.end());
    for (const auto& [pair, times] : needs) edges.push_back(pair);
    const Paths all = paths_over(edges);
    const auto is_between = [&](const std::string& consumer, const std::string& middle,
                                const std::string& producer) {
      // In a feedback loop each would stand between the other two.
      return middle != consumer && middle != producer && all.contains({middle, producer}) &&
             !all.contains({middle, consumer}) && !all.contains({producer, middle});
    };
    std::vector<HiddenDependency> out;
    for (const auto& [pair, times] : needs) {
      const auto& [consumer, producer] = pair;
      bool follows = false;
      for (auto next = all.lower_bound({consumer, ""});
           next != all.end() && next->first == consumer; ++next)
        follows |= is_between(consumer, next->second, producer);
      if (!follows) out.push_back({consumer, producer, times});
    }
    return out;
  }

  const Paths& paths_;
  std::map<std::string, Group> groups_;
};

}  // namespace

std::vector<HiddenDependency> hidden_dependencies(const std::vector<Trial>& trials,
                                                  const Paths& paths) {
  return Search(trials, paths).found();
}

}  // namespace culprit::drill
