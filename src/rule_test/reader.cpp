#include "rule_test/reader.h"

#include <algorithm>
#include <array>
#include <unordered_set>

#include "knowledge/component_states.h"
#include "knowledge/signal_store.h"
#include "language/line_reader.h"
#include "language/scanner.h"
#include "rule_test/expectation_reader.h"
#include "rule_test/names.h"

namespace culprit::rule_test {
namespace {

using syntax::Name;

// "10Hz": a rate is a name to the scanner.
std::optional<double> rate_of(const std::string& text) {
  if (!text.ends_with("Hz") || text.size() > 32) return std::nullopt;
  const Value number = value_from_text(text.substr(0, text.size() - 2));
  if (const auto* whole = std::get_if<std::int64_t>(&number)) return static_cast<double>(*whole);
  if (const auto* real = std::get_if<double>(&number)) return *real;
  return std::nullopt;
}

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
    Course course{subject, {}, {}};
    const bool is_sampled =
        std::holds_alternative<SignalId>(subject) || std::holds_alternative<DiagnosticId>(subject);
    if (is_sampled && s.peek().text == "EVERY") {
      s.next();
      const Span span = s.peek().span;
      course.period = read_.duration(s, "how often it is read");
      if (!course.period) return false;
      if (*course.period < kShortestPeriod)
        return read_.fail(Code::kPolicyRange, span, "at least 1ms must pass between readings", "");
    }
    do {
      if (!stretch(s, course)) return false;
    } while (!s.at_end());
    scenario().courses.push_back(std::move(course));
    return true;
  }

  // "2s: value", "2s..5s: value"
  bool stretch(Scanner& s, Course& course) {
    Stretch stretch;
    const auto from = read_.duration(s, "a time, as in 2s: or 2s..5s:");
    if (!from) return false;
    stretch.from = *from;
    if (s.peek().is("..")) {
      s.next();
      const Span span = s.peek().span;
      stretch.until = read_.duration(s, "a time");
      if (!stretch.until) return false;
      if (*stretch.until <= stretch.from)
        return read_.fail(Code::kEmptyRange, span, "this time is not after the one before", "");
      if (std::holds_alternative<ParameterId>(course.subject))
        return read_.fail(Code::kSyntax, span, "a parameter keeps its value until it is set again",
                          "write the time from which on it has it, as in 2s: true");
    }
    if (!read_.expect_symbol(s, ":")) return false;
    if (!value(s, course.subject, stretch)) return false;
    course.stretches.push_back(std::move(stretch));
    return true;
  }

  bool value(Scanner& s, Subject subject, Stretch& stretch) {
    const bool is_parameter = std::holds_alternative<ParameterId>(subject);
    if (s.peek().text == "silent" && s.peek().kind == Token::Kind::kIdentifier && !is_parameter) {
      s.next();
      return true;
    }
    if (std::holds_alternative<TopicId>(subject)) return rate(s, stretch);
    const std::uint32_t begin = s.position();
    stretch.value = literal(s);
    if (!stretch.value) return false;
    const Span span{begin, std::max(begin, last_end_)};
    if (std::holds_alternative<DiagnosticId>(subject)) return is_level(*stretch.value, span);
    if (const auto* id = std::get_if<SignalId>(&subject)) return fits(*stretch.value, *id, span);
    return true;
  }

  bool rate(Scanner& s, Stretch& stretch) {
    const Name name = s.next_name();
    const auto rate = rate_of(name.text);
    if (!rate)
      return read_.fail(Code::kSyntax, name.span, "expected a rate, or silent",
                        "a rate is written like 10Hz");
    if (!(*rate > 0 && *rate <= kHighestRate))
      return read_.fail(Code::kPolicyRange, name.span, "a rate is above 0Hz and at most 1000Hz",
                        "write silent where nothing comes");
    stretch.value = Value(*rate);
    return true;
  }

  std::optional<Value> literal(Scanner& s) {
    const bool negative = s.peek().is("-");
    if (negative) s.next();
    const Token token = s.next();
    last_end_ = token.span.end;
    const bool is_truth =
        token.kind == Token::Kind::kIdentifier && (token.text == "true" || token.text == "false");
    if (token.kind == Token::Kind::kNumber) {
      if (const auto* whole = std::get_if<std::int64_t>(&token.literal))
        return Value(negative ? -*whole : *whole);
      const double number = std::get<double>(token.literal);
      return Value(negative ? -number : number);
    }
    if (!negative && is_truth) return Value(token.text == "true");
    if (!negative && token.kind == Token::Kind::kString)
      return Value(std::get<std::string>(token.literal));
    read_.fail_token(token, "a value", "a value is true, false, a number, or a text in quotes");
    return std::nullopt;
  }

