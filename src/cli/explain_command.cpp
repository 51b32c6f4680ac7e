#include <charconv>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "base/name_grammar.h"
#include "cli/commands.h"
#include "cli/decision_report.h"
#include "cli/explained_name.h"
#include "cli/glossary.h"
#include "cli/journal_file.h"
#include "doctor/finding_explanations.h"
#include "incident_reports/incident_report.h"
#include "journal/json.h"
#include "language/explanations.h"

namespace culprit::cli {
namespace {

struct ExplainOptions {
  std::vector<std::string> words;
  std::string what;  // the words as one text
  bool lists_terms = false;
  bool last = false;
  JournalOption journal;
  bool markdown = false;
  bool json = false;
};

Json to_json(const Explanation& e) {
  return {{"code", to_string(e.code)},
          {"title", e.title},
          {"why", e.why},
          {"wrong", e.wrong},
          {"right", e.right}};
}

Json to_json(const Term& term) {
  return {{"term", term.name}, {"section", term.section}, {"meaning", term.meaning}};
}

int list_terms(bool is_json) {
  Json all = Json::array();
  std::string section;
  for (const Term& term : glossary()) {
    if (is_json) {
      all.push_back(to_json(term));
      continue;
    }
    if (term.section != section) fmt::print("{}{}\n", section.empty() ? "" : "\n", term.section);
    section = term.section;
    fmt::print("  {}\n", term.name);
  }
  if (is_json) fmt::print("{}\n", to_line(all));
  return kOk;
}

Json to_json(const doctor::Explanation& e) {
  return {{"code", e.code},
          {"title", e.title},
          {"why", e.why},
          {"found", e.found},
          {"remedy", e.remedy}};
}

int explain_row(const ExplainOptions& options) {
  std::int64_t id = 0;
  const std::string& text = options.what;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (!options.last && (error != std::errc() || end != text.data() + text.size() || id < 1))
    return fail("'" + text + "' is no row of a journal"), kUsage;
  const auto journal = options.journal.open();
  if (!journal) return fail(journal.error());
  const auto report =
      options.json ? decision_as_json(*journal, id) : explain_decision(*journal, id);
  if (!report) return fail(report.error());
  fmt::print("{}{}", *report, options.json ? "\n" : "");
  return kOk;
}

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

// "R012" for "E012", or a term; empty: none is near.
std::string nearest_subject(const std::string& what) {
  constexpr std::size_t kCode = 4;
  for (const char letter : {'R', 'D'}) {
    const std::string code = letter + (what.size() == kCode ? what.substr(1) : "");
    const bool is_code =
        find_explanation(code) != nullptr || doctor::find_explanation(code) != nullptr;
    if (is_code) return code;
  }
  return nearest_term(what);
}

Json without_decision(const ExplainedName& found, const std::string& name) {
  return {{"name", name},
          {"kind", found.kind},
          {"rules", found.rules},
          {"decision", nullptr},
          {"sequel", Json::array()}};
}

int print_name(const ExplainOptions& options, const ExplainedName& found,
               const journal::Reader& journal) {
  const auto decision = latest_decision_about(found.rules, journal);
  if (!decision) return fail(decision.error());
  if (options.json) {
    Json document = without_decision(found, options.what);
    if (*decision != 0) {
      const auto json = decision_as_json(journal, *decision);
      if (!json) return fail(json.error());
      document.update(parse_json(*json));
    }
    fmt::print("{}\n", to_line(document));
    return kOk;
  }
  fmt::print("{}", found.text);
  if (*decision == 0) {
    fmt::print("  No decision was made about it yet.\n");
    return kOk;
  }
  const auto report = explain_decision(journal, *decision);
  if (!report) return fail(report.error());
  fmt::print("\nThe latest decision about it\n\n{}", *report);
  return kOk;
}

// The remedy for a word that is no code, term or name; may be empty.
std::string remedy_of(const std::string& what, const std::optional<RuleSet>& rules) {
  const bool is_incident =
      what.find('-') != std::string::npos && incident_reports::began_by_id(what);
  if (is_incident) return "; culprit incident " + what + " -o incident.html shows an incident";
  std::string near = rules ? nearest_name(*rules, what) : "";
  if (near.empty()) near = nearest_subject(what);
  return near.empty() ? "" : "; did you mean '" + printable(near) + "'?";
}

// A name of the rules that the journal has.
int explain_name(const ExplainOptions& options) {
  const auto journal = options.journal.open();
  auto rules = journal ? latest_rules(*journal) : Error{journal.error()};
  if (rules && *rules) {
    if (const auto found = find_name(**rules, options.what))
      return print_name(options, *found, *journal);
  }
  const std::optional<RuleSet> known = rules ? std::move(*rules) : std::nullopt;
  return fail("there is no code, term, rule, component or strategy '" + printable(options.what) +
                  "'" + remedy_of(options.what, known) +
                  (known ? ""
                         : "\nThe names of rules are unknown: " +
                               (rules ? "the journal has none" : rules.error())) +
                  "\nculprit explain lists all codes, culprit explain --terms all terms; culprit "
                  "explain --last explains the latest decision.",
              kUsage);
}

int explain(const ExplainOptions& options) {
  if (options.lists_terms) return list_terms(options.json);
  if (options.last || is_number(options.what)) return explain_row(options);
  if (options.markdown) {
    const bool of_doctor = options.what == "doctor";
    fmt::print("{}", of_doctor ? doctor::findings_page() : diagnostics_page());
    return kOk;
  }
  if (options.what.empty() && options.json) {
    Json all = Json::array();
    for (const Explanation& e : explanations()) all.push_back(to_json(e));
    for (const doctor::Explanation& e : doctor::explanations()) all.push_back(to_json(e));
    fmt::print("{}\n", to_line(all));
    return kOk;
  }
  if (options.what.empty()) {
    for (const Explanation& e : explanations()) fmt::print("{}  {}\n", to_string(e.code), e.title);
    for (const doctor::Explanation& e : doctor::explanations())
      fmt::print("{}  {}\n", e.code, e.title);
    return kOk;
  }
  if (const auto* finding = doctor::find_explanation(options.what)) {
    fmt::print("{}", options.json ? to_line(to_json(*finding)) + "\n" : page(*finding));
    return kOk;
  }
  const Explanation* explanation = find_explanation(options.what);
  if (explanation == nullptr) {
    if (const Term* term = find_term(options.what)) {
      fmt::print("{}", options.json ? to_line(to_json(*term)) + "\n" : page(*term));
      return kOk;
    }
    return explain_name(options);
  }
  if (options.json) {
    fmt::print("{}\n", to_line(to_json(*explanation)));
  } else {
    fmt::print("{}", page(*explanation));
  }
  return kOk;
}

}  // namespace

void add_explain(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<ExplainOptions>();
  CLI::App* command = app.add_subcommand(
      "explain",
      "Explain a decision from the journal, a name of the rules, a message of culprit check or "
      "doctor, or a term");
  auto* code = command->add_option(
      "WHAT", options->words,
      "A row of culprit log (123), a rule, component or strategy, a code (R012, "
      "D001) or a term (root cause); without it: all codes");
  CLI::Option* last =
      command->add_flag("--last", options->last, "The latest decision")->excludes(code);
  options->journal.add_to(*command);
  command->add_flag("--json", options->json, "As one JSON document");
  command->add_flag(
      "--markdown", options->markdown,
      "All explanations, as docs/diagnostics.md; with \"doctor\" as docs/findings.md");
  command->add_flag("--terms", options->lists_terms, "List the terms of the glossary")
      ->excludes(code)
      ->excludes(last);
  command->callback([options, &exit_code] {
    for (const std::string& word : options->words)
      options->what += (options->what.empty() ? "" : " ") + word;
    exit_code = explain(*options);
  });
}

}  // namespace culprit::cli
