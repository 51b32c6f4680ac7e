#include "rca_study/scenario_json.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/core.h>

#include "json/json.h"
#include "language/checker.h"
#include "rca_study/factors.h"
#include "rca_study/rules.h"
#include "study/json_fields.h"

namespace culprit::study::rca {
namespace {

constexpr std::string_view kFormat = "culprit-rca 1";
constexpr std::size_t kMostTopics = 100'000;
constexpr std::size_t kMostEnds = 1'000'000;
constexpr std::size_t kMostWays = 10'000'000;  // publishers times subscribers
constexpr std::size_t kMostFaults = 100;
constexpr double kMostSeconds = 3600;

constexpr std::array kRepairNames = {Repair::kConfigure, Repair::kRestart, Repair::kRedeploy};
constexpr std::array kLevels = {Criticality::kNonCritical, Criticality::kWarning,
                                Criticality::kError};

const char* level_name(Criticality level) {
  constexpr std::array kNames = {"NON_CRITICAL", "WARNING", "ERROR"};
  return kNames[static_cast<std::size_t>(level)];
}

// ---- writing

Json json_of(const Treatment& t) {
  Json helps = Json::object();
  for (std::size_t k = 0; k < kFaultKinds; ++k)
    helps[std::string(to_string(static_cast<FaultKind>(k)))] = t.helps[k];
  return {{"repair", to_string(t.repair)}, {"success", t.success},
          {"confidence", t.confidence},    {"impact", t.impact},
          {"takes_s", t.takes_s},          {"helps", std::move(helps)}};
}

Json json_of(const RcaComponent& c) {
  Json treatments = Json::array();
  for (const Treatment& t : c.treatments) treatments.push_back(json_of(t));
  Json json{{"name", c.name},
            {"criticality", level_name(c.criticality)},
            {"detector",
             {{"latency_s", c.detector.latency_s},
              {"miss", c.detector.miss},
              {"false_alarm", c.detector.false_alarm}}},
            {"treatments", std::move(treatments)}};
  if (c.detector.false_alarms_per_min > 0)
    json["detector"]["false_alarms_per_min"] = c.detector.false_alarms_per_min;
  if (c.is_unwatched) json["unwatched"] = true;
  return json;
}

Json json_of(const RcaTopic& topic, const RcaScenario& scenario) {
  Json publishers = Json::array();
  for (const std::size_t p : topic.publishers) publishers.push_back(scenario.components[p].name);
  Json subscribers = Json::array();
  for (const Subscription& s : topic.subscribers) {
    Json& json = subscribers.emplace_back(Json{{"component", scenario.components[s.component].name},
                                               {"passes", s.passes},
                                               {"delay_s", s.delay_s},
                                               {"redundant", s.is_redundant}});
    if (s.is_hidden) json["hidden"] = true;
  }
  Json json{{"name", topic.name},
            {"publishers", std::move(publishers)},
            {"subscribers", std::move(subscribers)}};
  if (topic.is_ignored) json["ignored"] = true;
  return json;
}

// ---- reading

class Reader {
 public:
  Expected<RcaScenario> read(const std::string& text) {
    const Json json = parse_json(text);
    if (json.is_discarded()) return Error{"it is no JSON"};
    JsonFields fields(json);
    if (fields.text("format") != kFormat)
      return Error{fmt::format("it is no scenario: its format is not \"{}\"", kFormat)};
    scenario_.seed = fields.natural("seed", UINT64_MAX);
    scenario_.reading_s = number(fields, "reading_s", 0.01, 10);
    scenario_.horizon_s = number(fields, "horizon_s", 1, kMostSeconds);
    each(fields, "components", kMostComponents, [&](JsonFields& f) { component(f); });
    each(fields, "topics", kMostTopics, [&](JsonFields& f) { topic(f); });
    each(fields, "faults", kMostFaults, [&](JsonFields& f) { fault(f); });
    if (fields.has("common_causes"))
      each(fields, "common_causes", kMostFaults, [&](JsonFields& f) { common_cause(f); });
    const auto& all = scenario_.components;
    if (std::all_of(all.begin(), all.end(), [](const RcaComponent& c) { return c.is_unwatched; }))
      fields.complain("components", all.empty() ? "is empty" : "has only unwatched ones");
    if (!fields.complaint().empty()) return Error{fields.complaint()};
    // The names become names of rules.
    const Checked checked = check(Source("scenario.rules", rules_text(scenario_)));
    for (const Diagnostic& d : checked.diagnostics) {
      if (d.severity == Severity::kError) return Error{"no rules can be made of it: " + d.cause};
    }
    return std::move(scenario_);
  }