  bool fits(const Value& value, SignalId id, Span span) {
    std::string text;
    if (as_type(value, rules_[id].type, text).known) return true;
    return read_.fail(Code::kTypeMismatch, span,
                      rules_[id].name + " is a " + std::string(to_string(rules_[id].type)) +
                          " in the rules, and this is none",
                      "");
  }

  bool is_level(const Value& value, Span span) {
    const auto* level = std::get_if<std::int64_t>(&value);
    if (level != nullptr && *level >= 0 && *level <= 3) return true;
    return read_.fail(Code::kPolicyRange, span,
                      "a level is 0 (OK), 1 (WARN), 2 (ERROR) or 3 (STALE)", "");
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

  // Everywhere in the rules where this component is adapted in this way.
  bool adaptation(Scanner& s) {
    const auto name = read_.component_reference(s);
    const auto component = name ? names_.component(*name) : std::nullopt;
    if (!component) return false;
    const Token word = s.next();
    const auto type = syntax::adaptation_type(word.text);
    if (!type) {
      const std::string near = closest(word.text, syntax::adaptation_keywords());
      return read_.fail_token(word, "an adaptation, such as restart or set_parameter",
                              near.empty() ? "" : "did you mean " + near + "?");
    }
    std::optional<Name> subject;
    if (!is_answer(s.peek().text)) {
      subject = read_.name_or_text(s, kAnswersText);
      if (!subject) return false;
    }
    std::vector<Place> places;
    for (std::size_t i = 0; i < rules_.strategies.size(); ++i) {
      const auto& adaptations = rules_.strategies[i].adaptations;
      for (std::size_t a = 0; a < adaptations.size(); ++a) {
        const bool same = adaptations[a].component == *component && adaptations[a].type == *type &&
                          (!subject || adaptations[a].subject == subject->text);
        if (same) places.push_back({StrategyId(i), a});
      }
    }
    if (places.empty())
      return read_.fail(Code::kUnknownName,
                        {name->span.begin, (subject ? subject->span : word.span).end},
                        "no strategy of the rules adapts " + name->text + " in this way", "");
    return answers(s, places);
  }

  bool strategy(Scanner& s) {
    const auto name = read_.name_or_text(s, "a strategy");
    const auto id = name ? names_.strategy(*name) : std::nullopt;
    return id && answers(s, {{*id, std::nullopt}});
  }

  struct Place {
    StrategyId strategy;
    std::optional<std::size_t> adaptation;  // nothing: all of them
  };
  static constexpr const char* kAnswersText = "HEALS, TAKES, REFUSED or UNANSWERED";
  static bool is_answer(std::string_view word) {
    return word == "HEALS" || word == "TAKES" || word == "REFUSED" || word == "UNANSWERED";
  }

  bool answers(Scanner& s, const std::vector<Place>& places) {
    do {
      const Token word = s.next();
      if (word.text == "HEALS") {
        if (!heals(s, places)) return false;
      } else if (word.text == "TAKES") {
        const auto time = read_.duration(s, "how long it takes");
        if (!time) return false;
        answer(places, {}, time);
      } else if (word.text == "REFUSED") {
        answer(places, Answer::Manner::kRefuses, {});
      } else if (word.text == "UNANSWERED") {
        answer(places, Answer::Manner::kNeverAnswers, {});
      } else {
        return read_.unexpected_clause(word, {"HEALS", "TAKES", "REFUSED", "UNANSWERED"});
      }
    } while (!s.at_end());
    return true;
  }

  void answer(const std::vector<Place>& places, std::optional<Answer::Manner> manner,
              std::optional<Duration> takes) {
    for (const Place& place : places) {
      const std::size_t count = rules_[place.strategy].adaptations.size();
      for (std::size_t a = 0; a < count; ++a) {
        if (place.adaptation && *place.adaptation != a) continue;
        scenario().answers.push_back({place.strategy, a, manner, takes});
      }
    }
  }

  // "HEALS /topic signal AFTER 300ms"
  bool heals(Scanner& s, const std::vector<Place>& places) {
    Cure cure;
    do {
      const auto name = read_.name_or_text(s, "a topic or a signal");
      const auto subject = name ? names_.topic_or_signal(*name) : std::nullopt;
      if (!subject) return false;
      cure.subjects.push_back(*subject);
    } while (!s.at_end() && !is_answer(s.peek().text) && s.peek().text != "AFTER");
    if (s.peek().text == "AFTER") {
      s.next();
      const auto after = read_.duration(s, "how long after it took effect");
      if (!after) return false;
      cure.after = *after;
    }
    for (const Place& place : places) {
      cure.strategy = place.strategy;
      cure.adaptation = place.adaptation;
      scenario().cures.push_back(cure);
    }
    return true;
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
  std::uint32_t last_end_ = 0;
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
