// Components that a container loads, on a peer that behaves as rclcpp_components' container does:
// one is reloaded and its container goes on; where that fails, or the container died, the container
// and all that it had come back, once and in order.
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <future>
#include <memory>
#include <random>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "owners/proc.h"
#include "ros2/node.h"
#include "ros2/options.h"
#include "ros2/services.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

// The detector is wrong until it is loaded with the parameters that the rules give it.
constexpr const char* kWeak = R"(
RULE DetectorWeak
  POLICIES ERROR ATTEMPTS 1
  TRIGGER parameter(detector, gain) < 5
    STRATEGY detector_redeploy 90 10
      ADAPTATION detector redeploy 5
)";
constexpr const char* kGone = R"(
RULE DetectorGone
  POLICIES ERROR
  TRIGGER alive(detector) == false
    STRATEGY detector_redeploy 90 10
      ADAPTATION detector redeploy 5
RULE TrackerGone
  POLICIES ERROR
  TRIGGER alive(tracker) == false
    STRATEGY tracker_redeploy 90 10
      ADAPTATION tracker redeploy 5
RULE BoxGone
  POLICIES ERROR
  TRIGGER alive(box) == false
    STRATEGY box_redeploy 90 10
      ADAPTATION box redeploy 5
)";

struct Composed : testing::Test {
  void SetUp() override {
    setenv("AMENT_PREFIX_PATH", world.folder().c_str(), 1);
    const std::filesystem::path index =
        world.folder() / "share/ament_index/resource_index/rclcpp_components";
    std::filesystem::create_directories(index);
    std::ofstream(index / "peer") << "peer::Node;lib/libpeer.so\n";
  }
  std::string domain() const { return std::to_string(ros2::options_from_environment()->domain); }
  // The box, and what lives there, in the order in which it is loaded.
  std::string rules(const std::string& behaviour, const std::string& plugin = "peer::Node") const {
    const std::string parameters =
        world.write("detector.yaml", "detector:\n  ros__parameters:\n    gain: 7.0\n");
    return "COMPONENT box NODE /box LAUNCH \"ros2_peer_node " + domain() + " --container" +
           behaviour + " /box\"\nCOMPONENT detector NODE /detector IN /box PLUGIN " + plugin +
           " PARAMETERS " + parameters +
           "\nCOMPONENT tracker NODE /tracker IN /box PLUGIN peer::Node\n";
  }
  TestProgram run(const std::string& text, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"culprit", "run", world.write("composed.rules", text),
                                       "--state-dir", state()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return TestProgram(world, std::move(arguments));
  }
  std::string state() const { return (world.folder() / "state").string(); }
  TestProgram box(std::vector<std::string> names = {"/box", "/detector", "/tracker"}) const {
    std::vector<std::string> arguments{"ros2_peer_node", domain(), "--keeps-if", keeps()};
    arguments.insert(arguments.end(), names.begin(), names.end());
    return TestProgram(world, std::move(arguments));
  }
  std::string keeps() const { return (world.folder() / "keeps").string(); }
  // The output of a box that culprit started.
  std::string said() const {
    std::ifstream in(state() + "/log/" + domain() + "--box.log");
    return {std::istreambuf_iterator<char>(in), {}};
  }
  template <class Done>
  static bool comes(Done done) {
    for (const Time end = live_now() + TestProgram::kPatience; !done();) {
      if (live_now() > end) return false;
      std::this_thread::sleep_for(20ms);
    }
    return true;
  }
  void end_box(const TestProgram& culprit) const {
    if (const int pid = pid_in(culprit.output(), "box"); pid != 0) kill(pid, SIGKILL);
  }

  TestWorld world;
};

TEST_F(Composed, OneIsReloadedAndItsContainerGoesOn) {
  auto container = box();
  const auto culprit = run(rules("") + kWeak);
  EXPECT_TRUE(culprit.prints("DetectorWeak resolved by detector_redeploy")) << culprit.output();
  EXPECT_THAT(container.output(), HasSubstr("unloaded /detector\nloaded /detector\n"));
  EXPECT_THAT(container.output(), Not(HasSubstr("/tracker")));
  EXPECT_FALSE(container.wait(100ms)) << "the container was ended";
  EXPECT_THAT(culprit.output(), Not(HasSubstr("tracker is lost")));
  EXPECT_THAT(culprit.output(), Not(HasSubstr("several nodes")));
}

