#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <iostream>
#include <map>
#include <memory>
#include <unistd.h>

#include <fmt/core.h>

#include "base/duration_words.h"
#include "base/environment.h"
#include "base/live_clock.h"
#include "base/name_grammar.h"
#include "cli/commands.h"
#include "cli/drill_session.h"
#include "cli/run_configuration.h"
#include "cli/unified_diff.h"
#include "drill/drill_record.h"
#include "drill/drill_report.h"
#include "drill/exported_tests.h"
#include "drill/priors.h"
#include "drill/write_back.h"
#include "journal/json.h"
#include "language/parser.h"
#include "live/rule_file.h"
#include "live/rule_trust.h"
#include "live/run_journal.h"
#include "live/setups.h"
#include "owners/service_units.h"
#include "ros2/options.h"
#include "terminal/command.h"
#include "terminal/console.h"
#include "terminal/seconds_option.h"

namespace culprit::cli {
namespace {

using drill::Results;
using drill::Trial;

struct DrillOptions {
  std::string rules;
  drill::PlanOptions plan{};
  std::vector<std::string> kinds{};
  double hang_seconds = 3;
  double budget_seconds = 0;
  double patience_seconds = 60;
  double monitor_seconds = 0;
  std::string abort{};
  std::string record{};
  std::string state_folder{};
  std::string html{};
  std::string exports{};
  bool is_agreed = false;
  bool launches = false;
  bool writes = false;
  bool json = false;

