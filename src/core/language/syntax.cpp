#include "language/syntax.h"

#include <array>

namespace culprit::syntax {

std::vector<std::string_view> drill_faults() {
  return {"kill", "hang", "slow", "deactivate", "restart", "loss"};
}
namespace {

struct AdaptationKeyword {
  AdaptationType type;
  std::string_view keyword;
};
constexpr std::array kAdaptations = {
    AdaptationKeyword{AdaptationType::kSetParameter, "set_parameter"},
    AdaptationKeyword{AdaptationType::kIncreaseParameter, "increase_parameter"},
    AdaptationKeyword{AdaptationType::kDecreaseParameter, "decrease_parameter"},
    AdaptationKeyword{AdaptationType::kChangeCommunication, "change_communication"},
    AdaptationKeyword{AdaptationType::kActivate, "activate"},
    AdaptationKeyword{AdaptationType::kDeactivate, "deactivate"},
    AdaptationKeyword{AdaptationType::kRestart, "restart"},
    AdaptationKeyword{AdaptationType::kRedeploy, "redeploy"},
    AdaptationKeyword{AdaptationType::kStart, "start"},
    AdaptationKeyword{AdaptationType::kStop, "stop"},
    AdaptationKeyword{AdaptationType::kChangeMode, "change_mode"},
    AdaptationKeyword{AdaptationType::kCall, "call"},
    AdaptationKeyword{AdaptationType::kStartGroup, "start_group"},
};

}  // namespace

std::string_view keyword(AdaptationType type) {
  for (const auto& known : kAdaptations) {
    if (known.type == type) return known.keyword;
  }
  return "";
}

std::optional<AdaptationType> adaptation_type(std::string_view keyword) {
  for (const auto& known : kAdaptations) {
    if (known.keyword == keyword) return known.type;
  }
  return std::nullopt;
}

std::vector<std::string_view> adaptation_keywords() {
  std::vector<std::string_view> keywords;
  for (const auto& known : kAdaptations) keywords.push_back(known.keyword);
  return keywords;
}

bool names_parameter(AdaptationType type) {
  using enum AdaptationType;
  return type == kSetParameter || type == kIncreaseParameter || type == kDecreaseParameter ||
         type == kChangeCommunication;
}

bool File::has_reuse() const { return !includes.empty() || !templates.empty() || !uses.empty(); }

std::string_view symbol(Operator op) {
  switch (op) {
    case Operator::kNot:
      return "!";
    case Operator::kNegate:
    case Operator::kSubtract:
      return "-";
    case Operator::kMultiply:
      return "*";
    case Operator::kDivide:
      return "/";
    case Operator::kRemainder:
      return "%";
    case Operator::kPlus:
    case Operator::kAdd:
      return "+";
    case Operator::kLess:
      return "<";
    case Operator::kLessEqual:
      return "<=";
    case Operator::kGreater:
      return ">";
    case Operator::kGreaterEqual:
      return ">=";
    case Operator::kEqual:
      return "==";
    case Operator::kNotEqual:
      return "!=";
    case Operator::kAnd:
      return "&&";
    case Operator::kOr:
      return "||";
  }
  return "";
}

}  // namespace culprit::syntax
