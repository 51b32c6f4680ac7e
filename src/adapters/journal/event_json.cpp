#include "journal/event_json.h"

#include <algorithm>

#include "journal/requests.h"
#include "json/json_writer.h"
#include "knowledge/component_states.h"
#include "knowledge/describe.h"
#include "knowledge/event_words.h"

namespace culprit::journal {
namespace {

using What = EventWhat;

constexpr std::string_view word_of(ComingUp::Driver driver) {
  switch (driver) {
    case ComingUp::Driver::kOther:
      return "other";
    case ComingUp::Driver::kCulprit:
      return "culprit";
    case ComingUp::Driver::kUnknown:
      break;
  }
  return "unknown";
}

struct WordOfOrder {
  const char* operator()(const Pause&) const { return "pause"; }
  const char* operator()(const Resume&) const { return "resume"; }
  const char* operator()(const SetDryRun& o) const { return o.is_on ? "dry_run" : "act"; }
  const char* operator()(const Approve&) const { return "approve"; }
  const char* operator()(const Refuse&) const { return "refuse"; }
  const char* operator()(const Propose&) const { return "propose"; }
  const char* operator()(const Silence&) const { return "silence"; }
  const char* operator()(const LiftSilence&) const { return "lift_silence"; }
  const char* operator()(const RunStrategy&) const { return "run_strategy"; }
  const char* operator()(const Forget&) const { return "forget"; }
  const char* operator()(const Revive&) const { return "revive"; }
  const char* operator()(const EndStarted&) const { return "end_started"; }
};

// Writes the event's members, behind its type.
class EventWriter {
 public:
  EventWriter(Time at, const RuleSet& rules, JsonWriter& json)
      : at_(at), rules_(rules), json_(json) {}

