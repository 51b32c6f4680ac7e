#include "knowledge/plotted_values.h"

#include <cmath>
#include <limits>

#include "knowledge/describe.h"

namespace culprit {
namespace {

constexpr float kUnplotted = std::numeric_limits<float>::quiet_NaN();
constexpr double kSilentAfter = 3;  // usual intervals

float plotted_value(const Slot& slot, const Input& input) {
  if (!slot.known) return kUnplotted;
  switch (input.type) {
    case Type::kBool:
      return slot.b ? 1 : 0;
    case Type::kDuration:
      return static_cast<float>(seconds(Duration(slot.i)));
    case Type::kInt:
      return static_cast<float>(slot.i);
    case Type::kString:
      return kUnplotted;
    case Type::kDouble:
      return std::isfinite(slot.d) ? static_cast<float>(slot.d) : kUnplotted;
  }
  return kUnplotted;
}

}  // namespace

std::vector<std::string> plotted_names(const RuleSet& rules) {
  std::vector<std::string> names;
  for (const Topic& topic : rules.topics) {
    names.push_back("rate " + topic.name);
    names.push_back("age " + topic.name);
  }
  for (const Input& input : rules.inputs) names.push_back("input " + describe(input, rules));
  return names;
}

std::vector<float> plotted_values(const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  std::vector<float> values;
  values.reserve(2 * rules.topics.size() + rules.inputs.size());
  for (std::size_t t = 0; t < rules.topics.size(); ++t) {
    const SignalStore::Rhythm& rhythm = knowledge.signals.rhythm(TopicId(t));
    const double age = rhythm.last ? seconds(knowledge.now - *rhythm.last) : kUnplotted;
    const double interval = seconds(rhythm.interval);
    const bool is_silent = rhythm.last && age > kSilentAfter * interval;
    values.push_back(interval <= 0 ? kUnplotted : is_silent ? 0 : static_cast<float>(1 / interval));
    values.push_back(static_cast<float>(age));
  }
  for (std::size_t i = 0; i < rules.inputs.size(); ++i)
    values.push_back(plotted_value(knowledge.signals[InputId(i)], rules.inputs[i]));
  return values;
}

}  // namespace culprit