TEST_F(Composed, WhatItsContainerDoesNotUnloadComesBackWithAFreshContainerAndAllThatItHad) {
  std::ofstream(keeps()) << "now";
  auto container = box();
  const auto culprit = run(rules(" --keeps-if " + keeps()) + kWeak);
  EXPECT_TRUE(culprit.prints("its container is replaced, with all that it has"))
      << culprit.output();
  EXPECT_TRUE(culprit.prints("DetectorWeak resolved by detector_redeploy")) << culprit.output();
  EXPECT_TRUE(container.wait(1s)) << "two containers";
  EXPECT_TRUE(comes([&] { return said().find("loaded /tracker\n") != std::string::npos; }));
  EXPECT_EQ(said(), "loaded /detector\nloaded /tracker\n") << culprit.output();
  end_box(culprit);
}

TEST_F(Composed, NoContainerIsReplacedThatHasWhatNobodyCouldLoadAgain) {
  std::ofstream(keeps()) << "now";
  auto container = box({"/box", "/detector", "/tracker", "/planner"});
  const auto culprit = run(rules("") + kWeak);
  EXPECT_TRUE(culprit.prints("/planner lives there, too, and could not be loaded again"))
      << culprit.output();
  EXPECT_TRUE(culprit.prints("DetectorWeak is exhausted")) << culprit.output();
  EXPECT_FALSE(container.wait(100ms)) << "the container was ended";
}

TEST_F(Composed, NothingIsUnloadedThatCouldNotBeLoadedAgain) {
  auto container = box();
  const auto culprit = run(rules("", "peer::Nodde") + kWeak);
  EXPECT_TRUE(
      culprit.prints("the package peer has no component peer::Nodde; did you mean "
                     "peer::Node?"))
      << culprit.output();
  EXPECT_TRUE(culprit.prints("DetectorWeak waits: detector cannot be started")) << culprit.output();
  EXPECT_THAT(container.output(), Not(HasSubstr("unloaded")));
  TestProgram check(world, {"culprit", "check", "--robot",
                            world.write("typo.rules", rules("", "peer::Nodde") + kWeak)});
  EXPECT_EQ(check.wait(), 0);
  EXPECT_THAT(check.output(), HasSubstr("PLUGIN: the package peer has no component peer::Nodde"));
}

TEST_F(Composed, AContainerThatIsKilledComesBackOnceWithAllThatItHad) {
  const auto culprit = run(rules("") + kGone, {"--launch"});
  ASSERT_TRUE(culprit.prints("tracker is there (process ")) << culprit.output();
  ASSERT_TRUE(comes([&] { return said() == "loaded /detector\nloaded /tracker\n"; })) << said();
  const int first = pid_in(culprit.output(), "box");
  ASSERT_NE(first, 0) << culprit.output();
  kill(first, SIGKILL);
  EXPECT_TRUE(culprit.prints("BoxGone resolved by box_redeploy")) << culprit.output();
  EXPECT_TRUE(culprit.prints("DetectorGone cleared")) << culprit.output();
  EXPECT_TRUE(culprit.prints("TrackerGone cleared")) << culprit.output();
  // One dead process is one fault.
  EXPECT_THAT(culprit.output(), HasSubstr("box is held responsible for BoxGone"));
  EXPECT_THAT(culprit.output(), Not(HasSubstr("detector is held responsible")));
  EXPECT_THAT(culprit.output(), Not(HasSubstr("tracker is held responsible")));
  EXPECT_TRUE(comes([&] { return pid_in(culprit.output(), "box") != first; }));
  EXPECT_EQ(said(), "loaded /detector\nloaded /tracker\nloaded /detector\nloaded /tracker\n")
      << culprit.output();
  EXPECT_THAT(culprit.output(), Not(HasSubstr("several nodes")));
  end_box(culprit);
}

