// sunset-node <name>: one process of the live SUNSET robot (members.h).
//
// The environment chooses the robot that it joins, as for every ROS 2 node: ROS_DOMAIN_ID,
// ROS_LOCALHOST_ONLY and so on (ros2/options.h).
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "exemplars/node_command_line.h"
#include "exemplars/sunset/camera_node.h"
#include "exemplars/sunset/crash_at_start.h"
#include "exemplars/sunset/depth_node.h"
#include "exemplars/sunset/evaluator_node.h"
#include "exemplars/sunset/image_enhancement_node.h"
#include "exemplars/sunset/segmentation_node.h"
#include "exemplars/sunset/sensor_fusion_node.h"
#include "exemplars/sunset/world_node.h"

namespace culprit::sunset {
namespace {

int fail(const std::string& why) {
  std::fprintf(stderr, "sunset-node: %s\n", why.c_str());
  return 1;
}

template <class Node>
int run(ros2::Executor& executor, ros2::Context& context, const NodeOptions& options) {
  Node node(options);
  if (auto opened = node.open(context); !opened) return fail(opened.error());
  executor.run();
  return 0;
}

int run(Member member, const NodeOptions& options) {
  ros2::Executor executor;
  if (auto stops = executor.stop_on({SIGINT, SIGTERM}); !stops) return fail(stops.error());
  const auto participant = ros2::options_from_environment();
  if (!participant) return fail(participant.error());
  const auto context = ros2::Context::create(executor, *participant);
  if (!context) return fail(context.error());
  switch (member) {
    case Member::kWorld:
      return run<WorldNode>(executor, **context, options);
    case Member::kCamera:
      return run<CameraNode>(executor, **context, options);
    case Member::kDepth:
      return run<DepthNode>(executor, **context, options);
    case Member::kImageEnhancement:
      return run<ImageEnhancementNode>(executor, **context, options);
    case Member::kSensorFusion:
      return run<SensorFusionNode>(executor, **context, options);
    case Member::kSegmentation:
      return run<SegmentationNode>(executor, **context, options);
    case Member::kEvaluator:
      return run<EvaluatorNode>(executor, **context, options);
  }
  return 1;
}

int main(int argc, char** argv) {
  std::map<std::string, Member> members;
  for (const Member member : kMembers) members.emplace(name_of(member), member);
  std::vector<std::string> names;
  for (const auto& [name, member] : members) names.push_back(name);

  const NodeCommandLine line{
      .about = "One process of the SUNSET exemplar's robot.",
      .names = names,
      .environment = "SUNSET",
      .seed_of = "flight",
      .option = "state",
      .option_environment = "SUNSET_STATE",
      .option_help = "Folder where parameters outlive the process; without it they do not"};
  int exit_code = 0;
  const auto given = parse(line, argc, argv, exit_code);
  if (!given) return exit_code;
  const NodeOptions options{.speed = given->speed, .seed = given->seed, .state = given->option};
  if (take_crash(options.state, given->name))
    return fail(given->name + " crashes at its start, as it was told");
  return run(members.at(given->name), options);
}

}  // namespace
}  // namespace culprit::sunset

int main(int argc, char** argv) {
  const int code = culprit::sunset::main(argc, argv);
  std::fflush(nullptr);
  // Everything is closed by now; Fast DDS's static objects would sleep for another 100 ms.
  std::_Exit(code);
}
