// rover-node <name>: one process of the live rover (nodes.h).
//
// The environment chooses the robot that it joins, as for every ROS 2 node: ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY and so on
// (ros2/options.h).
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "exemplars/node_command_line.h"
#include "exemplars/rover/nodes.h"

namespace culprit::rover {
namespace {

int fail(const std::string& why) {
  std::fprintf(stderr, "rover-node: %s\n", why.c_str());
  return 1;
}

// An experimenter's file for the next process of a name, "busy_s 8": `busy_s` seconds long its device is busy, it needs `start_s`
// seconds to start, or a parameter of the node has another default.
Expected<void> obey_experiment(std::string_view name, Settings& settings) {
  const auto file = settings.state / ("next_" + std::string(name));
  auto& [what, number] = settings.changed;
  if (settings.state.empty() || !(std::ifstream(file) >> what >> number)) return {};
  std::error_code error;
  const auto written = std::filesystem::last_write_time(file, error);
  const auto is_busy = [number = number, written] {
    return std::filesystem::file_time_type::clock::now() - written <
           std::chrono::duration<double>(number);
  };
  if (!error && what == "busy_s" && is_busy()) return Error{"the device is busy"};
  std::filesystem::remove(file, error);
  if (what == "start_s") std::this_thread::sleep_for(std::chrono::duration<double>(number));
  return {};
}

int run(const Process& process, const Settings& settings) {
  ros2::Executor executor;
  if (auto stops = executor.stop_on({SIGINT, SIGTERM}); !stops) return fail(stops.error());
  const auto participant = ros2::options_from_environment();
  if (!participant) return fail(participant.error());
  auto context = ros2::Context::create(executor, *participant);
  if (!context) return fail(context.error());
  const std::unique_ptr<RoverNode> node =
      process.make != nullptr ? process.make(settings) : nullptr;
  const bool is_localization = process.name == "lifecycle_manager_localization";
  const auto opened = node ? node->open(**context)
                           : run_lifecycle_manager(
                                 **context, std::string(process.name),
                                 is_localization ? std::span<const std::string_view>(kLocalization)
                                                 : std::span<const std::string_view>(kNavigation));
  if (!opened) return fail(opened.error());
  executor.run();
  std::fflush(nullptr);
  std::_Exit(0);  // a lifecycle manager may be blocked for ever
}

int main(int argc, char** argv) {
  std::vector<Process> known(processes().begin(), processes().end());
  known.push_back(kEkf);
  std::vector<std::string> names;
  for (const Process& each : known) names.emplace_back(each.name);
  const NodeCommandLine line{.about = "One process of the rover, a robot in Nav2's shape.",
                             .names = names,
                             .environment = "ROVER",
                             .seed_of = "world",
                             .option = "state",
                             .option_environment = "ROVER_STATE",
                             .option_help = "Folder of what outlives a process"};
  int exit_code = 0;
  const auto given = parse(line, argc, argv, exit_code);
  if (!given) return exit_code;
  const auto is_it = [&](const Process& each) { return each.name == given->name; };
  const std::string node = "/" + given->name;
  Settings settings{
      .node = node, .is_managed = is_server(node), .seed = given->seed, .state = given->option};
  if (auto obeyed = obey_experiment(given->name, settings); !obeyed) return fail(obeyed.error());
  return run(*std::ranges::find_if(known, is_it), settings);
}

}  // namespace
}  // namespace culprit::rover

int main(int argc, char** argv) { return culprit::rover::main(argc, argv); }
