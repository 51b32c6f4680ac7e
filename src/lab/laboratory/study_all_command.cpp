// culprit study all: every study that needs no live robot, one after the other, into a folder.
#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "base/text_file.h"
#include "laboratory/commands.h"
#include "terminal/console.h"

namespace culprit::lab {
namespace {

// A study: the file that it writes, its arguments, and about how long it takes on two processors.
//
// No study repeats more than its intervals need. Regrets have a mean of 0.7 % and are at most 6 %
// (docs/study-rca.md), so their standard deviation is below 2 %: 400 robots know the mean to ± 0.2
// points (95 %), and 1000 to ± 0.12. Twelve models of a fleet know each ratio to about ± 0.1
// (docs/fleet.md), and 40 would take longer than all the rest.
struct Step {
  const char* name;
  const char* full;   // empty: not part of the full study
  const char* quick;  // empty: not part of the quick one
  double full_sec;
  double quick_sec;
};

constexpr std::array kSteps = {
    Step{"sunset", "sunset --planner paper --planner reference",
         "sunset --planner paper --planner reference --runs 54 --experiments 100 --repetitions 4",
         15, 4},
    Step{"sunset-managers",
         "sunset --ablation --planner bt --planner metacontrol --planner rosa --planner rebet "
         "--planner rebet-ucb --planner rebet-greedy --planner rebet-random --planner ac-ros "
         "--planner vogel --planner ghahremani --planner bandit --planner random --planner bayes "
         "--planner oracle",
         "sunset --ablation --planner bt --planner rosa --planner rebet --planner rebet-ucb "
         "--planner bandit --planner random --planner bayes --runs 54",
         10, 3},
    Step{"sunset-sweep", "sunset --sweep --planner paper --planner reference --runs 54", "", 75, 0},
    Step{"suave", "suave", "suave --runs 30", 2, 1},
    Step{"suave-extended", "suave --extended", "suave --extended --runs 30", 2, 1},
    Step{"suave-stress", "suave --stress", "suave --stress --runs 30", 2, 1},
    Step{"suave-claims", "suave --claims", "suave --claims --runs 30", 2, 1},
    Step{"rca", "rca --components 20 --faults 3 --episodes 300",
         "rca --components 20 --faults 3 --episodes 40 --planner naive,paper,bayes", 10, 2},
    Step{"rca-learning", "rca --components 5 --faults 1 --learn 500",
         "rca --components 5 --faults 1 --learn 500", 5, 5},
    Step{"rca-regret", "rca --regret --systems 400", "rca --regret --systems 30", 80, 5},
    Step{"fleet", "fleet --models 12", "fleet --models 4 --robots 3", 140, 14},
};

struct AllOptions {
  bool quick = false;
  std::string folder = "studies";
  unsigned jobs = 0;  // 0: as each study has it
  std::string version;
};

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

// Runs a study as if it were typed.
int run_study(const std::string& arguments, const std::string& output, const AllOptions& options) {
  CLI::App app;
  int exit_code = kFailed;
  add_study(app, options.version, exit_code);
  std::vector<std::string> words = words_of("study " + arguments);
  if (!arguments.starts_with("rca --components 5")) {
    words.insert(words.end(), {"--format", "markdown"});
  }
  if (options.jobs > 0) words.insert(words.end(), {"--jobs", std::to_string(options.jobs)});
  words.insert(words.end(), {"--output", output});
  std::reverse(words.begin(), words.end());
  app.parse(words);
  return exit_code;
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

int study_all(const AllOptions& options) {
  std::error_code failed;
  std::filesystem::create_directories(options.folder, failed);
  if (failed) return fail(options.folder + ": " + failed.message(), kFailed);
  double expected = 0;  // seconds, by the table above
  std::vector<const Step*> steps;
  for (const Step& step : kSteps) {
    if (std::string_view(options.quick ? step.quick : step.full).empty()) continue;
    steps.push_back(&step);
    expected += options.quick ? step.quick_sec : step.full_sec;
  }
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
    const std::string part = file + ".part";
    if (const int code = run_study(arguments, part, options); code != kOk) return code;
    const auto text = read_text(part);
    if (!text) return fail(text.error(), kFailed);
    const auto written = write_text(file, head + *text);
    if (!written) return fail(written.error(), kFailed);
    std::filesystem::remove(part, failed);
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
  command->add_option("--jobs", options->jobs, "Threads (default: one for each processor)")
      ->check(CLI::Range(1U, 1024U));
  command->callback([options, &exit_code] { exit_code = study_all(*options); });
}

}  // namespace culprit::lab
