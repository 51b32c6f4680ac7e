// culprit study all: every study that needs no live robot, one after the other, into a folder.
#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/temporary_folder.h"
#include "base/text_file.h"
#include "laboratory/commands.h"
#include "laboratory/study_report.h"
#include "terminal/console.h"

namespace culprit::lab {
namespace {

// A study: the file that it writes, its commands, and about how long they take on two processors.
// Commands are joined by kAndThen. WORK is a folder that is removed after them.
//
// No study repeats more than its intervals need. Regrets have a mean of 0.7 % and are at most 6 %
// (docs/study-rca.md), so their standard deviation is below 2 %: 400 robots know the mean to ± 0.2
// points (95 %), and 1000 to ± 0.12. Twelve models of a fleet know each ratio to about ± 0.1
// (docs/fleet.md), and 40 would take longer than all the rest.
//
// Random robots are of a seed that nothing was chosen or improved on: bayes was on seed 1.
struct Step {
  const char* name;
  const char* full;
  const char* quick;  // empty: not part of the quick one
  double full_sec;
  double quick_sec;
};

constexpr std::string_view kAndThen = " && ";
constexpr std::string_view kWork = "WORK";
// Not a study: scores the cases in WORK/cases with their own script.
constexpr std::string_view kScore = "score";

constexpr std::array kSteps = {
    Step{"sunset", "sunset --planner paper --planner reference",
         "sunset --planner paper --planner reference --runs 54 --experiments 100 --repetitions 4",
         15, 4},
    Step{"sunset-managers",
         "sunset --ablation --planner bt --planner metacontrol --planner rosa --planner rebet "
         "--planner rebet-ucb --planner rebet-greedy --planner rebet-random --planner ac-ros "
         "--planner vogel --planner ghahremani --planner bandit --planner random --planner bayes "
         "--planner oracle",
         "sunset --ablation --planner bt --planner metacontrol --planner rosa --planner rebet "
         "--planner rebet-ucb --planner rebet-greedy --planner rebet-random --planner ac-ros "
         "--planner vogel --planner ghahremani --planner bandit --planner random --planner bayes "
         "--planner oracle --runs 54",
         10, 4},
    Step{"sunset-sweep", "sunset --sweep --planner paper --planner reference --runs 54", "", 75, 0},
    Step{"suave", "suave", "suave --runs 30", 2, 1},
    Step{"suave-extended", "suave --extended", "suave --extended --runs 30", 2, 1},
    Step{"suave-stress", "suave --stress", "suave --stress --runs 30", 2, 1},
    Step{"suave-claims", "suave --claims --runs 400", "suave --claims --runs 30", 6, 1},
    Step{"suave-two-rows",
         "suave --fit-rows none,bt --runs 100 --output WORK/vehicle.json"
         " && suave --claims --runs 400 --vehicle WORK/vehicle.json",
         "suave --fit-rows none,bt --runs 20 --output WORK/vehicle.json"
         " && suave --claims --runs 30 --vehicle WORK/vehicle.json",
         18, 4},
    Step{"rca", "rca --components 20 --faults 3 --episodes 300 --seed 2026",
         "rca --components 20 --faults 3 --episodes 40 --planner naive,paper,bayes --seed 2026", 10,
         2},
    Step{"rca-slow-monitors",
         "rca --components 20 --ignore --episodes 300 --detector-latency 0..3s --not-stated "
         "--planner bayes,patient,informed --seed 2026",
         "rca --components 20 --ignore --episodes 30 --detector-latency 0..3s --not-stated "
         "--planner bayes,patient,informed --seed 2026",
         3, 1},
    Step{"rca-false-alarms",
         "rca --components 20 --ignore --episodes 100 --false-alarms 2 --faults-before 30 "
         "--planner bayes,patient --seed 2026",
         "", 20, 0},
    Step{"rca-learning", "rca --components 5 --faults 1 --learn 500 --seed 2026",
         "rca --components 5 --faults 1 --learn 500 --seed 2026", 5, 5},
    Step{"rca-regret", "rca --regret --systems 400 --seed 2026",
         "rca --regret --systems 30 --seed 2026", 80, 5},
    Step{"rca-cases", "rca --export-cases WORK/cases --cases 200 --seed 2026 && score",
         "rca --export-cases WORK/cases --cases 20 --seed 2026 && score", 8, 4},
    Step{"rover", "rover && rover --faults pairs", "rover", 50, 3},
    Step{"fleet", "fleet --models 12", "fleet --models 4 --robots 3", 140, 14},
};

struct AllOptions {
  bool quick = false;
  std::string folder = "studies";
  std::vector<std::string> only;  // names of steps; none: all
  unsigned jobs = 0;              // 0: as each study has it
  std::string version;
};

std::vector<std::string> parts_of(const std::string& text, std::string_view separator) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + separator.size();
  }
  return parts;
}

// Runs a study as if it were typed. Its tables go into `output`, if it has any.
int run_study(const std::string& arguments, const std::string& output, const AllOptions& options) {
  CLI::App app;
  int exit_code = kFailed;
  add_study(app, options.version, exit_code);
  std::vector<std::string> words = parts_of("study " + arguments, " ");
  const bool has_tables = arguments.find("--output ") == std::string::npos &&
                          arguments.find("--export-cases ") == std::string::npos;
  if (has_tables) {
    if (arguments.find("--learn ") == std::string::npos)
      words.insert(words.end(), {"--format", "markdown"});
    // The output of the rover's study is its plays.
    words.insert(words.end(), {arguments.starts_with("rover") ? "--tables" : "--output", output});
  }
  if (options.jobs > 0) words.insert(words.end(), {"--jobs", std::to_string(options.jobs)});
  std::reverse(words.begin(), words.end());
  app.parse(words);
  return exit_code;
}

