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

void write_value(const Value& value, JsonWriter& json) {
  std::visit([&](const auto& v) { json.value(v); }, value);
}

std::optional<Value> value_from(const Json& json) {
  if (json.is_boolean()) return json.get<bool>();
  if (json.is_number_float()) return json.get<double>();
  if (json.is_number_integer()) return json.get<std::int64_t>();
  if (json.is_string()) return json.get<std::string>();
  return std::nullopt;
}

struct RequestWriter {
  JsonWriter& json;

  void operator()(const ChangeLifecycle& r) const {
    json.member("change_lifecycle", word_of(r.transition));
  }
  void operator()(const ReadLifecycle&) const { add_nothing("read_lifecycle"); }
  void operator()(const SetParameter& r) const {
    json.member("set_parameter", [&] {
      json.begin_object();
      json.member("name", r.name);
      json.member("value", [&] { write_value(r.value, json); });
      json.end_object();
    });
  }
  void operator()(const ReadParameter& r) const { json.member("read_parameter", r.name); }
  void operator()(const CallService& r) const {
    if (r.request.empty()) return json.member("call_service", r.service);
    json.member("call_service", [&] {
      json.begin_object();
      json.member("service", r.service);
      json.member("request", r.request);
      json.end_object();
    });
  }
  void operator()(const ChangeMode& r) const { json.member("change_mode", r.mode); }
  void operator()(const ReadMode&) const { add_nothing("read_mode"); }
  void operator()(const StopProcess& r) const { json.member("stop_process", r.pid); }
  void operator()(const StartProcess&) const { add_nothing("start_process"); }
  void operator()(const Probe&) const { add_nothing("probe"); }

 private:
  void add_nothing(const char* word) const {
    json.member(word, [&] { json.null(); });
  }
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

void write(const decltype(Command::what)& request, JsonWriter& json) {
  json.begin_object();
  std::visit(RequestWriter{json}, request);
  json.end_object();
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

void write(const decltype(Reply::value)& value, JsonWriter& json) {
  if (const auto* v = std::get_if<Value>(&value)) return write_value(*v, json);
  const auto* state = std::get_if<Lifecycle>(&value);
  if (state == nullptr) return json.null();
  json.begin_object();
  json.member("lifecycle", culprit::to_string(*state));
  json.end_object();
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