  std::filesystem::path state() const {
    return state_folder.empty() ? default_state_folder() : std::filesystem::path(state_folder);
  }
};

std::string date_of(std::time_t at, const char* format) {
  std::tm parts{};
  char text[32] = "?";
  if (localtime_r(&at, &parts) != nullptr) std::strftime(text, sizeof text, format, &parts);
  return text;
}

// Progress and plan: of people, so not where the document goes.
std::FILE* remarks_of(const DrillOptions& options) { return options.json ? stderr : stdout; }

bool is_confirmed(const DrillOptions& options) {
  if (options.is_agreed) return true;
  if (isatty(STDIN_FILENO) == 0) return false;
  say(remarks_of(options), "Inject these faults? [y/N] ");
  std::string answer;
  std::getline(std::cin, answer);
  return answer == "y" || answer == "yes";
}

// The rules of the file, and one more for each condition of the drill: it fires when the condition does not hold, and
// reports.
struct DrillRules {
  std::string file;
  std::vector<DrillSession::Condition> interlocks;
  std::vector<DrillSession::Condition> aborts;
};
Expected<DrillRules> rules_for(const DrillOptions& options, const RuleSet& rules,
                               const std::filesystem::path& folder) {
  DrillRules out{options.rules, {}, {}};
  std::string more;
  const auto add = [&](std::vector<DrillSession::Condition>& all, const char* what,
                       const std::string& text, const std::string& trigger) {
    all.push_back({fmt::format("{}{}_{}", drill::kOwnRules, what, all.size() + 1), text});
    more += fmt::format("\nRULE {}\n  POLICIES NON_CRITICAL REPORT\n  TRIGGER {}\n",
                        all.back().rule, trigger);
  };
  for (const Interlock& each : rules.interlocks)
    add(out.interlocks, "interlock", each.text, "!(" + each.text + ")");
  for (const std::string& condition : rules.aborts) add(out.aborts, "abort", condition, condition);
  if (!options.abort.empty()) add(out.aborts, "abort", options.abort, options.abort);
  if (more.empty()) return out;
  std::error_code error;
  const auto whole = std::filesystem::absolute(options.rules, error);
  out.file = (folder / "drill.rules").string();
  if (auto written =
          write_text(out.file, "INCLUDE " + drill::in_quotes(whole.string()) + "\n" + more);
      !written)
    return Error{written.error()};
  if (const auto read = live::read_rules(out.file); !read) return Error{read.error()};
  return out;
}

// A drill breaks a component far more often than a robot should: the limits on repairs would hide what rules do.
std::vector<std::string> manager_arguments(const DrillOptions& options, const std::string& rules,
                                           const std::filesystem::path& journal) {
  std::vector<std::string> all{
      "run",
      rules,
      "--journal",
      journal.string(),
      "--state-dir",
      options.state().string(),
      "--improvise",
      "--revive",  // the drill crashes nodes, and on_exit=Shutdown() ends the launch
      "--intensity",
      "none",
      "--intensity-kind",
      "none",
      "--intensity-component",
      "none",
      "--restarts",
      "none",
      "--backoff",
      "0",
      "--healthy",
      "2"};  // shorter than the robot is well before each fault
  if (options.launches) all.emplace_back("--launch");
  if (options.monitor_seconds > 0) all.emplace_back("--dry-run");
  return all;
}

// The environment and a file may have options of `culprit run`, too. Errors: the culprit would not repair by itself.
Expected<void> repairs_by_itself(std::vector<std::string> manager) {
  manager.emplace_back("--print-config");
  const auto all = with_configuration(std::move(manager));
  if (!all) return Error{all.error()};
  for (const char* option : {"approve", "dry-run"}) {
    if (all->printed.find(fmt::format("\n{} = true\n", option)) != std::string::npos)
      return Error{fmt::format(
          "the options of culprit run have {} = true, so nobody would repair the robot in time; "
          "nothing is injected",
          option)};
  }
  return {};
}

// Components that their owners could not start now: a program that was removed, an engine that does not answer.
std::map<std::string, std::string> owner_troubles(const RuleSet& rules) {
  std::map<std::string, std::string> out;
  for (const auto& each : live::launch_troubles(rules))
    out.emplace(each.component, "its LAUNCH could not run: " + each.why);
  for (const Component& each : rules.components) {
    if (!each.has_owner() || !each.host().empty()) continue;
    const auto could =
        each.unit ? owners::could_manage(*each.unit) : owners::could_manage(*each.engine);
    if (!could) out.emplace(each.name, could.error());
  }
  return out;
}

// Measures the comparisons of the file in all recorded runs.
Expected<std::vector<drill::ThresholdMeasure>> thresholds_of(const std::filesystem::path& file,
                                                             const std::string& text,
                                                             const std::vector<Trial>& trials) {
  const auto reader = journal::Reader::open(file);
  if (!reader) return Error{reader.error()};
  std::vector<Diagnostic> mistakes;
  const auto comparisons = drill::comparisons_in(parse(Source("rules", text), mistakes));
  std::vector<drill::FaultyStretch> faulty;
  for (const Trial& trial : trials) {
    const auto fired = drill::finding_of(trial).fired;
    faulty.push_back({trial.injected,
                      trial.well && !trial.restored ? *trial.well : trial.end,
                      {fired.begin(), fired.end()}});
  }
  return drill::measure_all(*reader, comparisons, faulty);
}

// How long each component took from its start until it was up, by the journal.
std::map<std::string, std::vector<double>> starts_in(const std::filesystem::path& file) {
  std::map<std::string, std::vector<double>> starts;
  const auto reader = journal::Reader::open(file);
  if (!reader) return starts;
  auto rows = reader->entries(journal::Which::kReadable);
  if (!rows) return starts;
  journal::Entry row;
  for (auto more = rows->next(row); more && *more; more = rows->next(row)) {
    const Json event = row.kind == journal::kind::kEvent ? parse_json(row.body) : Json();
    if (!event.is_object() || journal::text_of(event, "type") != "came_up") continue;
    starts[journal::text_of(event, "component")].push_back(
        (journal::number_of(event, "joining_ns") + journal::number_of(event, "rising_ns")) / 1e9);
  }
  return starts;
}

std::string diff_of(const std::string& name, const std::string& before, const std::string& after) {
  const auto old_lines = lines_of(before);
  const auto new_lines = lines_of(after);
  std::vector<LineEdit> edits;
  std::size_t old_line = 0;
  for (const std::string_view line : new_lines) {
    const bool is_added = line.starts_with("DEPENDENCY ") &&
                          line.find("# drill ") != std::string_view::npos &&
                          (old_line == old_lines.size() || old_lines[old_line] != line);
    if (is_added || old_line == old_lines.size()) {
      edits.push_back({'+', line});
    } else if (old_lines[old_line] == line) {
      edits.push_back({' ', line});
      ++old_line;
    } else {
      edits.push_back({'-', old_lines[old_line++]});
      edits.push_back({'+', line});
    }
  }
  return unified_diff(name, edits);
}

// Once for each record: counts are added. Remembers it by a file there.
int write_priors(const DrillOptions& options, const std::string& robot,
                 const drill::DrillRecord& record) {
  const auto mark = record.file("priors");
  if (std::filesystem::exists(mark)) return kOk;
  const auto journal = live::default_journal(options.state(), robot);
  const auto added = drill::add_priors(record.file("robot.journal"), journal, wall_now());
  if (!added) return fail(added.error());
  say(remarks_of(options), "culprit: {} couplings and {} latencies added to '{}'\n",
      added->couplings, added->latencies, journal.string());
  const auto marked = write_text(mark.string(), journal.string() + "\n");
  return marked ? kOk : fail(marked.error());
}

// The measured numbers as a diff, and into the file if that is asked for.
int show_changes(const DrillOptions& options, const std::string& text, const Results& results) {
  const auto changed = drill::write_back(options.rules, text, results);
  if (!changed) return fail(changed.error());
  for (const std::string& each : changed->unwritten)
    say(stderr, "culprit: not written: {}\n", escape_controls(each));
  if (changed->text == text) return kOk;
  say_text(remarks_of(options), "\n" + diff_of(options.rules, text, changed->text));
  if (!options.writes) return kOk;
  const auto now = read_text(options.rules);
  if (!now || *now != text)
    return fail("'" + options.rules + "' was changed during the drill and stays as it is");
  if (auto written = write_text(options.rules, changed->text); !written)
    return fail(written.error());
  return kOk;
}

int show_results(const DrillOptions& options, const std::string& text, const RuleSet& rules,
                 const drill::DrillRecord& record) {
  const auto& trials = record.trials();
  const bool monitors = options.monitor_seconds > 0;
  double last = 0;  // a trial whose fault could not be injected has no time
  for (const Trial& each : trials) last = std::max(last, each.injected);
  const auto at = last > 0 ? static_cast<std::time_t>(last) : std::time(nullptr);
  Results results = drill::results_of(trials, rules, drill::paths_over(record.head().healthy.edges),
                                      date_of(at, "%Y-%m-%d"));
  auto thresholds = thresholds_of(record.file("robot.journal"), text, trials);
  if (!thresholds) say(stderr, "culprit: no thresholds are measured: {}\n", thresholds.error());
  if (thresholds) results.thresholds = std::move(*thresholds);
  results.starts = starts_in(record.file("robot.journal"));
  if (options.json) {
    say(stdout, "{}\n", to_line(drill::report_json(results)));
  } else {
    say(stdout, "\n");
    for (const std::string& line :
         monitors ? drill::threshold_lines(results.thresholds) : drill::report_lines(results))
      say(stdout, "{}\n", escape_controls(line));
  }
  if (!options.html.empty()) {
    if (auto written = write_text(options.html, drill::report_page(results)); !written)
      return fail(written.error());
  }
  if (!options.exports.empty()) {
    const auto whole = std::filesystem::absolute(options.rules);
    const auto exported = drill::export_tests(options.exports, whole.string(), results.date, trials,
                                              record.head().healthy);
    if (!exported) return fail(exported.error());
  }
  const int shown = show_changes(options, text, results);
  if (shown != kOk || !options.writes || monitors) return shown;
  return write_priors(options, rules.robot, record);
}

Expected<std::unique_ptr<DrillSession>> begin_session(const DrillOptions& options,
                                                      const RuleSet& rules,
                                                      const drill::DrillRecord& record,
                                                      const std::atomic<bool>& stop) {
  const auto participant = ros2::options_from_environment();
  if (!participant) return Error{participant.error()};
  const std::filesystem::path folder = record.file("robot.journal").parent_path();
  auto all = rules_for(options, rules, folder);
  if (!all) return Error{all.error()};
  DrillSession::Options session;
  session.manager = manager_arguments(options, all->file, record.file("robot.journal"));
  session.log = record.file("culprit.log");
  session.injected = options.state() / fmt::format("{}-{}.drill", participant->domain,
                                                   rules.robot.empty() ? "robot" : rules.robot);
  session.interlocks = all->interlocks;
  session.aborts = all->aborts;
  session.hang = from_seconds(options.hang_seconds);
  session.patience = from_seconds(options.patience_seconds);
  session.heals = options.monitor_seconds <= 0;
  return DrillSession::begin(
      std::move(session),
      [&options](const std::string& line) {
        say(remarks_of(options), "culprit: {}\n", escape_controls(line));
      },
      stop);
}

// All steps that are not done yet. Errors: why it ended early.
Expected<void> inject_all(const DrillOptions& options, const RuleSet& rules,
                          const drill::DrillPlan& plan, DrillSession& session,
                          drill::DrillRecord& record) {
  std::FILE* const remarks = remarks_of(options);
  const Time begin = live_now();
  Duration left = plan.estimate;
  std::size_t number = 0;
  for (const drill::Step& step : plan.steps) {
    ++number;
    left -= drill::estimate(step, rules, options.plan);
    if (record.has(step.id())) continue;
    if (const auto limit = drill::limit_reached(step, record.trials(), rules); !limit.empty()) {
      say(remarks, "[{}/{}] {} is left out: {}\n", number, plan.steps.size(),
          escape_controls(drill::to_string(step.faults)), limit);
      continue;
    }
    // The plan fits by its estimate; repairs may take longer.
    if (options.plan.budget &&
        live_now() - begin + drill::estimate(step, rules, options.plan) > *options.plan.budget) {
      say(remarks, "culprit: the budget is used up after {} of {}; --record resumes the drill\n",
          number - 1, plan.steps.size());
      return {};
    }
    const auto trial = session.run(step);
    if (!trial) return Error{trial.error()};
    if (auto added = record.add(*trial); !added) return Error{added.error()};
    say(remarks, "[{}/{}] {}; about {} left\n", number, plan.steps.size(),
        escape_controls(drill::line_of(*trial)), in_words(left));
    if (const std::string why = session.why_to_end(); !why.empty()) return Error{why};
  }
  return {};
}

// Found before the drill, not after it.
Expected<void> may_be_written(const DrillOptions& options) {
  const auto folder = std::filesystem::absolute(options.rules).parent_path();
  if (!options.writes ||
      (access(options.rules.c_str(), W_OK) == 0 && access(folder.c_str(), W_OK) == 0))
    return {};
  return Error{"--write: '" + options.rules + "' cannot be written: " + std::strerror(errno)};
}

int run_drill(DrillOptions options) {
  for (const std::string& word : options.kinds) {
    const auto kind = drill::fault_kind(word);
    if (!kind) return fail("--kinds: " + drill::no_fault_kind(word), kUsage);
    options.plan.kinds.push_back(*kind);
  }
  options.plan.hang = from_seconds(options.hang_seconds);
  if (options.budget_seconds > 0) options.plan.budget = from_seconds(options.budget_seconds);
  if (auto trusted = live::trust_rules(options.rules); !trusted) return fail(trusted.error());
  if (auto may = may_be_written(options); !may) return fail(may.error());
  const bool monitors = options.monitor_seconds > 0;
  if (!monitors) {
    auto repairs = repairs_by_itself(manager_arguments(options, options.rules, "journal"));
    if (!repairs) return fail(repairs.error());
  }
  const auto loaded =
      live::read_rules(options.rules, Strictness::kLenient, colour_of(STDERR_FILENO));
  if (!loaded) return fail(loaded.error());
  const auto text = read_text(options.rules);
  if (!text) return fail(text.error());
  const RuleSet& rules = loaded->rules;
  if (!monitors) options.plan.spared = owner_troubles(rules);
  const auto plan = drill::plan(rules, options.plan);
  if (!plan) return fail(plan.error(), kUsage);
  std::FILE* const remarks = remarks_of(options);
  drill::DrillHead head{*text, {}};
  if (!monitors) {
    for (const std::string& line : drill::plan_lines(*plan, options.plan))
      say(remarks, "{}\n", escape_controls(line));
    if (plan->steps.empty()) return fail("there is no fault to inject");
    if (!is_confirmed(options)) return fail("nothing is injected: --yes agrees to the plan");
    for (const drill::Step& step : plan->steps) head.plan.push_back(step.id());
  }
  const std::string robot = rules.robot.empty() ? "robot" : rules.robot;
  const std::filesystem::path folder =
      options.record.empty() ? options.state() / "drills" /
                                   (robot + "-" + date_of(std::time(nullptr), "%Y%m%d-%H%M%S"))
                             : std::filesystem::path(options.record);
  auto record = drill::DrillRecord::open(folder, head);
  if (!record) return fail(record.error());
  say(remarks, "The record is in {}; --record resumes it\n", folder.string());
  StopSignals signals(Hangup::kStops);
  std::string trouble;
  {
    auto session = begin_session(options, rules, *record, signals.stopped());
    if (!session) return fail(session.error());
    if (const auto now = read_text(options.rules); !now || *now != *text)
      return fail("'" + options.rules +
                  "' was changed since the plan was shown; nothing is injected");
    if (monitors) {
      (*session)->watch(from_seconds(options.monitor_seconds));
    } else {
      if (auto kept = record->keep((*session)->healthy()); !kept) return fail(kept.error());
      const auto done = inject_all(options, rules, *plan, **session, *record);
      if (!done) trouble = done.error();
    }
  }
  const int shown = show_results(options, *text, rules, *record);
  return trouble.empty() ? shown : fail("the drill ends: " + trouble);
}

}  // namespace

void add_drill(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<DrillOptions>();
  CLI::App* command = app.add_subcommand(
      "drill",
      "Inject faults into a live robot, one at a time, and measure how the rules respond.\n"
      "Shows the plan and asks first. A culprit of its own heals meanwhile (docs/drill.md).");
  command->add_option("RULES", options->rules, "The rule file")->type_name("FILE")->required();
  command->add_option("--only", options->plan.only, "Components to break (default: all)")
      ->delimiter(',')
      ->type_name("COMPONENT");
  command
      ->add_option("--kinds", options->kinds,
                   "Kinds of faults: kill, hang, slow, deactivate, restart, set_parameter, loss "
                   "(default: all but loss)")
      ->delimiter(',')
      ->type_name("KIND");
  command->add_option("--times", options->plan.times, "Rounds: each has every fault once")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_flag("--pairs", options->plan.pairs, "Also kill two components at once");
  add_seconds(*command, "--budget", options->budget_seconds, "Time for all faults", 1, 7 * 86400)
      ->default_str("");
  command->add_option("--seed", options->plan.seed, "Seed of the order")->capture_default_str();
  add_seconds(*command, "--hang", options->hang_seconds, "How long a process is stopped or slow",
              0.2, 600);
  add_seconds(*command, "--patience", options->patience_seconds,
              "Time for the robot to recover, before and after a fault", 5, 3600);
  command->add_option("--abort", options->abort,
                      "A condition of the rule language that ends the drill at once");
  command->add_flag("--yes", options->is_agreed, "Agree to the plan without being asked");
  CLI::Option* const launch = command->add_flag(
      "--launch", options->launches, "Start components that are missing, by their LAUNCH commands");
  command
      ->add_option("--record", options->record,
                   "Folder of the record; an unfinished drill of the same plan is resumed")
      ->type_name("FOLDER")
      ->check(trouble_of_folder);
  command->add_option("--state-dir", options->state_folder, "Folder of logs and records")
      ->type_name("FOLDER")
      ->check(trouble_of_folder)
      ->default_str("~/.local/state/culprit");
  command->add_flag("--write", options->writes, "Write measured numbers into the rule file");
  command->add_flag("--json", options->json, "Print the results as a JSON document");
  command->add_option("--html", options->html, "Write the results as a page")->type_name("FILE");
  command
      ->add_option("--export", options->exports,
                   "Write each fault as a test of the rules (culprit test)")
      ->type_name("FOLDER")
      ->check(trouble_of_folder);
  add_seconds(*command, "--monitor", options->monitor_seconds,
              "Inject nothing: watch the healthy robot and propose thresholds", 1, 7 * 86400)
      ->default_str("")
      ->excludes(launch);  // it is a dry run
  command->callback([options, &exit_code] { exit_code = run_drill(*options); });
}

}  // namespace culprit::cli