// The scores of culprit's planners and of the simple methods on each kind of robot, as the script
// prints them. Errors: there is no Python.
Expected<std::string> scores_of(const std::filesystem::path& cases) {
  std::string all;
  for (const std::string robots : {"public", "sunset", "rover"}) {
    const std::string answers = (robots == "public" ? "" : robots + "-") + "answers-";
    const std::filesystem::path printed = cases / (robots + ".txt");
    const auto scored = run_python(
        {"python3", "-I", "-B", cases / "score.py", cases / robots,
         cases / (answers + "bayes.json"), cases / (answers + "paper.json"), "--baseline", "all"},
        printed);
    if (!scored) return Error{"the scorer needs python3: " + scored.error()};
    const auto table = read_text(printed.string());
    if (!table) return table;
    all += fmt::format("**Scores on {}**\n\n```text\n{}```\n\n",
                       robots == "public" ? "random robots" : robots, *table);
  }
  return all;
}

// Runs the commands of a step, and appends their tables to `text`.
int run_step(const std::string& commands, const AllOptions& options, std::string& text) {
  const auto work = TemporaryFolder::make("studies");
  if (!work) return fail(work.error(), kFailed);
  for (std::string command : parts_of(commands, kAndThen)) {
    if (command == kScore) {
      const auto scores = scores_of(*work / "cases");
      if (!scores) return fail(scores.error(), kFailed);
      text += *scores;
      continue;
    }
    if (const std::size_t at = command.find(kWork); at != std::string::npos)
      command.replace(at, kWork.size(), (*work / "").parent_path().string());
    const std::filesystem::path tables = *work / "tables.md";
    std::error_code ignored;
    std::filesystem::remove(tables, ignored);
    if (const int code = run_study(command, tables.string(), options); code != kOk) return code;
    if (!std::filesystem::exists(tables)) continue;
    const auto written = read_text(tables.string());
    if (!written) return fail(written.error(), kFailed);
    text += *written + "\n";
  }
  return kOk;
}

// The first line of a finished file. Another version or command makes the file anew.
std::string head_of(const std::string& arguments, const std::string& version) {
  return fmt::format("<!-- culprit study {} (culprit {}) -->\n\n", arguments, version);
}

bool is_done(const std::string& file, const std::string& head) {
  if (!std::filesystem::exists(file)) return false;
  const auto text = read_text(file);
  return text && text->starts_with(head);
}

// Errors: there is no step of that name, or the quick studies have none.
Expected<std::vector<const Step*>> steps_of(const AllOptions& options) {
  std::vector<const Step*> steps;
  std::vector<std::string_view> names;
  for (const Step& step : kSteps) {
    if (options.quick && std::string_view(step.quick).empty()) continue;
    names.emplace_back(step.name);
    const bool is_wanted =
        options.only.empty() || std::ranges::find(options.only, step.name) != options.only.end();
    if (is_wanted) steps.push_back(&step);
  }
  for (const std::string& name : options.only) {
    if (std::ranges::find(names, name) == names.end())
      return Error{fmt::format("--only {}: there are {}", name,
                               fmt::join(names.begin(), names.end(), ", "))};
  }
  return steps;
}

int study_all(const AllOptions& options) {
  const auto wanted = steps_of(options);
  if (!wanted) return fail(wanted.error(), kUsage);
  const std::vector<const Step*>& steps = *wanted;
  std::error_code failed;
  std::filesystem::create_directories(options.folder, failed);
  if (failed) return fail(options.folder + ": " + failed.message(), kFailed);
  double expected = 0;  // seconds, by the table above
  for (const Step* step : steps) expected += options.quick ? step->quick_sec : step->full_sec;
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  double done_by_table = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Step& step = *steps[i];
    const std::string arguments = options.quick ? step.quick : step.full;
    const double step_sec = options.quick ? step.quick_sec : step.full_sec;
    const std::string file = options.folder + "/" + step.name + ".md";
    const std::string head = head_of(arguments, options.version);
    if (is_done(file, head)) {
      fmt::print(stderr, "culprit: {} of {}: {} is there already\n", i + 1, steps.size(), file);
      expected -= step_sec;
      continue;
    }
    const double elapsed = std::chrono::duration<double>(Clock::now() - begin).count();
    // This machine beside the one of the table.
    const double pace = done_by_table > 0 ? elapsed / done_by_table : 1;
    fmt::print(stderr, "culprit: {} of {}: {}, about {:.0f} s left\n", i + 1, steps.size(),
               step.name, (expected - done_by_table) * pace);
    std::string text = head;
    if (const int code = run_step(arguments, options, text); code != kOk) return code;
    const auto written = write_text(file, text);
    if (!written) return fail(written.error(), kFailed);
    done_by_table += step_sec;
  }
  fmt::print(stderr, "culprit: all {} studies are in {}\n", steps.size(), options.folder);
  return kOk;
}

}  // namespace

void add_study_all(CLI::App& study, const std::string& version, int& exit_code) {
  auto options = std::make_shared<AllOptions>();
  options->version = version;
  CLI::App* command = study.add_subcommand(
      "all", "All studies but those on live robots, as Markdown; goes on where it was interrupted");
  command->add_flag("--quick", options->quick, "Fewer runs, for a first look: two minutes");
  command->add_option("--folder", options->folder, "Write there, one file for each study")
      ->type_name("FOLDER")
      ->capture_default_str();
  command->add_option("--only", options->only, "Only these studies, by the names of their files")
      ->delimiter(',');
  command->add_option("--jobs", options->jobs, "Threads (default: one for each processor)")
      ->check(CLI::Range(1U, 1024U));
  command->callback([options, &exit_code] { exit_code = study_all(*options); });
}

}  // namespace culprit::lab