TEST_F(Composed, WhatAKilledCulpritLeftUnfinishedIsFinishedOnce) {
  auto text = rules("") + kGone;
  {
    auto culprit = run(text, {"--launch"});
    ASSERT_TRUE(culprit.prints("tracker is there (process ")) << culprit.output();
    kill(pid_in(culprit.output(), "box"), SIGKILL);
    ASSERT_TRUE(culprit.prints("detector is lost")) << culprit.output();
    culprit.signal(SIGKILL);
    ASSERT_TRUE(culprit.wait());
  }
  const auto culprit = run(text);
  EXPECT_TRUE(comes([&] {
    return pid_in(culprit.output(), "detector") != 0 && pid_in(culprit.output(), "tracker") != 0;
  })) << culprit.output();
  EXPECT_TRUE(comes([&] {
    return said() == "loaded /detector\nloaded /tracker\nloaded /detector\nloaded /tracker\n";
  })) << said()
      << culprit.output();
  EXPECT_THAT(culprit.output(), Not(HasSubstr("several nodes")));
  end_box(culprit);
}

// Sets the detector's gain from outside, and unloads, as a person does with `ros2 param set` and
// `ros2 component unload`.
class Person {
 public:
  Person() {
    auto context = ros2::Context::create(executor_, *ros2::options_from_environment());
    if (!context) throw std::runtime_error(context.error());
    context_ = std::move(*context);
    node_ = std::move(*ros2::Node::create(*context_, {"/", "person"}));
    set_ = std::move(*node_->create_client<ros2::srv::SetParameters>("/detector/set_parameters"));
    list_ = std::move(*node_->create_client<ros2::srv::ListNodes>("/box/_container/list_nodes"));
    unload_ =
        std::move(*node_->create_client<ros2::srv::UnloadNode>("/box/_container/unload_node"));
    thread_ = std::thread([this] { executor_.run(); });
  }
  ~Person() {
    executor_.stop();
    thread_.join();
  }
  // A detector that is not there now needs none.
  void weaken_detector() {
    std::promise<void> done;
    set_->call({{{"gain", ros2::to_parameter_value(1.0)}}}, ros2::Repeat::kUntilAnswered, 1s,
               [&](const auto&) { done.set_value(); });
    done.get_future().wait();
  }
  // Whether the box had it, and unloads it.
  bool unloads(const std::string& node) {
    std::promise<std::uint64_t> listed;
    list_->call({}, ros2::Repeat::kUntilAnswered, 10s, [&](const auto& answer) {
      std::uint64_t id = 0;
      for (std::size_t i = 0; answer.response && i < answer.response->unique_ids.size(); ++i) {
        if (answer.response->full_node_names[i] == node) id = answer.response->unique_ids[i];
      }
      listed.set_value(id);
    });
    const std::uint64_t id = listed.get_future().get();
    if (id == 0) return false;
    std::promise<bool> done;
    unload_->call({id}, ros2::Repeat::kNever, 10s, [&](const auto& answer) {
      done.set_value(answer.response && answer.response->success);
    });
    return done.get_future().get();
  }

 private:
  ros2::Executor executor_;
  std::unique_ptr<ros2::Context> context_;
  std::unique_ptr<ros2::Node> node_;
  std::unique_ptr<ros2::Client<ros2::srv::SetParameters>> set_;
  std::unique_ptr<ros2::Client<ros2::srv::ListNodes>> list_;
  std::unique_ptr<ros2::Client<ros2::srv::UnloadNode>> unload_;
  std::thread thread_;
};

// As `ros2 component unload`: the container goes on, so nothing crashed.
TEST_F(Composed, WhatAPersonUnloadsStaysDownUntilAPersonOrdersOtherwise) {
  auto container = box();
  const auto culprit = run(rules("") + kGone, {"--settle", "0.5"});
  ASSERT_TRUE(culprit.prints("detector is there (process ")) << culprit.output();
  ASSERT_TRUE(culprit.prints("watching")) << culprit.output();
  Person person;
  std::this_thread::sleep_for(1s);
  ASSERT_TRUE(person.unloads("/detector")) << container.output();
  EXPECT_TRUE(culprit.prints("detector stays down: it was unloaded, and not by culprit"))
      << culprit.output();
  std::this_thread::sleep_for(4s);  // that nothing happens takes time
  EXPECT_THAT(container.output(), Not(HasSubstr("\nloaded"))) << culprit.output();
  TestProgram revive(world, {"culprit", "revive"});
  revive.wait();
  EXPECT_TRUE(culprit.prints("DetectorGone resolved by detector_redeploy")) << culprit.output();
  EXPECT_THAT(container.output(), HasSubstr("unloaded /detector\nloaded /detector\n"));
  EXPECT_FALSE(container.wait(100ms)) << "the container was ended";
}