  void operator()(const FailureDetected& e) const {
    about(e.rule);
    json_.member("criticality", culprit::to_string(rules_[e.rule].policies.criticality));
    if (e.known_dead) json_.member("known_dead", name(*e.known_dead));
  }
  void operator()(const FailureResolved& e) const {
    about(e.rule);
    if (e.strategy) json_.member("strategy", name(*e.strategy));
    json_.member("reaction_s", seconds(e.reaction));
  }
  void operator()(const FailureLost& e) const { about(e.rule); }
  void operator()(const StrategyChosen& e) const {
    about(e.strategy);
    json_.member("dry_run", e.dry_run);
    add_names("components", rules_[e.strategy].components);
    add_names("explains", e.explains);
    if (!e.also_ended.empty()) add_names("also_ended", e.also_ended);
    add_reasons(e.suspects, e.candidates);
  }
  void operator()(const FailureHeldBack& e) const {
    about(e.rule);
    add_reasons(e.suspects, e.candidates);
  }
  void operator()(const AdaptationDone& e) const {
    about(e.strategy);
    json_.member("adaptation", e.adaptation);
    if (!e.remark.empty()) json_.member("remark", e.remark);
  }
  void operator()(const AdaptationFailed& e) const {
    about(e.strategy);
    json_.member("adaptation", e.adaptation);
    json_.member("reason", e.reason);
  }
  void operator()(const StrategyFailed& e) const {
    about(e.strategy);
    json_.member("reason", e.reason);
  }
  void operator()(const StrategyResumed& e) const { about(e.strategy); }
  void operator()(const Undone& e) const {
    about(e.strategy);
    json_.member("what", e.what);
    json_.member("succeeded", e.succeeded);
  }
  void operator()(const RoundSpent& e) const { about(e.rule); }
  void operator()(const RuleExhausted& e) const { about(e.rule); }
  void operator()(const LastResortReached& e) const { about(e.rule); }
  void operator()(const LastResortDone& e) const { about(e.strategy); }
  void operator()(const ComponentLost& e) const {
    about(e.component);
    json_.member("remark", e.remark);
  }
  void operator()(const ComponentFound& e) const {
    about(e.component);
    json_.member("pid", e.pid);
  }
  void operator()(const StaysDown& e) const {
    add_names("components", e.components);
    json_.member("why", culprit::to_string(e.why));
    if (e.launcher != 0) json_.member("launcher", e.launcher);
    if (e.fell) json_.member("fell", name(*e.fell));
    if (e.why == StaysDown::Why::kDoubt) json_.member("after_ns", e.after.count());
  }
  void operator()(const NeverSeen& e) const {
    std::visit([this](auto id) { about(id); }, e.what);
    json_.member("type", words_of<NeverSeen>().name);
    if (!e.near.empty()) json_.member("near", e.near);
  }
  void operator()(const LifecycleIntended& e) const {
    about(e.component);
    json_.member("lifecycle", culprit::to_string(e.state));
    if (e.is_owed) json_.member("owed", true);
  }
  void operator()(const CameUp& e) const {
    about(e.component);
    json_.member("driver", word_of(e.how.driver));
    json_.member("joining_ns", e.how.joining.count());
    json_.member("rising_ns", e.how.rising.count());
  }
  void operator()(const RivalSeen& e) const { about(e.component); }
  void operator()(const Trouble& e) const { json_.member("what", e.text); }
  void operator()(const OrderAccepted& e) const {
    add(e.order);
    if (!e.holds_back.empty()) add_names("holds_back", e.holds_back);
  }
  void operator()(const OrderRefused& e) const {
    add(e.order);
    json_.member("refused_because", e.reason);
  }
  void operator()(const ActionHeldBack& e) const {
    about(e.strategy);
    json_.member("reason", e.reason);
    if (!e.candidates.empty()) add_reasons(e.suspects, e.candidates);
  }
  void operator()(const ApprovalAsked& e) const {
    about(e.strategy);
    add_reasons(e.suspects, e.candidates);
  }
  void operator()(const ApprovalLapsed& e) const { about(e.strategy); }
  void operator()(const StrategyAbandoned& e) const {
    about(e.strategy);
    json_.member("reason", e.reason);
  }
  void operator()(const OrderCarriedOut& e) const { about(e.strategy); }
  void operator()(const SilenceEnded&) const {}
  void operator()(const StormBegan& e) const { json_.member("reason", e.reason); }
  void operator()(const StormEnded&) const {}
  void operator()(const OutcomePending& e) const {
    about(e.strategy);
    json_.member("helped", e.has_helped);
    json_.member("due", e.due.time_since_epoch().count());
  }
  void operator()(const OutcomeCounted& e) const {
    about(e.strategy);
    json_.member("as", culprit::to_string(e.as));
  }
  void operator()(const FailureFlaps& e) const {
    about(e.rule);
    json_.member("times", e.times);
  }
  void operator()(const JudgementSuspended& e) const { json_.member("reason", e.reason); }
  void operator()(const JudgementResumed&) const {}
  void operator()(const SleepNoticed& e) const { json_.member("time_ns", e.time.count()); }
  void operator()(const HostSilent& e) const {
    json_.member("host", e.host);
    add_names("components", e.components);
    if (e.is_last) json_.member("is_last", true);
  }
  void operator()(const HostBack& e) const { json_.member("host", e.host); }
  void operator()(const ValueUnknown& e) const {
    json_.member("input", describe(rules_[e.input], rules_));
    json_.member("reason", culprit::to_string(e.why));
  }
  void operator()(const RuleBlind& e) const {
    about(e.rule);
    json_.member("since", e.blind.since.time_since_epoch().count());
    json_.member("why", culprit::to_string(e.blind.why));
    if (!e.blind.input.empty()) json_.member("input", e.blind.input);
    if (!e.blind.near.empty()) json_.member("near", e.blind.near);
  }
  void operator()(const RuleSees& e) const {
    about(e.rule);
    json_.member("blind_for_ns", e.blind_for.count());
  }
  void operator()(const IncidentOpened& e) const { add(e.incident); }
  void operator()(const IncidentChanged& e) const { add(e.incident); }
  void operator()(const IncidentClosed& e) const {
    json_.member("incident", e.id);
    about(e.root);
    json_.member("how", culprit::to_string(e.how));
    if (!e.into.empty()) json_.member("into", e.into);
  }
  void operator()(const PriorsAdopted& e) const {
    json_.member("source", e.source);
    add_each("priors", e.priors, [this](const PriorsTold::Prior& each) {
      json_.begin_object();
      about(each.strategy);
      json_.member("alpha", each.alpha);
      json_.member("beta", each.beta);
      json_.end_object();
    });
  }

