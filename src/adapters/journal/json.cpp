#include "journal/json.h"

#include <array>

#include "knowledge/component_states.h"
#include "knowledge/describe.h"

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

class EventWriter {
 public:
  explicit EventWriter(const RuleSet& rules) : rules_(rules) {}

  Json operator()(const FailureDetected& e) const {
    return {{"type", "failure_detected"},
            {"rule", name(e.rule)},
            {"criticality", culprit::to_string(rules_[e.rule].policies.criticality)}};
  }
  Json operator()(const FailureResolved& e) const {
    Json json = {{"type", "failure_resolved"}, {"rule", name(e.rule)}};
    if (e.strategy) json["strategy"] = name(*e.strategy);
    json["reaction_s"] = seconds(e.reaction);
    return json;
  }
  Json operator()(const FailureLost& e) const {
    return {{"type", "failure_lost"}, {"rule", name(e.rule)}};
  }
  Json operator()(const StrategyChosen& e) const {
    Json json = of_strategy("strategy_chosen", e.strategy);
    json["dry_run"] = e.dry_run;
    json["components"] = Json::array();
    for (const ComponentId component : rules_[e.strategy].components)
      json["components"].push_back(name(component));
    json["explains"] = Json::array();
    for (const RuleId rule : e.explains) json["explains"].push_back(name(rule));
    json["suspects"] = suspects(e.suspects);
    json["candidates"] = candidates(e.candidates);
    return json;
  }
  Json operator()(const FailureHeldBack& e) const {
    return {{"type", "failure_held_back"},
            {"rule", name(e.rule)},
            {"suspects", suspects(e.suspects)},
            {"candidates", candidates(e.candidates)}};
  }
  Json operator()(const AdaptationDone& e) const {
    Json json = of_adaptation("adaptation_done", e.strategy, e.adaptation);
    if (!e.remark.empty()) json["remark"] = e.remark;
    return json;
  }
  Json operator()(const AdaptationFailed& e) const {
    Json json = of_adaptation("adaptation_failed", e.strategy, e.adaptation);
    json["reason"] = e.reason;
    return json;
  }
  Json operator()(const StrategyFailed& e) const {
    Json json = of_strategy("strategy_failed", e.strategy);
    json["reason"] = e.reason;
    return json;
  }
  Json operator()(const StrategyResumed& e) const {
    return of_strategy("strategy_resumed", e.strategy);
  }
  Json operator()(const Undone& e) const {
    Json json = of_strategy("undone", e.strategy);
    json["what"] = e.what;
    json["succeeded"] = e.succeeded;
    return json;
  }
  Json operator()(const RoundSpent& e) const {
    return {{"type", "round_spent"}, {"rule", name(e.rule)}};
  }
  Json operator()(const RuleExhausted& e) const {
    return {{"type", "rule_exhausted"}, {"rule", name(e.rule)}};
  }
  Json operator()(const ComponentLost& e) const {
    return {{"type", "component_lost"}, {"component", name(e.component)}, {"remark", e.remark}};
  }
  Json operator()(const ComponentFound& e) const {
    return {{"type", "component_found"}, {"component", name(e.component)}, {"pid", e.pid}};
  }
  Json operator()(const NeverSeen& e) const {
    Json json = std::visit([this](auto id) { return named(id); }, e.what);
    json["type"] = "never_seen";
    if (!e.near.empty()) json["near"] = e.near;
    return json;
  }
  Json operator()(const LifecycleIntended& e) const {
    return {{"type", "lifecycle_intended"},
            {"component", name(e.component)},
            {"lifecycle", culprit::to_string(e.state)}};
  }
  Json operator()(const CameUp& e) const {
    return {{"type", "came_up"},
            {"component", name(e.component)},
            {"driver", e.how.driver == ComingUp::Driver::kOther     ? "other"
                       : e.how.driver == ComingUp::Driver::kCulprit ? "culprit"
                                                                    : "unknown"},
            {"joining_ns", e.how.joining.count()},
            {"rising_ns", e.how.rising.count()}};
  }
  Json operator()(const RivalSeen& e) const {
    return {{"type", "rival_seen"}, {"component", name(e.component)}};
  }
  Json operator()(const Trouble& e) const { return {{"type", "trouble"}, {"what", e.text}}; }
  Json operator()(const OrderAccepted& e) const { return of_order("order_accepted", e.order); }
  Json operator()(const OrderRefused& e) const {
    Json json = of_order("order_refused", e.order);
    json["refused_because"] = e.reason;
    return json;
  }
  Json operator()(const ActionHeldBack& e) const {
    Json json = of_strategy("action_held_back", e.strategy);
    json["reason"] = e.reason;
    return json;
  }
  Json operator()(const ApprovalAsked& e) const {
    Json json = of_strategy("approval_asked", e.strategy);
    json["suspects"] = suspects(e.suspects);
    json["candidates"] = candidates(e.candidates);
    return json;
  }
  Json operator()(const ApprovalLapsed& e) const {
    return of_strategy("approval_lapsed", e.strategy);
  }
  Json operator()(const StrategyAbandoned& e) const {
    Json json = of_strategy("strategy_abandoned", e.strategy);
    json["reason"] = e.reason;
    return json;
  }
  Json operator()(const OrderCarriedOut& e) const {
    return of_strategy("order_carried_out", e.strategy);
  }
  Json operator()(const SilenceEnded&) const { return {{"type", "silence_ended"}}; }
  Json operator()(const StormBegan& e) const {
    return {{"type", "storm_began"}, {"reason", e.reason}};
  }
  Json operator()(const StormEnded&) const { return {{"type", "storm_ended"}}; }
  Json operator()(const OutcomePending& e) const {
    Json json = of_strategy("outcome_pending", e.strategy);
    json["helped"] = e.has_helped;
    json["due"] = e.due.time_since_epoch().count();
    return json;
  }
  Json operator()(const OutcomeCounted& e) const {
    Json json = of_strategy("outcome_counted", e.strategy);
    json["as"] = culprit::to_string(e.as);
    return json;
  }
  Json operator()(const FailureFlaps& e) const {
    return {{"type", "failure_flaps"}, {"rule", name(e.rule)}, {"times", e.times}};
  }
  Json operator()(const JudgementSuspended& e) const {
    return {{"type", "judgement_suspended"}, {"reason", e.reason}};
  }
  Json operator()(const JudgementResumed&) const { return {{"type", "judgement_resumed"}}; }
  Json operator()(const SleepNoticed& e) const {
    return {{"type", "sleep_noticed"}, {"time_ns", e.time.count()}};
  }
  Json operator()(const LastResortReached& e) const {
    return {{"type", "last_resort_reached"}, {"rule", name(e.rule)}};
  }

