// Runs a tree, to try out the leaves:
//
//     mission TREE.xml [NAME=VALUE ...]
//
// NAME=VALUE are put on the blackboard. Beside culprit's leaves the tree may use two that only say what a
// robot would do: <Drive seconds="20"/> and <Stop why="..."/>.
// Exit status: 0 the tree succeeded; 1 it failed, or was ended by Ctrl-C; 2 it cannot be run.
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>

#include "culprit_bt/register.h"
#include "rclcpp/rclcpp.hpp"

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kTick{50};

void say(const std::string& words) {
  std::printf("%s\n", words.c_str());
  std::fflush(stdout);
}

// It has driven for so long in all. Halted, it stands; ticked again, it goes on where it was.
class Drive : public BT::StatefulActionNode {
 public:
  using BT::StatefulActionNode::StatefulActionNode;

  static BT::PortsList providedPorts() {
    return {BT::InputPort<double>("seconds", "of driving until it is there")};
  }

 private:
  BT::NodeStatus onStart() override {
    if (!getInput("seconds", seconds_)) throw BT::RuntimeError("Drive: port seconds is missing");
    say(driven_ == Clock::duration::zero() ? "drives" : "drives on");
    since_ = Clock::now();
    return BT::NodeStatus::RUNNING;
  }

  BT::NodeStatus onRunning() override {
    const std::chrono::duration<double> driven = driven_ + (Clock::now() - since_);
    if (driven.count() < seconds_) return BT::NodeStatus::RUNNING;
    driven_ = Clock::duration::zero();
    say("is there");
    return BT::NodeStatus::SUCCESS;
  }

  void onHalted() override {
    driven_ += Clock::now() - since_;
    say("stands");
  }

  double seconds_ = 0;
  Clock::duration driven_{};
  Clock::time_point since_{};
};

class Stop : public BT::SyncActionNode {
 public:
  using BT::SyncActionNode::SyncActionNode;

  static BT::PortsList providedPorts() { return {BT::InputPort<std::string>("why")}; }

 private:
  BT::NodeStatus tick() override {
    say("stopped: " + getInput<std::string>("why").value_or(""));
    return BT::NodeStatus::SUCCESS;
  }
};

BT::NodeStatus run(const std::string& file, int values, char** value) {
  const auto node = rclcpp::Node::make_shared("mission");
  BT::BehaviorTreeFactory factory;
  culprit_bt::register_nodes(factory);
  factory.registerNodeType<Drive>("Drive");
  factory.registerNodeType<Stop>("Stop");
  const auto blackboard = BT::Blackboard::create();
  blackboard->set<rclcpp::Node::SharedPtr>("node", node);
  for (int i = 0; i < values; ++i) {
    const std::string text = value[i];
    const auto equals = text.find('=');
    if (equals == 0 || equals == std::string::npos)
      throw BT::RuntimeError("'", text, "' is not NAME=VALUE");
    blackboard->set(text.substr(0, equals), text.substr(equals + 1));
  }
  // BehaviorTree.CPP cannot read a file of this folder by its mere name.
  BT::Tree tree = factory.createTreeFromFile(std::filesystem::absolute(file), blackboard);
  BT::NodeStatus status = BT::NodeStatus::RUNNING;
  while (rclcpp::ok() && status == BT::NodeStatus::RUNNING) {
    status = tree.tickOnce();
    if (status == BT::NodeStatus::RUNNING) tree.sleep(kTick);
  }
  tree.haltTree();
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  if (argc < 2) {
    std::fprintf(stderr, "mission: name a tree: mission TREE.xml [NAME=VALUE ...]\n");
    return 2;
  }
  try {
    const BT::NodeStatus status = run(argv[1], argc - 2, argv + 2);
    rclcpp::shutdown();
    say("the mission " + BT::toStr(status));
    return status == BT::NodeStatus::SUCCESS ? 0 : 1;
  } catch (const std::exception& error) {
    rclcpp::shutdown();
    std::fprintf(stderr, "mission: %s\n", error.what());
    return 2;
  }
}
