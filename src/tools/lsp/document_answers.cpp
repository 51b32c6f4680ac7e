#include "lsp/document_answers.h"

#include <algorithm>

#include "language/formatter.h"
#include "language/scanner.h"
#include "lsp/completion.h"
#include "lsp/hover.h"
#include "lsp/wire.h"

namespace culprit::lsp {
namespace {

using OccurrenceKind = Occurrence::Kind;

// CodeActionContext.only: the kinds that the client wants, all if it does not say.
bool wants_quick_fixes(const Json& params) {
  const Json* only = at(params, {"context", "only"});
  if (only == nullptr || !only->is_array()) return true;
  return std::find(only->begin(), only->end(), kQuickFix) != only->end();
}

// CompletionItemKind
int item_kind(Proposal::Kind kind) {
  switch (kind) {
    case Proposal::Kind::kKeyword:
      return 14;
    case Proposal::Kind::kFunction:
      return 3;
    case Proposal::Kind::kConstant:
      return 21;
    case Proposal::Kind::kSignal:
      return 6;
    case Proposal::Kind::kComponent:
      return 7;
    case Proposal::Kind::kTopic:
    case Proposal::Kind::kStatus:
      return 12;
    case Proposal::Kind::kParameter:
      return 10;
    case Proposal::Kind::kService:
      return 2;
    case Proposal::Kind::kTemplate:
      return 15;
    case Proposal::Kind::kFile:
      return 17;
  }
  return 1;
}

// SymbolKind, for things that a file declares.
int symbol_kind(OccurrenceKind kind) {
  switch (kind) {
    case OccurrenceKind::kConstant:
      return 14;
    case OccurrenceKind::kComponent:
      return 5;
    case OccurrenceKind::kRule:
      return 3;
    case OccurrenceKind::kStrategy:
      return 6;
    case OccurrenceKind::kTemplate:
      return 12;
    default:
      return 13;
  }
}

// Whether the line at `offset` is an INCLUDE.
bool includes_at(const Document& document, std::uint32_t offset) {
  const Source& source = document.source();
  const std::string_view line = source.text(source.line(source.position(offset).line));
  return trimmed(line).starts_with("INCLUDE");
}

Span line_of(const Source& source, Span span) {
  return source.line(source.position(span.begin).line);
}

Json symbol(const Document& document, const Occurrence& thing) {
  return {{"name", thing.name},
          {"kind", symbol_kind(thing.kind)},
          {"range", to_json(document.source(), line_of(document.source(), thing.span))},
          {"selectionRange", to_json(document.source(), thing.span)}};
}

// A name that the language takes for one, so that a rename leaves a file that can be read.
bool is_name(const std::string& text) {
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  };
  return !text.empty() && is_letter(text[0]) && std::all_of(text.begin(), text.end(), [&](char c) {
    return is_letter(c) || (c >= '0' && c <= '9');
  });
}

// The thing that the request's position points at; null if at none.
const Occurrence* pointed_at(const Asked& asked) {
  return occurrence_at(asked.document.names(), place_in(asked.document, asked.params));
}

}  // namespace

Json completion(const Asked& asked, const std::function<std::vector<std::string>()>& includable) {
  const Document& document = asked.document;
  Json items = Json::array();
  const std::uint32_t place = place_in(document, asked.params);
  std::vector<std::string> files;
  if (includable && includes_at(document, place)) files = includable();
  for (const Proposal& p : proposals(document, place, asked.robot, files)) {
    // Editors do not know what belongs to the name of a topic.
    Json edit{{"range", to_json(document.source(), typed_part(document, place, p))},
              {"newText", p.text}};
    Json item{{"label", p.text}, {"kind", item_kind(p.kind)}, {"textEdit", std::move(edit)}};
    if (!p.detail.empty()) item["detail"] = p.detail;
    items.push_back(std::move(item));
  }
  return items;
}

Json hover(const Asked& asked) {
  const Document& document = asked.document;
  const Occurrence* thing = pointed_at(asked);
  const std::string text = thing == nullptr ? "" : hover(document, *thing, asked.robot);
  if (text.empty()) return nullptr;
  return {{"contents", {{"kind", "markdown"}, {"value", text}}},
          {"range", to_json(document.source(), thing->span)}};
}

Json definition(const Asked& asked,
                const std::function<Expected<Source>(const std::string& file)>& load) {
  const Document& document = asked.document;
  const Occurrence* thing = pointed_at(asked);
  if (thing == nullptr) return nullptr;
  for (const Occurrence& o : document.names()) {
    if (o.declares && o.same_as(*thing))
      return {{"uri", asked.uri}, {"range", to_json(document.source(), o.span)}};
  }
  const Source& source = document.rules.source;
  const auto at_place = [&](const Place& place) -> Json {
    const Source& file = source.file(place.file);
    return {{"uri", place.file == 0 ? asked.uri : uri_of(file.name())},
            {"range", to_json(file, place.span)}};
  };
  if (thing->kind == OccurrenceKind::kFile) {
    const auto included = load(thing->name);
    if (!included) return nullptr;
    return {{"uri", uri_of(included->name())}, {"range", to_json(*included, {0, 0})}};
  }
  if (thing->kind == OccurrenceKind::kTemplate) {
    const auto known = document.rules.templates.find(thing->name);
    return known == document.rules.templates.end() ? Json() : at_place(known->second.name);
  }
  for (const Occurrence& o : document.names_elsewhere()) {
    if (o.same_as(*thing)) return at_place(source.origin(o.span).place);
  }
  return nullptr;
}

