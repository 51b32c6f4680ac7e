#include <array>

#include "lsp/language_server.h"
#include "rule_files/rule_files.h"
#include "rule_graph/draft_graph.h"
#include "rule_json/from_json.h"
#include "rule_json/to_json.h"
#include "web/calls.h"

namespace culprit::web {
namespace {

constexpr const char* kUri = "culprit:rules";  // what the language server calls the text

// The questions that an editor may ask about a text; any other would need a session.
constexpr std::array<std::string_view, 4> kQuestions = {
    "textDocument/completion", "textDocument/hover", "textDocument/formatting",
    "textDocument/codeAction"};

http::Answer read(RuleDesk& desk) {
  auto content = desk.read();
  if (!content) return http::refuse(500, content.error());
  return {200,
          {{"path", desk.path()},
           {"text", std::move(content->text)},
           {"version", std::move(content->version)},
           {"can_save", desk.can_save()}}};
}

http::Answer save(RuleDesk& desk, const Json& body) {
  const auto text = http::text_of(body, "text");
  const auto version = http::text_of(body, "version");
  if (!text || !version) return http::refuse(400, "send the texts 'text' and 'version'");
  const auto outcome = desk.save(*text, *version);
  if (const auto* refusal = std::get_if<RuleDesk::Refusal>(&outcome)) {
    const bool is_stale = refusal->problem == RuleDesk::Problem::kChangedMeanwhile;
    return http::refuse(is_stale ? 409 : 403, refusal->message);
  }
  return {200, {{"version", std::get<std::string>(outcome)}}};
}

// One question of an editor, answered by a language server that knows nothing but this text and what
// it includes.
http::Answer ask(const RuleDesk& desk, const Json& body) {
  const auto text = http::text_of(body, "text");
  if (!text) return http::refuse(400, "send the rules as 'text'");
  Json reply{{"diagnostics", Json::array()}, {"result", nullptr}};
  lsp::LanguageServer server("web",
                             [&](const Json& message) {
                               if (message.contains("id")) {
                                 reply["result"] = message.value("result", Json());
                               } else if (message["params"]["uri"] == kUri) {
                                 reply["diagnostics"] = message["params"]["diagnostics"];
                               }
                             },
                             {desk.loader(), [&](const std::string&) {
                                return desk.can_save() ? rule_files::includable(desk.path())
                                                       : std::vector<std::string>{};
                              }});
  const Json document{{"uri", kUri}};
  server.handle({{"method", "textDocument/didOpen"},
                 {"params", {{"textDocument", {{"uri", kUri}, {"text", *text}}}}}});
  const auto method = http::text_of(body, "method");
  if (!method) return {200, reply};
  if (std::find(kQuestions.begin(), kQuestions.end(), *method) == kQuestions.end())
    return http::refuse(
        400, "'method' has to be one that asks about a text, such as textDocument/hover");
  Json params = Json::object();
  if (const auto sent = body.find("params"); sent != body.end() && sent->is_object())
    params = *sent;
  params["textDocument"] = document;
  server.handle({{"id", 1}, {"method", *method}, {"params", params}});
  return {200, reply};
}

http::Answer as_json(const Json& body) {
  const auto text = http::text_of(body, "text");
  if (!text) return http::refuse(400, "send the rules as 'text'");
  const auto json = rule_json::to_json(Source(kTextOfPage, *text));
  if (!json) return http::refuse(422, json.error());
  return {200, *json};
}

http::Answer as_text(const Json& body) {
  const auto text = rule_json::to_rules(kTextOfPage, to_line(body));
  if (!text) return http::refuse(422, text.error());
  return {200, {{"text", *text}}};
}

http::Answer graph(const RuleDesk& desk, const Json& body) {
  const auto text = http::text_of(body, "text");
  if (!text) return http::refuse(400, "send the rules as 'text'");
  const auto draft = rule_graph::graph_of_draft(expand(Source(kTextOfPage, *text), desk.loader()));
  if (!draft) return http::refuse(422, draft.error());
  Json answer = rule_graph::as_json(draft->graph);
  answer["errors"] = draft->errors;
  answer["warnings"] = draft->warnings;
  return {200, std::move(answer)};
}

}  // namespace

std::vector<http::Route> rule_routes(RuleDesk& desk) {
  return {
      {http::Method::kGet, "/api/rules", [&desk](const Json&) { return read(desk); }},
      {http::Method::kPut, "/api/rules", [&desk](const Json& body) { return save(desk, body); }},
      {http::Method::kPost, "/api/rules/ask", [&desk](const Json& body) { return ask(desk, body); },
       http::Role::kLook},
      {http::Method::kPost, "/api/rules/graph",
       [&desk](const Json& body) { return graph(desk, body); }, http::Role::kLook},
      {http::Method::kPost, "/api/rules/json", as_json, http::Role::kLook},
      {http::Method::kPost, "/api/rules/text", as_text, http::Role::kLook}};
}

}  // namespace culprit::web
