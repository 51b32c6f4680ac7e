#include "rule_json/forms.h"

namespace culprit::rule_json {

namespace {

std::vector<Form> table() {
  using enum Part;
  const Clause name{"", "name", kWord};
  const Clause component{"", "component", kName};
  const Clause type{"", "type", kType};
  const Clause parameter{"", "parameter", kName};
  const Clause impact{"", "impact", kNumber};
  const std::vector<Clause> bounds = {{"STALE", "stale", kDuration}, {"RANGE", "range", kRange}};
  const std::vector<Clause> published = {{"FROM", "from", kName}, bounds[0], bounds[1]};
  return {
      {"ROBOT", {name}, {}, {}},
      {"CYCLE", {{"", "length", kDuration}}, {}, {}},
      {"CONST", {name, {"=", "value", kExpression}}, {}, {}},
      {"COMPONENT",
       {name},
       {{"NODE", "node", kNodes},
        {"LAUNCH", "launch", kText},
        {"ENV", "env", kText},
        {"SETUP", "setup", kName},
        {"CWD", "cwd", kName},
        {"UNIT", "unit", kName},
        {"USER", "user", kFlag},
        {"CONTAINER", "container", kNamePair},
        {"HOST", "host", kName},
        {"IN", "in", kName},
        {"PLUGIN", "plugin", kName},
        {"PACKAGE", "package", kName},
        {"PARAMETERS", "parameters", kName},
        {"REMAP", "remap", kName},
        {"RESPAWNED", "respawned", kFlag},
        {"REQUIRED", "required", kFlag},
        {"READY", "ready", kDuration},
        {"LIFECYCLE", "lifecycle", kWord}},
       {}},
      {"DEPENDENCY", {{"", "consumer", kName}, {"ON", "producers", kNames}}, {}, {}},
      {"GROUP", {name, {"", "members", kBraced}, {"MANAGER", "manager", kWord}}, {}, {}},
      {"IGNORE", {{"TOPIC", "topics", kNames}}, {}, {}},
      {"INTERLOCK", {{"", "expression", kExpression}}, {}, {}},
      {"ABORT", {{"", "expression", kExpression}}, {}, {}},
      {"DRILL", {component, type, parameter, {"", "value", kExpression}}, {}, {"set_parameter"}},
      {"DRILL", {component, type, {"", "fault", kWord}}, {}, {"without"}},
      {"DRILL", {component, type, {"", "times", kNumber}}, {}, {"limit"}},
      {"SIGNAL", {name, {"DIAGNOSTIC", "diagnostic", kName}, {"KEY", "key", kName}}, published, {}},
      {"SIGNAL", {name, {"TOPIC", "topic", kName}, {"FIELD", "field", kName}}, published, {}},
      {"SIGNAL", {name, {"PARAMETER", "component", kName}, parameter}, bounds, {}},
      {"RULE", {name}, {}, {}},
      {"POLICIES",
       {{"", "criticality", kWord}},
       {{"FOR", "for", kDuration},
        {"HOLD", "hold", kHold},
        {"COOLDOWN", "cooldown", kDuration},
        {"ATTEMPTS", "attempts", kNumber},
        {"ON_CHANGE", "on_change", kFlag},
        {"REPORT", "report", kFlag}},
       {}},
      {"TRIGGER", {{"", "expression", kExpression}}, {}, {}},
      {"STRATEGY",
       {name, {"", "probability", kNumber}, {"", "confidence", kNumber}},
       {{"LASTRESORT", "last_resort", kFlag},
        {"WITHIN", "within", kDuration},
        {"WHEN", "when", kExpression}},
       {}},
      {"INCLUDE", {{"", "file", kText}}, {}, {}},
      {"TEMPLATE", {name, {"", "parameters", kParameters}}, {}, {}},
      {"END", {}, {}, {}},
      {"USE", {{"", "template", kWord}, {"", "arguments", kArguments}}, {{"IN", "in", kName}}, {}},
      {"ADAPTATION",
       {component, type, parameter, {"", "value", kExpression}, impact},
       {},
       {"set_parameter", "increase_parameter", "decrease_parameter"}},
      {"ADAPTATION",
       {component, type, parameter, {"", "topic", kName}, impact},
       {},
       {"change_communication"}},
      {"ADAPTATION", {component, type, {"", "mode", kName}, impact}, {}, {"change_mode"}},
      {"ADAPTATION", {component, type, {"", "service", kName}, impact}, {}, {"call"}},
      {"ADAPTATION",
       {component, type, {"", "service", kName}, {"", "request", kText}, impact},
       {},
       {"call"}},
      {"ADAPTATION",
       {component, type, impact},
       {},
       {"activate", "deactivate", "restart", "redeploy", "start", "stop", "start_group"}},
  };
}

}  // namespace

std::span<const Form> forms() {
  static const std::vector<Form> kForms = table();
  return kForms;
}

}  // namespace culprit::rule_json
