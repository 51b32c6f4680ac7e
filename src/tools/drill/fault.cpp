#include "drill/fault.h"

#include <string>
#include <vector>

#include "base/closest.h"
#include "base/name_grammar.h"
#include "journal/json.h"
#include "language/foreign_words.h"

namespace culprit::drill {
namespace {

constexpr std::string_view kWords[] = {"kill",    "hang",          "slow", "deactivate",
                                       "restart", "set_parameter", "loss"};

}  // namespace

std::string_view word_of(FaultKind kind) { return kWords[static_cast<std::size_t>(kind)]; }

std::optional<FaultKind> fault_kind(std::string_view word) {
  for (const FaultKind kind : kFaultKinds) {
    if (word_of(kind) == word) return kind;
  }
  return std::nullopt;
}

std::string no_fault_kind(std::string_view word) {
  std::vector<std::string_view> known;
  std::string list;
  for (const FaultKind kind : kFaultKinds) {
    known.push_back(word_of(kind));
    list += (list.empty() ? "" : ", ") + std::string(known.back());
  }
  std::string near(clause_of_other_tools(word, known));
  if (near.empty()) near = closest(word, known);
  return "'" + printable(word) + "' is none of " + list +
         (near.empty() ? "" : "; did you mean '" + near + "'?");
}

bool acts_on_process(FaultKind kind) {
  return kind == FaultKind::kKill || kind == FaultKind::kHang || kind == FaultKind::kSlow ||
         kind == FaultKind::kLoss;
}

bool lasts(FaultKind kind) {
  return kind == FaultKind::kHang || kind == FaultKind::kSlow || kind == FaultKind::kLoss;
}

std::string to_string(const Fault& fault) {
  std::string text = std::string(word_of(fault.kind)) + " " + fault.component;
  if (fault.kind == FaultKind::kSetParameter)
    text += " " + fault.parameter + " " + culprit::to_string(fault.value);
  return text;
}

std::string to_string(const std::vector<Fault>& faults) {
  std::string text;
  for (const Fault& fault : faults) text += (text.empty() ? "" : " + ") + to_string(fault);
  return text;
}

Json value_to_json(const Value& value) {
  return std::visit([](const auto& each) { return Json(each); }, value);
}

std::optional<Value> value_from(const Json& json) {
  if (json.is_boolean()) return Value(json.get<bool>());
  if (json.is_number_integer()) return Value(json.get<std::int64_t>());
  if (json.is_number()) return Value(json.get<double>());
  if (json.is_string()) return Value(json.get<std::string>());
  return std::nullopt;
}

Json to_json(const Fault& fault) {
  Json json{{"kind", word_of(fault.kind)}, {"component", fault.component}};
  if (fault.kind == FaultKind::kSetParameter) {
    json["parameter"] = fault.parameter;
    json["value"] = value_to_json(fault.value);
  }
  return json;
}

std::optional<Fault> fault_from(const Json& json) {
  if (!json.is_object()) return std::nullopt;
  const auto kind = fault_kind(journal::text_of(json, "kind"));
  Fault fault{kind.value_or(FaultKind::kKill), journal::text_of(json, "component")};
  if (!kind || fault.component.empty()) return std::nullopt;
  if (fault.kind != FaultKind::kSetParameter) return fault;
  const auto value = json.contains("value") ? value_from(json["value"]) : std::nullopt;
  fault.parameter = journal::text_of(json, "parameter");
  if (!value || fault.parameter.empty()) return std::nullopt;
  fault.value = *value;
  return fault;
}

}  // namespace culprit::drill
