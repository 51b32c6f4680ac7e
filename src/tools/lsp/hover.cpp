#include "lsp/hover.h"

#include <algorithm>

#include "language/functions.h"
#include "lsp/live_hover.h"

namespace culprit::lsp {
namespace {

using OccurrenceKind = Occurrence::Kind;

std::string code(std::string_view text) { return "```\n" + std::string(text) + "\n```"; }

// The line on which `thing` is declared; empty if none does.
std::string declaration(const Document& document, const Occurrence& thing) {
  for (const Occurrence& o : document.names()) {
    if (!o.declares || !o.same_as(thing)) continue;
    const std::uint32_t line = document.source.position(o.span.begin).line;
    return code(document.source.text(document.source.line(line)));
  }
  return "";
}

template <class Table>
auto find_named(const Table& table, const std::string& name) {
  return std::find_if(table.begin(), table.end(), [&](const auto& t) { return t.name == name; });
}

std::string of_signal(const Document& document, const Occurrence& thing) {
  std::string text = declaration(document, thing);
  if (text.empty())
    text = "`" + thing.name + "`: not declared; looked up among the keys of diagnostics";
  if (!document.checked.rules) return text;
  const auto& signals = document.checked.rules->signals;
  const auto signal = find_named(signals, thing.name);
  if (signal == signals.end()) return text;
  text += "\n\nA " + std::string(to_string(signal->type)) + ".";
  if (signal->stale) text += " Unknown when older than " + to_string(*signal->stale) + ".";
  return text;
}

std::string of_component(const Document& document, const Occurrence& thing) {
  std::string text = declaration(document, thing);
  if (text.empty()) text = "`" + thing.name + "`: not declared; the node of this name";
  if (!document.checked.rules) return text;
  const RuleSet& rules = *document.checked.rules;
  std::string strategies;
  for (const Strategy& strategy : rules.strategies) {
    const bool adapts =
        std::any_of(strategy.components.begin(), strategy.components.end(),
                    [&](ComponentId component) { return rules[component].name == thing.name; });
    if (adapts) strategies += (strategies.empty() ? "" : ", ") + strategy.name;
  }
  return strategies.empty() ? text : text + "\n\nAdapted by " + strategies + ".";
}

// What the file and the language say.
std::string meaning(const Document& document, const Occurrence& thing) {
  switch (thing.kind) {
    case OccurrenceKind::kFunction: {
      const FunctionInfo* function = find_function(thing.name);
      return function == nullptr ? "" : code(function->usage);
    }
    case OccurrenceKind::kSignal:
      return of_signal(document, thing);
    case OccurrenceKind::kComponent:
      return of_component(document, thing);
    case OccurrenceKind::kConstant:
    case OccurrenceKind::kRule:
    case OccurrenceKind::kStrategy:
      return declaration(document, thing);
    case OccurrenceKind::kTopic:
      return "Topic `" + thing.name + "`";
    case OccurrenceKind::kDiagnostic:
      return "Diagnostic status `" + thing.name + "`";
    case OccurrenceKind::kService:
      return "Service `" + thing.name + "`";
    case OccurrenceKind::kParameter:
      return "Parameter `" + thing.name + "` of `" + thing.scope + "`";
  }
  return "";
}

}  // namespace

std::string hover(const Document& document, const Occurrence& thing, const LiveInventory* robot) {
  const std::string text = meaning(document, thing);
  const std::string now = robot == nullptr ? "" : live_facts(document, thing, *robot);
  return now.empty() ? text : text + "\n\n" + now;
}

}  // namespace culprit::lsp