Json references(const Asked& asked) {
  const Document& document = asked.document;
  const Occurrence* thing = pointed_at(asked);
  if (thing == nullptr) return nullptr;
  const Json* wanted = at(asked.params, {"context", "includeDeclaration"});
  const bool with_declaration = wanted == nullptr || !wanted->is_boolean() || wanted->get<bool>();
  Json places = Json::array();
  for (const Occurrence& o : document.names()) {
    if (o.same_as(*thing) && (with_declaration || !o.declares))
      places.push_back({{"uri", asked.uri}, {"range", to_json(document.source(), o.span)}});
  }
  return places;
}

Expected<Json> rename(const Asked& asked) {
  const Document& document = asked.document;
  const Occurrence* thing = pointed_at(asked);
  if (thing == nullptr) return Error{"there is no name here"};
  const bool is_ours = std::any_of(document.names().begin(), document.names().end(),
                                   [&](const auto& o) { return o.declares && o.same_as(*thing); });
  if (!is_ours) return Error{"'" + thing->name + "' is not declared in this file"};
  const std::string name = text_at(asked.params, {"newName"});
  if (!is_name(name))
    return Error{"a name begins with a letter and has letters, digits and underscores"};
  const bool is_taken =
      std::any_of(document.names().begin(), document.names().end(), [&](const Occurrence& o) {
        return o.declares && o.name == name && o.scope == thing->scope && !o.same_as(*thing);
      });
  if (is_taken) return Error{"'" + name + "' is declared already"};
  Json edits = Json::array();
  for (const Occurrence& o : document.names()) {
    if (o.same_as(*thing))
      edits.push_back({{"range", to_json(document.source(), o.span)}, {"newText", name}});
  }
  return Json{{"changes", {{asked.uri, std::move(edits)}}}};
}

// One edit, of the whole text. A file with mistakes stays as it is: they are shown already.
Json formatting(const Asked& asked) {
  const Document& document = asked.document;
  const auto text = format(document.source());
  if (!text || *text == document.source().text()) return Json::array();
  const auto end = static_cast<std::uint32_t>(document.source().text().size());
  return Json::array({{{"range", to_json(document.source(), {0, end})}, {"newText", *text}}});
}

// The fixes of mistakes within the range that the client asks about.
Json code_actions(const Asked& asked) {
  const Document& document = asked.document;
  Json actions = Json::array();
  if (!wants_quick_fixes(asked.params)) return actions;
  const std::uint32_t begin = place_in(document, asked.params, {"range", "start"});
  const std::uint32_t end = place_in(document, asked.params, {"range", "end"});
  for (const Diagnostic& d : document.diagnostics) {
    const bool touches = d.span.begin <= end && begin <= d.span.end;
    if (!d.fix || !touches) continue;
    Json edit{{"range", to_json(document.source(), d.fix->span)}, {"newText", d.fix->text}};
    actions.push_back({{"title", title_of(*d.fix, document.source())},
                       {"kind", kQuickFix},
                       {"diagnostics", Json::array({to_json(d, document.source())})},
                       {"edit", {{"changes", {{asked.uri, Json::array({std::move(edit)})}}}}}});
  }
  // An editor applies the preferred one unasked, so there is none where there is a choice.
  if (actions.size() == 1) actions[0]["isPreferred"] = true;
  return actions;
}

// Rules hold their strategies; everything else that is declared stands beside them.
Json symbols(const Asked& asked) {
  const Document& document = asked.document;
  Json all = Json::array();
  for (const Occurrence& o : document.names()) {
    if (!o.declares || o.kind == OccurrenceKind::kHole) continue;
    Json entry = symbol(document, o);
    if (o.kind == OccurrenceKind::kStrategy && !all.empty() && all.back().contains("children")) {
      all.back()["range"]["end"] = entry["range"]["end"];
      all.back()["children"].push_back(std::move(entry));
      continue;
    }
    if (o.kind == OccurrenceKind::kRule) entry["children"] = Json::array();
    all.push_back(std::move(entry));
  }
  return all;
}

// Five numbers for each: line and start relative to the one before, length, type, modifiers.
Json semantic_tokens(const Asked& asked) {
  const Document& document = asked.document;
  Json data = Json::array();
  TextPosition last;
  for (const Occurrence& o : document.names()) {
    const TextPosition begin = text_position(document.source(), o.span.begin);
    const TextPosition end = text_position(document.source(), o.span.end);
    const bool same_line = begin.line == last.line;
    data.push_back(begin.line - last.line);
    data.push_back(same_line ? begin.character - last.character : begin.character);
    data.push_back(end.character - begin.character);
    data.push_back(static_cast<int>(o.kind));
    data.push_back(o.declares ? 1 : 0);
    last = begin;
  }
  return {{"data", std::move(data)}};
}

}  // namespace culprit::lsp
