#include "language/rule_checks.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "language/evaluate.h"
#include "language/symbols.h"

namespace culprit {
namespace {

using enum AdaptationType;

bool sets_parameter(const syntax::Adaptation& a) {
  return a.type == kSetParameter || a.type == kIncreaseParameter || a.type == kDecreaseParameter ||
         a.type == kChangeCommunication;
}
bool ends_process(const syntax::Adaptation& a) { return a.type == kRedeploy || a.type == kStop; }
bool changes_presence(const syntax::Adaptation& a) { return a.type == kStart || a.type == kStop; }
bool lacks_launch(const culprit::Adaptation& adaptation, const RuleSet& rules) {
  const Component& component = rules[adaptation.component];
  if (adaptation.type == kRedeploy) return !component.can_start_again();
  return adaptation.type == kStart && !component.can_start();
}

// Empty: a COMPONENT line declares it, and may get a LAUNCH.
std::string remedy_of_undeclared(const Component& component, const Symbols& symbols) {
  if (component.declared) return "";
  const std::string& name = component.name;
  if (symbols.is_topic(name))
    return "this is a topic of these rules: write the component that publishes it";
  const bool is_node = name.starts_with('/');
  return "declare it: COMPONENT " +
         (is_node ? name.substr(name.rfind('/') + 1) + " NODE " + name : name) +
         " LAUNCH \"program arguments\"";
}

// It does no harm, so it is only a warning.
constexpr const char* kRestartInVain =
    "the restart is in vain, for the component's process is ended after it";

// Why the two cannot be in one strategy; null if they can. Both are about one component, `first`
// stands before.
const char* contradiction(const syntax::Adaptation& first, const syntax::Adaptation& second) {
  const auto are = [&](AdaptationType a, AdaptationType b) {
    return (first.type == a && second.type == b) || (first.type == b && second.type == a);
  };
  if (changes_presence(first) && changes_presence(second)) return nullptr;  // see Presence
  if (are(kActivate, kDeactivate)) return "the component is both activated and deactivated";
  if (are(kActivate, kActivate) || are(kDeactivate, kDeactivate)) return "this is done already";
  const bool lifecycle =
      second.type == kActivate || second.type == kDeactivate || second.type == kRestart;
  if (first.type == kRestart && lifecycle) return "a restart activates the component already";
  if (second.type == kRestart) return "a restart undoes what was done to the component before";
  if (first.type == kRestart && ends_process(second)) return kRestartInVain;
  const bool other_configures = sets_parameter(first) || sets_parameter(second) ||
                                first.type == kChangeMode || second.type == kChangeMode ||
                                lifecycle || first.type == kActivate || first.type == kDeactivate;
  if (are(kRedeploy, kRedeploy)) return "this is done already";
  if (ends_process(first) && ends_process(second))
    return "the component's process is ended already";
  if ((ends_process(first) || ends_process(second)) && other_configures) {
    return "the component is both redeployed or stopped and reconfigured";
  }
  if (sets_parameter(first) && sets_parameter(second) &&
      first.subject.text == second.subject.text) {
    return "this parameter is set twice";
  }
  if (are(kChangeMode, kChangeMode)) return "the component's mode is changed twice";
  return nullptr;
}

// The starts and stops of one component in a strategy. They are carried out in their order, so they
// may take turns (paper: a node is not added twice "without removing it"): start, stop, start. A
// strategy whose last one is the opposite of its first was not meant.
class Presence {
 public:
  // Why `next` cannot follow; null if it can.
  const char* contradiction_of(const syntax::Adaptation& next) const {
    if (!changes_presence(next) || last_ == nullptr || next.type != last_->type) return nullptr;
    return next.type == kStart ? "this component is started already"
                               : "this component is stopped already";
  }
  void add(const syntax::Adaptation& adaptation) {
    if (!changes_presence(adaptation)) return;
    if (first_ == nullptr) first_ = &adaptation;
    last_ = &adaptation;
  }
  // The last one, if it takes the first one back; else null.
  const syntax::Adaptation* taken_back() const {
    return first_ != nullptr && first_->type != last_->type ? last_ : nullptr;
  }