// CULPRIT_CHAOS_KILLS says how often (scripts/chaos), CULPRIT_CHAOS_SEED when.
TEST_F(Composed, CulpritMayBeKilledAtAnyInstantOfAReload) {
  const auto setting = [](const char* name, int otherwise) {
    const char* value = std::getenv(name);
    return value == nullptr ? otherwise : std::atoi(value);
  };
  std::mt19937 random(static_cast<unsigned>(setting("CULPRIT_CHAOS_SEED", 1)));
  std::uniform_int_distribution<int> reloading(0, 800);
  // No repair is proven before the next kill, so all count as attempts for one failure.
  const std::string text = rules("") + R"(
RULE DetectorWeak
  POLICIES ERROR ATTEMPTS 1000
  TRIGGER parameter(detector, gain) < 5
    STRATEGY detector_redeploy 90 10
      ADAPTATION detector redeploy 5
)";
  const std::vector<std::string> options{"--settle", "1", "--healthy", "1", "--backoff", "0"};
  auto container = box();
  Person person;
  for (int kills = setting("CULPRIT_CHAOS_KILLS", 4); kills > 0; --kills) {
    person.weaken_detector();
    TestProgram culprit = run(text, options);
    culprit.prints("decided", 6s);
    std::this_thread::sleep_for(std::chrono::milliseconds(reloading(random)));
    culprit.signal(SIGKILL);
    EXPECT_EQ(culprit.wait(), -SIGKILL) << culprit.output();
  }
  person.weaken_detector();
  const auto last = run(text, options);
  EXPECT_TRUE(last.prints("DetectorWeak resolved by")) << last.output() << container.output();
  EXPECT_FALSE(container.wait(100ms)) << "the container was ended";
  // Each time one is unloaded, and one loaded.
  std::istringstream said(container.output().substr(container.output().find("unloaded")));
  int loaded = 1;
  for (std::string line; std::getline(said, line);) {
    EXPECT_EQ(line, loaded == 1 ? "unloaded /detector" : "loaded /detector") << container.output();
    loaded = 1 - loaded;
  }
  EXPECT_EQ(loaded, 1) << container.output();
}

// Any program on the network can offer services of these names.
TEST_F(Composed, ANodeThatOnlyOffersTheServicesOfAContainerIsNotBelieved) {
  const std::string stalls = (world.folder() / "stalls").string();
  TestProgram container(world, {"ros2_peer_node", domain(), "--active", "--stalls-if", stalls,
                                "/box", "/detector", "/tracker"});
  ros2::Executor executor;
  auto context = ros2::Context::create(executor, *ros2::options_from_environment());
  ASSERT_TRUE(context) << context.error();
  auto forger = ros2::Node::create(**context, {"/", "forger"});
  ASSERT_TRUE(forger) << forger.error();
  auto list = (*forger)->create_service<ros2::srv::ListNodes>(
      "/box/_container/list_nodes", [](const ros2::srv::ListNodes::Request&) {
        return ros2::srv::ListNodes::Response{{"/detector"}, {99}};
      });
  ASSERT_TRUE(list) << list.error();
  std::atomic<int> asked = 0;
  auto unload = (*forger)->create_service<ros2::srv::UnloadNode>(
      "/box/_container/unload_node", [&](const ros2::srv::UnloadNode::Request&) {
        ++asked;
        return ros2::srv::UnloadNode::Response{false, "no"};
      });
  ASSERT_TRUE(unload) << unload.error();
  std::thread thread([&] { executor.run(); });
  const auto culprit = run(rules("") + kWeak, {"--approve"});
  ASSERT_TRUE(culprit.prints("DetectorWeak detected")) << culprit.output();
  std::filesystem::rename(world.write("seconds", "300"), stalls);  // only the forger answers
  ASSERT_TRUE(comes([&] { return !std::filesystem::exists(stalls); }));
  TestProgram order(world, {"culprit", "run-strategy", "detector_redeploy", "--domain", domain()});
  order.wait();
  EXPECT_TRUE(culprit.prints("another process answers for the container /box")) << culprit.output();
  EXPECT_FALSE(container.wait(100ms)) << "the container was ended";
  EXPECT_EQ(asked, 0);
  executor.stop();
  thread.join();
}

}  // namespace
}  // namespace culprit::cli
