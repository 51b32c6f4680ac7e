#include "rule_test/reader.h"

#include <algorithm>
#include <array>
#include <unordered_set>

#include "knowledge/component_states.h"
#include "language/line_reader.h"
#include "language/scanner.h"
#include "rule_test/answer_reader.h"
#include "rule_test/course_reader.h"
#include "rule_test/expectation_reader.h"
#include "rule_test/names.h"

namespace culprit::rule_test {
namespace {

using syntax::Name;

class Reader {
 public:
  Reader(const Source& source, const RuleSet& rules, std::vector<Diagnostic>& diagnostics)
      : source_(source),
        rules_(rules),
        read_(source, diagnostics),
        names_(rules, diagnostics),
        diagnostics_(diagnostics) {}

  Suite read() {
    for (std::uint32_t line = 1; line <= source_.line_count(); ++line) {
      Scanner scanner(source_.text(), source_.line(line));
      if (!scanner.at_end()) statement(scanner);
    }
    end_test();
    if (suite_.tests.empty() && diagnostics_.empty())
      read_.fail(Code::kIncomplete, {}, "this file has no test", "begin one with TEST \"name\"");
    return std::move(suite_);
  }

 private:
  struct Statement {
    std::string_view keyword;
    bool (Reader::*read)(Scanner&);
  };
  static constexpr std::size_t kStatementCount = 12;
  static const std::array<Statement, kStatementCount> kStatements;

