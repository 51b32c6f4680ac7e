#include "cli/decision_report.h"

#include <algorithm>

#include <fmt/core.h>

#include "base/name_grammar.h"
#include "cli/journal_file.h"
#include "journal/json.h"
#include "knowledge/event_words.h"

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

std::string candidates_of(const Json& body) {
  const Json candidates = body.value("candidates", Json::array());
  if (!candidates.is_array() || candidates.empty()) return "";
  std::string out = "\nStrategies compared\n";
  for (const Json& each : candidates) {
    std::string numbers = fmt::format("relative cost {:.2f}", journal::number_of(each, "cost"));
    if (each.is_object() && each.contains("resolves"))
      numbers += fmt::format(", resolves it with {:.0f} %, relative value {:.2f}",
                             100 * journal::number_of(each, "resolves"),
                             journal::number_of(each, "value"));
    const std::string because = text_of(each, "because");
    out += fmt::format("  {:<24} {}: {}\n", text_of(each, "strategy"), numbers,
                       because.empty() ? "chosen" : "not chosen, " + because);
  }
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
  out += suspects_of(body) + answers_of(body) + hinges_of(body) + candidates_of(body);
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

}  // namespace culprit::cli
