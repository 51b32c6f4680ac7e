// The leaves against a culprit that the test plays. The tree's own node is spun by nobody: what leaves know
// must not depend on that.
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "culprit_bt/register.h"
#include "rclcpp/rclcpp.hpp"
#include "rclcpp_action/rclcpp_action.hpp"

namespace culprit_bt {
namespace {

using namespace std::chrono_literals;
using BT::NodeStatus;
using culprit_msgs::msg::Component;
using culprit_msgs::msg::Status;
using Action = culprit_msgs::action::WaitForRecovery;

constexpr auto kPatienceOfTest = 60s;

bool eventually(const std::function<bool()>& holds) {
  const auto ends = std::chrono::steady_clock::now() + kPatienceOfTest;
  while (std::chrono::steady_clock::now() < ends) {
    if (holds()) return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

// A node on a thread of its own, which can be held as SIGSTOP holds a process.
class Played {
 public:
  explicit Played(const std::string& name) : node(rclcpp::Node::make_shared(name)) {
    executor_.add_node(node);
    thread_ = std::thread([this] {
      while (!ends_) {
        if (is_held_) {
          std::this_thread::sleep_for(10ms);
        } else {
          executor_.spin_once(10ms);
        }
      }
    });
  }
  ~Played() {
    ends_ = true;
    thread_.join();
  }
  Played(const Played&) = delete;
  Played& operator=(const Played&) = delete;

  void hold() { is_held_ = true; }
  void let_go() { is_held_ = false; }

  const rclcpp::Node::SharedPtr node;

 private:
  rclcpp::executors::SingleThreadedExecutor executor_;
  std::atomic<bool> ends_{false};
  std::atomic<bool> is_held_{false};
  std::thread thread_;
};

Status robot(std::uint8_t health = Component::HEALTH_OK) {
  Component camera;
  camera.name = "camera";
  camera.is_present = true;
  camera.process = Component::PROCESS_RUNNING;
  camera.health = health;
  Status status;
  status.hears = true;
  status.health = health;
  status.components = {camera};
  return status;
}

class PlayedCulprit {
 public:
  using Handle = rclcpp_action::ServerGoalHandle<Action>;

  PlayedCulprit() {
    const auto& node = played_.node;
    publisher_ =
        node->create_publisher<Status>("~/status", rclcpp::QoS(1).reliable().transient_local());
    server_ = rclcpp_action::create_server<Action>(
        node, "~/wait_for_recovery",
        [](const rclcpp_action::GoalUUID&, std::shared_ptr<const Action::Goal>) {
          return rclcpp_action::GoalResponse::ACCEPT_AND_EXECUTE;
        },
        [this](std::shared_ptr<Handle>) {
          was_canceled = true;
          return rclcpp_action::CancelResponse::ACCEPT;
        },
        [this](std::shared_ptr<Handle> handle) {
          const std::scoped_lock lock(mutex_);
          handle_ = std::move(handle);
        });
  }

  void tell(const Status& status) { publisher_->publish(status); }
  void hold() { played_.hold(); }
  void let_go() { played_.let_go(); }

  // The goal that was asked for last; null: none was.
  std::shared_ptr<Handle> goal() {
    const std::scoped_lock lock(mutex_);
    return handle_;
  }

  static std::shared_ptr<Action::Result> result(bool recovered, const std::string& message) {
    auto result = std::make_shared<Action::Result>();
    result->recovered = recovered;
    result->message = message;
    return result;
  }

  std::atomic<bool> was_canceled{false};

 private:
  std::mutex mutex_;
  std::shared_ptr<Handle> handle_;
  rclcpp::Publisher<Status>::SharedPtr publisher_;
  rclcpp_action::Server<Action>::SharedPtr server_;
  Played played_{"culprit"};  // it ends first
};

// A tree of what the XML says, beside a child that the test plays: <Child/>.
class Mission {
 public:
  explicit Mission(const std::string& inner) {
    register_nodes(factory_);
    factory_.registerSimpleAction("Note", [this](BT::TreeNode&) {
      ++notes;
      return NodeStatus::SUCCESS;
    });
    factory_.registerBuilder<Child>("Child",
                                    [this](const std::string& name, const BT::NodeConfig& config) {
                                      return std::make_unique<Child>(name, config, *this);
                                    });
    blackboard->set<rclcpp::Node::SharedPtr>("node", rclcpp::Node::make_shared("mission"));
    tree_ = factory_.createTreeFromText(
        "<root BTCPP_format=\"4\"><BehaviorTree ID=\"M\">" + inner + "</BehaviorTree></root>",
        blackboard);
  }

  NodeStatus tick() { return tree_.tickOnce(); }
  bool becomes(NodeStatus status) {
    return eventually([&] { return tick() == status; });
  }
  // While it runs.
  NodeStatus end() {
    NodeStatus status = NodeStatus::RUNNING;
    eventually([&] { return (status = tick()) != NodeStatus::RUNNING; });
    return status;
  }
  void halt() { tree_.haltTree(); }
  std::string says(const std::string& key) {
    std::string text;
    return blackboard->get(key, text) ? text : "";
  }

  const BT::Blackboard::Ptr blackboard = BT::Blackboard::create();
  NodeStatus child = NodeStatus::RUNNING;
  int begun = 0;
  int halted = 0;
  int notes = 0;

 private:
  class Child : public BT::StatefulActionNode {
   public:
    Child(const std::string& name, const BT::NodeConfig& config, Mission& mission)
        : BT::StatefulActionNode(name, config), mission_(mission) {}
    static BT::PortsList providedPorts() { return {}; }

   private:
    NodeStatus onStart() override {
      ++mission_.begun;
      return mission_.child;
    }
    NodeStatus onRunning() override { return mission_.child; }
    void onHalted() override { ++mission_.halted; }

    Mission& mission_;
  };

  BT::BehaviorTreeFactory factory_;
  BT::Tree tree_;
};

constexpr const char* kIsHealthy = R"(<IsHealthy component="camera" reason="{reason}"/>)";

TEST(IsHealthy, FailsWhileCulpritWasNeverHeard) {
  Mission mission(kIsHealthy);
  EXPECT_EQ(mission.tick(), NodeStatus::FAILURE);
  EXPECT_NE(mission.says("reason").find("does `culprit run` run?"), std::string::npos);
}

TEST(IsHealthy, FollowsWhatCulpritTells) {
  PlayedCulprit culprit;
  Mission mission(kIsHealthy);
  culprit.tell(robot());
  EXPECT_TRUE(mission.becomes(NodeStatus::SUCCESS));
  EXPECT_EQ(mission.says("reason"), "");
  culprit.tell(robot(Component::HEALTH_ERROR));
  EXPECT_TRUE(mission.becomes(NodeStatus::FAILURE));
  EXPECT_EQ(mission.says("reason"), "a rule that fails touches camera");
  culprit.tell(robot());
  EXPECT_TRUE(mission.becomes(NodeStatus::SUCCESS));
}

TEST(IsHealthy, GetsWhatWasToldBeforeTheTreeWasMade) {
  PlayedCulprit culprit;
  culprit.tell(robot());
  Mission mission(kIsHealthy);
  EXPECT_TRUE(mission.becomes(NodeStatus::SUCCESS));
}

TEST(IsHealthy, FailsOnceCulpritDoesNotAnswerThoughItsLastWordWasGood) {
  PlayedCulprit culprit;
  Mission mission(kIsHealthy);
  culprit.tell(robot());
  ASSERT_TRUE(mission.becomes(NodeStatus::SUCCESS));
  culprit.hold();
  EXPECT_TRUE(mission.becomes(NodeStatus::FAILURE));
  EXPECT_NE(mission.says("reason").find("/culprit does not answer"), std::string::npos);
  // It has nothing new to tell when it goes on.
  culprit.let_go();
  EXPECT_TRUE(mission.becomes(NodeStatus::SUCCESS));
}

TEST(IsHealthy, BelievesNothingOfACulpritThatHasEnded) {
  auto culprit = std::make_unique<PlayedCulprit>();
  Mission mission(kIsHealthy);
  culprit->tell(robot());
  ASSERT_TRUE(mission.becomes(NodeStatus::SUCCESS));
  culprit.reset();
  ASSERT_TRUE(mission.becomes(NodeStatus::FAILURE));
  // One that has told nothing yet.
  culprit = std::make_unique<PlayedCulprit>();
  ASSERT_TRUE(eventually([&] {
    EXPECT_EQ(mission.tick(), NodeStatus::FAILURE);
    return mission.says("reason") == "/culprit has not told yet how the robot is";
  }));
  culprit->tell(robot());
  EXPECT_TRUE(mission.becomes(NodeStatus::SUCCESS));
}

TEST(IsHealthy, FailsForANameThatIsMistyped) {
  PlayedCulprit culprit;
  culprit.tell(robot());
  Mission mission(R"(<IsHealthy component="camra" reason="{reason}"/>)");
  EXPECT_TRUE(eventually([&] {
    EXPECT_EQ(mission.tick(), NodeStatus::FAILURE);
    return mission.says("reason").find("did you mean 'camera'?") != std::string::npos;
  }));
}

TEST(IsHealthy, NeedsANodeAndWordsThatItKnows) {
  BT::BehaviorTreeFactory factory;
  register_nodes(factory);
  const std::string text =
      R"(<root BTCPP_format="4"><BehaviorTree ID="M"><IsHealthy/></BehaviorTree></root>)";
  try {
    const BT::Tree tree = factory.createTreeFromText(text);
    FAIL();
  } catch (const BT::RuntimeError& error) {
    EXPECT_NE(std::string(error.what()).find("set<rclcpp::Node::SharedPtr>(\"node\", node)"),
              std::string::npos);
  }
  Mission mission(R"(<IsHealthy tolerate="PAIN"/>)");
  EXPECT_THROW(mission.tick(), BT::RuntimeError);
}

constexpr const char* kWait =
    R"(<WaitForRecovery component="camera" timeout="90" unreachable="60" doing="{doing}"
                        needs_person="{person}" reason="{reason}"/>)";

TEST(WaitForRecovery, SucceedsWhenCulpritSaysSo) {
  PlayedCulprit culprit;
  culprit.tell(robot(Component::HEALTH_ERROR));
  Mission mission(kWait);
  ASSERT_TRUE(eventually([&] {
    EXPECT_EQ(mission.tick(), NodeStatus::RUNNING);
    return culprit.goal() != nullptr;
  }));
  EXPECT_EQ(culprit.goal()->get_goal()->component, "camera");
  EXPECT_GT(culprit.goal()->get_goal()->timeout.sec, 0);
  EXPECT_LE(culprit.goal()->get_goal()->timeout.sec, 90);
  auto feedback = std::make_shared<Action::Feedback>();
  feedback->doing = "restart camera";
  feedback->needs_person = true;
  EXPECT_TRUE(eventually([&] {
    culprit.goal()->publish_feedback(feedback);
    EXPECT_EQ(mission.tick(), NodeStatus::RUNNING);
    return mission.says("doing") == "restart camera";
  }));
  EXPECT_TRUE(mission.blackboard->get<bool>("person"));
  culprit.goal()->succeed(PlayedCulprit::result(true, "camera is well"));
  EXPECT_EQ(mission.end(), NodeStatus::SUCCESS);
}

TEST(WaitForRecovery, FailsWithWhatCulpritSays) {
  PlayedCulprit culprit;
  culprit.tell(robot());
  Mission mission(kWait);
  ASSERT_TRUE(eventually([&] { return mission.tick() != NodeStatus::RUNNING || culprit.goal(); }));
  culprit.goal()->abort(PlayedCulprit::result(false, "there is no component 'camera'"));
  EXPECT_EQ(mission.end(), NodeStatus::FAILURE);
  EXPECT_EQ(mission.says("reason"), "there is no component 'camera'");
}

TEST(WaitForRecovery, FailsWhereCulpritCannotBeReached) {
  Mission mission(R"(<WaitForRecovery unreachable="0.2" reason="{reason}"/>)");
  EXPECT_EQ(mission.end(), NodeStatus::FAILURE);
  EXPECT_NE(mission.says("reason").find("culprit is not reachable"), std::string::npos);
}

TEST(WaitForRecovery, FailsWhenItsTimeIsOverThoughNobodySaysSo) {
  Mission mission(R"(<WaitForRecovery timeout="0.2" unreachable="60" reason="{reason}"/>)");
  EXPECT_EQ(mission.end(), NodeStatus::FAILURE);
  EXPECT_EQ(mission.says("reason").rfind("the time is over", 0), 0U);
}

TEST(WaitForRecovery, CancelsTheGoalWhenHalted) {
  PlayedCulprit culprit;
  culprit.tell(robot());
  Mission mission(kWait);
  ASSERT_TRUE(eventually([&] { return mission.tick() != NodeStatus::RUNNING || culprit.goal(); }));
  mission.halt();
  EXPECT_TRUE(eventually([&] { return culprit.was_canceled.load(); }));
}

TEST(WaitForRecovery, AsksTheNextCulpritWhenOneEnded) {
  auto culprit = std::make_unique<PlayedCulprit>();
  culprit->tell(robot());
  Mission mission(kWait);
  ASSERT_TRUE(eventually([&] { return mission.tick() != NodeStatus::RUNNING || culprit->goal(); }));
  culprit.reset();
  culprit = std::make_unique<PlayedCulprit>();
  culprit->tell(robot());
  ASSERT_TRUE(eventually([&] {
    EXPECT_EQ(mission.tick(), NodeStatus::RUNNING);
    return culprit->goal() != nullptr;
  }));
  culprit->goal()->succeed(PlayedCulprit::result(true, "camera is well"));
  EXPECT_EQ(mission.end(), NodeStatus::SUCCESS);
}

TEST(WaitForRecovery, RefusesATimeThatIsNone) {
  Mission negative(R"(<WaitForRecovery timeout="-1"/>)");
  EXPECT_THROW(negative.tick(), BT::RuntimeError);
  Mission nan(R"(<WaitForRecovery timeout="nan"/>)");
  EXPECT_THROW(nan.tick(), BT::RuntimeError);
}

constexpr const char* kGuarded = R"(<ReactiveSequence>
  <Incident component="camera" headline="{headline}"><Child/></Incident> <Note/>
</ReactiveSequence>)";

TEST(Incident, RunsItsChildWhileThereIsOneAndWhatComesNextAfterwards) {
  PlayedCulprit culprit;
  culprit.tell(robot());
  Mission mission(kGuarded);
  // Until culprit is heard nobody knows, and that counts as one.
  EXPECT_EQ(mission.tick(), NodeStatus::RUNNING);
  EXPECT_EQ(mission.begun, 1);
  ASSERT_TRUE(mission.becomes(NodeStatus::SUCCESS));
  EXPECT_EQ(mission.halted, 1);
  EXPECT_EQ(mission.notes, 1);

  culprit.tell(robot(Component::HEALTH_ERROR));
  ASSERT_TRUE(mission.becomes(NodeStatus::RUNNING));
  EXPECT_EQ(mission.begun, 2);
  EXPECT_EQ(mission.says("headline"), "a rule that fails touches camera");
  culprit.tell(robot());
  EXPECT_TRUE(mission.becomes(NodeStatus::SUCCESS));
  EXPECT_EQ(mission.halted, 2);
}

TEST(Incident, HoldsBackWhatComesNextUntilItIsOverThoughTheChildIsDone) {
  PlayedCulprit culprit;
  culprit.tell(robot(Component::HEALTH_ERROR));
  Mission mission(kGuarded);
  mission.child = NodeStatus::SUCCESS;
  ASSERT_TRUE(eventually([&] {
    EXPECT_EQ(mission.tick(), NodeStatus::RUNNING);
    return mission.says("headline") == "a rule that fails touches camera";
  }));
  for (int i = 0; i < 10; ++i) EXPECT_EQ(mission.tick(), NodeStatus::RUNNING);
  EXPECT_EQ(mission.begun, 1);
  EXPECT_EQ(mission.notes, 0);
  culprit.tell(robot());
  EXPECT_TRUE(mission.becomes(NodeStatus::SUCCESS));
  EXPECT_EQ(mission.notes, 1);
}

TEST(Incident, FailsWhenItsChildFails) {
  Mission mission(kGuarded);
  mission.child = NodeStatus::FAILURE;
  EXPECT_EQ(mission.tick(), NodeStatus::FAILURE);
  EXPECT_EQ(mission.notes, 0);
}

TEST(Incident, LetsNoMissionRunUnguardedBecauseOfAMistypedName) {
  PlayedCulprit culprit;
  culprit.tell(robot());
  Mission mission(R"(<ReactiveSequence>
    <Incident component="camra" headline="{headline}"><Child/></Incident> <Note/>
  </ReactiveSequence>)");
  EXPECT_EQ(mission.end(), NodeStatus::FAILURE);
  EXPECT_NE(mission.says("headline").find("did you mean 'camera'?"), std::string::npos);
  EXPECT_EQ(mission.notes, 0);
  EXPECT_EQ(mission.halted, 1);
}

class PlayedModes {
 public:
  using Change = system_modes_msgs::srv::ChangeMode;
  using Get = system_modes_msgs::srv::GetMode;

