#include "lsp/language_server.h"

#include <string_view>
#include <tuple>

#include "lsp/document_answers.h"
#include "lsp/wire.h"

namespace culprit::lsp {
namespace {

// JSON-RPC 2.0 and LSP error codes.
constexpr int kParseError = -32700;
constexpr int kInvalidRequest = -32600;
constexpr int kMethodNotFound = -32601;
constexpr int kRequestFailed = -32803;

Json succeeded(Json result) { return {{"result", std::move(result)}}; }

Json failed(int code, const std::string& message) {
  return {{"error", {{"code", code}, {"message", message}}}};
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
  if (!method.starts_with("textDocument/"))
    return failed(kMethodNotFound, "there is no method '" + method + "'");
  return answer_about({uri, found->second, params, robot_ ? &*robot_ : nullptr},
                      method.substr(std::string_view("textDocument/").size()));
}

Json LanguageServer::answer_about(const Asked& asked, const std::string& what) const {
  const std::string path = path_of(asked.uri);
  if (what == "completion") {
    const auto includable = [&] { return files_.includable(path); };
    using Includable = std::function<std::vector<std::string>()>;
    return succeeded(completion(asked, files_.includable ? Includable(includable) : nullptr));
  }
  if (what == "definition")
    return succeeded(definition(asked, [&](const std::string& file) { return load(file, path); }));
  if (what == "hover") return succeeded(hover(asked));
  if (what == "references") return succeeded(references(asked));
  if (what == "formatting") return succeeded(formatting(asked));
  if (what == "codeAction") return succeeded(code_actions(asked));
  if (what == "documentSymbol") return succeeded(symbols(asked));
  if (what == "semanticTokens/full") return succeeded(semantic_tokens(asked));
  if (what == "rename") {
    auto edit = rename(asked);
    return edit ? succeeded(std::move(*edit)) : failed(kRequestFailed, edit.error());
  }
  return failed(kMethodNotFound, "there is no method 'textDocument/" + what + "'");
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

}  // namespace culprit::lsp