 private:
  const syntax::Adaptation* first_ = nullptr;
  const syntax::Adaptation* last_ = nullptr;
};

// The adaptations of one component in a strategy so far. Keeps the first of several that contradict
// the same others.
class Done {
 public:
  // Why the earliest of those that contradict `next` does so; null if none does.
  const char* contradiction_of(const syntax::Adaptation& next) const {
    if (const char* why = presence_.contradiction_of(next)) return why;
    const syntax::Adaptation* earliest = nullptr;
    const auto consider = [&](const syntax::Adaptation* a) {
      if (a != nullptr && (earliest == nullptr || a < earliest) && contradiction(*a, next))
        earliest = a;
    };
    for (const syntax::Adaptation* a : of_type_) consider(a);
    const auto same_parameter = by_parameter_.find(next.subject.text);
    if (sets_parameter(next) && same_parameter != by_parameter_.end())
      consider(same_parameter->second);
    return earliest == nullptr ? nullptr : contradiction(*earliest, next);
  }

  // They are parts of one vector, added in its order.
  void add(const syntax::Adaptation& adaptation) {
    presence_.add(adaptation);
    const syntax::Adaptation*& first = of_type_[static_cast<std::size_t>(adaptation.type)];
    if (first == nullptr) first = &adaptation;
    if (sets_parameter(adaptation)) by_parameter_.emplace(adaptation.subject.text, &adaptation);
  }
  const Presence& presence() const { return presence_; }

 private:
  Presence presence_;
  std::array<const syntax::Adaptation*, static_cast<std::size_t>(kStartGroup) + 1> of_type_{};
  std::map<std::string_view, const syntax::Adaptation*> by_parameter_;
};

// The state in which earlier steps left a component. A step may take back what one before it did.
class Left {
 public:
  // Why `next` cannot follow; null if it can.
  const char* contradiction_of(const syntax::Adaptation& next) const {
    if (process_ == kStop && next.type == kStop) return "this component is stopped already";
    if (process_ == kStop && next.type != kStart) return "an earlier step stopped the component";
    if (process_ != kStop && process_ && next.type == kStart)
      return "this component is started already";
    if (lifecycle_ == next.type) return "this is done already";
    return nullptr;
  }
  void add(const syntax::Adaptation& a) {
    if (a.type == kStart || a.type == kStop || a.type == kRedeploy) {
      process_ = a.type;
      lifecycle_.reset();
    }
    if (a.type == kActivate || a.type == kDeactivate) lifecycle_ = a.type;
    if (a.type == kRestart) lifecycle_ = kActivate;
  }

 private:
  std::optional<AdaptationType> process_;
  std::optional<AdaptationType> lifecycle_;  // activated or deactivated, and not started anew since
};

bool brings_up_again(AdaptationType later, AdaptationType earlier) {
  return (later == kStart && earlier == kStop) || (later == kActivate && earlier == kDeactivate);
}

// The producers of all components, in one array: a list for each would be thousands of small
// blocks.
class Producers {
 public:
  explicit Producers(const RuleSet& rules)
      : ends_(rules.components.size() + 1), all_(rules.dependencies.size()) {
    for (const Dependency& d : rules.dependencies) ++ends_[d.consumer.index + 1];
    std::partial_sum(ends_.begin(), ends_.end(), ends_.begin());
    std::vector<std::size_t> next(ends_.begin(), ends_.end() - 1);
    for (const Dependency& d : rules.dependencies)
      all_[next[d.consumer.index]++] = d.producer.index;
  }
  // Those of `component` are [begin, end), in the order of the file.
  std::size_t begin(std::size_t component) const { return ends_[component]; }
  std::size_t end(std::size_t component) const { return ends_[component + 1]; }
  std::size_t operator[](std::size_t place) const { return all_[place]; }

 private:
  std::vector<std::size_t> ends_;  // of what is in front of each component, and of the last one
  std::vector<std::size_t> all_;
};

// The first component of each node.
using ComponentsByNode = std::unordered_map<std::string_view, ComponentId>;

ComponentsByNode components_by_node(const RuleSet& rules) {
  ComponentsByNode all;
  for (std::size_t c = 0; c < rules.components.size(); ++c) {
    const std::string& node = rules.components[c].node;
    if (!node.empty()) all.emplace(node, ComponentId(c));
  }
  return all;
}

// The component whose state, samples or log lines the input is; empty: the rules do not say.
std::optional<ComponentId> owner_of(const Input& input, const RuleSet& rules,
                                    const ComponentsByNode& nodes) {
  using enum Input::Kind;
  switch (input.subject()) {
    case Input::Subject::kComponent:
      return input.component;
    case Input::Subject::kSignal:
      return publisher_of(input.signal, rules);
    case Input::Subject::kParameter:
    case Input::Subject::kDiagnostic:
      return std::nullopt;
    case Input::Subject::kTopic:
      if (input.kind == kGoals || input.kind == kGoalAge) return std::nullopt;
      break;
  }
  const Topic& topic = rules[input.topic];
  if (topic.publisher) return topic.publisher;
  // A topic below the name of a node is private to it. A node may stand below the name of another.
  std::string_view above = topic.name;
  for (auto slash = above.rfind('/'); slash != above.npos; slash = above.rfind('/')) {
    above = above.substr(0, slash);
    if (const auto owner = nodes.find(above); owner != nodes.end()) return owner->second;
  }
  return std::nullopt;
}

// The components that the trigger is about. Empty also if one of its inputs has no known owner.
std::set<std::size_t> subjects_of(const Rule& rule, const RuleSet& rules,
                                  const ComponentsByNode& nodes) {
  std::set<std::size_t> subjects;
  for (const InputId input : rule.inputs) {
    const auto owner = owner_of(rules[input], rules, nodes);
    if (!owner) return {};
    subjects.insert(owner->index);
  }
  return subjects;
}

// Searches declared dependencies for producers.
class ProducerSearch {
 public:
  explicit ProducerSearch(const RuleSet& rules)
      : producers_(rules), seen_by_(rules.components.size()) {}

