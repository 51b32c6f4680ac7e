#include <algorithm>
#include <memory>

#include <fmt/core.h>

#include "bag/bag_file.h"
#include "cli/commands.h"
#include "cli/governor_options.h"
#include "cli/journal_file.h"
#include "cli/load_rules.h"
#include "cli/replay_bag.h"
#include "knowledge/describe.h"
#include "replay/replay.h"
#include "terminal/console.h"
#include "terminal/planner_options.h"

namespace culprit::cli {
namespace {

struct ReplayOptions {
  std::string journal;
  std::int64_t session = 0;
  std::string rules;
  bool events = false;
  std::vector<std::filesystem::path> message_path;
  PlannerOptions planner;
};

int complain_about(const ReplayOptions& options, const std::string& what) {
  return fail("cannot replay '" + options.journal + "': " + what);
}

int repeat(const ReplayOptions& options, const journal::Reader& journal,
           replay::Recording& recording) {
  const auto planner = PlannerOptions::from_json(recording.session().planner);
  if (!planner) return complain_about(options, planner.error());
  const auto governor = GovernorOptions::from_json(recording.session().governor).options();
  if (!governor) return complain_about(options, governor.error());
  replay::EventSink sink;
  if (options.events) {
    sink = [&](const Event& event, const RuleSet& rules) {
      const std::string text = line(event, rules, recording.session().start, Colour::kOff);
      if (!text.empty()) fmt::print("{}\n", text);
    };
  }
  const auto result = replay::repeat(recording, journal, planner->planner(), *governor, sink);
  if (!result) return complain_about(options, result.error());
  fmt::print("{} steps, {} observations, {} decisions of the run that begins with row {}\n",
             result->steps, result->observations, result->decisions, recording.session_row());
  if (!result->difference) {
    fmt::print("all decided as recorded (sha256 {})\n", result->digest.substr(0, 16));
    return kOk;
  }
  const auto& difference = *result->difference;
  fmt::print("the decisions differ at {:.3f} s, in row {}{}\n",
             seconds(difference.at - recording.session().start), difference.row,
             result->has_gap ? "; rows before it were lost, so they may" : "");
  for (const std::string& each : difference.recorded) fmt::print("  recorded  {}\n", each);
  for (const std::string& each : difference.repeated) fmt::print("  replayed  {}\n", each);
  return kFailed;
}

// What rules and a planner say to do: one line for each failure and each strategy.
struct Advice {
  double at = 0;
  std::string what;
};

Expected<std::vector<Advice>> advice(replay::Recording& recording, const RuleSet& rules,
                                     const PlannerOptions& planner,
                                     std::vector<std::string>* missing) {
  std::vector<Advice> all;
  const auto found = replay::advise(
      recording, rules, planner.planner(), [&](const Event& event, const RuleSet& of) {
        const bool is_told = std::holds_alternative<FailureDetected>(event.what) ||
                             std::holds_alternative<FailureResolved>(event.what) ||
                             std::holds_alternative<StrategyChosen>(event.what);
        if (!is_told) return;
        std::string what;
        if (const auto* chosen = std::get_if<StrategyChosen>(&event.what)) {
          what = of[of[chosen->strategy].rule].name + ": " + of[chosen->strategy].name;
        } else if (const auto* detected = std::get_if<FailureDetected>(&event.what)) {
          what = of[detected->rule].name + " detected";
        } else {
          what = of[std::get<FailureResolved>(event.what).rule].name + " is gone";
        }
        all.push_back({seconds(event.at - recording.session().start), std::move(what)});
      });
  if (!found) return Error{found.error()};
  if (missing != nullptr) *missing = *found;
  return all;
}

// Prints both, merged by time; what both say at nearly the same time is one line. Gives how many
// lines differ.
int print_difference(const std::vector<Advice>& recorded, const std::vector<Advice>& other) {
  constexpr double kSameTime = 1.0;  // seconds
  std::vector<bool> is_matched(other.size());
  struct Line {
    double at;
    char mark;
    const std::string* what;
  };
  std::vector<Line> lines;
  for (const Advice& ours : recorded) {
    std::size_t match = other.size();
    for (std::size_t i = 0; i < other.size() && match == other.size(); ++i) {
      const bool is_same = !is_matched[i] && other[i].what == ours.what &&
                           std::abs(other[i].at - ours.at) <= kSameTime;
      if (is_same) match = i;
    }
    if (match < other.size()) is_matched[match] = true;
    lines.push_back({ours.at, match < other.size() ? ' ' : '-', &ours.what});
  }
  for (std::size_t i = 0; i < other.size(); ++i) {
    if (!is_matched[i]) lines.push_back({other[i].at, '+', &other[i].what});
  }
  std::stable_sort(lines.begin(), lines.end(),
                   [](const Line& a, const Line& b) { return a.at < b.at; });
  int differences = 0;
  for (const Line& each : lines) {
    fmt::print("{} {:10.3f}  {}\n", each.mark, each.at, *each.what);
    differences += each.mark != ' ' ? 1 : 0;
  }
  return differences;
}

int compare(const ReplayOptions& options, replay::Recording& recording, bool other_planner) {
  const auto recorded_planner = PlannerOptions::from_json(recording.session().planner);
  if (!recorded_planner) return complain_about(options, recorded_planner.error());
  std::unique_ptr<const RuleSet> other;
  if (!options.rules.empty()) {
    other = load_rules(options.rules);
    if (other == nullptr) return kFailed;
  }
  std::vector<std::string> missing;
  const auto before = advice(recording, recording.rules(), *recorded_planner, nullptr);
  if (!before) return complain_about(options, before.error());
  const auto after = advice(recording, other != nullptr ? *other : recording.rules(),
                            other_planner ? options.planner : *recorded_planner, &missing);
  if (!after) return complain_about(options, after.error());
  for (const std::string& each : missing)
    fmt::print(stderr, "culprit: the recording does not have the {}\n", each);
  fmt::print("- as recorded, + as it would be; both only advise on what was observed\n");
  const int differences = print_difference(*before, *after);
  fmt::print("{} lines differ\n", differences);
  return kOk;
}

int replay_any(const ReplayOptions& options, bool other_planner) {
  if (bag::is_bag(options.journal)) {
    if (options.rules.empty()) return fail("a bag has no rules: add --rules"), kUsage;
    return replay_bag({options.journal, options.rules, options.message_path, options.planner});
  }
  const auto journal = journal::Reader::open(options.journal);
  if (!journal) return fail(journal.error());
  auto recording = replay::Recording::open(*journal, options.session);
  if (!recording) return complain_about(options, recording.error());
  if (options.rules.empty() && !other_planner) return repeat(options, *journal, *recording);
  return compare(options, *recording, other_planner);
}

}  // namespace

void add_replay(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* command = app.add_subcommand(
      "replay",
      "Run a recorded journal through the manager again: it must decide the same.\nWith --rules or "
      "--planner: what would have been decided, beside what was. A rosbag2 recording works, too.");
  command->add_option("JOURNAL", options->journal, "The journal file, or a bag")->required();
  command->add_option("--session", options->session,
                      "The run that begins with this row (default: the latest)");
  command->add_option("--rules", options->rules, "Other rules");
  command->add_flag("--events", options->events, "Print what happens");
  command->add_option("--message-path", options->message_path,
                      "For a bag: folders with .msg files: <folder>/<package>/msg/<Type>.msg");
  options->planner.add_to(*command);
  const CLI::Option* planner = command->get_option("--planner");
  const CLI::Option* objective = command->get_option("--objective");
  command->callback([options, planner, objective, &exit_code] {
    exit_code = replay_any(*options, planner->count() + objective->count() > 0);
  });
}

}  // namespace culprit::cli