 private:
  struct WordOfOrder {
    const char* operator()(const Pause&) const { return "pause"; }
    const char* operator()(const Resume&) const { return "resume"; }
    const char* operator()(const SetDryRun& o) const { return o.is_on ? "dry_run" : "act"; }
    const char* operator()(const Approve&) const { return "approve"; }
    const char* operator()(const Refuse&) const { return "refuse"; }
    const char* operator()(const Silence&) const { return "silence"; }
    const char* operator()(const LiftSilence&) const { return "lift_silence"; }
    const char* operator()(const RunStrategy&) const { return "run_strategy"; }
    const char* operator()(const Forget&) const { return "forget"; }
  };
  Json named(ComponentId id) const { return {{"component", name(id)}}; }
  Json named(TopicId id) const { return {{"topic", name(id)}}; }
  Json named(SignalId id) const { return {{"signal", name(id)}}; }
  Json named(ParameterId id) const {
    return {{"component", name(rules_[id].component)}, {"parameter", name(id)}};
  }
  Json named(DiagnosticId id) const { return {{"diagnostic", rules_.diagnostics[id.index].name}}; }
  Json of_order(const char* type, const Order& order) const {
    Json json = {{"type", type},
                 {"order", std::visit(WordOfOrder{}, order.what)},
                 {"number", order.number},
                 {"author", order.author},
                 {"reason", order.reason}};
    if (const auto* silence = std::get_if<Silence>(&order.what)) {
      add_target(json, silence->what);
      if (silence->lasts) json["lasts_ns"] = silence->lasts->count();
    } else if (const auto* lift = std::get_if<LiftSilence>(&order.what)) {
      add_target(json, lift->what);
    } else if (const auto* run = std::get_if<RunStrategy>(&order.what)) {
      // An order that is refused may be about what does not exist.
      if (run->strategy.index >= rules_.strategies.size()) return json;
      json["rule"] = name(rules_[run->strategy].rule);
      json["strategy"] = name(run->strategy);
    }
    return json;
  }
  void add_target(Json& json, const Silenceable& what) const {
    const auto* rule = std::get_if<RuleId>(&what);
    const auto* component = std::get_if<ComponentId>(&what);
    if (rule != nullptr && rule->index < rules_.rules.size()) json["rule"] = name(*rule);
    if (component != nullptr && component->index < rules_.components.size())
      json["component"] = name(*component);
  }
  template <class Id>
  const std::string& name(Id id) const {
    return rules_[id].name;
  }
  Json of_strategy(const char* type, StrategyId strategy) const {
    return {{"type", type}, {"rule", name(rules_[strategy].rule)}, {"strategy", name(strategy)}};
  }
  Json of_adaptation(const char* type, StrategyId strategy, std::size_t adaptation) const {
    Json json = of_strategy(type, strategy);
    json["adaptation"] = adaptation;
    return json;
  }
  Json suspects(const std::vector<Suspect>& all) const {
    Json json = Json::array();
    for (const Suspect& suspect : all)
      json.push_back({{"component", name(suspect.component)},
                      {"failure", name(suspect.failure)},
                      {"probability", suspect.probability}});
    return json;
  }
  Json candidates(const std::vector<Candidate>& all) const {
    Json json = Json::array();
    for (const Candidate& candidate : all) {
      Json entry = {{"strategy", name(candidate.strategy)}, {"cost", candidate.cost}};
      if (candidate.resolves > 0) entry["resolves"] = candidate.resolves;
      if (candidate.value > 0) entry["value"] = candidate.value;
      if (candidate.excluded) {
        entry["excluded"] = culprit::to_string(*candidate.excluded);
        entry["because"] = describe_exclusion(candidate, rules_);
      }
      json.push_back(std::move(entry));
    }
    return json;
  }

