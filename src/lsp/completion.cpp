#include "lsp/completion.h"

#include <set>
#include <sstream>

#include "language/functions.h"

namespace culprit::lsp {
namespace {

using Kind = Proposal::Kind;

std::vector<Proposal> keywords(std::initializer_list<const char*> words) {
  std::vector<Proposal> out;
  for (const char* word : words) out.push_back({Kind::kKeyword, word, ""});
  return out;
}

// Each thing of `kind` that the file names, once.
void add_named(const Document& document, Occurrence::Kind kind, Kind as,
               std::vector<Proposal>& out) {
  std::set<std::string> seen;
  for (const Occurrence& o : document.names) {
    if (o.kind == kind && seen.insert(o.name).second) out.push_back({as, o.name, ""});
  }
}

std::vector<Proposal> in_expression(const Document& document) {
  std::vector<Proposal> out;
  add_named(document, Occurrence::Kind::kSignal, Kind::kSignal, out);
  add_named(document, Occurrence::Kind::kConstant, Kind::kConstant, out);
  for (const std::string_view name : function_names())
    out.push_back({Kind::kFunction, std::string(name), std::string(find_function(name)->usage)});
  return out;
}

// The function in whose parentheses the text ends; null if in none.
const FunctionInfo* open_call(std::string_view text) {
  int depth = 0;
  for (std::size_t i = text.size(); i-- > 0;) {
    if (text[i] == ')') ++depth;
    if (text[i] != '(' || depth-- > 0) continue;
    std::size_t begin = i;
    while (begin > 0 && (std::isalnum(static_cast<unsigned char>(text[begin - 1])) != 0 ||
                         text[begin - 1] == '_'))
      --begin;
    return find_function(text.substr(begin, i - begin));
  }
  return nullptr;
}

std::vector<Proposal> in_adaptation(const Document& document, std::size_t words) {
  std::vector<Proposal> out;
  if (words == 1) add_named(document, Occurrence::Kind::kComponent, Kind::kComponent, out);
  if (words == 2) {
    for (const std::string_view type : syntax::adaptation_keywords())
      out.push_back({Kind::kKeyword, std::string(type), "adaptation"});
  }
  return words > 2 ? in_expression(document) : out;
}

std::vector<std::string> words_of(std::string_view text) {
  std::istringstream in{std::string(text)};
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

}  // namespace

std::vector<Proposal> proposals(const Document& document, std::uint32_t offset) {
  const std::uint32_t line_begin =
      document.source.line(document.source.position(offset).line).begin;
  const std::string_view before = document.source.text({line_begin, offset});
  auto words = words_of(before);
  // The word under the cursor is what is being typed.
  const bool is_typing = !before.empty() && before.back() != ' ' && before.back() != '\t';
  if (is_typing && !words.empty()) words.pop_back();
  if (words.empty())
    return keywords({"RULE", "POLICIES", "TRIGGER", "STRATEGY", "ADAPTATION", "COMPONENT", "SIGNAL",
                     "CONST", "DEPENDENCY", "IGNORE", "ROBOT", "CYCLE"});

  if (const FunctionInfo* function = open_call(before)) {
    std::vector<Proposal> out;
    if (function->arguments[0] == Argument::kTopic)
      add_named(document, Occurrence::Kind::kTopic, Kind::kTopic, out);
    else if (function->arguments[0] == Argument::kComponent)
      add_named(document, Occurrence::Kind::kComponent, Kind::kComponent, out);
    else
      out = in_expression(document);
    return out;
  }
  const std::string& statement = words.front();
  if (statement == "ADAPTATION") return in_adaptation(document, words.size());
  if (statement == "POLICIES") {
    return words.size() == 1 ? keywords({"ERROR", "WARNING", "NON_CRITICAL"})
                             : keywords({"FOR", "HOLD", "COOLDOWN", "ATTEMPTS", "ON_CHANGE"});
  }
  if (statement == "COMPONENT") return keywords({"NODE", "LAUNCH"});
  if (statement == "SIGNAL")
    return keywords({"DIAGNOSTIC", "TOPIC", "PARAMETER", "KEY", "FIELD", "STALE", "RANGE"});
  if (statement == "IGNORE") return keywords({"TOPIC"});
  if (statement == "STRATEGY" && words.size() == 4) return keywords({"WHEN"});
  if (statement == "DEPENDENCY") {
    std::vector<Proposal> out = keywords({"ON"});
    add_named(document, Occurrence::Kind::kComponent, Kind::kComponent, out);
    return out;
  }
  const bool has_expression =
      statement == "TRIGGER" || statement == "CONST" || statement == "STRATEGY";
  return has_expression ? in_expression(document) : std::vector<Proposal>{};
}

}  // namespace culprit::lsp
