#include "laboratory/live_campaign.h"

#include <csignal>
#include <filesystem>
#include <optional>
#include <string_view>
#include <sys/wait.h>
#include <thread>
#include <utility>

#include <fmt/core.h>

#include "base/environment.h"
#include "base/live_clock.h"
#include "base/text_file.h"
#include "base/units.h"
#include "owners/spawn.h"
#include "study/run_record.h"
#include "terminal/console.h"

namespace culprit::lab {
namespace {

using namespace std::chrono_literals;

// A run takes half a minute, its robot a minute at most until it is well.
constexpr Duration kLongestRun = 3min;
// Until a run that was asked to end has ended its robot.
constexpr Duration kFarewell = 20s;

// As --switches has it: "D-S".
std::string switches_of(const PaperSwitches& switches) {
  std::string text = study::label(switches);
  std::erase(text, ' ');
  return text;
}

std::vector<std::string> command_of(const study::Configuration& configuration, std::uint32_t run,
                                    std::uint64_t seed, const std::string& output) {
  const std::size_t colon = configuration.planner.find(':');
  std::vector<std::string> command = {"culprit-lab", "study", "sunset", "--live"};
  const auto add = [&](const char* option, std::string value) {
    command.emplace_back(option);
    command.push_back(std::move(value));
  };
  add("--run", std::to_string(run));
  add("--planner", configuration.planner.substr(0, colon));
  if (colon != std::string::npos) add("--objective", configuration.planner.substr(colon + 1));
  add("--switches", switches_of(configuration.switches));
  if (configuration.probabilities == study::Probabilities::kMisspecified)
    command.emplace_back("--misspecified");
  add("--seed", std::to_string(seed));
  add("--output", output);
  return command;
}

// The exit status; nothing if it had to be killed.
std::optional<int> end_of(int pid, const std::atomic<bool>& stop) {
  int status = 0;
  const auto ends_by = [&](Time end, const auto& is_over) {
    while (live_now() < end && !is_over()) {
      if (waitpid(pid, &status, WNOHANG) == pid) return true;
      std::this_thread::sleep_for(50ms);
    }
    return false;
  };
  if (ends_by(live_now() + kLongestRun, [&] { return stop.load(); })) return status;
  kill(pid, SIGTERM);
  if (ends_by(live_now() + kFarewell, [] { return false; })) return status;
  kill(pid, SIGKILL);
  waitpid(pid, &status, 0);
  return std::nullopt;
}

std::string last_line(const std::filesystem::path& log) {
  const auto text = read_text(log.string());
  if (!text) return "it said nothing";
  std::string_view all = *text;
  while (all.ends_with('\n')) all.remove_suffix(1);
  const std::size_t begin = all.rfind('\n');
  if (begin != std::string_view::npos) all.remove_prefix(begin + 1);
  constexpr std::string_view kWho = "culprit: ";
  if (all.starts_with(kWho)) all.remove_prefix(kWho.size());
  return all.empty() ? "it said nothing" : std::string(all);
}

}  // namespace

Expected<LiveCampaign> LiveCampaign::open() {
  auto folder = TemporaryFolder::make("live");
  if (!folder) return Error{folder.error()};
  return LiveCampaign(std::move(*folder));
}

Expected<study::RunMetrics> LiveCampaign::play(const study::Configuration& configuration,
                                               std::uint32_t run, std::uint64_t seed,
                                               const std::atomic<bool>& stop) const {
  const std::string name = fmt::format("live run {} of {}", run, study::label(configuration));
  std::string why;
  for (int i = 0; i < kAttempts && !stop; ++i) {
    auto metrics = attempt(configuration, run, seed, stop);
    if (metrics || stop) return metrics;
    why = metrics.error();
    say(stderr, "culprit: {} failed: {}{}\n", name, why,
        i + 1 < kAttempts ? "; it is played again" : "");
  }
  return stop ? Error{"interrupted"}
              : Error{fmt::format("{} failed {} times, at last: {}", name, kAttempts, why)};
}

Expected<study::RunMetrics> LiveCampaign::attempt(const study::Configuration& configuration,
                                                  std::uint32_t run, std::uint64_t seed,
                                                  const std::atomic<bool>& stop) const {
  // The seed is another for each run.
  const std::filesystem::path place = folder_ / std::to_string(seed);
  std::error_code error;
  std::filesystem::remove_all(place, error);
  std::filesystem::create_directories(place, error);
  const std::filesystem::path output = place / "run.json";
  owners::Program program;
  program.arguments = command_of(configuration, run, seed, output.string());
  program.search_first = {own_folder()};
  program.log = place / "log";
  // Where its world has its folder: what it leaves there if it is killed goes with ours.
  program.environment = {"TMPDIR=" + place.string()};
  program.lifetime = owners::Lifetime::kStarter;
  const auto pid = owners::spawn(program);
  if (!pid) return Error{pid.error()};
  const auto status = end_of(*pid, stop);
  if (stop) return Error{"interrupted"};
  if (!status) return Error{"it did not end, and was killed"};
  if (WIFSIGNALED(*status)) return Error{fmt::format("it ended by signal {}", WTERMSIG(*status))};
  if (WEXITSTATUS(*status) != 0) return Error{last_line(program.log)};
  const auto text = read_text(output.string());
  if (!text) return Error{text.error()};
  const auto json = parse_json(*text);
  if (!json.is_object()) return Error{output.string() + ": is no JSON object"};
  auto metrics = study::run_from_json<study::RunMetrics>(json);
  std::filesystem::remove_all(place, error);
  return metrics;
}

}  // namespace culprit::lab