  void statement(Scanner& s) {
    const Token head = s.next();
    if (head.kind == Token::Kind::kBad) {
      is_broken_ = true;
      read_.fail(Code::kBadToken, head.span, head.text, "");
      return;
    }
    keyword_ = head.span;
    std::vector<std::string_view> keywords;
    for (const Statement& candidate : kStatements) {
      if (head.text == candidate.keyword) {
        if (!(this->*candidate.read)(s) || !read_.line_ends(s)) is_broken_ = true;
        return;
      }
      keywords.push_back(candidate.keyword);
    }
    is_broken_ = true;
    std::string upper = head.text;
    std::transform(upper.begin(), upper.end(), upper.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    const bool lower_case = std::find(keywords.begin(), keywords.end(), upper) != keywords.end();
    const std::string near = lower_case ? upper : closest(upper, keywords);
    std::string all;
    for (const std::string_view keyword : keywords) all += " " + std::string(keyword);
    read_.fail(Code::kUnknownStatement, head.span,
               "no statement begins with '" + std::string(source_.text(head.span)) + "'",
               near.empty() ? "a line begins with one of" + all : "did you mean " + near + "?");
  }

  Scenario& scenario() {
    return suite_.tests.empty() ? suite_.shared : suite_.tests.back().scenario;
  }

  bool inside_test(std::string_view what) {
    return !suite_.tests.empty() ||
           read_.fail(Code::kOutOfPlace, keyword_, std::string(what) + " stands outside of a test",
                      "begin one with TEST \"name\"");
  }

  // ---- the file and its tests

  // Its paths are read by rule_files(), which also says what is wrong with them.
  bool rules_line(Scanner& s) {
    if (!suite_.tests.empty())
      return read_.fail(Code::kOutOfPlace, keyword_, "RULES stands inside a test",
                        "it holds for the whole file: write it before the first TEST");
    s = Scanner(source_.text(), {s.rest().end, s.rest().end});
    return true;
  }

  bool test(Scanner& s) {
    end_test();
    auto name = read_.name_or_text(s, "the test's name, in quotes if it has blanks");
    suite_.tests.emplace_back();
    suite_.tests.back().span = keyword_;
    is_broken_ = false;
    if (!name) return false;
    if (!test_names_.insert(name->text).second)
      return read_.fail(Code::kDuplicateName, name->span,
                        "another test of this file is called '" + name->text + "'",
                        "give each test a name of its own");
    suite_.tests.back().span = name->span;
    suite_.tests.back().name = std::move(name->text);
    return true;
  }

  void end_test() {
    if (suite_.tests.empty() || is_broken_) return;
    const Test& test = suite_.tests.back();
    if (test.length == Duration::zero())
      read_.fail(Code::kIncomplete, test.span, "this test does not say how long it runs",
                 "add for example RUN 10s");
    if (test.expectations.empty())
      read_.fail(Code::kIncomplete, test.span, "this test expects nothing",
                 "add for example EXPECT SomeRule RESOLVED BY 5s");
    for (const Expectation& e : test.expectations) {
      if (test.length > Duration::zero() && (e.by.value_or(e.after) > test.length))
        read_.fail(Code::kEmptyRange, e.span,
                   "the test is over after " + to_string(test.length) + ", before this time",
                   "let it RUN longer");
    }
  }

  bool run(Scanner& s) {
    if (!inside_test("RUN")) return false;
    Test& test = suite_.tests.back();
    const Span span = s.peek().span;
    const auto length = read_.positive_duration(s, "how long the test runs");
    if (!length) return false;
    if (test.length != Duration::zero())
      return read_.fail(Code::kDuplicateName, keyword_, "the length of this test is set already",
                        "keep one RUN line");
    test.length = std::min(*length, kLongestRun);
    if (*length > kLongestRun)
      return read_.fail(Code::kPolicyRange, span, "a test runs at most 1h", "");
    return true;
  }

  bool expect(Scanner& s) {
    if (!inside_test("EXPECT")) return false;
    auto expectation = read_expectation(s, read_, names_);
    if (!expectation) return false;
    const Span rest = s.rest();
    expectation->span = {keyword_.begin, rest.begin};
    suite_.tests.back().expectations.push_back(*expectation);
    return true;
  }

  // ---- the graph

  bool component(Scanner& s) {
    const auto name = read_.component_reference(s);
    const auto id = name ? names_.component(*name) : std::nullopt;
    if (!id) return false;
    while (!s.at_end()) {
      const Token clause = s.next();
      if (clause.text == "PUBLISHES") {
        if (!each_name(s, [&](const Name& n) { return publishes(*id, n); })) return false;
      } else if (clause.text == "SUBSCRIBES") {
        if (!each_endpoint(s, *id, EndpointKind::kSubscriber, "a topic")) return false;
      } else if (clause.text == "SERVES") {
        if (!each_endpoint(s, *id, EndpointKind::kServer, "a service")) return false;
      } else if (clause.text == "CALLS") {
        if (!each_endpoint(s, *id, EndpointKind::kClient, "a service")) return false;
      } else if (clause.text == "NEEDS") {
        if (!each_name(s, [&](const Name& n) { return needs(*id, n); })) return false;
      } else if (clause.text == "STATE") {
        const auto state = initial_state(s);
        if (!state) return false;
        scenario().states.push_back({*id, state->presence, state->lifecycle});
      } else {
        return read_.unexpected_clause(clause, kComponentClauses);
      }
    }
    return true;
  }
  static inline const std::vector<std::string_view> kComponentClauses = {
      "PUBLISHES", "SUBSCRIBES", "SERVES", "CALLS", "NEEDS", "STATE"};

  // One name and all that follow, up to the next clause.
  template <class Take>
  bool each_name(Scanner& s, Take take) {
    do {
      const auto name = read_.name_or_text(s, "a name");
      if (!name || !take(*name)) return false;
    } while (!s.at_end() && std::find(kComponentClauses.begin(), kComponentClauses.end(),
                                      s.peek().text) == kComponentClauses.end());
    return true;
  }

  bool each_endpoint(Scanner& s, ComponentId id, EndpointKind kind, const char* what) {
    return each_name(s, [&](const Name& name) {
      Scanner again(source_.text(), name.span);
      if (!read_.ros_name(again, what)) return false;
      scenario().endpoints.push_back({id, kind, name.text});
      return true;
    });
  }

  // A topic that no rule reads still is an edge of the graph.
  bool publishes(ComponentId id, const Name& name) {
    const bool is_topic = name.text.starts_with('/');
    if (is_topic) scenario().endpoints.push_back({id, EndpointKind::kPublisher, name.text});
    const bool is_read =
        !is_topic || std::any_of(rules_.topics.begin(), rules_.topics.end(),
                                 [&](const Topic& t) { return t.name == name.text; });
    if (!is_read) return true;
    const auto subject = names_.topic_or_signal(name);
    if (subject) scenario().origins.push_back({id, *subject});
    return subject.has_value();
  }

  bool needs(ComponentId consumer, const Name& name) {
    const auto producer = names_.component(name);
    if (!producer) return false;
    if (*producer == consumer)
      return read_.fail(Code::kContradiction, name.span, "a component cannot need itself", "");
    scenario().needs.push_back({consumer, *producer});
    return true;
  }

  struct State {
    Presence presence = Presence::kThere;
    Lifecycle lifecycle = Lifecycle::kUnknown;
  };
  std::optional<State> initial_state(Scanner& s) {
    const Token word = s.next();
    if (word.text == "absent") return State{Presence::kAbsent, Lifecycle::kActive};
    if (word.text == "unmanaged") return State{Presence::kThere, Lifecycle::kUnknown};
    if (const auto lifecycle = lifecycle_of(word.text)) return State{Presence::kThere, *lifecycle};
    read_.unexpected_clause(
        word, {"active", "inactive", "unconfigured", "finalized", "unmanaged", "absent"});
    return std::nullopt;
  }

  static std::optional<Lifecycle> lifecycle_of(std::string_view word) {
    for (const Lifecycle state : {Lifecycle::kActive, Lifecycle::kInactive,
                                  Lifecycle::kUnconfigured, Lifecycle::kFinalized}) {
      if (word == to_string(state)) return state;
    }
    return std::nullopt;
  }

  // ---- courses

  bool topic(Scanner& s) {
    const auto name = read_.ros_name(s, "a topic");
    const auto id = name ? names_.topic(*name) : std::nullopt;
    return id && course(s, *id);
  }
  bool signal(Scanner& s) {
    const auto name = read_.identifier(s, "a signal");
    const auto id = name ? names_.signal(*name) : std::nullopt;
    return id && course(s, *id);
  }
  bool level(Scanner& s) {
    const auto name = read_.name_or_text(s, "a diagnostic status");
    const auto id = name ? names_.diagnostic(*name) : std::nullopt;
    return id && course(s, *id);
  }
  bool parameter(Scanner& s) {
    const auto name = read_.component_reference(s);
    const auto component = name ? names_.component(*name) : std::nullopt;
    if (!component) return false;
    const auto parameter = read_.name_or_text(s, "a parameter");
    const auto id = parameter ? names_.parameter(*component, *parameter) : std::nullopt;
    return id && course(s, *id);
  }

  bool course(Scanner& s, Subject subject) {
    auto course = read_course(s, read_, rules_, subject);
    if (!course) return false;
    scenario().courses.push_back(std::move(*course));
    return true;
  }

  // ---- what happens, and how the robot answers

  bool at(Scanner& s) {
    const auto time = read_.duration(s, "a time");
    if (!time) return false;
    const auto name = read_.component_reference(s);
    const auto id = name ? names_.component(*name) : std::nullopt;
    if (!id) return false;
    Incident incident{*time, *id, Incident::Kind::kKilled, Lifecycle::kUnknown};
    const Token what = s.next();
    if (what.text == "STOPPED") {
      incident.kind = Incident::Kind::kStopped;
    } else if (what.text == "HUNG") {
      incident.kind = Incident::Kind::kHung;
    } else if (what.text == "STATE") {
      const Token word = s.next();
      const auto state = lifecycle_of(word.text);
      if (!state)
        return read_.unexpected_clause(word, {"active", "inactive", "unconfigured", "finalized"});
      incident.kind = Incident::Kind::kState;
      incident.lifecycle = *state;
    } else if (what.text != "KILLED") {
      return read_.unexpected_clause(what, {"KILLED", "STOPPED", "HUNG", "STATE"});
    }
    scenario().incidents.push_back(incident);
    return true;
  }

  bool adaptation(Scanner& s) {
    return read_answers_of_adaptation(s, read_, names_, rules_, scenario());
  }
  bool strategy(Scanner& s) {
    return read_answers_of_strategy(s, read_, names_, rules_, scenario());
  }

  const Source& source_;
  const RuleSet& rules_;
  LineReader read_;
  Names names_;
  std::vector<Diagnostic>& diagnostics_;
  Suite suite_;
  std::unordered_set<std::string> test_names_;
  bool is_broken_ = false;  // a line of the test under way; what follows from it is not reported
  Span keyword_;
};

const std::array<Reader::Statement, Reader::kStatementCount> Reader::kStatements = {{
    {"RULES", &Reader::rules_line},
    {"COMPONENT", &Reader::component},
    {"TOPIC", &Reader::topic},
    {"SIGNAL", &Reader::signal},
    {"LEVEL", &Reader::level},
    {"PARAMETER", &Reader::parameter},
    {"ADAPTATION", &Reader::adaptation},
    {"STRATEGY", &Reader::strategy},
    {"TEST", &Reader::test},
    {"AT", &Reader::at},
    {"EXPECT", &Reader::expect},
    {"RUN", &Reader::run},
}};

}  // namespace

std::vector<Name> rule_files(const Source& source, std::vector<Diagnostic>& diagnostics) {
  std::vector<Name> files;
  LineReader read(source, diagnostics);
  for (std::uint32_t line = 1; line <= source.line_count(); ++line) {
    Scanner s(source.text(), source.line(line));
    if (s.next().text != "RULES") continue;
    do {
      auto name = read.name_or_text(s, "the path of a rule file");
      if (!name) break;
      files.push_back(std::move(*name));
    } while (!s.at_end());
  }
  if (files.empty() && diagnostics.empty())
    read.fail(Code::kIncomplete, {}, "this file does not say which rules it tests",
              "begin it with RULES and a path, relative to this file");
  return files;
}

Suite read_suite(const Source& source, const RuleSet& rules, std::vector<Diagnostic>& diagnostics) {
  return Reader(source, rules, diagnostics).read();
}

}  // namespace culprit::rule_test
