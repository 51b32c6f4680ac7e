// suave-node <name>: one process of the live SUAVE robot.
//
// The environment chooses the robot that it joins, as for every ROS 2 node: ROS_DOMAIN_ID,
// ROS_LOCALHOST_ONLY and so on (ros2/options.h).
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>

#include "exemplars/node_command_line.h"
#include "exemplars/suave/function_process.h"
#include "exemplars/suave/mission_process.h"
#include "exemplars/suave/vehicle_process.h"

namespace culprit::suave {
namespace {

int fail(const std::string& why) {
  std::fprintf(stderr, "suave-node: %s\n", why.c_str());
  return 1;
}

int run(const std::function<int(ros2::Executor&, ros2::Context&)>& with) {
  ros2::Executor executor;
  if (auto stops = executor.stop_on({SIGINT, SIGTERM}); !stops) return fail(stops.error());
  const auto participant = ros2::options_from_environment();
  if (!participant) return fail(participant.error());
  const auto context = ros2::Context::create(executor, *participant);
  if (!context) return fail(context.error());
  return with(executor, **context);
}

template <class Process>
int run_process(Process& process, ros2::Executor& executor, ros2::Context& context) {
  if (auto opened = process.open(context); !opened) return fail(opened.error());
  executor.run();
  return 0;
}

int main(int argc, char** argv) {
  static const std::map<std::string, Function> kFunctions = {{"search", Function::kSearch},
                                                             {"follow", Function::kFollow},
                                                             {"motion", Function::kMotion},
                                                             {"recharge", Function::kRecharge}};
  const NodeCommandLine line{
      .about = "One process of the SUAVE exemplar's robot.",
      .names = {"vehicle", "mission", "search", "follow", "motion", "recharge"},
      .environment = "SUAVE",
      .seed_of = "mission",
      .option = "mission",
      .option_environment = "SUAVE_MISSION",
      .option_help = "standard, or extended: the battery runs low",
      .choices = {"standard", "extended"}};
  int exit_code = 0;
  const auto given = parse(line, argc, argv, exit_code);
  if (!given) return exit_code;
  const NodeOptions options{.speed = given->speed, .seed = given->seed};

  // The newest: only it publishes what a live manager can rely on.
  const model::Generation& generation = **model::find_generation("new");
  const model::MissionPlan& plan = **model::find_mission_plan(given->option);
  return run([&](ros2::Executor& executor, ros2::Context& context) {
    const auto function = kFunctions.find(given->name);
    if (function != kFunctions.end()) {
      FunctionProcess process(function->second, options, generation);
      return run_process(process, executor, context);
    }
    if (given->name == "vehicle") {
      VehicleProcess process(options, generation, plan);
      return run_process(process, executor, context);
    }
    MissionProcess process(options, generation, plan);
    return run_process(process, executor, context);
  });
}

}  // namespace
}  // namespace culprit::suave

int main(int argc, char** argv) {
  const int code = culprit::suave::main(argc, argv);
  std::fflush(nullptr);
  // Everything is closed by now; Fast DDS's static objects would sleep for another 100 ms.
  std::_Exit(code);
}
