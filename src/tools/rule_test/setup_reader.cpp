#include "rule_test/setup_reader.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/invariant.h"
#include "knowledge/component_states.h"
#include "language/foreign_words.h"
#include "rule_test/course_reader.h"

namespace culprit::rule_test {
namespace {

using syntax::Name;

const std::vector<std::string_view> kComponentClauses = {
    "PUBLISHES", "SUBSCRIBES", "SERVES", "CALLS", "NEEDS", "STATE", "KILLED", "STOPPED", "HUNG"};

bool is_component_clause(std::string_view word) {
  return std::find(kComponentClauses.begin(), kComponentClauses.end(), word) !=
         kComponentClauses.end();
}

std::optional<Lifecycle> lifecycle_of(std::string_view word) {
  for (const Lifecycle state : {Lifecycle::kActive, Lifecycle::kInactive, Lifecycle::kUnconfigured,
                                Lifecycle::kFinalized}) {
    if (word == to_string(state)) return state;
  }
  return std::nullopt;
}

const std::vector<std::string_view> kIncidents = {"KILLED", "STOPPED", "HUNG", "STATE"};

// The statement that other tools for tests call `upper`; empty: it is none of `known`.
std::string statement_for(std::string_view upper, const std::vector<std::string_view>& known) {
  constexpr auto kWords = std::to_array<std::pair<std::string_view, std::string_view>>(
      {{"ASSERT", "EXPECT"},    {"VERIFY", "EXPECT"},   {"CHECK", "EXPECT"},
       {"SHOULD", "EXPECT"},    {"THEN", "EXPECT"},     {"WAIT", "RUN"},
       {"TIMEOUT", "RUN"},      {"SLEEP", "RUN"},       {"DURATION", "RUN"},
       {"LENGTH", "RUN"},       {"CASE", "TEST"},       {"SCENARIO", "TEST"},
       {"DEF", "TEST"},         {"IT", "TEST"},         {"DESCRIBE", "TEST"},
       {"EVAL_TIME", "RUN"},    {"GIVEN", "COMPONENT"}, {"MOCK", "ADAPTATION"},
       {"STUB", "ADAPTATION"},  {"INCLUDE", "RULES"},   {"NODE", "COMPONENT"},
       {"DIAGNOSTIC", "LEVEL"}, {"ACTION", "GOAL"},     {"PARAM", "PARAMETER"},
       {"WHEN", "AT"}});
  for (const auto& [theirs, ours] : kWords) {
    if (theirs == upper && std::ranges::find(known, ours) != known.end()) return std::string(ours);
  }
  return "";
}

// The incidents of a process.
std::optional<Incident::Kind> incident_of(std::string_view word) {
  if (word == "KILLED") return Incident::Kind::kKilled;
  if (word == "STOPPED") return Incident::Kind::kStopped;
  if (word == "HUNG") return Incident::Kind::kHung;
  return std::nullopt;
}

}  // namespace

const std::vector<std::string_view>& SetupReader::keywords() {
  static const std::vector<std::string_view> kKeywords = {"COMPONENT", "TOPIC", "SIGNAL", "LEVEL",
                                                          "PARAMETER", "AT",    "GOAL",   "LOG"};
  return kKeywords;
}

bool SetupReader::read(std::string_view keyword, Scanner& s, Scenario& scenario) {
  CULPRIT_ASSERT(std::ranges::find(keywords(), keyword) != keywords().end());
  scenario_ = &scenario;
  if (keyword == "COMPONENT") return component(s);
  if (keyword == "TOPIC") return topic(s);
  if (keyword == "SIGNAL") return signal(s);
  if (keyword == "LEVEL") return level(s);
  if (keyword == "PARAMETER") return parameter(s);
  if (keyword == "GOAL") return goal(s);
  if (keyword == "LOG") return log(s);
  return at(s);
}

// ---- the graph

bool SetupReader::component(Scanner& s) {
  const auto name = read_.component_reference(s);
  const auto id = name ? names_.component(*name) : std::nullopt;
  if (!id) return false;
  while (!s.at_end()) {
    if (!component_clause(s, *id)) return false;
  }
  return true;
}

bool SetupReader::component_clause(Scanner& s, ComponentId id) {
  const Token clause = s.next();
  if (clause.text == "PUBLISHES")
    return each_name(s, [&](const Name& n) { return publishes(id, n); });
  if (clause.text == "SUBSCRIBES")
    return each_endpoint(s, id, EndpointKind::kSubscriber, "a topic");
  if (clause.text == "SERVES") return each_endpoint(s, id, EndpointKind::kServer, "a service");
  if (clause.text == "CALLS") return each_endpoint(s, id, EndpointKind::kClient, "a service");
  if (clause.text == "NEEDS") return each_name(s, [&](const Name& n) { return needs(id, n); });
  if (clause.text == "STATE") return initial_state(s, id);
  const auto incident = incident_of(clause.text);
  if (!incident) return read_.unexpected_clause(clause, kComponentClauses);
  scenario_->incidents.push_back({Duration::zero(), id, *incident, Lifecycle::kUnknown});
  return true;
}

// One name and all that follow, up to the next clause.
template <class Take>
bool SetupReader::each_name(Scanner& s, Take take) {
  do {
    if (s.peek().is(",")) return read_.fail_comma(s.next());
    const auto name = read_.name_or_text(s, "a name");
    if (!name || !take(*name)) return false;
  } while (!s.at_end() && !is_component_clause(s.peek().text));
  return true;
}

bool SetupReader::each_endpoint(Scanner& s, ComponentId id, EndpointKind kind, const char* what) {
  return each_name(s, [&](const Name& name) {
    Scanner again(source_.text(), name.span);
    if (!read_.ros_name(again, what)) return false;
    scenario_->endpoints.push_back({id, kind, name.text});
    return true;
  });
}

// A topic that no rule reads still is an edge of the graph.
bool SetupReader::publishes(ComponentId id, const Name& name) {
  const bool is_topic = name.text.starts_with('/');
  if (is_topic) scenario_->endpoints.push_back({id, EndpointKind::kPublisher, name.text});
  for (std::size_t t = 0; is_topic && t < rules_.topics.size(); ++t) {
    const auto& [read, publisher] = rules_.topics[t];
    if (read == name.text && (!publisher || *publisher == id))
      scenario_->origins.push_back({id, TopicId(t)});
  }
  if (is_topic) return true;
  const std::string topic = "/" + name.text;
  if (!names_.is_signal(name.text) &&
      std::ranges::any_of(rules_.topics, [&](const auto& each) { return each.name == topic; }))
    return read_.fail(Code::kBadRosName, name.span, "'" + name.text + "' is no full topic name",
                      "write " + topic, Edit{name.span, topic});
  const auto subject = names_.topic_or_signal(name);
  if (!subject) return false;
  scenario_->origins.push_back({id, *subject});
  // The topic of a signal is an edge of the graph, too.
  const auto* signal = std::get_if<SignalId>(&*subject);
  const auto* field =
      signal != nullptr ? std::get_if<TopicField>(&rules_[*signal].source) : nullptr;
  if (field != nullptr)
    scenario_->endpoints.push_back({id, EndpointKind::kPublisher, rules_[field->topic].name});
  return true;
}

bool SetupReader::needs(ComponentId consumer, const Name& name) {
  if (name.text.starts_with('/') && !names_.is_component(name.text))
    return read_.fail(Code::kUnknownName, name.span, "NEEDS names components",
                      "for a topic write SUBSCRIBES " + name.text);
  const auto producer = names_.component(name);
  if (!producer) return false;
  if (*producer == consumer)
    return read_.fail(Code::kContradiction, name.span, "a component cannot need itself", "");
  scenario_->needs.push_back({consumer, *producer});
  return true;
}

bool SetupReader::initial_state(Scanner& s, ComponentId id) {
  const Token word = s.next();
  if (word.text == "absent") {
    scenario_->states.push_back({id, Presence::kAbsent, Lifecycle::kActive});
  } else if (word.text == "unmanaged") {
    scenario_->states.push_back({id, Presence::kThere, Lifecycle::kUnknown});
  } else if (const auto lifecycle = lifecycle_of(word.text)) {
    scenario_->states.push_back({id, Presence::kThere, *lifecycle});
  } else {
    return read_.unexpected_clause(
        word, {"active", "inactive", "unconfigured", "finalized", "unmanaged", "absent"});
  }
  return true;
}

// ---- courses

bool SetupReader::topic(Scanner& s) {
  auto name = read_.ros_name(s, "a topic");
  if (name && s.peek().text == "FROM") {
    s.next();
    const auto publisher = read_.component_reference(s);
    const auto component = publisher ? names_.component(*publisher) : std::nullopt;
    if (!component) return false;
    name->text += " FROM " + rules_[*component].name;
    name->span.end = publisher->span.end;
  }
  const auto id = name ? names_.topic(*name) : std::nullopt;
  return id && course(s, *id);
}

bool SetupReader::signal(Scanner& s) {
  const auto name = read_.identifier(s, "a signal");
  const auto id = name ? names_.signal(*name) : std::nullopt;
  return id && course(s, *id);
}

bool SetupReader::level(Scanner& s) {
  const auto name = read_.name_or_text(s, "a diagnostic status");
  const auto id = name ? names_.diagnostic(*name) : std::nullopt;
  return id && course(s, *id);
}

bool SetupReader::parameter(Scanner& s) {
  const auto name = read_.component_reference(s);
  const auto component = name ? names_.component(*name) : std::nullopt;
  if (!component) return false;
  const auto parameter = read_.name_or_text(s, "a parameter");
  const auto id = parameter ? names_.parameter(*component, *parameter) : std::nullopt;
  return id && course(s, *id);
}

bool SetupReader::course(Scanner& s, Subject subject) {
  auto course = read_course(s, read_, rules_, subject);
  if (!course) return false;
  scenario_->courses.push_back(std::move(*course));
  return true;
}

// GOAL /action 2s, or GOAL /action 2s..5s aborted.
bool SetupReader::goal(Scanner& s) {
  auto action = read_.ros_name(s, "an action");
  if (!action) return false;
  if (!names_.is_topic(action->text + std::string(kStatusOfAction)))
    return read_.fail(Code::kUnknownName, action->span,
                      "no trigger of the rules reads goals of '" + action->text + "'",
                      "write an action that goals() or goal_age() names");
  action->text += kStatusOfAction;
  const auto topic = names_.topic(*action);
  const auto from = topic ? read_.duration(s, "when it begins") : std::nullopt;
  if (!from) return false;
  GoalCourse goal{*topic, *from, {}, GoalStatus::kUnknown};
  if (!s.at_end()) {
    if (!read_.expect_symbol(s, "..")) return false;
    goal.until = read_.duration(s, "when it ends");
    if (!goal.until) return false;
    const Token word = s.next();
    const auto outcome = counted_outcome(word.text);
    if (!outcome || !is_over(*outcome))
      return read_.unexpected_clause(word, {"succeeded", "canceled", "aborted"});
    goal.outcome = *outcome;
  }
  scenario_->goals.push_back(goal);
  return true;
}

// LOG camera ERROR 2s, or LOG camera ERROR 2s..5s, which is ten lines a second.
bool SetupReader::log(Scanner& s) {
  const auto name = read_.component_reference(s);
  const auto id = name ? names_.component(*name) : std::nullopt;
  if (!id) return false;
  const Token word = s.next();
  const auto level = log_level(word.text);
  if (!level) return read_.unexpected_clause(word, log_levels());
  const auto from = read_.duration(s, "when it is written");
  if (!from) return false;
  LogCourse course{*id, *level, *from, {}};
  if (!s.at_end()) {
    if (!read_.expect_symbol(s, "..")) return false;
    course.until = read_.duration(s, "until when lines are written");
    if (!course.until) return false;
  }
  scenario_->logs.push_back(course);
  return true;
}

// ---- what happens

bool SetupReader::at(Scanner& s) {
  const auto time = read_.duration(s, "a time");
  if (!time || !is_subject_of_at(s)) return false;
  const auto name = read_.component_reference(s);
  const auto id = name ? names_.component(*name) : std::nullopt;
  if (!id) return false;
  Incident incident{*time, *id, Incident::Kind::kState, Lifecycle::kUnknown};
  const Token what = s.next();
  if (const auto kind = incident_of(what.text)) {
    incident.kind = *kind;
  } else if (what.text == "STATE") {
    const Token word = s.next();
    const auto state = lifecycle_of(word.text);
    if (!state)
      return read_.unexpected_clause(word, {"active", "inactive", "unconfigured", "finalized"});
    incident.lifecycle = *state;
  } else if (lifecycle_of(what.text)) {
    return read_.fail(Code::kSyntax, what.span, "STATE is missing before this",
                      "write STATE " + std::string(what.text),
                      Edit{{what.span.begin, what.span.begin}, "STATE "});
  } else {
    return read_.unexpected_clause(what, kIncidents);
  }
  scenario_->incidents.push_back(incident);
  return true;
}

// "AT 2s KILL camera", "AT 2s TOPIC /rgb silent": reported.
bool SetupReader::is_subject_of_at(const Scanner& s) {
  Scanner ahead = s.ahead();
  const Token word = ahead.next();
  if (word.kind != Token::Kind::kIdentifier || names_.is_component(std::string(word.text)))
    return true;
  const std::string upper = upper_case(word.text);
  const auto& statements = keywords();
  if (std::ranges::find(statements, upper) != statements.end() && upper != "COMPONENT")
    return read_.fail(Code::kSyntax, word.span, "AT says only what happens to a component",
                      "write the time behind the name, as in TOPIC /scan 2s: silent");
  std::string incident = closest(upper, kIncidents);
  if (std::ranges::find(kIncidents, upper) != kIncidents.end()) incident = upper;
  if (incident.empty()) incident = clause_of_other_tools(upper, kIncidents);
  const bool is_swapped = incident_of(incident).has_value();
  if (!is_swapped) return true;
  if (ahead.at_end())
    return read_.fail(Code::kSyntax, word.span,
                      "a component is missing in front of '" + std::string(word.text) + "'",
                      "write for example AT 2s camera " + incident);
  ahead.take('(');  // "kill(camera)"
  const syntax::Name component = ahead.next_name();
  ahead.take(')');
  const Span span{word.span.begin, ahead.taken()};
  const std::string meant = component.text + " " + incident;
  return read_.fail(Code::kSyntax, span, "the component stands in front of what happens to it",
                    "write " + meant, Edit{span, meant});
}

bool is_of_rules(std::string_view upper) {
  constexpr auto kWords = std::to_array<std::string_view>(
      {"RULE", "POLICIES", "TRIGGER", "CONST", "DEPENDENCY", "INTERLOCK", "CYCLE", "ROBOT", "GROUP",
       "IGNORE", "TEMPLATE", "USE"});
  return std::ranges::find(kWords, upper) != kWords.end();
}

namespace {

// A word that stands in front of all tests elsewhere.
bool is_of_set_up(std::string_view upper) {
  return upper == "BEFORE_EACH" || upper == "BEFOREEACH" || upper == "SETUP" ||
         upper == "BACKGROUND" || upper == "FIXTURE";
}

}  // namespace

std::string fail_unknown_statement(LineReader& read, const Source& source, const Token& head,
                                   const std::vector<std::string_view>& keywords) {
  const std::string upper = upper_case(head.text);
  const bool is_there = std::ranges::find(keywords, upper) != keywords.end();
  std::string near = is_there ? upper : statement_for(upper, keywords);
  std::string remedy = "did you mean " + near + "?";
  if (near.empty() && is_of_rules(upper)) {
    remedy = "it stands in the .rules file, which RULES names";
  } else if (near.empty()) {
    near = closest(upper, keywords);
    remedy = "did you mean " + near + "?";
  }
  if (near.empty() && is_of_set_up(upper)) {
    remedy = "remove the word: lines in front of the first TEST hold for every test";
  } else if (near.empty() && head.kind == Token::Kind::kDuration) {
    remedy = "write AT in front of it";
  } else if (near.empty() && !is_of_rules(upper)) {
    remedy = "a line begins with one of";
    for (const std::string_view keyword : keywords) remedy += " " + std::string(keyword);
  }
  read.fail(Code::kUnknownStatement, head.span,
            "no statement begins with '" + std::string(source.text(head.span)) + "'", remedy);
  return near;
}

}  // namespace culprit::rule_test