 private:
  void about(RuleId id) const { json_.member("rule", name(id)); }
  void about(StrategyId id) const {
    about(rules_[id].rule);
    json_.member("strategy", name(id));
  }
  void about(ComponentId id) const { json_.member("component", name(id)); }
  void about(TopicId id) const { json_.member("topic", name(id)); }
  void about(SignalId id) const { json_.member("signal", name(id)); }
  void about(ParameterId id) const {
    about(rules_[id].component);
    json_.member("parameter", name(id));
  }
  void about(DiagnosticId id) const {
    json_.member("diagnostic", rules_.diagnostics[id.index].name);
  }
  void add(const Order& order) const {
    json_.member("order", std::visit(WordOfOrder{}, order.what));
    json_.member("number", order.number);
    json_.member("author", order.author);
    json_.member("reason", order.reason);
    if (const auto* silence = std::get_if<Silence>(&order.what)) {
      add_target(silence->what);
      if (silence->lasts) json_.member("lasts_ns", silence->lasts->count());
    } else if (const auto* lift = std::get_if<LiftSilence>(&order.what)) {
      add_target(lift->what);
    } else if (const auto* run = std::get_if<RunStrategy>(&order.what)) {
      // An order that is refused may be about what does not exist.
      if (run->strategy.index < rules_.strategies.size()) about(run->strategy);
    }
  }
  void add(const Incident& incident) const {
    json_.member("incident", incident.id);
    about(incident.root);
    add_names("consequences", incident.consequences);
    add_names("components", incident.components);
    if (!incident.host.empty()) json_.member("host", incident.host);
    json_.member("certain", incident.is_certain);
    json_.member("suspected", incident.is_suspected);
    json_.member("age_ns", (at_ - incident.since).count());
    json_.member("criticality", culprit::to_string(incident.criticality));
    json_.member("exhausted", incident.is_exhausted);
    json_.member("needs_person", incident.needs_person());
    if (!incident.condition.empty()) json_.member("condition", incident.condition);
    json_.member("headline", incident.headline);
  }
  void add_target(const Silenceable& what) const {
    const auto* rule = std::get_if<RuleId>(&what);
    const auto* component = std::get_if<ComponentId>(&what);
    if (rule != nullptr && rule->index < rules_.rules.size()) about(*rule);
    if (component != nullptr && component->index < rules_.components.size()) about(*component);
  }
  void add_reasons(const std::vector<Suspect>& suspects,
                   const std::vector<Candidate>& candidates) const {
    add_each("suspects", suspects, [this](const Suspect& suspect) {
      json_.begin_object();
      json_.member("component", name(suspect.component));
      json_.member("failure", name(suspect.failure));
      json_.member("probability", suspect.probability);
      if (!suspect.evidence.empty())
        add_each("evidence", suspect.evidence, [this](const Evidence& each) { add(each); });
      json_.end_object();
    });
    add_each("candidates", candidates, [this](const Candidate& candidate) { add(candidate); });
  }
  void add(const Evidence& evidence) const {
    json_.begin_object();
    json_.member("source", culprit::to_string(evidence.source));
    json_.member("text", evidence.text);
    if (evidence.age) json_.member("age_ns", evidence.age->count());
    json_.member("log_odds", evidence.log_odds);
    if (!evidence.without.empty()) json_.member("without", evidence.without);
    json_.end_object();
  }
  void add(const Candidate& candidate) const {
    json_.begin_object();
    json_.member("strategy", name(candidate.strategy));
    json_.member("cost", candidate.cost);
    if (candidate.resolves > 0) json_.member("resolves", candidate.resolves);
    if (candidate.value > 0) json_.member("value", candidate.value);
    if (candidate.excluded) {
      json_.member("excluded", culprit::to_string(*candidate.excluded));
      json_.member("because", describe_exclusion(candidate, rules_));
      const std::string end = describe_end_of_wait(candidate, rules_);
      if (!end.empty()) json_.member("ends", end);
    }
    json_.end_object();
  }
  template <class Ids>
  void add_names(const char* key, const Ids& ids) const {
    add_each(key, ids, [this](auto id) { json_.value(name(id)); });
  }
  template <class All, class Write>
  void add_each(const char* key, const All& all, const Write& write) const {
    json_.key(key);
    json_.begin_array();
    for (const auto& each : all) write(each);
    json_.end_array();
  }
  template <class Id>
  const std::string& name(Id id) const {
    return rules_[id].name;
  }