 private:
  template <class Read>
  void each(JsonFields& fields, const std::string& name, std::size_t most, Read read) {
    const Json& all = fields.array(name);
    if (all.size() > most) return fields.complain(name, "has more than " + std::to_string(most));
    for (std::size_t i = 0; i < all.size(); ++i) {
      JsonFields inside(all[i]);
      read(inside);
      if (inside.complaint().empty()) continue;
      return fields.complain_inside(fmt::format("{}[{}]", name, i), inside.complaint());
    }
  }

  static double number(JsonFields& fields, std::string_view name, double least, double most) {
    const double value = fields.number(name);
    if (value < least || value > most)
      fields.complain(name, fmt::format("is not between {:g} and {:g}", least, most));
    return value;
  }

  // One of `all`, which are called so.
  template <class All, class NameOf>
  static auto choice(JsonFields& fields, std::string_view field, const All& all, NameOf name_of) {
    const std::string name = fields.text(field);
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const auto& each) { return name == name_of(each); });
    if (found == all.end())
      fields.complain(field, "'" + name + "' is none of those that there are");
    return found == all.end() ? all.front() : *found;
  }

  std::size_t index_of(JsonFields& fields, const std::string& name) {
    const auto found = places_.find(name);
    if (found != places_.end()) return found->second;
    fields.complain("component", "'" + name + "' is not among the components");
    return 0;
  }

  void component(JsonFields& fields) {
    RcaComponent component;
    component.name = fields.text("name");
    const bool is_name = !component.name.empty() && component.name.size() <= 64 &&
                         component.name.front() >= 'a' && component.name.front() <= 'z' &&
                         std::all_of(component.name.begin(), component.name.end(), [](char c) {
                           return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
                         });
    if (!is_name) fields.complain("name", "is not made of a-z, 0-9 and _, or too long");
    if (!places_.emplace(component.name, scenario_.components.size()).second)
      fields.complain("name", "'" + component.name + "' is there twice");
    component.criticality = choice(fields, "criticality", kLevels, level_name);
    JsonFields detector(fields.object("detector"));
    component.detector.latency_s = number(detector, "latency_s", 0, kMostSeconds);
    component.detector.miss = number(detector, "miss", 0, 1);
    component.detector.false_alarm = number(detector, "false_alarm", 0, 1);
    if (detector.has("false_alarms_per_min"))
      component.detector.false_alarms_per_min =
          number(detector, "false_alarms_per_min", 0, RcaFactors::kMostFalseAlarms);
    fields.complain_inside("detector", detector.complaint());
    component.is_unwatched = fields.has("unwatched") && fields.truth("unwatched");
    each(fields, "treatments", kRepairs,
         [&](JsonFields& f) { component.treatments.push_back(treatment(f, component)); });
    if (component.treatments.empty()) fields.complain("treatments", "is empty");
    scenario_.components.push_back(std::move(component));
  }

  static Treatment treatment(JsonFields& fields, const RcaComponent& component) {
    Treatment t;
    t.repair = choice(fields, "repair", kRepairNames, [](Repair r) { return to_string(r); });
    const bool is_there =
        std::any_of(component.treatments.begin(), component.treatments.end(),
                    [&](const Treatment& other) { return other.repair == t.repair; });
    if (is_there) fields.complain("repair", "is there twice");
    t.success = number(fields, "success", 1, 100);
    t.confidence = number(fields, "confidence", 1, 100);
    t.impact = static_cast<int>(fields.natural("impact", 1000));
    if (t.impact < 1) fields.complain("impact", "is less than 1");
    t.takes_s = number(fields, "takes_s", 0.01, 60);
    JsonFields helps(fields.object("helps"));
    for (std::size_t k = 0; k < kFaultKinds; ++k)
      t.helps[k] = number(helps, to_string(static_cast<FaultKind>(k)), 0, 1);
    fields.complain_inside("helps", helps.complaint());
    return t;
  }