  // One of `subjects` that the component depends on, directly or not. Empty: it depends on none, or is
  // one itself, or all searches together have passed kMostSteps dependencies.
  std::optional<std::size_t> producer_among(const std::set<std::size_t>& subjects,
                                            std::size_t component) {
    if (subjects.contains(component)) return std::nullopt;
    ++search_;
    std::vector<std::size_t> open{component};
    while (!open.empty()) {
      const std::size_t here = open.back();
      open.pop_back();
      if (subjects.contains(here)) return here;
      for (std::size_t place = producers_.begin(here); place < producers_.end(here); ++place) {
        if (steps_left_ == 0) return std::nullopt;
        --steps_left_;
        const std::size_t producer = producers_[place];
        if (std::exchange(seen_by_[producer], search_) != search_) open.push_back(producer);
      }
    }
    return std::nullopt;
  }

 private:
  // A thousand rules of four strategies, on a robot with 500 dependencies, need no more.
  static constexpr std::size_t kMostSteps = 2'000'000;

  Producers producers_;
  std::vector<std::size_t> seen_by_;  // the last search that found it, by component
  std::size_t search_ = 0;
  std::size_t steps_left_ = kMostSteps;
};

}  // namespace

std::vector<bool> steps_of(const syntax::Strategy& strategy) {
  const auto& all = strategy.adaptations;
  std::vector<bool> begins(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) begins[i] = all[i].begins_step;
  if (std::ranges::find(begins, true) != begins.end()) return begins;
  std::unordered_map<std::string_view, std::size_t> last;  // of each component, until now
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto [before, is_first] = last.try_emplace(all[i].component.text, i);
    const std::size_t earlier = std::exchange(before->second, i);
    // Something else is adapted between the two.
    begins[i] = i > earlier + 1 && brings_up_again(all[i].type, all[earlier].type);
  }
  return begins;
}

void check_contradictions(const syntax::Strategy& strategy, std::vector<Diagnostic>& diagnostics) {
  const auto& all = strategy.adaptations;
  if (all.size() < 2) return;
  const auto begins_step = steps_of(strategy);
  std::map<std::string_view, Left> left_by_component;  // by earlier steps
  std::size_t begin = 0;                               // of the step
  const auto report = [&](const syntax::Adaptation& adaptation, const char* why) {
    Left before = left_by_component[adaptation.component.text];
    for (const auto* each = &all[begin]; each != &adaptation; ++each) {
      if (each->component.text == adaptation.component.text) before.add(*each);
    }
    const bool may_follow = before.contradiction_of(adaptation) == nullptr;
    diagnostics.push_back(
        {Code::kContradiction, why == kRestartInVain ? Severity::kWarning : Severity::kError,
         adaptation.span, "strategy '" + strategy.name.text + "' contradicts itself: " + why,
         may_follow ? "write THEN ADAPTATION if it is a later step, or remove one of the two"
                    : "split it into two strategies, or remove one of the adaptations"});
  };
  while (begin < all.size()) {
    std::size_t end = begin + 1;
    while (end < all.size() && !begins_step[end]) ++end;
    std::map<std::string_view, Done> done_by_component;
    for (std::size_t i = begin; i < end; ++i) {
      const syntax::Adaptation& adaptation = all[i];
      Done& done = done_by_component[adaptation.component.text];
      const char* why = left_by_component[adaptation.component.text].contradiction_of(adaptation);
      if (why == nullptr) why = done.contradiction_of(adaptation);
      if (why != nullptr) report(adaptation, why);
      done.add(adaptation);
    }
    for (const auto& [component, done] : done_by_component) {
      if (const syntax::Adaptation* last = done.presence().taken_back())
        report(*last, "the component is both started and stopped");
    }
    for (std::size_t i = begin; i < end; ++i) left_by_component[all[i].component.text].add(all[i]);
    begin = end;
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!begins_step[i] || all[i].begins_step) continue;
    diagnostics.push_back({Code::kContradiction, Severity::kWarning, all[i].span,
                           "strategy '" + strategy.name.text + "' takes '" + all[i].component.text +
                               "' down and brings it up again in steps",
                           "write THEN ADAPTATION where a step begins",
                           Edit{{all[i].span.begin, all[i].span.begin}, "THEN "}});
  }
}

