#include "lsp/hover.h"

#include <algorithm>

#include "language/functions.h"
#include "language/scanner.h"
#include "lsp/live_hover.h"

namespace culprit::lsp {
namespace {

using OccurrenceKind = Occurrence::Kind;

std::string code(std::string_view text) { return "```\n" + std::string(text) + "\n```"; }

std::string line_at(const Source& source, std::uint32_t offset) {
  return code(source.text(source.line(source.position(offset).line)));
}

// The line on which `thing` is declared; empty if none does.
std::string declaration(const Document& document, const Occurrence& thing) {
  for (const Occurrence& o : document.names()) {
    if (!o.declares || !o.same_as(thing)) continue;
    return line_at(document.source(), o.span.begin);
  }
  for (const Occurrence& o : document.names_elsewhere()) {
    if (!o.same_as(thing)) continue;
    const Place place = document.rules.source.origin(o.span).place;
    const Source& file = document.rules.source.file(place.file);
    return line_at(file, place.span.begin) +
           (place.file == 0 ? "" : "\n\nIn `" + file.name() + "`.");
  }
  return "";
}

// How it is used, and what is written above it.
std::string of_template(const Document& document, const Occurrence& thing) {
  const auto known = document.rules.templates.find(thing.name);
  if (known == document.rules.templates.end()) return "";
  const Place& place = known->second.name;
  const Source& file = document.rules.source.file(place.file);
  std::string above;
  for (std::uint32_t n = file.position(place.span.begin).line - 1; n > 0; --n) {
    const std::string_view line = trimmed(file.text(file.line(n)));
    if (!line.starts_with('#')) break;
    above = std::string(trimmed(line.substr(1))) + "\n" + above;
  }
  return code("USE " + known->second.usage) + (above.empty() ? "" : "\n\n" + above);
}

std::string of_file(const Document& document, const Occurrence& thing) {
  for (std::uint32_t f = 1; f < document.rules.source.file_count(); ++f) {
    const std::string& name = document.rules.source.file(f).name();
    if (name.ends_with(thing.name)) return "`" + name + "`";
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

// The meaning according to the file and the language.
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
    case OccurrenceKind::kTemplate:
      return of_template(document, thing);
    case OccurrenceKind::kHole:
      return "Parameter `" + thing.name + "` of the template `" + thing.scope + "`";
    case OccurrenceKind::kFile:
      return of_file(document, thing);
    case OccurrenceKind::kTopic:
      return "Topic `" + thing.name + "`";
    case OccurrenceKind::kDiagnostic:
      return "Diagnostic status `" + thing.name + "`";
    case OccurrenceKind::kService:
      return "Service `" + thing.name + "`";
    case OccurrenceKind::kAction:
      return "Action `" + thing.name + "`";
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