  PlayedModes() {
    change_ = played_.node->create_service<Change>(
        "/base/change_mode",
        [this](std::shared_ptr<Change::Request> request, std::shared_ptr<Change::Response> answer) {
          answer->success = request->mode_name != "FAZT";
          if (answer->success && obeys) mode = request->mode_name;
        });
    get_ = played_.node->create_service<Get>(
        "/base/get_mode",
        [this](std::shared_ptr<Get::Request>, std::shared_ptr<Get::Response> answer) {
          answer->current_mode = mode;
        });
  }

  std::string mode = "SLOW";  // touched by its thread alone once it was asked
  std::atomic<bool> obeys{true};

 private:
  rclcpp::Service<Change>::SharedPtr change_;
  rclcpp::Service<Get>::SharedPtr get_;
  Played played_{"modes"};
};

TEST(RequestMode, SucceedsOnceTheModeIsReadBack) {
  PlayedModes modes;
  Mission mission(R"(<RequestMode system="base" mode="FAST" timeout="60" reason="{reason}"/>)");
  EXPECT_EQ(mission.end(), NodeStatus::SUCCESS);
  EXPECT_EQ(modes.mode, "FAST");
}

TEST(RequestMode, FailsWhereItIsRefused) {
  PlayedModes modes;
  Mission mission(R"(<RequestMode system="/base" mode="FAZT" timeout="60" reason="{reason}"/>)");
  EXPECT_EQ(mission.end(), NodeStatus::FAILURE);
  EXPECT_EQ(mission.says("reason").rfind("/base refused mode 'FAZT'", 0), 0U);
}

TEST(RequestMode, FailsWhereItWasAcceptedAndDidNotComeAbout) {
  PlayedModes modes;
  modes.obeys = false;
  Mission mission(R"(<RequestMode system="base" mode="FAST" timeout="10" reason="{reason}"/>)");
  EXPECT_EQ(mission.end(), NodeStatus::FAILURE);
  EXPECT_EQ(mission.says("reason"), "mode 'FAST' was accepted, and /base is in 'SLOW'");
}

TEST(RequestMode, FailsWhereNobodyServesTheMode) {
  Mission mission(R"(<RequestMode system="bace" mode="FAST" timeout="0.3" reason="{reason}"/>)");
  EXPECT_EQ(mission.end(), NodeStatus::FAILURE);
  EXPECT_EQ(mission.says("reason").rfind("no node serves /bace/change_mode", 0), 0U);
}

TEST(RequestMode, RefusesPortsThatSayNothing) {
  Mission without_mode(R"(<RequestMode system="base" mode=""/>)");
  EXPECT_THROW(without_mode.tick(), BT::RuntimeError);
  Mission without_time(R"(<RequestMode system="base" mode="FAST" timeout="0"/>)");
  EXPECT_THROW(without_time.tick(), BT::RuntimeError);
}

TEST(Plugin, HasAllLeavesAndTheTreesThatComeAlongCanBeMade) {
  BT::BehaviorTreeFactory factory;
  factory.registerFromPlugin(PLUGIN);
  factory.registerSimpleAction("Stop", [](BT::TreeNode&) { return NodeStatus::SUCCESS; },
                               {BT::InputPort<std::string>("why")});
  factory.registerSimpleAction("Drive", [](BT::TreeNode&) { return NodeStatus::SUCCESS; },
                               {BT::InputPort<double>("seconds")});
  for (const char* name : {"Incident", "IsHealthy", "RequestMode", "WaitForRecovery"})
    EXPECT_EQ(factory.manifests().count(name), 1U) << name;
  const auto blackboard = BT::Blackboard::create();
  blackboard->set<rclcpp::Node::SharedPtr>("node", rclcpp::Node::make_shared("mission"));
  blackboard->set<std::string>("component", "camera");
  blackboard->set<std::string>("seconds", "1");
  auto tree = factory.createTreeFromFile(TREES "/stop_while_repaired.xml", blackboard);
  EXPECT_EQ(tree.tickOnce(), NodeStatus::RUNNING);  // nothing is known yet
}

}  // namespace
}  // namespace culprit_bt

int main(int argc, char** argv) {
  // Away from a robot that runs here, and from the other test.
  setenv("ROS_LOCALHOST_ONLY", "1", 1);
  setenv("ROS_DOMAIN_ID", "73", 1);
  testing::InitGoogleTest(&argc, argv);
  rclcpp::init(argc, argv);
  const int failed = RUN_ALL_TESTS();
  rclcpp::shutdown();
  return failed;
}