void check_launches(const syntax::Rule& rule, const Symbols& symbols, const RuleSet& rules,
                    RuleId id, std::size_t said, std::vector<Diagnostic>& diagnostics) {
  std::map<std::uint32_t, std::size_t> unknown;  // diagnostics of names, by where these begin
  for (std::size_t d = said; d < diagnostics.size(); ++d) {
    if (diagnostics[d].code == Code::kUnknownName) unknown.emplace(diagnostics[d].span.begin, d);
  }
  std::vector<Diagnostic> impossible;
  std::set<ComponentId> components;        // that lack it
  std::vector<std::size_t> misspelt;       // diagnostics
  std::size_t failing = 0;                 // strategies
  auto written = rule.strategies.begin();  // in the same order, but for those without a name
  for (const StrategyId s : rules[id].strategies) {
    const Strategy& strategy = rules[s];
    while (written->name.text != strategy.name) ++written;
    const auto missing = std::find_if(strategy.adaptations.begin(), strategy.adaptations.end(),
                                      [&](const auto& a) { return lacks_launch(a, rules); });
    if (missing == strategy.adaptations.end()) continue;
    const std::size_t place = missing->written;
    ++failing;
    // A misspelt name is the mistake; the component that is meant may well have a LAUNCH.
    const auto its = unknown.find(written->adaptations[place].component.span.begin);
    if (its != unknown.end()) {
      misspelt.push_back(its->second);
      continue;
    }
    const bool is_ended = missing->type == kRedeploy;
    components.insert(missing->component);
    const std::string undeclared = remedy_of_undeclared(rules[missing->component], symbols);
    impossible.push_back(
        {Code::kNoLaunch, Severity::kWarning, written->adaptations[place].span,
         "strategy '" + strategy.name + "' can never run: component '" +
             rules[missing->component].name + "' has no LAUNCH command",
         !undeclared.empty()
             ? undeclared
             : std::string("add LAUNCH \"program arguments\" to its COMPONENT line, "
                           "or UNIT if systemd runs it") +
                   (is_ended ? ", or RESPAWNED if its launcher starts it again" : "")});
  }
  const bool is_never_valid = failing > 0 && failing == rules[id].strategies.size();
  if (is_never_valid && !misspelt.empty()) {
    for (const std::size_t place : misspelt) diagnostics[place].severity = Severity::kError;
    return;
  }
  if (is_never_valid) {
    // One mistake, one message: this one says what those of the strategies would.
    const bool is_one = components.size() == 1;
    const Component& first = rules[*components.begin()];
    const std::string undeclared = is_one ? remedy_of_undeclared(first, symbols) : "";
    diagnostics.push_back({Code::kNeverValid, Severity::kError, rule.name.span,
                           "no strategy of rule '" + rule.name.text + "' can ever run: " +
                               (is_one ? "component '" + first.name + "' has"
                                       : "the components that they start have") +
                               " no LAUNCH command",
                           !undeclared.empty()
                               ? undeclared
                               : std::string("add LAUNCH \"program arguments\" to ") +
                                     (is_one ? "its COMPONENT line" : "their COMPONENT lines") +
                                     ", or a strategy that needs none"});
    return;
  }
  diagnostics.insert(diagnostics.end(), impossible.begin(), impossible.end());
}

void check_required(const syntax::Rule& rule, const RuleSet& rules, RuleId id,
                    std::vector<Diagnostic>& diagnostics) {
  auto written = rule.strategies.begin();  // in the same order, but for those without a name
  for (const StrategyId s : rules[id].strategies) {
    const Strategy& strategy = rules[s];
    while (written->name.text != strategy.name) ++written;
    if (strategy.is_last_resort) continue;
    const auto& all = strategy.adaptations;
    for (auto stop = all.begin(); stop != all.end(); ++stop) {
      if (stop->type != kStop || !rules[stop->component].is_required) continue;
      const bool is_back = std::any_of(stop, all.end(), [&](const auto& later) {
        return later.type == kStart && later.component == stop->component;
      });
      if (is_back) continue;
      diagnostics.push_back({Code::kStopsRequired, Severity::kWarning,
                             written->adaptations[stop->written].span,
                             "strategy '" + strategy.name + "' stops '" +
                                 rules[stop->component].name + "', which is REQUIRED",
                             "redeploy it, make the strategy a LASTRESORT, or take REQUIRED from "
                             "its COMPONENT line"});
    }
  }
}

