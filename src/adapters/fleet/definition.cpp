#include "fleet/definition.h"

#include "fleet/clean.h"
#include "journal/entry.h"

namespace culprit::fleet {
namespace {

std::string text_of(const Program& program) {
  std::string text;
  for (const Instruction& each : program.code) {
    text += std::to_string(static_cast<int>(each.op)) + ":";
    if (each.op != Op::kConstant) {
      text += std::to_string(each.operand);
    } else if (each.operand < program.constants.size()) {
      const Constant& constant = program.constants[each.operand];
      text += constant.text + "/" + std::to_string(constant.slot.i);
    }
    text += " ";
  }
  return text;
}

}  // namespace

std::string definition_of(const Strategy& strategy, const RuleSet& rules) {
  std::string text;
  for (const Adaptation& each : strategy.adaptations)
    text += (each.begins_step ? "THEN " : "") + rules[each.component].name + "|" +
            std::to_string(static_cast<int>(each.type)) + "|" + each.subject + "|" + each.topic +
            "|" + each.request + "|" + text_of(each.value) + "\n";
  journal::Hasher hasher;
  return journal::to_hex(hasher.of(text)).substr(0, 16);
}

std::map<StrategyName, std::string> definitions_of(const RuleSet& rules) {
  std::map<StrategyName, std::string> all;
  for (const Strategy& strategy : rules.strategies)
    all[{clean(rules[strategy.rule].name), clean(strategy.name)}] = definition_of(strategy, rules);
  return all;
}

}  // namespace culprit::fleet