  const RuleSet& rules_;
};

struct RequestWriter {
  Json operator()(const ChangeLifecycle& r) const {
    return {{"change_lifecycle", word_of(r.transition)}};
  }
  Json operator()(const ReadLifecycle&) const { return {{"read_lifecycle", nullptr}}; }
  Json operator()(const SetParameter& r) const {
    return {{"set_parameter", {{"name", r.name}, {"value", of_value(r.value)}}}};
  }
  Json operator()(const ReadParameter& r) const { return {{"read_parameter", r.name}}; }
  Json operator()(const CallService& r) const { return {{"call_service", r.service}}; }
  Json operator()(const ChangeMode& r) const { return {{"change_mode", r.mode}}; }
  Json operator()(const ReadMode&) const { return {{"read_mode", nullptr}}; }
  Json operator()(const StopProcess& r) const { return {{"stop_process", r.pid}}; }
  Json operator()(const StartProcess&) const { return {{"start_process", nullptr}}; }
};

}  // namespace

std::string to_text(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json from_text(std::string_view text) { return Json::parse(text, nullptr, false); }

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

Json to_json(const Event& event, const RuleSet& rules) {
  Json json = std::visit(EventWriter(rules), event.what);
  json["text"] = describe(event, rules);
  json["time"] = event.at.time_since_epoch().count();
  return json;
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