  void topic(JsonFields& fields) {
    RcaTopic topic;
    topic.name = fields.text("name");
    if (topic.name.empty() || topic.name.front() != '/' || topic.name.size() > 255)
      fields.complain("name", "is no absolute name, or too long");
    std::set<std::size_t> seen;
    for (const Json& name : fields.array("publishers")) {
      const std::size_t place = index_of(fields, name.is_string() ? name.get<std::string>() : "");
      if (!seen.insert(place).second) fields.complain("publishers", "has one twice");
      topic.publishers.push_back(place);
    }
    seen.clear();
    each(fields, "subscribers", kMostComponents, [&](JsonFields& f) {
      Subscription s;
      s.component = index_of(f, f.text("component"));
      s.passes = number(f, "passes", 0, 1);
      s.delay_s = number(f, "delay_s", 0, kMostSeconds);
      s.is_redundant = f.truth("redundant");
      s.is_hidden = f.has("hidden") && f.truth("hidden");
      if (!seen.insert(s.component).second) f.complain("component", "subscribes twice");
      topic.subscribers.push_back(s);
    });
    ends_ += topic.publishers.size() + topic.subscribers.size();
    paths_ += topic.publishers.size() * topic.subscribers.size();
    if (ends_ > kMostEnds || paths_ > kMostWays)
      fields.complain("subscribers", "are more than are read in all");
    topic.is_ignored = fields.has("ignored") && fields.truth("ignored");
    scenario_.topics.push_back(std::move(topic));
  }

  void fault(JsonFields& fields) {
    constexpr std::array kKinds = {
        FaultKind::kSilent, FaultKind::kSlow, FaultKind::kDegraded,      FaultKind::kFlapping,
        FaultKind::kCrash,  FaultKind::kHang, FaultKind::kWrongParameter};
    InjectedFault fault;
    fault.component = index_of(fields, fields.text("component"));
    fault.kind = choice(fields, "kind", kKinds, [](FaultKind kind) { return to_string(kind); });
    fault.at_s = number(fields, "at_s", 0, scenario_.horizon_s);
    fault.is_unfixable = fields.has("unfixable") && fields.truth("unfixable");
    const bool is_there =
        std::any_of(scenario_.faults.begin(), scenario_.faults.end(),
                    [&](const InjectedFault& other) { return other.component == fault.component; });
    if (is_there) fields.complain("component", "has a fault already");
    scenario_.faults.push_back(fault);
  }

  void common_cause(JsonFields& fields) {
    CommonCause cause;
    const Json& hit = fields.array("components");
    if (hit.size() != 2 || hit[0] == hit[1])
      return fields.complain("components", "does not name two different ones");
    const auto place = [&](const Json& name) {
      return index_of(fields, name.is_string() ? name.get<std::string>() : "");
    };
    cause.first = place(hit[0]);
    cause.second = place(hit[1]);
    cause.at_s = number(fields, "at_s", 0, scenario_.horizon_s);
    cause.lasts_s = number(fields, "lasts_s", 0.01, kMostSeconds);
    scenario_.common_causes.push_back(cause);
  }

  RcaScenario scenario_;
  std::map<std::string, std::size_t> places_;
  std::size_t ends_ = 0;
  std::size_t paths_ = 0;
};

}  // namespace

std::string to_json(const RcaScenario& scenario) {
  Json json = {{"format", kFormat},
               {"seed", scenario.seed},
               {"reading_s", scenario.reading_s},
               {"horizon_s", scenario.horizon_s},
               {"components", Json::array()},
               {"topics", Json::array()},
               {"faults", Json::array()}};
  for (const RcaComponent& c : scenario.components) json["components"].push_back(json_of(c));
  for (const RcaTopic& t : scenario.topics) json["topics"].push_back(json_of(t, scenario));
  for (const InjectedFault& f : scenario.faults) {
    Json& fault =
        json["faults"].emplace_back(Json{{"component", scenario.components[f.component].name},
                                         {"kind", to_string(f.kind)},
                                         {"at_s", f.at_s}});
    if (f.is_unfixable) fault["unfixable"] = true;
  }
  for (const CommonCause& cause : scenario.common_causes)
    json["common_causes"].push_back(
        {{"components",
          {scenario.components[cause.first].name, scenario.components[cause.second].name}},
         {"at_s", cause.at_s},
         {"lasts_s", cause.lasts_s}});
  return json.dump(1) + "\n";
}

Expected<RcaScenario> scenario_from_json(const std::string& text) { return Reader().read(text); }

}  // namespace culprit::study::rca
