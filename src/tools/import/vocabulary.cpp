#include "import/vocabulary.h"

#include <algorithm>

#include "base/ros_names.h"
#include "language/line_reader.h"

namespace culprit::foreign {
namespace {

using Kind = Expression::Kind;

constexpr std::string_view kFrequency = "_freq";

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

// "/a/b" -> "a_b_"
std::string as_prefix(std::string name_space) {
  if (name_space.empty()) return "";
  std::replace(name_space.begin(), name_space.end(), '/', '_');
  return name_space.substr(1) + "_";
}

bool is_free_name(const std::string& name) {
  const Source source("name", name);
  std::vector<Diagnostic> diagnostics;
  Scanner scanner(source.text(), source.line(1));
  return LineReader(source, diagnostics).declared_name(scanner, "a name").has_value() &&
         scanner.at_end();
}

struct Uses {
  std::vector<std::string> readings;  // as values that change
  std::vector<std::string> limits;    // as what such a value is compared with
};

// In `a < b`, a is read and b is a limit.
void collect_uses(const Expression& e, Uses& uses) {
  if (e.kind == Kind::kName) uses.readings.push_back(e.name.text);
  const bool compares = e.kind == Kind::kBinary && e.op >= syntax::Operator::kLess &&
                        e.op <= syntax::Operator::kNotEqual;
  if (compares && e.children[0].kind == Kind::kName) {
    uses.readings.push_back(e.children[0].name.text);
    collect_names(e.children[1], uses.limits);
    return;
  }
  for (const Expression& child : e.children) collect_uses(child, uses);
}

}  // namespace

void collect_names(const Expression& e, std::vector<std::string>& names) {
  if (e.kind == Kind::kName) names.push_back(e.name.text);
  for (const Expression& child : e.children) collect_names(child, names);
}

std::string NameClaims::claim(const std::string& wanted) {
  constexpr std::size_t kLongest = 200;
  std::string name = wanted.substr(0, kLongest);
  for (char& c : name) {
    if (!is_letter(c) && !is_digit(c)) c = '_';
  }
  if (name.empty() || is_digit(name.front())) name.insert(name.begin(), '_');
  std::string candidate = name;
  while (!is_free_name(candidate) || !used_.insert(candidate).second) {
    int& number = next_.emplace(name, 2).first->second;
    candidate = name + "_" + std::to_string(number++);
  }
  return candidate;
}

const std::string& NameClaims::keep(const std::string& name) { return *used_.insert(name).first; }

Vocabulary::Vocabulary(const File& file) {
  for (const Constant& constant : file.constants) {
    const auto [known, is_new] = constants_.emplace(constant.name, &constant);
    if (file.last_constant_counts) known->second = &constant;
  }
  std::vector<Uses> triggers;
  std::vector<std::string> values;
  for (const Rule& rule : file.rules) {
    collect_uses(rule.trigger, triggers.emplace_back());
    for (const Strategy& strategy : rule.strategies) {
      for (const Adaptation& adaptation : strategy.adaptations) {
        if (adaptation.value) collect_names(*adaptation.value, values);
      }
    }
  }
  find_components(file);
  std::set<std::string> fixed(values.begin(), values.end());
  for (const Uses& uses : triggers) fixed.insert(uses.limits.begin(), uses.limits.end());
  for (const Uses& uses : triggers) {
    for (const std::string& name : uses.readings) add_reading(name);
  }
  for (const std::string& name : fixed) {
    if (constants_.count(name) == 0) add_reading(name);
  }
  for (const Uses& uses : triggers) {
    const bool is_constant = std::none_of(uses.readings.begin(), uses.readings.end(),
                                          [this](const auto& name) { return is_monitored(name); });
    if (!is_constant) continue;
    for (const std::string& name : uses.readings) {
      if (fixed.count(name) == 0 && constants_.at(name)->type != "string") look_up(name);
    }
  }
  for (const auto& [name, constant] : constants_) {
    if (!is_monitored(name)) constant_names_[name] = claims_.claim(name);
  }
}

void Vocabulary::find_components(const File& file) {
  std::vector<const Adaptation*> adaptations;
  for (const Rule& rule : file.rules) {
    for (const Strategy& strategy : rule.strategies) {
      for (const Adaptation& adaptation : strategy.adaptations) adaptations.push_back(&adaptation);
    }
  }
  // A component without a full name is found by its name, so that name must not go to another.
  for (const Adaptation* a : adaptations) {
    if (!a->component.starts_with('/')) add_component(a->component);
  }
  for (const Adaptation* a : adaptations) add_component(a->component);
  std::set<std::string> redeployed;
  for (const Adaptation* a : adaptations) {
    if (a->type == AdaptationType::kRedeploy) redeployed.insert(a->component);
  }
  for (Component& component : components_)
    component.is_redeployed = redeployed.count(component.node) != 0;
}

void Vocabulary::add_component(const std::string& written) {
  const auto [known, is_new] = component_names_.emplace(written, "");
  if (!is_new) return;
  known->second = claims_.claim(own_name(written));
  components_.push_back({known->second, written, false});
}

void Vocabulary::add_reading(const std::string& name) {
  if (is_monitored(name)) return;
  const auto constant = constants_.find(name);
  const bool is_text = constant != constants_.end() && constant->second->type == "string";
  if (is_text || add_rate(name) || add_diagnostic(name)) return;
  if (constant == constants_.end()) look_up(name);
}

bool Vocabulary::is_monitored(const std::string& name) const {
  return rates_.count(name) != 0 || signal_names_.count(name) != 0;
}

void Vocabulary::look_up(const std::string& name) {
  signal_names_[name] = is_free_name(name) ? claims_.keep(name) : claims_.claim(name);
}

bool Vocabulary::add_rate(const std::string& name) {
  if (!name.ends_with(kFrequency)) return false;
  std::string topic;
  std::size_t longest = 0;
  for (const Component& component : components_) {
    const std::string name_space = namespace_of(component.node);
    const std::string prefix = as_prefix(name_space);
    if (prefix.size() <= longest || !name.starts_with(prefix)) continue;
    if (name.size() <= prefix.size() + kFrequency.size()) continue;
    longest = prefix.size();
    topic = name_space + "/" +
            name.substr(prefix.size(), name.size() - prefix.size() - kFrequency.size());
  }
  if (!topic.empty()) rates_[name] = topic;
  return !topic.empty();
}

bool Vocabulary::add_diagnostic(const std::string& name) {
  if (name.ends_with(kFrequency)) return false;
  std::string status;
  for (const Component& component : components_) {
    const std::string own = own_name(component.node);
    if (own.size() > status.size() && name.starts_with(own + "_") && name.size() > own.size() + 1)
      status = own;
  }
  if (status.empty()) return false;
  const std::string ours = claims_.claim(name);
  signal_names_[name] = ours;
  signals_.push_back({ours, status, name.substr(status.size() + 1)});
  return true;
}

bool Vocabulary::counts(const Constant& constant) const {
  return constants_.at(constant.name) == &constant;
}

std::string Vocabulary::constant(const Constant& constant) const {
  const auto found = constant_names_.find(constant.name);
  return found == constant_names_.end() ? "" : found->second;
}

Meaning Vocabulary::meaning(const std::string& written) const {
  if (const auto rate = rates_.find(written); rate != rates_.end())
    return {"rate(" + rate->second + ")", false};
  if (const auto signal = signal_names_.find(written); signal != signal_names_.end())
    return {signal->second, false};
  const auto constant = constant_names_.find(written);
  if (constant == constant_names_.end()) return {written, false};
  return {constant->second, std::holds_alternative<std::int64_t>(constants_.at(written)->value)};
}

std::string Vocabulary::note(const std::string& written) const {
  if (const auto rate = rates_.find(written); rate != rates_.end()) {
    return written + " is taken for the rate of " + rate->second +
           " within 2 s; the reference takes the best rate of the last few messages, so it sees "
           "silence later";
  }
  const auto signal = signal_names_.find(written);
  if (signal == signal_names_.end()) return "";
  const bool is_declared = std::any_of(signals_.begin(), signals_.end(),
                                       [&](const Signal& s) { return s.name == signal->second; });
  if (is_declared) return "";
  if (signal->second != written) {
    return written + " is called " + signal->second + " here; declare it: SIGNAL " +
           signal->second + " DIAGNOSTIC status KEY key";
  }
  if (written.ends_with("_heartbeat_freq")) {
    return written +
           " has no equivalent and is looked up on the robot by name; alive(component) "
           "says whether a node still answers";
  }
  if (written.ends_with(kFrequency)) {
    return written +
           " names no topic of a known namespace and is looked up on the robot by name; "
           "if it is a topic's frequency, write rate(/namespace/topic)";
  }
  if (written.ends_with("_lc_state")) {
    return written +
           " is looked up on the robot by name; lifecycle(component) gives \"active\" and "
           "the like";
  }
  return written + " is looked up on the robot: as the key of a diagnostic, or <hardware id>_<key>";
}

}  // namespace culprit::foreign
