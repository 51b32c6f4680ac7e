#include "lsp/language_server.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <tuple>

#include "language/formatter.h"
#include "language/scanner.h"
#include "lsp/completion.h"
#include "lsp/hover.h"
#include "lsp/text_position.h"

namespace culprit::lsp {
namespace {

using OccurrenceKind = Occurrence::Kind;

// JSON-RPC 2.0 and LSP error codes.
constexpr int kParseError = -32700;
constexpr int kInvalidRequest = -32600;
constexpr int kMethodNotFound = -32601;
constexpr int kRequestFailed = -32803;

constexpr const char* kQuickFix = "quickfix";  // CodeActionKind

// The value at a path of members; null if it is not there. A client's message may have any shape.
using JsonPath = std::initializer_list<const char*>;
const Json* at(const Json& value, const JsonPath& path) {
  const Json* here = &value;
  for (const char* member : path) {
    const auto found = here->find(member);
    if (!here->is_object() || found == here->end()) return nullptr;
    here = &*found;
  }
  return here;
}

std::string text_at(const Json& value, const JsonPath& path) {
  const Json* found = at(value, path);
  return found != nullptr && found->is_string() ? found->get<std::string>() : "";
}

std::uint32_t number_at(const Json& value, const JsonPath& path) {
  const Json* found = at(value, path);
  return found != nullptr && found->is_number_unsigned() ? found->get<std::uint32_t>() : 0;
}

// The offset of the position in `params` that `path` leads to.
std::uint32_t place_in(const Document& document, const Json& params, const JsonPath& path) {
  const Json* position = at(params, path);
  if (position == nullptr) return 0;
  return offset_of(document.source(),
                   {number_at(*position, {"line"}), number_at(*position, {"character"})});
}

std::uint32_t place_in(const Document& document, const Json& params) {
  return place_in(document, params, {"position"});
}

// CodeActionContext.only: the kinds that the client wants, all if it does not say.
bool wants_quick_fixes(const Json& params) {
  const Json* only = at(params, {"context", "only"});
  if (only == nullptr || !only->is_array()) return true;
  return std::find(only->begin(), only->end(), kQuickFix) != only->end();
}

Json to_json(TextPosition position) {
  return {{"line", position.line}, {"character", position.character}};
}

Json to_json(const Source& source, Span span) {
  return {{"start", to_json(text_position(source, span.begin))},
          {"end", to_json(text_position(source, span.end))}};
}

Json to_json(const Diagnostic& diagnostic, const Source& source) {
  const std::string remedy = diagnostic.remedy.empty() ? "" : "\n" + diagnostic.remedy;
  return {{"range", to_json(source, diagnostic.span)},
          {"severity", diagnostic.severity == Severity::kError ? 1 : 2},
          {"code", to_string(diagnostic.code)},
          {"source", "culprit"},
          {"message", diagnostic.cause + remedy}};
}

// file:///a%20b.rules -> /a b.rules; empty for what is no file.
std::string path_of(const std::string& uri) {
  constexpr std::string_view kScheme = "file://";
  if (!uri.starts_with(kScheme)) return "";
  std::string path;
  for (std::size_t i = kScheme.size(); i < uri.size(); ++i) {
    unsigned value = 0;
    const char* begin = uri.data() + i + 1;
    const bool is_escape = uri[i] == '%' && i + 2 < uri.size() &&
                           std::from_chars(begin, begin + 2, value, 16).ptr == begin + 2;
    path += is_escape ? static_cast<char>(value) : uri[i];
    if (is_escape) i += 2;
  }
  return path;
}

// As VS Code writes them: an editor knows its documents by what it called them.
std::string uri_of(const std::string& path) {
  constexpr std::string_view kPlain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~/";
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string uri = "file://";
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    if (kPlain.find(c) != std::string_view::npos) {
      uri += c;
    } else {
      uri += {'%', kDigits[byte / 16], kDigits[byte % 16]};
    }
  }
  return uri;
}

Json succeeded(Json result) { return {{"result", std::move(result)}}; }

Json failed(int code, const std::string& message) {
  return {{"error", {{"code", code}, {"message", message}}}};
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

// The types by which editors colour names; the order is that of Occurrence::Kind.
constexpr std::array kTokenTypes = {"enumMember", "class",     "variable", "string", "property",
                                    "namespace",  "method",    "function", "string", "string",
                                    "macro",      "parameter", "string"};

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

}  // namespace

bool LanguageServer::handle(const Json& message) {
  if (message.is_discarded()) {
    Json reply{{"jsonrpc", "2.0"}, {"id", nullptr}};
    reply.update(failed(kParseError, "this is no JSON"));
    send_(reply);
    return true;
  }
  const std::string method = text_at(message, {"method"});
  if (method == "exit") return false;
  const Json* id = at(message, {"id"});
  const Json* params = at(message, {"params"});
  static const Json kNone = Json::object();
  if (id == nullptr) {
    notice(method, params != nullptr ? *params : kNone);
    return true;
  }
  if (method.empty()) return true;  // an answer to what we never asked
  // An id must be a number or a string; it is sent back.
  const bool is_id = id->is_number() || id->is_string();
  Json reply{{"jsonrpc", "2.0"}, {"id", is_id ? *id : Json(nullptr)}};
  reply.update(answer(method, params != nullptr ? *params : kNone));
  send_(reply);
  return true;
}

void LanguageServer::notice(const std::string& method, const Json& params) {
  const std::string uri = text_at(params, {"textDocument", "uri"});
  if (method == "textDocument/didOpen") {
    open(uri, text_at(params, {"textDocument", "text"}));
  } else if (method == "textDocument/didChange") {
    // Whole texts, as the capabilities say; the last one counts.
    const Json* changes = at(params, {"contentChanges"});
    if (changes != nullptr && changes->is_array() && !changes->empty())
      open(uri, text_at(changes->back(), {"text"}));
  } else if (method == "textDocument/didClose") {
    std::set<std::string> uris = {uri};
    if (const auto closed = documents_.find(uri); closed != documents_.end()) {
      uris = concerned(uri, closed->second);
      documents_.erase(closed);
    }
    interests_.erase(uri);
    uris.merge(read_includers_of(uri));
    publish(uris);
  }
}

// The text that is open counts, not the one on the disk.
Expected<Source> LanguageServer::load(const std::string& file, const std::string& from) const {
  if (!files_.load) return Error{"no other file can be read here"};
  auto loaded = files_.load(file, from);
  if (!loaded) return loaded;
  const auto open = documents_.find(uri_of(loaded->name()));
  if (open == documents_.end()) return loaded;
  return Source(loaded->name(), std::string(open->second.source().text()));
}

void LanguageServer::read(const std::string& uri, std::string text) {
  const auto load_file = [this](const std::string& file, const std::string& from) {
    return load(file, from);
  };
  auto entry = documents_.find(uri);
  if (entry == documents_.end()) {
    entry = documents_.emplace(uri, Document(std::move(text), path_of(uri), load_file)).first;
  } else {
    entry->second.change(std::move(text), load_file);
  }
  Document& document = entry->second;
  if (document.checked.rules) interests_[uri] = interest_of(*document.checked.rules);
  if (robot_) document.compare_with(*robot_);
}

std::set<std::string> LanguageServer::concerned(const std::string& uri, const Document& document) {
  std::set<std::string> uris = {uri};
  for (const auto& [file, diagnostics] : document.elsewhere)
    uris.insert(uri_of(document.rules.source.file(file).name()));
  return uris;
}

// Reads the documents that include `uri` anew. Gives all that are concerned.
std::set<std::string> LanguageServer::read_includers_of(const std::string& uri) {
  const std::string path = path_of(uri);
  std::set<std::string> uris;
  std::vector<std::string> includers;
  for (const auto& [other, document] : documents_) {
    const Source& source = document.rules.source;
    for (std::uint32_t f = 1; f < source.file_count(); ++f) {
      if (other != uri && !path.empty() && source.file(f).name() == path)
        includers.push_back(other);
    }
  }
  for (const std::string& other : includers) {
    uris.merge(concerned(other, documents_.at(other)));
    read(other, std::string(documents_.at(other).source().text()));
    uris.merge(concerned(other, documents_.at(other)));
  }
  return uris;
}

void LanguageServer::open(const std::string& uri, std::string text) {
  std::set<std::string> uris;
  if (const auto before = documents_.find(uri); before != documents_.end())
    uris = concerned(uri, before->second);
  read(uri, std::move(text));
  uris.merge(concerned(uri, documents_.at(uri)));
  uris.merge(read_includers_of(uri));
  publish(uris);
}

void LanguageServer::see(LiveInventory robot) {
  robot_ = std::move(robot);
  std::set<std::string> uris;
  for (auto& [uri, document] : documents_) {
    std::set<std::string> before = concerned(uri, document);
    if (!document.compare_with(*robot_)) continue;
    uris.merge(before);
    uris.merge(concerned(uri, document));
  }
  publish(uris);
}

LiveInterest LanguageServer::interest() const {
  LiveInterest all;
  for (const auto& [uri, interest] : interests_) {
    all.nodes.insert(interest.nodes.begin(), interest.nodes.end());
    for (const auto& [topic, fields] : interest.fields_of_topics)
      all.fields_of_topics[topic].insert(fields.begin(), fields.end());
  }
  return all;
}

void LanguageServer::publish(const std::set<std::string>& uris) {
  for (const std::string& uri : uris) publish(uri);
}

// Publishes the diagnostics of the document, and those that its including documents have in it;
// each once.
void LanguageServer::publish(const std::string& uri) {
  Json diagnostics = Json::array();
  std::set<std::tuple<Code, TextPosition, TextPosition>> said;
  const auto add = [&](const Diagnostic& d, const Source& source) {
    const auto here =
        std::tuple(d.code, text_position(source, d.span.begin), text_position(source, d.span.end));
    if (said.insert(here).second) diagnostics.push_back(to_json(d, source));
  };
  if (const auto own = documents_.find(uri); own != documents_.end()) {
    for (const Diagnostic& d : own->second.diagnostics) add(d, own->second.source());
  }
  for (const auto& [other, document] : documents_) {
    for (const auto& [file, found] : document.elsewhere) {
      const Source& source = document.rules.source.file(file);
      if (other == uri || uri_of(source.name()) != uri) continue;
      for (const Diagnostic& d : found) add(d, source);
    }
  }
  send_({{"jsonrpc", "2.0"},
         {"method", "textDocument/publishDiagnostics"},
         {"params", {{"uri", uri}, {"diagnostics", std::move(diagnostics)}}}});
}

Json LanguageServer::answer(const std::string& method, const Json& params) {
  if (is_shut_down_) return failed(kInvalidRequest, "the server was shut down");
  if (method == "initialize") {
    return succeeded({{"capabilities", capabilities()},
                      {"serverInfo", {{"name", "culprit"}, {"version", version_}}}});
  }
  if (method == "shutdown") {
    is_shut_down_ = true;
    return succeeded(nullptr);
  }
  const std::string uri = text_at(params, {"textDocument", "uri"});
  const auto found = documents_.find(uri);
  if (method.starts_with("textDocument/") && found == documents_.end())
    return failed(kRequestFailed, "the document '" + uri + "' is not open");
  if (method == "textDocument/completion") return succeeded(completion(uri, found->second, params));
  if (method == "textDocument/hover") return succeeded(hover_at(found->second, params));
  if (method == "textDocument/definition") return succeeded(definition(uri, found->second, params));
  if (method == "textDocument/references") return succeeded(references(uri, found->second, params));
  if (method == "textDocument/formatting") return succeeded(formatting(found->second));
  if (method == "textDocument/codeAction")
    return succeeded(code_actions(uri, found->second, params));
  if (method == "textDocument/documentSymbol") return succeeded(symbols(found->second));
  if (method == "textDocument/semanticTokens/full")
    return succeeded(semantic_tokens(found->second));
  if (method == "textDocument/rename") {
    auto edit = rename(uri, found->second, params);
    return edit ? succeeded(std::move(*edit)) : failed(kRequestFailed, edit.error());
  }
  return failed(kMethodNotFound, "there is no method '" + method + "'");
}

Json LanguageServer::capabilities() const {
  constexpr int kWholeText = 1;
  Json legend{{"tokenTypes", kTokenTypes}, {"tokenModifiers", {"declaration"}}};
  return {{"textDocumentSync", {{"openClose", true}, {"change", kWholeText}}},
          {"completionProvider", {{"triggerCharacters", {" ", "(", "/"}}}},
          {"hoverProvider", true},
          {"definitionProvider", true},
          {"referencesProvider", true},
          {"renameProvider", true},
          {"documentFormattingProvider", true},
          {"codeActionProvider", {{"codeActionKinds", {kQuickFix}}}},
          {"documentSymbolProvider", true},
          {"semanticTokensProvider", {{"legend", std::move(legend)}, {"full", true}}}};
}

const Occurrence* LanguageServer::pointed_at(const Document& document, const Json& params) const {
  return occurrence_at(document.names(), place_in(document, params));
}

Json LanguageServer::completion(const std::string& uri, const Document& document,
                                const Json& params) const {
  Json items = Json::array();
  const std::uint32_t place = place_in(document, params);
  std::vector<std::string> files;
  if (files_.includable && includes_at(document, place)) files = files_.includable(path_of(uri));
  for (const Proposal& p : proposals(document, place, robot(), files)) {
    // Editors do not know what belongs to the name of a topic.
    Json edit{{"range", to_json(document.source(), typed_part(document, place, p))},
              {"newText", p.text}};
    Json item{{"label", p.text}, {"kind", item_kind(p.kind)}, {"textEdit", std::move(edit)}};
    if (!p.detail.empty()) item["detail"] = p.detail;
    items.push_back(std::move(item));
  }
  return items;
}

Json LanguageServer::hover_at(const Document& document, const Json& params) const {
  const Occurrence* thing = pointed_at(document, params);
  const std::string text = thing == nullptr ? "" : hover(document, *thing, robot());
  if (text.empty()) return nullptr;
  return {{"contents", {{"kind", "markdown"}, {"value", text}}},
          {"range", to_json(document.source(), thing->span)}};
}

Json LanguageServer::definition(const std::string& uri, const Document& document,
                                const Json& params) const {
  const Occurrence* thing = pointed_at(document, params);
  if (thing == nullptr) return nullptr;
  for (const Occurrence& o : document.names()) {
    if (o.declares && o.same_as(*thing))
      return {{"uri", uri}, {"range", to_json(document.source(), o.span)}};
  }
  const Source& source = document.rules.source;
  const auto at_place = [&](const Place& place) -> Json {
    const Source& file = source.file(place.file);
    return {{"uri", place.file == 0 ? uri : uri_of(file.name())},
            {"range", to_json(file, place.span)}};
  };
  if (thing->kind == OccurrenceKind::kFile) {
    const auto included = load(thing->name, path_of(uri));
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

Json LanguageServer::references(const std::string& uri, const Document& document,
                                const Json& params) const {
  const Occurrence* thing = pointed_at(document, params);
  if (thing == nullptr) return nullptr;
  const Json* wanted = at(params, {"context", "includeDeclaration"});
  const bool with_declaration = wanted == nullptr || !wanted->is_boolean() || wanted->get<bool>();
  Json places = Json::array();
  for (const Occurrence& o : document.names()) {
    if (o.same_as(*thing) && (with_declaration || !o.declares))
      places.push_back({{"uri", uri}, {"range", to_json(document.source(), o.span)}});
  }
  return places;
}

Expected<Json> LanguageServer::rename(const std::string& uri, const Document& document,
                                      const Json& params) const {
  const Occurrence* thing = pointed_at(document, params);
  if (thing == nullptr) return Error{"there is no name here"};
  const bool is_ours = std::any_of(document.names().begin(), document.names().end(),
                                   [&](const auto& o) { return o.declares && o.same_as(*thing); });
  if (!is_ours) return Error{"'" + thing->name + "' is not declared in this file"};
  const std::string name = text_at(params, {"newName"});
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
  return Json{{"changes", {{uri, std::move(edits)}}}};
}

// One edit, of the whole text. A file with mistakes stays as it is: they are shown already.
Json LanguageServer::formatting(const Document& document) const {
  const auto text = format(document.source());
  if (!text || *text == document.source().text()) return Json::array();
  const auto end = static_cast<std::uint32_t>(document.source().text().size());
  return Json::array({{{"range", to_json(document.source(), {0, end})}, {"newText", *text}}});
}

// The fixes of mistakes within the range that the client asks about.
Json LanguageServer::code_actions(const std::string& uri, const Document& document,
                                  const Json& params) const {
  Json actions = Json::array();
  if (!wants_quick_fixes(params)) return actions;
  const std::uint32_t begin = place_in(document, params, {"range", "start"});
  const std::uint32_t end = place_in(document, params, {"range", "end"});
  for (const Diagnostic& d : document.diagnostics) {
    const bool touches = d.span.begin <= end && begin <= d.span.end;
    if (!d.fix || !touches) continue;
    Json edit{{"range", to_json(document.source(), d.fix->span)}, {"newText", d.fix->text}};
    actions.push_back({{"title", title_of(*d.fix, document.source())},
                       {"kind", kQuickFix},
                       {"diagnostics", Json::array({to_json(d, document.source())})},
                       {"edit", {{"changes", {{uri, Json::array({std::move(edit)})}}}}}});
  }
  // An editor applies the preferred one unasked, so there is none where there is a choice.
  if (actions.size() == 1) actions[0]["isPreferred"] = true;
  return actions;
}

// Rules hold their strategies; everything else that is declared stands beside them.
Json LanguageServer::symbols(const Document& document) const {
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
Json LanguageServer::semantic_tokens(const Document& document) const {
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