  const Time at_;
  const RuleSet& rules_;
  JsonWriter& json_;
};

class EventReader {
 public:
  EventReader(const Json& json, const RuleSet& rules)
      : json_(json),
        rules_(rules),
        rule_(find_rule(rules, text_of(json, "rule"))),
        strategy_(find_strategy(rules, text_of(json, "rule"), text_of(json, "strategy"))),
        component_(find_component(rules, text_of(json, "component"))) {}

  std::optional<What> read(EventKind kind) const {
    return read(kind, std::make_index_sequence<std::variant_size_v<What::Variant>>());
  }

 private:
  template <std::size_t... kKinds>
  std::optional<What> read(EventKind kind, std::index_sequence<kKinds...>) const {
    std::optional<What> what;
    (void)((kKinds == kind &&
            (what = read<std::variant_alternative_t<kKinds, What::Variant>>(), true)) ||
           ...);
    return what;
  }

  // Every event names its subject by the same members.
  template <class T>
  std::optional<What> read() const {
    T event{};
    if constexpr (requires { event.rule; }) {
      if (!rule_) return std::nullopt;
      event.rule = *rule_;
    }
    if constexpr (requires { event.strategy.index; }) {
      if (!strategy_) return std::nullopt;
      event.strategy = *strategy_;
    }
    if constexpr (requires { event.component; }) {
      if (!component_) return std::nullopt;
      event.component = *component_;
    }
    if (!complete(event)) return std::nullopt;
    return event;
  }

  // Reads the other members of the row; false if a member is missing that the event needs.
  template <class T>
  bool complete(T& event) const {
    if constexpr (requires { event.adaptation; }) {
      const std::int64_t adaptation = integer_of(json_, "adaptation", -1);
      const auto count = static_cast<std::int64_t>(rules_[event.strategy].adaptations.size());
      if (adaptation < 0 || adaptation >= count) return false;
      event.adaptation = static_cast<std::size_t>(adaptation);
    }
    return true;
  }
  // By which strategy may be one that is no longer there.
  bool complete(FailureResolved& event) const {
    using How = FailureResolved::How;
    event.how = strategy_ ? How::kByStrategy : How::kWithoutStrategy;
    event.strategy = strategy_;
    return true;
  }
  bool complete(StrategyChosen& event) const {
    event.dry_run = flag_of(json_, "dry_run");
    return true;
  }
  bool complete(Undone& event) const {
    event.succeeded = flag_of(json_, "succeeded");
    return true;
  }
  bool complete(ComponentFound& event) const {
    const std::int64_t pid = integer_of(json_, "pid");
    event.pid = static_cast<int>(pid);
    return pid > 0 && pid <= INT32_MAX;
  }
  bool complete(LifecycleIntended& event) const {
    const auto reading = reading_from_json(json_);
    const auto* state = std::get_if<Lifecycle>(&reading);
    if (state != nullptr) event.state = *state;
    event.is_owed = flag_of(json_, "owed");
    return state != nullptr;
  }
  bool complete(CameUp& event) const {
    using Driver = ComingUp::Driver;
    const std::string driver = text_of(json_, "driver");
    for (const Driver each : {Driver::kOther, Driver::kCulprit}) {
      if (driver == word_of(each)) event.how.driver = each;
    }
    event.how.joining = duration("joining_ns");
    event.how.rising = duration("rising_ns");
    return true;
  }
  bool complete(StaysDown& event) const {
    const auto why = reason_named(text_of(json_, "why"));
    const auto names = json_.find("components");
    if (!why || names == json_.end() || !names->is_array()) return false;
    event.why = *why;
    for (const Json& each : *names) {
      const auto component =
          each.is_string() ? find_component(rules_, each.get<std::string>()) : std::nullopt;
      if (component) event.components.push_back(*component);
    }
    event.launcher =
        static_cast<int>(std::clamp<std::int64_t>(integer_of(json_, "launcher"), 0, INT32_MAX));
    event.fell = find_component(rules_, text_of(json_, "fell"));
    event.after = duration("after_ns");
    return !event.components.empty();
  }
  bool complete(OutcomePending& event) const {
    event.has_helped = flag_of(json_, "helped");
    event.due = Time(Duration(integer_of(json_, "due")));
    return true;
  }
  bool complete(OutcomeCounted& event) const {
    using As = OutcomeCounted::As;
    for (const As as : {As::kSuccess, As::kFailure}) {
      if (text_of(json_, "as") == culprit::to_string(as)) event.as = as;
    }
    return true;
  }
  bool complete(FailureFlaps& event) const {
    event.times =
        static_cast<int>(std::clamp<std::int64_t>(integer_of(json_, "times"), 0, INT32_MAX));
    return true;
  }
  bool complete(SleepNoticed& event) const {
    event.time = duration("time_ns");
    return true;
  }
  bool complete(OrderAccepted& event) const { return complete(event.order); }
  bool complete(OrderRefused& event) const { return complete(event.order); }
  bool complete(ActionHeldBack&) const { return false; }   // by which restraint?
  bool complete(SilenceEnded&) const { return false; }     // of what?
  bool complete(NeverSeen&) const { return false; }        // each run detects it by itself
  bool complete(PriorsAdopted&) const { return false; }    // likewise
  bool complete(HostSilent&) const { return false; }       // likewise
  bool complete(HostBack&) const { return false; }         // likewise
  bool complete(ValueUnknown&) const { return false; }     // likewise
  bool complete(IncidentOpened&) const { return false; }   // likewise
  bool complete(IncidentChanged&) const { return false; }  // likewise
  bool complete(IncidentClosed&) const { return false; }   // likewise
  bool complete(RuleBlind& event) const {
    const auto why = unseen_named(text_of(json_, "why"));
    if (!why) return false;
    event.blind = {Time(Duration(integer_of(json_, "since"))), *why, text_of(json_, "input"),
                   text_of(json_, "near")};
    return true;
  }
  bool complete(RuleSees& event) const {
    event.blind_for = duration("blind_for_ns");
    return true;
  }

