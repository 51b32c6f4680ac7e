// A live group whose lifecycle manager gets stuck as Nav2's does: culprit brings it up past the manager.
#include <array>
#include <csignal>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/joined.h"
#include "live/test_healed_robot.h"
#include "ros2/live_test.h"
#include "ros2/peer_process.h"

namespace culprit::live {
namespace {

constexpr std::array kServers = {"controller", "planner", "navigator"};

std::vector<std::string> command_of(const std::string& component, std::uint32_t domain) {
  if (component != "manager") return {CULPRIT_PEER_NODE, std::to_string(domain), "/" + component};
  std::vector<std::string> command = {CULPRIT_PEER_MANAGER, std::to_string(domain), "/manager"};
  for (const char* server : kServers) command.push_back(std::string("/") + server);
  return command;
}

std::string rules_text(std::uint32_t domain) {
  std::string text;
  for (const std::string component : {"controller", "planner", "navigator", "manager"}) {
    text += "COMPONENT " + component + " NODE /" + component + " LAUNCH \"" +
            joined(command_of(component, domain), " ") +
            (component == "manager" ? "\"\n" : "\" LIFECYCLE launcher\n");
  }
  return text +
         "GROUP servers { controller, planner, navigator } MANAGER manager\n"
         "RULE HalfUp\n  POLICIES ERROR FOR 2s\n  TRIGGER servers == \"half_up\"\n"
         "    STRATEGY start_servers 80 10\n      ADAPTATION servers start_group 25\n";
}

class Keeper : public HealedRobot {
 public:
  explicit Keeper(const ros2::ParticipantOptions& participant)
      : HealedRobot(participant, rules_text(participant.domain)) {}

  bool sees_all_active() { return HealedRobot::sees_all_active(kServers); }
  bool has_resolved() {
    return comes_true([this] { return resolved() > 0; });
  }
};

struct Groups : testing::Test {
  std::unique_ptr<ros2::PeerProcess> start(const std::string& component) const {
    return std::make_unique<ros2::PeerProcess>(command_of(component, domain.number()));
  }

  ros2::TestDomain domain;
  std::unique_ptr<ros2::PeerProcess> controller = start("controller");
  std::unique_ptr<ros2::PeerProcess> planner = start("planner");
  std::unique_ptr<ros2::PeerProcess> navigator = start("navigator");
  std::unique_ptr<ros2::PeerProcess> manager = start("manager");
};

TEST_F(Groups, OneOfWhichAServerWasKilledIsBroughtUpPastItsManager) {
  Keeper keeper(domain.options());
  ASSERT_TRUE(keeper.sees_all_active()) << keeper.said();
  planner->end(SIGKILL);
  EXPECT_TRUE(manager->says("Deactivating /planner"));
  EXPECT_TRUE(keeper.has_resolved()) << keeper.said();
  EXPECT_TRUE(keeper.sees_all_active()) << keeper.said();
}

TEST_F(Groups, OneOfWhichAServerHangsIsBroughtUpPastItsManager) {
  Keeper keeper(domain.options());
  ASSERT_TRUE(keeper.sees_all_active()) << keeper.said();
  kill(planner->pid(), SIGSTOP);
  EXPECT_TRUE(keeper.has_resolved()) << keeper.said();
  EXPECT_TRUE(keeper.sees_all_active()) << keeper.said();
}

}  // namespace
}  // namespace culprit::live