void check_effects(const std::vector<RuleConditions>& conditions, const RuleSet& rules,
                   std::vector<Diagnostic>& diagnostics) {
  if (rules.dependencies.empty()) return;
  const ComponentsByNode nodes = components_by_node(rules);
  ProducerSearch search(rules);
  for (const RuleConditions& rule : conditions) {
    const std::set<std::size_t> subjects = subjects_of(rules[rule.rule], rules, nodes);
    for (std::size_t s = 0; !subjects.empty() && s < rule.strategies.size(); ++s) {
      const Strategy& strategy = rules[rules[rule.rule].strategies[s]];
      const auto producer_of = [&](ComponentId c) {
        return search.producer_among(subjects, c.index);
      };
      const auto begins_anew = [](const culprit::Adaptation& a) {
        return !a.group && (a.type == kRestart || a.type == kRedeploy);
      };
      const auto anew = std::ranges::find_if(strategy.adaptations, begins_anew);
      // Beside a repair of the cause, its consumers may have to begin anew, too.
      const bool is_effect_only = std::ranges::all_of(
          strategy.components, [&](ComponentId c) { return producer_of(c).has_value(); });
      if (strategy.is_last_resort || anew == strategy.adaptations.end() || !is_effect_only)
        continue;
      const std::string& effect = rules[anew->component].name;
      const std::string& cause = rules.components[*producer_of(anew->component)].name;
      diagnostics.push_back(
          {Code::kAdaptsEffect, Severity::kWarning,
           rule.strategies[s]->adaptations[anew->written].span,
           "strategy '" + strategy.name + "' adapts only '" + effect + "', which depends on '" +
               cause + "'; the trigger is about '" + cause + "'",
           "adapt " + cause + ", or write a rule with a trigger about " + effect});
    }
  }
}

void check_constant_trigger(const syntax::Rule& rule, const Program& trigger,
                            std::vector<Diagnostic>& diagnostics) {
  const bool reads = std::any_of(trigger.code.begin(), trigger.code.end(),
                                 [](const Instruction& i) { return i.op == Op::kInput; });
  if (reads) return;
  const Slot result = evaluate(trigger, {});
  const bool always = result.known && result.b;
  diagnostics.push_back({always ? Code::kAlwaysTrue : Code::kNeverTrue, Severity::kError,
                         rule.trigger->span,
                         always ? "this trigger is always true" : "this trigger is never true",
                         "let it read a signal or call a function such as rate(topic)"});
}

void check_circles(const syntax::File& file, const RuleSet& rules,
                   std::vector<Diagnostic>& diagnostics) {
  const std::size_t count = rules.components.size();
  const Producers producers(rules);

  enum class Mark : std::uint8_t { kNew, kOpen, kDone };
  std::vector<Mark> marks(count, Mark::kNew);
  std::set<std::size_t> in_circle;
  struct Visit {
    std::size_t component;
    std::size_t next;  // of its producers
  };
  std::vector<Visit> path;
  for (std::size_t start = 0; start < count; ++start) {
    if (marks[start] != Mark::kNew) continue;
    path.push_back({start, producers.begin(start)});
    marks[start] = Mark::kOpen;
    while (!path.empty()) {
      Visit& here = path.back();
      if (here.next == producers.end(here.component)) {
        marks[here.component] = Mark::kDone;
        path.pop_back();
        continue;
      }
      const std::size_t to = producers[here.next++];
      if (marks[to] == Mark::kOpen) in_circle.insert(to);
      if (marks[to] == Mark::kNew) {
        marks[to] = Mark::kOpen;
        path.push_back({to, producers.begin(to)});
      }
    }
  }
  std::size_t next = 0;  // the first of rules.dependencies that the line gave
  for (const syntax::Dependency& d : file.dependencies) {
    const ComponentId consumer = rules.dependencies[next].consumer;
    next += d.producers.size();
    if (in_circle.erase(consumer.index) == 0) continue;
    diagnostics.push_back({Code::kCircularDependency, Severity::kError, d.consumer.span,
                           "the declared dependencies of '" + d.consumer.text + "' lead back to it",
                           "remove the DEPENDENCY that closes the loop"});
  }
}

}  // namespace culprit