  bool complete(Order& order) const {
    order.author = text_of(json_, "author");
    order.reason = text_of(json_, "reason");
    Silence silence;
    if (rule_) {
      silence.what = *rule_;
    } else if (component_) {
      silence.what = *component_;
    }
    if (json_.contains("lasts_ns")) silence.lasts = duration("lasts_ns");
    std::vector<decltype(Order::what)> all = {Pause{},          Resume{}, SetDryRun{true},
                                              SetDryRun{false}, Revive{}, EndStarted{}};
    if (rule_ || component_) {
      all.emplace_back(silence);
      all.emplace_back(LiftSilence{silence.what});
    }
    if (strategy_) all.emplace_back(RunStrategy{*strategy_});
    const std::string word = text_of(json_, "order");
    const auto meant = std::find_if(all.begin(), all.end(), [&](const auto& each) {
      return word == std::visit(WordOfOrder{}, each);
    });
    if (meant != all.end()) order.what = *meant;
    return meant != all.end();
  }

  Duration duration(const char* key) const {
    return Duration(std::max<std::int64_t>(0, integer_of(json_, key)));
  }

  const Json& json_;
  const RuleSet& rules_;
  const std::optional<RuleId> rule_;
  const std::optional<StrategyId> strategy_;
  const std::optional<ComponentId> component_;
};

}  // namespace

std::string line_of(const Event& event, const RuleSet& rules) {
  constexpr std::size_t kUsual = 700;
  std::string line;
  line.reserve(kUsual);
  JsonWriter json(line);
  json.begin_object();
  // On disk their type comes after the names.
  if (!std::holds_alternative<NeverSeen>(event.what)) json.member("type", words_of(event).name);
  std::visit(EventWriter(event.at, rules, json), event.what);
  json.member("text", describe(event, rules));
  json.member("time", event.at.time_since_epoch().count());
  json.end_object();
  return line;
}

Json to_json(const Event& event, const RuleSet& rules) { return parse_json(line_of(event, rules)); }

std::optional<Event> event_from_json(const Json& json, const RuleSet& rules) {
  const auto kind = kind_named(text_of(json, "type"));
  if (!kind) return std::nullopt;
  auto what = EventReader(json, rules).read(*kind);
  if (!what) return std::nullopt;
  return Event{Time(Duration(integer_of(json, "time"))), std::move(*what)};
}

}  // namespace culprit::journal
