#include "lsp/completion.h"

#include <algorithm>
#include <set>
#include <sstream>

#include "language/functions.h"
#include "language/scanner.h"
#include "lsp/live_names.h"

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
  for (const auto* all : {&document.names(), &document.names_elsewhere()}) {
    for (const Occurrence& o : *all) {
      if (o.kind == kind && seen.insert(o.name).second) out.push_back({as, o.name, ""});
    }
  }
}

std::vector<std::string> words_of(std::string_view text) {
  std::istringstream in{std::string(text)};
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

bool is_identifier_part(std::string_view text) {
  return std::all_of(text.begin(), text.end(),
                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
}

// The call in whose parentheses a text ends.
struct OpenCall {
  const FunctionInfo* function = nullptr;  // null if in none
  std::size_t index = 0;                   // of the argument
  std::string first;                       // argument, if it is complete
};

OpenCall open_call(std::string_view text) {
  OpenCall call;
  int depth = 0;
  std::size_t first_comma = text.size();
  for (std::size_t i = text.size(); i-- > 0;) {
    if (text[i] == ')') ++depth;
    if (text[i] == ',' && depth == 0) {
      ++call.index;
      first_comma = i;
    }
    if (text[i] != '(' || depth-- > 0) continue;
    std::size_t begin = i;
    while (begin > 0 && is_identifier_part(text.substr(begin - 1, 1))) --begin;
    call.function = find_function(text.substr(begin, i - begin));
    const auto first = words_of(text.substr(i + 1, first_comma - i - 1));
    if (call.index > 0 && first.size() == 1) call.first = first[0];
    return call;
  }
  return call;
}

// The proposals for the end of one line's text.
class Completion {
 public:
  Completion(const Document& document, std::string_view before, const LiveInventory* robot,
             const std::vector<std::string>& files)
      : document_(document),
        before_(before),
        robot_(robot),
        files_(files),
        words_(words_of(before)) {
    // The word under the cursor is what is being typed.
    const bool is_typing = !before.empty() && before.back() != ' ' && before.back() != '\t';
    if (is_typing && !words_.empty()) words_.pop_back();
    // A step is completed as its adaptation.
    if (!words_.empty() && words_.front() == "THEN") {
      words_.erase(words_.begin());
      is_step_ = true;
    }
  }

  std::vector<Proposal> find() {
    if (words_.empty() && is_step_) return keywords({"ADAPTATION"});
    if (words_.empty()) {
      return keywords({"RULE",      "POLICIES", "TRIGGER", "STRATEGY",   "ADAPTATION", "THEN",
                       "COMPONENT", "SIGNAL",   "CONST",   "DEPENDENCY", "GROUP",      "IGNORE",
                       "INTERLOCK", "ABORT",    "DRILL",   "ROBOT",      "CYCLE",      "INCLUDE",
                       "USE",       "TEMPLATE", "END"});
    }
    if (words_.front() == "INCLUDE") return includable();
    if (words_.front() == "USE") return use();
    if (words_.front() == "TEMPLATE" || words_.front() == "END") return {};
    if (const OpenCall call = open_call(before_); call.function != nullptr) return argument(call);
    const std::string& statement = words_.front();
    if (statement == "ADAPTATION") return adaptation();
    if (statement == "COMPONENT") {
      if (words_.back() == "NODE" || words_.back() == "IN") return names(&live_nodes);
      if (words_.back() == "CONTAINER") return keywords({"docker", "podman"});
      if (words_.back() == "LIFECYCLE") return keywords({"self", "managed", "launcher"});
      for (const char* takes_text : {"UNIT", "HOST", "LAUNCH", "ENV", "SETUP", "CWD", "PLUGIN",
                                     "PACKAGE", "PARAMETERS", "REMAP"}) {
        if (words_.back() == takes_text) return {};
      }
      if (words_.size() > 1 && words_[words_.size() - 2] == "UNIT")
        return keywords({"USER", "HOST", "NODE", "RESPAWNED", "REQUIRED", "READY", "LIFECYCLE"});
      return keywords({"NODE", "LAUNCH", "ENV", "SETUP", "CWD", "UNIT", "CONTAINER", "HOST", "IN",
                       "PLUGIN", "PACKAGE", "PARAMETERS", "REMAP", "RESPAWNED", "REQUIRED", "READY",
                       "LIFECYCLE"});
    }
    if (statement == "SIGNAL") return signal();
    if (statement == "IGNORE") {
      return words_.size() == 1 ? keywords({"TOPIC"}) : names(&live_topics);
    }
    if (statement == "POLICIES") {
      return words_.size() == 1
                 ? keywords({"ERROR", "WARNING", "NON_CRITICAL"})
                 : keywords({"FOR", "HOLD", "COOLDOWN", "ATTEMPTS", "ON_CHANGE", "REPORT"});
    }
    if (statement == "STRATEGY" && words_.size() == 4) return keywords({"WHEN", "LASTRESORT"});
    if (statement == "STRATEGY" && words_.back() == "LASTRESORT")
      return keywords({"WITHIN", "WHEN"});
    if (statement == "DEPENDENCY") {
      if (words_.size() == 2) return keywords({"ON"});
      return components();
    }
    if (statement == "GROUP") {
      if (words_.size() == 1) return {};
      return before_.find('}') != std::string_view::npos && words_.back() != "MANAGER"
                 ? keywords({"MANAGER"})
                 : components();
    }
    if (statement == "DRILL") {
      if (words_.size() == 1) return components();
      if (words_.size() == 2) return keywords({"set_parameter", "without", "limit"});
      return words_.back() == "without"
                 ? keywords({"kill", "hang", "slow", "deactivate", "restart", "loss"})
                 : std::vector<Proposal>{};
    }
    const bool has_expression = statement == "TRIGGER" || statement == "CONST" ||
                                statement == "STRATEGY" || statement == "INTERLOCK" ||
                                statement == "ABORT";
    return has_expression ? expression() : std::vector<Proposal>{};
  }

 private:
  std::vector<Proposal> includable() {
    std::vector<Proposal> out;
    for (const std::string& file : files_) out.push_back({Kind::kFile, "\"" + file + "\"", ""});
    return out;
  }

  std::vector<Proposal> use() {
    if (before_.find('(') != std::string_view::npos) {
      if (before_.find(')') != std::string_view::npos) return keywords({"IN"});
      std::vector<Proposal> out = components();
      for (Proposal& topic : topics()) out.push_back(std::move(topic));
      return out;
    }
    if (words_.size() > 1) return keywords({"IN"});
    std::vector<Proposal> out;
    for (const auto& [name, known] : document_.rules.templates)
      out.push_back({Kind::kTemplate, name, known.usage});
    return out;
  }

  std::vector<Proposal> expression() {
    std::vector<Proposal> out;
    add_named(document_, Occurrence::Kind::kSignal, Kind::kSignal, out);
    add_named(document_, Occurrence::Kind::kConstant, Kind::kConstant, out);
    for (const std::string_view name : function_names())
      out.push_back({Kind::kFunction, std::string(name), std::string(find_function(name)->usage)});
    return out;
  }

  std::vector<Proposal> argument(const OpenCall& call) {
    if (words_.back() == "FROM") return components();
    const bool has_place = call.index < call.function->arguments.size();
    switch (has_place ? call.function->arguments[call.index] : Argument::kExpression) {
      case Argument::kTopic:
        return topics();
      case Argument::kComponent:
        return components();
      case Argument::kParameter:
        return parameters(call.first);
      case Argument::kAction:
        return {};
      case Argument::kOutcome: {
        std::vector<Proposal> outcomes;
        for (const std::string_view word : counted_outcomes())
          outcomes.push_back({Kind::kKeyword, std::string(word), "outcome of a goal"});
        return outcomes;
      }
      case Argument::kLogLevel: {
        std::vector<Proposal> levels;
        for (const std::string_view word : log_levels())
          levels.push_back({Kind::kKeyword, std::string(word), "lines at this level or above"});
        return levels;
      }
      case Argument::kDiagnostic:
        return names(&live_statuses);
      case Argument::kExpression:
        break;
    }
    return expression();
  }

  std::vector<Proposal> adaptation() {
    if (words_.size() == 1) return components();
    if (words_.size() == 2) {
      std::vector<Proposal> out;
      for (const std::string_view type : syntax::adaptation_keywords())
        out.push_back({Kind::kKeyword, std::string(type), "adaptation"});
      return out;
    }
    const std::string& type = words_[2];
    if (words_.size() == 3) return type == "call" ? names(&live_routines) : parameters(words_[1]);
    return type == "change_communication" ? topics() : expression();
  }

  std::vector<Proposal> signal() {
    const std::string& last = words_.back();
    const std::size_t count = words_.size();
    if (last == "TOPIC") return topics();
    if (last == "DIAGNOSTIC") return names(&live_statuses);
    if (last == "PARAMETER" || last == "FROM") return components();
    if (last == "KEY" && robot_ != nullptr) return live_keys(*robot_, words_[count - 2]);
    if (count > 2 && words_[count - 2] == "PARAMETER") return parameters(last);
    return keywords({"DIAGNOSTIC", "TOPIC", "PARAMETER", "KEY", "FIELD", "FROM", "STALE", "RANGE"});
  }

  // ---- names of the file, then of the robot

  std::vector<Proposal> names(std::vector<Proposal> (*live)(const LiveInventory&)) {
    return robot_ == nullptr ? std::vector<Proposal>{} : live(*robot_);
  }

  std::vector<Proposal> components() {
    return with_live(Occurrence::Kind::kComponent, Kind::kComponent, names(&live_nodes));
  }
  std::vector<Proposal> topics() {
    return with_live(Occurrence::Kind::kTopic, Kind::kTopic, names(&live_topics));
  }

  std::vector<Proposal> with_live(Occurrence::Kind kind, Kind as, std::vector<Proposal> live) {
    std::vector<Proposal> out;
    add_named(document_, kind, as, out);
    for (Proposal& proposal : live) {
      const auto known = std::find_if(out.begin(), out.end(),
                                      [&](const Proposal& p) { return p.text == proposal.text; });
      if (known == out.end()) {
        out.push_back(std::move(proposal));
      } else {
        known->detail = proposal.detail;
      }
    }
    return out;
  }

  std::vector<Proposal> parameters(const std::string& component) {
    if (robot_ == nullptr) return {};
    return live_parameters(*robot_, document_.component_called(component));
  }

  const Document& document_;
  const std::string_view before_;
  const LiveInventory* robot_;
  const std::vector<std::string>& files_;
  std::vector<std::string> words_;
  bool is_step_ = false;  // THEN stands in front of them
};

// The parameters of the template whose lines are around `offset`.
void add_parameters(const Document& document, std::uint32_t offset, std::vector<Proposal>& out) {
  for (const syntax::Template& t : document.file().templates) {
    if (offset < t.lines.begin || offset > t.lines.end) continue;
    for (const syntax::TemplateParameter& p : t.parameters)
      out.push_back({Kind::kParameter, "{" + p.name.text + "}", "parameter of " + t.name.text});
  }
}

}  // namespace

std::vector<Proposal> proposals(const Document& document, std::uint32_t offset,
                                const LiveInventory* robot, const std::vector<std::string>& files) {
  const std::uint32_t line_begin =
      document.source().line(document.source().position(offset).line).begin;
  const std::string_view before = document.source().text({line_begin, offset});
  std::vector<Proposal> out = Completion(document, before, robot, files).find();
  if (words_of(before).size() > 1) add_parameters(document, offset, out);
  return out;
}

Span typed_part(const Document& document, std::uint32_t offset, const Proposal& proposal) {
  const std::string_view text = document.source().text();
  const bool is_identifier = is_identifier_part(proposal.text);
  const auto belongs = [&](char c) {
    return is_identifier ? is_identifier_part({&c, 1})
                         : !is_blank(c) && c != '\n' && c != '(' && c != ',';
  };
  std::uint32_t begin = offset;
  while (begin > 0 && belongs(text[begin - 1])) --begin;
  return {begin, offset};
}

}  // namespace culprit::lsp
