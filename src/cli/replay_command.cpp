#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/core.h>

#include "bag/bag_file.h"
#include "base/live_clock.h"
#include "base/units.h"
#include "cli/commands.h"
#include "cli/governor_options.h"
#include "cli/journal_file.h"
#include "cli/load_rules.h"
#include "cli/replay_bag.h"
#include "cli/replay_curves.h"
#include "journal/json.h"
#include "replay/hindsight.h"
#include "replay/replay.h"
#include "terminal/console.h"
#include "terminal/planner_options.h"
#include "terminal/seconds_option.h"

namespace culprit::cli {
namespace {

struct ReplayOptions {
  std::string journal;
  std::int64_t session = 0;
  std::string rules;
  bool events = false;
  std::string since;
  std::string until;
  std::vector<std::string> curves;
  bool json = false;
  std::string fail_on;
  std::string html;  // of a bag: the file of its page
  std::string mcap;  // likewise for Foxglove
  std::vector<std::filesystem::path> message_path;
  PlannerOptions planner;
};

int complain_about(const ReplayOptions& options, const std::string& what) {
  return fail("cannot replay '" + options.journal + "': " + what);
}

Json to_json(const replay::Repetition& result, const replay::Recording& recording) {
  Json json{{"same", !result.difference},    {"session", recording.session_row()},
            {"steps", result.steps},         {"observations", result.observations},
            {"decisions", result.decisions}, {"digest", result.digest},
            {"rows_lost", result.has_gap}};
  if (const auto& difference = result.difference)
    json["difference"] = {{"at_s", seconds(difference->at - recording.session().start)},
                          {"row", difference->row},
                          {"recorded", difference->recorded},
                          {"replayed", difference->repeated}};
  return json;
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
  if (options.json) {
    fmt::print("{}\n", to_line(to_json(*result, recording)));
    return result->difference ? kFailed : kOk;
  }
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

// The advice of rules and a planner: one line for each failure and each strategy.
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
          what = of[std::get<FailureResolved>(event.what).rule].name + " cleared";
        }
        all.push_back({seconds(event.at - recording.session().start), std::move(what)});
      });
  if (!found) return Error{found.error()};
  if (missing != nullptr) *missing = *found;
  return all;
}

// A line of one side only is marked, '-' as recorded or '+' as it would be.
struct AdviceLine {
  double at;
  char mark;
  const std::string* what;
};

// Both, merged by time; what both say at nearly the same time is one line. They point into both.
std::vector<AdviceLine> merged(const std::vector<Advice>& recorded,
                               const std::vector<Advice>& other) {
  constexpr double kSameTime = 1.0;  // seconds
  std::vector<bool> is_matched(other.size());
  std::vector<AdviceLine> lines;
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
                   [](const AdviceLine& a, const AdviceLine& b) { return a.at < b.at; });
  return lines;
}

// `what`: what was observed, on which both advise.
void print(const std::vector<AdviceLine>& lines, const std::string& what) {
  fmt::print("- as recorded, + as it would be; both only advise on {}\n", what);
  for (const AdviceLine& each : lines)
    fmt::print("{} {:10.3f}  {}\n", each.mark, each.at, *each.what);
  fmt::print("{} lines differ\n", std::count_if(lines.begin(), lines.end(),
                                                [](const AdviceLine& l) { return l.mark != ' '; }));
}

Json to_json(const std::vector<AdviceLine>& lines) {
  constexpr std::string_view kWhere[] = {"recorded", "other", "both"};
  Json list = Json::array();
  for (const AdviceLine& each : lines)
    list.push_back({{"at_s", each.at},
                    {"in", kWhere[each.mark == '-'   ? 0
                                  : each.mark == '+' ? 1
                                                     : 2]},
                    {"what", *each.what}});
  return list;
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
  const std::vector<AdviceLine> lines = merged(*before, *after);
  if (options.json) {
    fmt::print("{}\n", to_line(to_json(lines)));
  } else {
    print(lines, "what was observed");
  }
  return kOk;
}

Json to_json(const replay::Said& said) {
  constexpr const char* kWords[] = {"detected", "gone", "chosen"};
  Json json{{"clock", std::round(said.wall * 1000) / 1000},
            {"what", kWords[static_cast<std::size_t>(said.what)]},
            {"rule", said.rule}};
  if (!said.strategy.empty()) json["strategy"] = said.strategy;
  return json;
}

Json to_json(const std::vector<replay::Said>& all) {
  Json list = Json::array();
  for (const replay::Said& each : all) list.push_back(to_json(each));
  return list;
}

std::vector<Advice> advice(const replay::Hindsight& hindsight) {
  std::vector<Advice> all;
  for (const replay::Said& said : hindsight.said) {
    const char* end = said.what == replay::Said::What::kDetected ? " detected" : " cleared";
    const bool is_chosen = said.what == replay::Said::What::kChosen;
    all.push_back({said.wall - hindsight.since,
                   said.rule + (is_chosen ? ": " + said.strategy : std::string(end))});
  }
  return all;
}

