#include "journal/json.h"

#include <array>

#include "knowledge/component_states.h"

namespace culprit::journal {
namespace {

constexpr std::array kOutcomes = {Outcome::kDone, Outcome::kRefused, Outcome::kUnreachable,
                                  Outcome::kTimedOut};
constexpr std::array kTransitions = {Transition::kConfigure, Transition::kCleanup,
                                     Transition::kActivate, Transition::kDeactivate};
constexpr std::array kLifecycles = {Lifecycle::kUnknown,   Lifecycle::kUnconfigured,
                                    Lifecycle::kInactive,  Lifecycle::kActive,
                                    Lifecycle::kFinalized, Lifecycle::kTransition};

std::string word_of(Transition transition) {
  return culprit::to_string(Command{{}, {}, ChangeLifecycle{transition}, {}});
}

Json of_value(const Value& value) {
  return std::visit([](const auto& v) { return Json(v); }, value);
}

std::optional<Value> value_from(const Json& json) {
  if (json.is_boolean()) return json.get<bool>();
  if (json.is_number_float()) return json.get<double>();
  if (json.is_number_integer()) return json.get<std::int64_t>();
  if (json.is_string()) return json.get<std::string>();
  return std::nullopt;
}

struct RequestWriter {
  Json operator()(const ChangeLifecycle& r) const {
    return {{"change_lifecycle", word_of(r.transition)}};
  }
  Json operator()(const ReadLifecycle&) const { return {{"read_lifecycle", nullptr}}; }
  Json operator()(const SetParameter& r) const {
    return {{"set_parameter", {{"name", r.name}, {"value", of_value(r.value)}}}};
  }
  Json operator()(const ReadParameter& r) const { return {{"read_parameter", r.name}}; }
  Json operator()(const CallService& r) const {
    if (r.request.empty()) return {{"call_service", r.service}};
    return {{"call_service", {{"service", r.service}, {"request", r.request}}}};
  }
  Json operator()(const ChangeMode& r) const { return {{"change_mode", r.mode}}; }
  Json operator()(const ReadMode&) const { return {{"read_mode", nullptr}}; }
  Json operator()(const StopProcess& r) const { return {{"stop_process", r.pid}}; }
  Json operator()(const StartProcess&) const { return {{"start_process", nullptr}}; }
};

}  // namespace

std::string text_of(const Json& json, const char* key) {
  if (!json.is_object()) return "";
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

double number_of(const Json& json, const char* key, double otherwise) {
  if (!json.is_object()) return otherwise;
  const auto found = json.find(key);
  return found != json.end() && found->is_number() ? found->get<double>() : otherwise;
}

std::int64_t integer_of(const Json& json, const char* key, std::int64_t otherwise) {
  if (!json.is_object()) return otherwise;
  const auto found = json.find(key);
  return found != json.end() && found->is_number_integer() ? found->get<std::int64_t>() : otherwise;
}

bool flag_of(const Json& json, const char* key) {
  if (!json.is_object()) return false;
  const auto found = json.find(key);
  return found != json.end() && found->is_boolean() && found->get<bool>();
}

Json to_json(const decltype(Command::what)& request) {
  return std::visit(RequestWriter{}, request);
}

Expected<decltype(Command::what)> request_from_json(const Json& json) {
  using Request = decltype(Command::what);
  const Error unknown{"a request that this culprit does not know"};
  if (!json.is_object() || json.size() != 1) return unknown;
  const std::string& word = json.begin().key();
  const Json& what = json.begin().value();
  if (word == "stop_process" && what.is_number_integer())
    return Request(StopProcess{what.get<int>()});
  if (word == "start_process") return Request(StartProcess{});
  if (word == "set_parameter" && what.is_object()) {
    const auto value = value_from(what.value("value", Json()));
    if (value) return Request(SetParameter{text_of(what, "name"), *value});
  }
  if (word == "call_service" && what.is_object())
    return Request(CallService{text_of(what, "service"), text_of(what, "request")});
  if (!what.is_string()) return unknown;
  const std::string text = what.get<std::string>();
  if (word == "call_service") return Request(CallService{text});
  if (word == "change_mode") return Request(ChangeMode{text});
  for (const Transition transition : kTransitions) {
    if (word == "change_lifecycle" && text == word_of(transition))
      return Request(ChangeLifecycle{transition});
  }
  return unknown;
}

Json to_json(const decltype(Reply::value)& value) {
  if (const auto* v = std::get_if<Value>(&value)) return of_value(*v);
  if (const auto* state = std::get_if<Lifecycle>(&value))
    return {{"lifecycle", culprit::to_string(*state)}};
  return nullptr;
}

decltype(Reply::value) reading_from_json(const Json& json) {
  if (const auto value = value_from(json)) return *value;
  const std::string word = text_of(json, "lifecycle");
  for (const Lifecycle state : kLifecycles) {
    if (word == culprit::to_string(state)) return state;
  }
  return {};
}

std::string_view to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::kDone:
      return "done";
    case Outcome::kRefused:
      return "refused";
    case Outcome::kUnreachable:
      return "unreachable";
    case Outcome::kTimedOut:
      return "timed_out";
  }
  return "";
}

std::optional<Outcome> outcome_from(std::string_view word) {
  for (const Outcome outcome : kOutcomes) {
    if (word == to_string(outcome)) return outcome;
  }
  return std::nullopt;
}

}  // namespace culprit::journal
