#include "drill/trial.h"

#include <algorithm>

#include "journal/json.h"

namespace culprit::drill {
namespace {

using journal::number_of;
using journal::text_of;

// A restart ends by itself, so no strategy can have caused the recovery.
bool heals_itself(const Fault& fault) { return fault.kind == FaultKind::kRestart; }

std::vector<std::string> names_in(const Json& json, const char* key) {
  std::vector<std::string> names;
  const auto list = json.find(key);
  if (list == json.end() || !list->is_array()) return names;
  for (const Json& each : *list) {
    if (each.is_string()) names.push_back(each.get<std::string>());
  }
  return names;
}

std::optional<double> time_in(const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

}  // namespace

std::string Trial::id() const { return to_string(faults) + " #" + std::to_string(round); }

Json to_json(const Trial& trial) {
  Json json{{"faults", Json::array()}, {"round", trial.round}, {"injected", trial.injected}};
  for (const Fault& fault : trial.faults) json["faults"].push_back(to_json(fault));
  if (trial.undone) json["undone"] = *trial.undone;
  if (trial.well) json["well"] = *trial.well;
  if (trial.restored) json["restored"] = *trial.restored;
  json["end"] = trial.end;
  json["silent"] = Json::object();
  for (const auto& [component, at] : trial.silent) json["silent"][component] = at;
  if (!trial.trouble.empty()) json["trouble"] = trial.trouble;
  json["events"] = trial.events;
  return json;
}

std::optional<Trial> trial_from(const Json& json) {
  if (!json.is_object() || !json.contains("faults") || !json["faults"].is_array())
    return std::nullopt;
  Trial trial;
  for (const Json& each : json["faults"]) {
    const auto fault = fault_from(each);
    if (!fault) return std::nullopt;
    trial.faults.push_back(*fault);
  }
  if (trial.faults.empty()) return std::nullopt;
  trial.round = static_cast<int>(journal::integer_of(json, "round", 1));
  trial.injected = number_of(json, "injected");
  trial.undone = time_in(json, "undone");
  trial.well = time_in(json, "well");
  trial.restored = time_in(json, "restored");
  trial.end = number_of(json, "end");
  trial.trouble = text_of(json, "trouble");
  if (json.contains("silent") && json["silent"].is_object()) {
    for (const auto& [component, at] : json["silent"].items())
      if (at.is_number()) trial.silent[component] = at.get<double>();
  }
  if (json.contains("events") && json["events"].is_array()) {
    for (const Json& event : json["events"])
      if (event.is_object()) trial.events.push_back(event);
  }
  return trial;
}

Paths paths_over(const std::vector<std::pair<std::string, std::string>>& edges) {
  Paths paths(edges.begin(), edges.end());
  for (std::size_t before = 0; before != paths.size();) {
    before = paths.size();
    Paths more;
    for (const auto& [consumer, middle] : paths) {
      for (auto next = paths.lower_bound({middle, ""});
           next != paths.end() && next->first == middle; ++next)
        more.emplace(consumer, next->second);
    }
    paths.merge(more);
  }
  return paths;
}

bool is_of_own_rule(const Json& event) { return text_of(event, "rule").starts_with(kOwnRules); }

Finding finding_of(const Trial& trial, const std::set<std::string>& rules) {
  Finding out;
  const auto is_broken = [&](const std::string& component) {
    return std::ranges::any_of(trial.faults,
                               [&](const Fault& each) { return each.component == component; });
  };
  for (const Json& event : trial.events) {
    const std::string type = text_of(event, "type");
    const double after = number_of(event, "clock") - trial.injected;
    if (is_of_own_rule(event)) continue;
    if (trial.restored && after > *trial.restored - trial.injected) break;
    if (type == "failure_detected") {
      if (!rules.empty() && !rules.contains(text_of(event, "rule"))) continue;
      if (!out.noticed_after) {
        out.noticed_after = after;
        out.rule = text_of(event, "rule");
      }
      out.fired.insert(text_of(event, "rule"));
    } else if (type == "strategy_chosen" && !journal::flag_of(event, "dry_run")) {
      for (const std::string& component : names_in(event, "components")) {
        out.blamed.insert(component);
        if (!is_broken(component)) out.wrongly.insert(component);
      }
    } else if (type == "failure_resolved" && !text_of(event, "strategy").empty()) {
      out.helped.push_back(text_of(event, "rule") + "." + text_of(event, "strategy"));
    }
  }
  if (trial.well) out.well_after = *trial.well - trial.injected;
  for (const auto& [component, at] : trial.silent) {
    if (!is_broken(component)) out.silent.insert(component);
  }
  return out;
}

std::vector<Attempted> attempts_in(const Trial& trial) {
  std::vector<Attempted> out;
  if (!trial.trouble.empty() || std::ranges::any_of(trial.faults, heals_itself)) return out;
  std::map<std::pair<std::string, std::string>, double> done;
  for (const Json& event : trial.events) {
    const double at = number_of(event, "clock");
    if (trial.undone && at >= *trial.undone) break;
    const std::pair which(text_of(event, "rule"), text_of(event, "strategy"));
    const std::string type = text_of(event, "type");
    if (which.second.empty()) continue;
    if (type == "adaptation_done") {
      done[which] = at;
    } else if (type == "failure_resolved") {
      const auto last = done.find(which);
      out.push_back({which.first, which.second, true,
                     last == done.end() ? std::nullopt : std::optional(at - last->second)});
    } else if (type == "strategy_failed") {
      out.push_back({which.first, which.second, false, {}});
    }
  }
  return out;
}

}  // namespace culprit::drill