// Compares these rules with those that ran, over the last while.
int look_back(const ReplayOptions& options, const journal::Reader& journal, bool other_planner) {
  const auto age = duration_of_option("--since", options.since);
  if (!age) return fail(age.error(), kUsage);
  if (options.rules.empty()) return fail("--since is about other rules: add --rules", kUsage);
  const std::unique_ptr<const RuleSet> rules = load_rules(options.rules);
  if (rules == nullptr) return kFailed;
  const std::int64_t since = wall_now() - age->count();
  const replay::PlannerOf recorded_planner =
      [](const journal::Session& session) -> Expected<std::unique_ptr<const Planner>> {
    const auto recorded = PlannerOptions::from_json(session.planner);
    if (!recorded) return Error{recorded.error()};
    return std::unique_ptr<const Planner>(recorded->planner());
  };
  replay::PlannerOf planner = recorded_planner;
  if (other_planner)
    planner = [&](const journal::Session&) -> Expected<std::unique_ptr<const Planner>> {
      return std::unique_ptr<const Planner>(options.planner.planner());
    };
  const auto before = replay::hindsight(journal, nullptr, recorded_planner, since);
  if (!before) return complain_about(options, before.error());
  const auto after = replay::hindsight(journal, rules.get(), planner, since);
  if (!after) return complain_about(options, after.error());
  if (options.json) {
    fmt::print("{}\n", to_line({{"since", after->since},
                                {"until", after->until},
                                {"missing", after->missing},
                                {"recorded", to_json(before->said)},
                                {"other", to_json(after->said)}}));
    return kOk;
  }
  for (const std::string& each : after->missing)
    fmt::print(stderr, "culprit: the recording does not have the {}\n", each);
  const std::vector<Advice> recorded = advice(*before);
  const std::vector<Advice> other = advice(*after);
  print(merged(recorded, other),
        fmt::format("what was observed in the last {:.0f} s", after->until - after->since));
  return kOk;
}

int replay_recording(const ReplayOptions& options) {
  if (options.session != 0) return fail("--session is for a journal; a bag is one run", kUsage);
  if (options.rules.empty()) {
    // A folder may be anything.
    if (const auto bag = bag::BagFile::open(options.journal); !bag) return fail(bag.error());
    return fail("'" + options.journal + "' is a bag, which has no rules: add --rules my.rules",
                kUsage);
  }
  return replay_bag({options.journal, options.rules, options.message_path, options.since,
                     options.json, options.fail_on, options.planner, options.html, options.mcap});
}

int replay_any(const ReplayOptions& options, bool other_planner) {
  if (options.json && options.events)
    return fail("--json has the events already; leave --events out", kUsage);
  if (bag::is_bag(options.journal)) return replay_recording(options);
  if (!options.message_path.empty()) return fail("--message-path is for a bag", kUsage);
  if (!options.html.empty())
    return fail("--html is for a bag; culprit incident ID -o FILE writes one of a journal", kUsage);
  if (!options.mcap.empty()) return fail("--mcap is for a bag", kUsage);
  if (!options.fail_on.empty()) return fail("--fail-on is for a bag", kUsage);
  if (options.journal.ends_with(".rules"))
    return fail("'" + options.journal +
                    "' is no recording: write culprit replay RECORDING --rules " + options.journal,
                kUsage);
  const auto journal = journal::Reader::open(options.journal);
  if (!journal) return fail(journal.error());
  if (!options.curves.empty()) {
    if (!options.rules.empty() || options.session != 0)
      return fail("--curve is about the rules that ran, over all runs", kUsage);
    return replay_curves({options.curves, options.since, options.until, options.json}, *journal);
  }
  if (!options.until.empty()) return fail("--until is for --curve", kUsage);
  if (!options.since.empty()) return look_back(options, *journal, other_planner);
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
  command->add_option("JOURNAL", options->journal, "The journal file, or a bag")
      ->type_name("FILE")
      ->required();
  command->add_option("--session", options->session,
                      "The run that begins with this row (default: the latest)");
  command->add_option("--rules", options->rules, "Other rules")->type_name("FILE");
  command->add_flag("--events", options->events, "Print what happens (a bag's replay always does)");
  command
      ->add_option("--since", options->since,
                   "With --rules or --curve: only the last 10min, 1h ... until now over all runs, "
                   "or until the end of a bag")
      ->type_name("DURATION");
  command
      ->add_option("--curve", options->curves,
                   "Print what the rules read, as a table: 'rate /scan', 'age /scan', 'input x'")
      ->type_name("NAME");
  command->add_option("--until", options->until, "With --curve: until so long ago (default: 0s)")
      ->type_name("DURATION");
  command
      ->add_option("--message-path", options->message_path,
                   "For a bag: folders with .msg files: <folder>/<package>/msg/<Type>.msg")
      ->type_name("FOLDER");
  command->add_flag("--json", options->json, "As one JSON document; not with --events");
  command
      ->add_option("--html", options->html,
                   "For a bag: also write a page of its incidents and curves to this file")
      ->type_name("FILE");
  command
      ->add_option("--mcap", options->mcap,
                   "For a bag: also write events, rules and signals for Foxglove, and a layout")
      ->type_name("FILE");
  command
      ->add_option("--fail-on", options->fail_on,
                   "For a bag: exit with 1 if such a rule fired, or any could not be judged "
                   "(default: only if the bag is damaged)")
      ->check(CLI::IsMember({"error", "warning", "unjudged", "never"}));
  options->planner.add_to(*command);
  const CLI::Option* planner = command->get_option("--planner");
  const CLI::Option* objective = command->get_option("--objective");
  command->callback([options, planner, objective, &exit_code] {
    exit_code = replay_any(*options, planner->count() + objective->count() > 0);
  });
}

}  // namespace culprit::cli
