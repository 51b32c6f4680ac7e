#include "cli/decision_report.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/core.h>

#include "base/name_grammar.h"
#include "cli/journal_file.h"
#include "journal/json.h"
#include "journal/session.h"
#include "knowledge/beliefs.h"
#include "knowledge/event_words.h"
#include "language/checker.h"

namespace culprit::cli {
namespace {

using journal::Entry;

// culprit's own rows are escaped; the file may be another's.
std::string text_of(const Json& json, const char* key) {
  return escape_controls(journal::text_of(json, key));
}

// A strategy was chosen, be it begun or held back by the governor.
bool is_choice(const Json& body) {
  const std::string type = text_of(body, "type");
  return type == words_of<StrategyChosen>().name ||
         (type == words_of<ActionHeldBack>().name && body.contains("candidates"));
}

bool is_decision(const Entry& entry, const Json& body) {
  return entry.kind == journal::kind::kEvent &&
         (is_choice(body) || text_of(body, "type") == words_of<FailureHeldBack>().name);
}

// The latest decision of the rule that row `id` is about, not after it.
Expected<std::optional<Entry>> decision_at(const journal::Reader& journal, std::int64_t id) {
  std::string rule;
  if (id != 0) {
    const auto row = journal.entry(id);
    if (!row) return Error{row.error()};
    if (!*row) return std::optional<Entry>();
    const Json body = parse_json((*row)->body);
    rule = text_of(body, "rule");
    if (is_decision(**row, body) || rule.empty()) return row;
  }
  // Without a given row, a chosen strategy says more than a failure that waits.
  std::int64_t before = id;
  while (true) {
    auto row = journal.newest(journal::kind::kEvent, before);
    if (!row || !*row) return row;
    const Json body = parse_json((*row)->body);
    const bool fits =
        id == 0 ? is_choice(body) : is_decision(**row, body) && text_of(body, "rule") == rule;
    if (fits) return row;
    before = (*row)->id;
  }
}

bool is_answer(const Json& piece) {
  return text_of(piece, "source") == to_string(EvidenceSource::kAnswer);
}

// " 1.20 s"; empty if it is not known.
std::string age_of(const Json& piece) {
  if (!piece.is_object() || !piece.contains("age_ns")) return "";
  return fmt::format(" {:.2f} s", seconds(Duration(journal::integer_of(piece, "age_ns"))));
}

std::string evidence_line(const Json& piece) {
  const std::string age = age_of(piece);
  return fmt::format("{}{}{} ({}, {:+.1f})", text_of(piece, "text"), age.empty() ? "" : ", for",
                     age, text_of(piece, "source"), journal::number_of(piece, "log_odds"));
}

std::string suspects_of(const Json& body) {
  const Json suspects = body.value("suspects", Json::array());
  if (!suspects.is_array() || suspects.empty()) return "";
  std::string out = "\nPossible causes\n";
  for (const Json& each : suspects) {
    out += fmt::format("  {:>3.0f} %  {}, by {}\n", 100 * journal::number_of(each, "probability"),
                       text_of(each, "component"), text_of(each, "failure"));
    const Json evidence = each.is_object() ? each.value("evidence", Json::array()) : Json::array();
    for (const Json& piece : evidence) {
      if (!is_answer(piece)) out += "           " + evidence_line(piece) + "\n";
    }
  }
  return out;
}

std::string answers_of(const Json& body) {
  std::string out;
  for (const Json& suspect : body.value("suspects", Json::array())) {
    const Json evidence =
        suspect.is_object() ? suspect.value("evidence", Json::array()) : Json::array();
    for (const Json& piece : evidence) {
      if (is_answer(piece))
        out += "  " + text_of(piece, "text") + "," + age_of(piece) + " before the decision\n";
    }
  }
  return out.empty() ? "" : "\nAsked and answered\n" + out;
}

std::string hinges_of(const Json& body) {
  std::string out;
  for (const Json& suspect : body.value("suspects", Json::array())) {
    const Json evidence =
        suspect.is_object() ? suspect.value("evidence", Json::array()) : Json::array();
    for (const Json& piece : evidence) {
      const std::string without = text_of(piece, "without");
      if (!without.empty())
        out += fmt::format("  without \"{}\", {} would be held responsible\n",
                           text_of(piece, "text"), without);
    }
  }
  // Strategies of one rule mostly wait for the same.
  for (const Json& candidate : body.value("candidates", Json::array())) {
    const std::string end = text_of(candidate, "ends");
    const std::string line = "  " + end + "\n";
    if (!end.empty() && out.find(line) == std::string::npos) out += line;
  }
  return out.empty() ? "" : "\nWhat would change this\n" + out;
}

// The success rate of a strategy when a decision was made.
struct SuccessRate {
  double in_file = 0;  // 0..1
  double now = 0;
};

// The rates of the strategies of a rule, by name. Empty: the journal does not have the rules.
using SuccessRates = std::map<std::string, SuccessRate>;

Expected<SuccessRates> rates_before(const journal::Reader& journal, std::int64_t decision,
                                    const std::string& rule) {
  SuccessRates rates;
  const auto begin = journal.newest(journal::kind::kSession, decision);
  if (!begin) return Error{begin.error()};
  if (!*begin) return rates;
  const auto session = journal::session_from_json(parse_json((*begin)->body));
  if (!session) return rates;
  const auto rules = check(Source(session->rules_path, session->rules_text)).rules;
  if (!rules) return rates;
  const auto take = [&](const journal::LearnedBelief& learned, const Belief& belief) {
    const auto known = rates.find(learned.strategy);
    if (learned.rule == rule && known != rates.end()) known->second.now = belief.mean().value;
  };
  for (const Strategy& each : rules->strategies) {
    if ((*rules)[each.rule].name != rule) continue;
    const Belief prior = initial_belief(each.success, each.confidence);
    rates[each.name] = {each.success.value, prior.mean().value};
    for (const journal::LearnedBelief& learned : session->learned.beliefs) {
      if (learned.strategy == each.name) take(learned, journal::grown_from(prior, learned));
    }
  }
  auto rows = journal.entries(journal::Which::kReadable, (*begin)->id + 1);
  if (!rows) return Error{rows.error()};
  Entry entry;
  auto more = rows->next(entry);
  for (; more && *more && entry.id < decision; more = rows->next(entry)) {
    if (entry.kind != journal::kind::kBelief) continue;
    const Json body = parse_json(entry.body);
    const journal::LearnedBelief learned{
        journal::text_of(body, "rule"),
        journal::text_of(body, "strategy"),
        {journal::number_of(body, "alpha", 1), journal::number_of(body, "beta", 1)},
        {}};
    take(learned, learned.belief);
  }
  if (!more) return Error{more.error()};
  return rates;
}

int in_percent(double probability) { return static_cast<int>(std::lround(100 * probability)); }

// " (success rate 94 %; the file says 90 %)"
std::string text_of(const SuccessRate& rate) {
  const std::string now = fmt::format(" (success rate {} %", in_percent(rate.now));
  const bool is_same = in_percent(rate.now) == in_percent(rate.in_file);
  return now + (is_same ? ")" : fmt::format("; the file says {} %)", in_percent(rate.in_file)));
}

std::string candidates_of(const Json& body, const SuccessRates& rates) {
  const Json candidates = body.value("candidates", Json::array());
  if (!candidates.is_array() || candidates.empty()) return "";
  std::string out = "\nStrategies compared\n";
  bool differs = false;
  for (const Json& each : candidates) {
    std::string numbers = fmt::format("relative cost {:.2f}", journal::number_of(each, "cost"));
    if (each.is_object() && each.contains("resolves")) {
      const double resolves = journal::number_of(each, "resolves");
      const auto rate = rates.find(journal::text_of(each, "strategy"));
      const bool is_known = rate != rates.end();
      differs |= is_known && in_percent(resolves) != in_percent(rate->second.now);
      numbers +=
          fmt::format(", resolves it with {} %{}, relative value {:.2f}", in_percent(resolves),
                      is_known ? text_of(rate->second) : "", journal::number_of(each, "value"));
    }
    const std::string because = text_of(each, "because");
    out += fmt::format("  {:<24} {}: {}\n", text_of(each, "strategy"), numbers,
                       because.empty() ? "chosen" : "not chosen, " + because);
  }
  if (differs)
    out +=
        "  (Other possible causes make a strategy less likely to resolve the failure than its "
        "success rate; strategies that are ruled out make it more likely.)\n";
  return out;
}

bool is_over(const std::string& type) {
  return type == words_of<FailureResolved>().name || type == words_of<FailureLost>().name;
}

// The events after the decision for the same rule, up to the end of the strategy; the other rows in
// between belong to other failures.
Expected<std::vector<Entry>> sequel_of(const journal::Reader& journal, const Entry& decision,
                                       const std::string& rule) {
  std::vector<Entry> sequel;
  auto rows = journal.entries(journal::Which::kReadable, decision.id + 1);
  if (!rows) return Error{rows.error()};
  std::vector<std::int64_t> commands;
  Entry entry;
  auto more = rows->next(entry);
  // A strategy that was interrupted is finished by the next run.
  for (; more && *more; more = rows->next(entry)) {
    const Json body = parse_json(entry.body);
    const auto number = journal::integer_of(body, "command", -1);
    const bool is_outcome = entry.kind == journal::kind::kOutcome;
    const bool is_ours = is_outcome
                             ? std::find(commands.begin(), commands.end(), number) != commands.end()
                             : text_of(body, "rule") == rule;
    if (!is_ours) continue;
    if (is_decision(entry, body)) break;
    if (entry.kind == journal::kind::kIntent) commands.push_back(number);
    sequel.push_back(entry);
    if (is_over(text_of(body, "type"))) break;
  }
  if (!more) return Error{more.error()};
  return sequel;
}

struct ExplainedDecision {
  Entry entry;
  Json body;
  std::vector<Entry> sequel{};
};

Expected<ExplainedDecision> read_decision(const journal::Reader& journal, std::int64_t id) {
  const auto decision = decision_at(journal, id);
  if (!decision) return Error{decision.error()};
  if (!*decision)
    return Error{id == 0 ? "nothing was decided yet"
                         : fmt::format("there is no row {}, or nothing was decided about it; "
                                       "culprit log shows the rows",
                                       id)};
  ExplainedDecision explained{**decision, parse_json((*decision)->body)};
  if (!is_decision(explained.entry, explained.body)) return explained;
  auto sequel = sequel_of(journal, explained.entry, text_of(explained.body, "rule"));
  if (!sequel) return Error{sequel.error()};
  explained.sequel = std::move(*sequel);
  return explained;
}

}  // namespace

Expected<std::string> explain_decision(const journal::Reader& journal, std::int64_t id) {
  const auto decision = read_decision(journal, id);
  if (!decision) return Error{decision.error()};
  const auto& [entry, body, sequel] = *decision;
  std::string out =
      fmt::format("Row {}, {}\n{}\n", entry.id, local_time(entry.at), text_of(body, "text"));
  if (!is_decision(entry, body)) return out + to_indented(body) + "\n";
  const auto rates = rates_before(journal, entry.id, journal::text_of(body, "rule"));
  if (!rates) return Error{rates.error()};
  out += suspects_of(body) + answers_of(body) + hinges_of(body) + candidates_of(body, *rates);
  if (!sequel.empty()) out += "\nOutcome\n";
  for (const Entry& each : sequel) {
    if (const std::string line = log_line(each); !line.empty()) out += line + "\n";
  }
  return out;
}

Expected<std::string> decision_as_json(const journal::Reader& journal, std::int64_t id) {
  const auto decision = read_decision(journal, id);
  if (!decision) return Error{decision.error()};
  Json document{{"decision", log_document(decision->entry)}, {"sequel", Json::array()}};
  for (const Entry& each : decision->sequel) document["sequel"].push_back(log_document(each));
  return to_line(document);
}

Expected<std::int64_t> latest_decision_about(const std::vector<std::string>& rules,
                                             const journal::Reader& journal) {
  std::int64_t latest = 0;
  auto rows = journal.entries(journal::Which::kReadable);
  if (!rows) return Error{rows.error()};
  Entry entry;
  auto more = rows->next(entry);
  for (; more && *more; more = rows->next(entry)) {
    const bool may_be_one = std::ranges::any_of(
        rules, [&](const std::string& rule) { return entry.body.find(rule) != std::string::npos; });
    if (!may_be_one) continue;
    const Json body = parse_json(entry.body);
    const bool is_about_one =
        std::ranges::find(rules, journal::text_of(body, "rule")) != rules.end();
    if (is_about_one && is_decision(entry, body)) latest = entry.id;
  }
  if (!more) return Error{more.error()};
  return latest;
}

}  // namespace culprit::cli
