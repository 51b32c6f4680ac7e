// Processes that are left over, eat memory or a core, or do not run as they were started.
#include <algorithm>

#include <fmt/core.h>

#include "base/tool_names.h"
#include "doctor/examine.h"
#include "doctor/wording.h"

namespace culprit::doctor {
namespace {

using namespace std::chrono_literals;

std::vector<std::string> nodes_in(const Picture& picture, int pid) {
  std::vector<std::string> names;
  for (const Node& node : picture.nodes) {
    if (node.node.pid == pid && !is_tool_node(node.node.name)) names.push_back(node.node.name);
  }
  return names;
}

std::string name_of(int pid, const Process& process, const std::vector<std::string>& nodes) {
  return fmt::format("{} (process {}, {})", listed(nodes), pid, process.program);
}

void look_whether_left_over(int pid, const Process& process, const std::vector<std::string>& nodes,
                            Findings& all) {
  if (!process.is_left_over) return;
  all.push_back({"D014", Gravity::kWarning, name_of(pid, process, nodes),
                 "its launcher has exited, and so has the reader of its output",
                 "it is left over from an earlier launch: no launcher restarts it, a new launch "
                 "makes a second one, and printing may end it",
                 fmt::format("end it (kill {}) and launch the robot again", pid), nodes});
}

// Whether memory only grew: of four quarters of the time each ended higher than all before it.
bool only_grew(const std::vector<Process::Sample>& samples) {
  constexpr std::size_t kQuarters = 4;
  std::int64_t highest = samples.front().bytes;
  for (std::size_t i = 1; i <= kQuarters; ++i) {
    const std::int64_t now = samples[(samples.size() - 1) * i / kQuarters].bytes;
    if (now <= highest) return false;
    highest = now;
  }
  return true;
}

void look_at_memory(const Picture& picture, int pid, const Process& process,
                    const std::vector<std::string>& nodes, Findings& all) {
  constexpr std::size_t kFewest = 5;
  constexpr std::int64_t kLeast = 10'000'000;  // bytes: less comes and goes
  constexpr Duration kStartup = 60s;
  constexpr Duration kHorizon = 6h;
  const auto& samples = process.samples;
  if (samples.size() < kFewest || !only_grew(samples)) return;
  const std::int64_t grown = samples.back().bytes - samples.front().bytes;
  const Duration time = samples.back().at - samples.front().at;
  if (grown < kLeast || grown < samples.front().bytes / 20 || time <= 0s) return;
  if (process.age_at_first < kStartup) return;  // it is still building up
  const double rate = static_cast<double>(grown) / seconds(time);
  const Duration left = from_seconds(static_cast<double>(picture.free_memory) / rate);
  if (picture.free_memory == 0 || left > kHorizon) return;
  all.push_back(
      {"D017", left < 10min ? Gravity::kError : Gravity::kWarning, name_of(pid, process, nodes),
       fmt::format("its memory grew by {} in {}, from {} to {}", bytes(grown), duration(time),
                   bytes(samples.front().bytes), bytes(samples.back().bytes)),
       fmt::format("at that rate this machine has none left in {}; then the OOM "
                   "killer of Linux ends a process",
                   duration(left)),
       "see what it keeps (heaptrack, tracemalloc); start it again before it is late", nodes});
}

void look_at_processor(int pid, const Process& process, const std::vector<std::string>& nodes,
                       Findings& all) {
  constexpr Duration kLongEnough = 4s;
  constexpr double kAll = 0.95;
  const auto& samples = process.samples;
  if (samples.size() < 2 || process.busiest_thread.value_or(0) < kAll) return;
  const Duration time = samples.back().at - samples.front().at;
  if (time < kLongEnough) return;
  const double cores =
      seconds(samples.back().processor - samples.front().processor) / seconds(time);
  all.push_back(
      {"D018", Gravity::kWarning, name_of(pid, process, nodes),
       fmt::format("one of its threads never waited: {:.0f} % of a core for {}",
                   100 * std::min(1.0, process.busiest_thread.value_or(0)), duration(time)),
       fmt::format("it takes {:.1f} cores from the others, and is late itself if there is "
                   "more to do",
                   cores),
       "see what it does (perf top -p, py-spy top): a loop without a wait, or too much "
       "work for one thread",
       nodes});
}

void compare_parameters(const Picture& picture, const Process& process, Findings& all) {
  for (const auto& [node, wanted] : process.parameters) {
    const auto actual = picture.parameters.find(node);
    if (actual == picture.parameters.end()) continue;
    std::vector<std::string> differences;
    for (const auto& [name, value] : wanted) {
      const auto now = actual->second.find(name);
      if (now != actual->second.end() && now->second != value)
        differences.push_back(fmt::format("{} is {}, started with {}", name, now->second, value));
    }
    if (differences.empty()) continue;
    all.push_back({"D019",
                   Gravity::kWarning,
                   node,
                   listed(differences),
                   "a restart loses the values that were set since",
                   "write it into its parameter file, or set it back",
                   {node}});
  }
}

}  // namespace

void examine_processes(const Picture& picture, Findings& all) {
  for (const auto& [pid, process] : picture.processes) {
    const std::vector<std::string> nodes = nodes_in(picture, pid);
    if (nodes.empty()) continue;
    const bool is_named = std::ranges::any_of(
        nodes, [&](const std::string& node) { return picture.namesakes.contains(node); });
    if (!is_named) look_whether_left_over(pid, process, nodes, all);  // else that says so
    look_at_memory(picture, pid, process, nodes, all);
    look_at_processor(pid, process, nodes, all);
    compare_parameters(picture, process, all);
  }
}

}  // namespace culprit::doctor
