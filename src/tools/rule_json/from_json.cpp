#include "rule_json/from_json.h"

#include <algorithm>
#include <vector>

#include "language/diagnostic.h"
#include "language/formatter.h"
#include "language/parser.h"
#include "rule_json/document.h"
#include "rule_json/line_writer.h"
#include "rule_json/to_json.h"

namespace culprit::rule_json {
namespace {

class Converter {
 public:
  Converter(const std::string& name, const Json& document) : name_(name), document_(document) {}

  Expected<std::string> convert() {
    if (document()) {
      statements();
      if (document_.contains("end")) comment_lines(document_["end"], "/end");
    }
    if (complaints_.empty()) parse_all();
    if (!complaints_.empty()) return Error{complaints_};
    return format(Source(name_, text_));
  }

 private:
  bool document() {
    if (!document_.is_object())
      return complain("", "this is no object", "begin with {\"version\": 1, \"statements\": [");
    const std::vector<std::string_view> members = {"$schema", "version", "statements", "end"};
    for (const auto& [member, value] : document_.items()) {
      if (std::find(members.begin(), members.end(), member) == members.end())
        complain(pointer("", member), "there is no such member", nearest(member, members));
    }
    if (!document_.contains("version") || document_["version"] != kVersion)
      return complain("/version", "this must be 1",
                      "another version is for another version of culprit");
    if (!document_.contains("statements") || !document_["statements"].is_array())
      return complain("/statements", "this must be an array",
                      "it holds the lines of the rule file");
    return true;
  }

  void statements() {
    std::size_t index = 0;
    for (const Json& statement : document_["statements"]) {
      const std::string at = "/statements/" + std::to_string(index++);
      if (!statement.is_object()) {
        complain(at, "this is no object", "a statement is {\"statement\": \"RULE\", ...}");
        continue;
      }
      if (statement.contains("above")) comment_lines(statement["above"], at + "/above");
      LineWriter writer(statement, [&](const std::string& member, const std::string& cause,
                                       const std::string& remedy) {
        complain(pointer(at, member), cause, remedy);
      });
      add_line(writer.write(), at);
    }
  }

  // Lines without a statement.
  void comment_lines(const Json& lines, const std::string& at) {
    if (!lines.is_array()) {
      complain(at, "this must be an array", "it holds a text for each line of comments");
      return;
    }
    std::size_t index = 0;
    for (const Json& line : lines) {
      const std::string here = at + "/" + std::to_string(index++);
      const bool is_blank_line = line == "";
      if (is_blank_line || is_comment(line)) {
        add_line(line.get<std::string>(), here);
      } else {
        complain(here, "this is no line of comment", "it is empty, or begins with # or //");
      }
    }
  }

  void add_line(const std::string& line, const std::string& at) {
    text_ += line + "\n";
    places_.push_back(at);
  }

  // Finds the mistakes that no single line shows: a strategy outside of a rule, a word of the
  // language as a name.
  void parse_all() {
    const Source source(name_, text_);
    std::vector<Diagnostic> diagnostics;
    parse(source, diagnostics);
    for (const Diagnostic& d : diagnostics) {
      complain(places_[source.position(d.span.begin).line - 1], d.cause, d.remedy);
    }
  }

  // Gives false, for `return complain(...)`.
  bool complain(const std::string& at, const std::string& cause, const std::string& remedy) {
    complaints_ += name_ + ": " + (at.empty() ? "the document" : at) + ": " + cause +
                   (remedy.empty() ? "" : "; " + remedy) + "\n";
    return false;
  }

  const std::string& name_;
  const Json& document_;
  std::string text_;
  std::vector<std::string> places_;  // of each line of text_, as JSON pointers
  std::string complaints_;
};

}  // namespace

Expected<std::string> to_rules(const std::string& name, const std::string& json) {
  const auto document = parse_document(name, json);
  if (!document) return Error{document.error()};
  return Converter(name, *document).convert();
}

}  // namespace culprit::rule_json
