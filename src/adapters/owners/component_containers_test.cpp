#include "owners/component_containers.h"

#include <csignal>
#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit::owners {
namespace {

using testing::ElementsAre;

class ComponentContainersTest : public testing::Test {
 protected:
  void appear(const std::string& node, int pid) { see(NodeAppeared{node, pid}); }
  void load(const std::string& node) {
    see(EndpointAppeared{node, EndpointKind::kServer, node + "/_container/load_node"});
  }
  template <class What>
  void see(What what) {
    containers_.observe({Time(), std::move(what)});
  }
  std::optional<ComponentContainers::Home> home_of(unsigned component) const {
    return containers_.home_of(ComponentId(component));
  }

 private:
  const RuleSet rules_ = *check(Source("composed.rules",
                                       "COMPONENT detector NODE /detector\n"
                                       "COMPONENT box NODE /box\n"))
                              .rules;
  ComponentContainers containers_{rules_};
};

TEST_F(ComponentContainersTest, KnowTheNodesOfEachContainer) {
  appear("/detector", 7);
  EXPECT_FALSE(home_of(0)) << "alone";
  appear("/tracker", 7);
  EXPECT_FALSE(home_of(0)) << "a program of two nodes";
  appear("/box", 7);
  load("/box");
  ASSERT_TRUE(home_of(0));
  EXPECT_EQ(home_of(0)->container, "/box");
  EXPECT_THAT(home_of(0)->others, ElementsAre("/tracker"));
  EXPECT_FALSE(home_of(1)) << "the container itself";
}

TEST_F(ComponentContainersTest, RememberWhereAComponentLivedThatWasUnloaded) {
  appear("/box", 7);
  load("/box");
  appear("/detector", 7);
  see(NodeVanished{"/detector"});
  ASSERT_TRUE(home_of(0)) << "its container runs on";
  see(NodeVanished{"/box"});
  EXPECT_FALSE(home_of(0)) << "no other node is left to protect";
}

TEST_F(ComponentContainersTest, ForgetAComponentThatMovedToAnotherMachine) {
  appear("/box", 7);
  load("/box");
  appear("/detector", 7);
  see(NodeVanished{"/detector"});
  appear("/detector", 0);
  EXPECT_FALSE(home_of(0));
  appear("/elsewhere", 0);
  load("/elsewhere");
  EXPECT_FALSE(home_of(0)) << "that neither process is known makes them not one";
}

TEST_F(ComponentContainersTest, BelieveNoServiceOfAnotherProcessOrName) {
  appear("/detector", 7);
  appear("/box", 8);
  load("/box");
  EXPECT_FALSE(home_of(0));
  appear("/elsewhere", 7);
  see(EndpointAppeared{"/elsewhere", EndpointKind::kServer, "/box/_container/load_node"});
  see(EndpointAppeared{"/elsewhere", EndpointKind::kClient, "/elsewhere/_container/load_node"});
  EXPECT_FALSE(home_of(0));
}

TEST(ComponentsOfOneProcess, EndTogetherOnlyIfTheyComeBackTogether) {
  const RuleSet rules = *check(Source("shared.rules",
                                      "COMPONENT a NODE /a LAUNCH \"both\"\n"
                                      "COMPONENT b NODE /b LAUNCH \"both\"\n"
                                      "COMPONENT helper NODE /helper\n"
                                      "COMPONENT other NODE /other LAUNCH \"other\"\n"))
                             .rules;
  ComponentContainers containers(rules);
  const auto appear = [&](const char* node, int pid) {
    containers.observe({Time(), NodeAppeared{node, pid}});
  };
  appear("/a", 7);
  appear("/b", 7);
  appear("/helper", 7);
  appear("/other", 8);
  EXPECT_FALSE(containers.would_lose(ComponentId(0)));
  appear("/other", 7);
  EXPECT_EQ(containers.would_lose(ComponentId(0)), ComponentId(3));
  containers.observe({Time(), NodeVanished{"/other"}});
  EXPECT_FALSE(containers.would_lose(ComponentId(0))) << "it is not there any more";
  appear("/a", 0);
  EXPECT_FALSE(containers.would_lose(ComponentId(0))) << "whose process is not known";
}

// A process of its own, in the group of `leader`; 0: in one of its own.
int sleeper(int leader) {
  const int pid = fork();
  if (pid == 0) {
    pause();
    _exit(0);
  }
  setpgid(pid, leader);
  return pid;
}

TEST(ComponentsOfOneProcess, EndTogetherWithWhatTheSameLaunchStarted) {
  const RuleSet rules =
      *check(Source("launch.rules",
                    "COMPONENT a NODE /a LAUNCH \"ros2 launch both all.launch.py\"\n"
                    "COMPONENT b NODE /b\nCOMPONENT c NODE /c\n"
                    "COMPONENT d NODE /d\n"))
           .rules;
  ComponentContainers containers(rules);
  const int a = sleeper(0);
  const int b = sleeper(a);
  const int d = sleeper(0);
  const auto appear = [&](const char* node, int pid) {
    containers.observe({Time(), NodeAppeared{node, pid}});
  };
  appear("/a", a);
  appear("/b", b);
  appear("/c", a);
  appear("/d", d);
  const std::vector<ComponentId> in_process{ComponentId(2)};
  const std::vector<ComponentId> in_group{ComponentId(1), ComponentId(2)};
  EXPECT_EQ(containers.end_with(ComponentId(0), false), in_process);
  EXPECT_EQ(containers.end_with(ComponentId(0), true), in_group);
  containers.observe({Time(), NodeVanished{"/b"}});
  EXPECT_EQ(containers.end_with(ComponentId(0), true), in_process);
  appear("/a", 0);
  EXPECT_TRUE(containers.end_with(ComponentId(0), true).empty()) << "on another computer";
  for (const int pid : {a, b, d}) {
    kill(pid, SIGKILL);
    waitpid(pid, nullptr, 0);
  }
}

}  // namespace
}  // namespace culprit::owners
