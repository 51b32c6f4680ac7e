// Requests that people write, and what answers mean.
#include "link/service_call.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "ros2/services.h"

namespace culprit::link {
namespace {

using testing::HasSubstr;

Expected<ServiceCall> call(const std::string& type, const std::string& request,
                           const std::vector<std::filesystem::path>& message_path = {}) {
  ros2::MessageLibrary library(message_path);
  return ServiceCall::prepare(type, request, library);
}

// As the robot's own controller_manager defines it; the fields are others in each distribution.
struct ControllerFiles {
  ControllerFiles() {
    write("controller_manager_msgs/srv/SwitchController.srv",
          "string[] activate_controllers  # to start\nstring[] deactivate_controllers\n"
          "int32 BEST_EFFORT=1\nint32 strictness\nbool activate_asap\n"
          "builtin_interfaces/Duration timeout\n---\nbool ok\n");
    write("controller_manager_msgs/srv/SetHardwareComponentState.srv",
          "string name\nlifecycle_msgs/State target_state\n---\nbool ok\n"
          "lifecycle_msgs/State state\n");
    write("arm_msgs/srv/Odd.srv",
          "uint8[2] pair\nstring<=3 name\nint32[<=2] few\nOdd[] others\n---\n");
  }
  void write(const std::string& name, const std::string& text) const {
    const auto path = folder / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text;
  }
  Expected<ServiceCall> call(const std::string& type, const std::string& request) const {
    return link::call(type, request, {folder.path()});
  }
  test::TestFolder folder;
};

TEST(ServiceCall, SendsWhatTheTypesThatAreTheSameEverywhereSay) {
  EXPECT_EQ(call("std_srvs/srv/Trigger", "")->request(),
            rtps::encode(ros2::srv::Trigger::Request{}));
  EXPECT_EQ(call("std_srvs/srv/Empty", "{}")->request(),
            rtps::encode(ros2::srv::Trigger::Request{}));
  EXPECT_EQ(call("std_srvs/srv/SetBool", "data: true")->request(),
            rtps::encode(ros2::srv::SetBool::Request{true}));
  EXPECT_EQ(call("std_srvs/srv/SetBool", "")->request(),
            rtps::encode(ros2::srv::SetBool::Request{false}));
  const auto call_of_nav2 = call("nav2_msgs/srv/ManageLifecycleNodes", "command: 2");
  rtps::CdrReader resume(call_of_nav2->request());
  EXPECT_EQ(resume.read<std::uint8_t>(), 2);
  EXPECT_EQ(resume.left(), 0u);
  ros2::srv::SetParametersAtomically::Request gain;
  gain.parameters.resize(1);
  gain.parameters[0].name = "gain";
  gain.parameters[0].value.type = 3;
  gain.parameters[0].value.double_value = 1.5;
  EXPECT_EQ(call("rcl_interfaces/srv/SetParametersAtomically",
                 "parameters: [{name: gain, value: {type: 3, double_value: 1.5}}]")
                ->request(),
            rtps::encode(gain));
}

TEST(ServiceCall, SendsWhatTheFilesOfTheRobotSay) {
  const ControllerFiles files;
  const auto switching =
      files.call("controller_manager_msgs/srv/SwitchController",
                 "{activate_controllers: [arm, base], strictness: 2, timeout: {sec: 3}}");
  ASSERT_TRUE(switching) << switching.error();
  rtps::CdrReader sent(switching->request());
  EXPECT_EQ(sent.read<std::uint32_t>(), 2u);
  EXPECT_EQ(sent.read_string(), "arm");
  EXPECT_EQ(sent.read_string(), "base");
  EXPECT_EQ(sent.read<std::uint32_t>(), 0u) << "nothing to deactivate";
  EXPECT_EQ(sent.read<std::int32_t>(), 2);
  EXPECT_FALSE(sent.read<bool>());
  EXPECT_EQ(sent.read<std::int32_t>(), 3);
  EXPECT_EQ(sent.read<std::uint32_t>(), 0u);
  EXPECT_TRUE(sent.ok());
  EXPECT_EQ(sent.left(), 0u);
  const auto state = files.call("controller_manager_msgs/srv/SetHardwareComponentState",
                                "{name: arm, target_state: {label: inactive}}");
  ASSERT_TRUE(state) << state.error();
  rtps::CdrReader asked(state->request());
  EXPECT_EQ(asked.read_string(), "arm");
  EXPECT_EQ(asked.read<std::uint8_t>(), 0);
  EXPECT_EQ(asked.read_string(), "inactive");
}

TEST(ServiceCall, RefusesWhatDoesNotFitTheType) {
  const ControllerFiles files;
  const auto why = [&](const std::string& type, const std::string& request) {
    const auto made = files.call(type, request);
    return made ? "" : made.error();
  };
  EXPECT_THAT(why("std_srvs/srv/SetBool", "dat: true"),
              HasSubstr("std_srvs/srv/SetBool_Request has no field 'dat'; did you mean 'data'?"));
  EXPECT_THAT(why("std_srvs/srv/SetBool", "data: perhaps"),
              HasSubstr("'data': write true or false"));
  EXPECT_THAT(why("std_srvs/srv/SetBool", "true"), HasSubstr("write its fields"));
  EXPECT_THAT(why("std_srvs/srv/Trigger", "data: 1"), HasSubstr("no field 'data'; it has none"));
  EXPECT_THAT(why("std_srvs/srv/SetBool", "{data: [}"), HasSubstr("this is no YAML"));
  EXPECT_THAT(why("controller_manager_msgs/srv/SwitchController", "{strictness: 4000000000}"),
              HasSubstr("'strictness': write a whole number from -2147483648 to 2147483647"));
  EXPECT_THAT(why("controller_manager_msgs/srv/SwitchController", "{timeout: {secs: 1}}"),
              HasSubstr("'timeout': builtin_interfaces/msg/Duration has no field 'secs'"));
  EXPECT_THAT(why("arm_msgs/srv/Odd", "{pair: [1]}"), HasSubstr("'pair': it has 2 elements"));
  EXPECT_THAT(why("arm_msgs/srv/Odd", "{pair: [1, 256]}"), HasSubstr("'pair[1]': write a whole"));
  EXPECT_THAT(why("arm_msgs/srv/Odd", "{name: long}"), HasSubstr("3 characters at most"));
  EXPECT_THAT(why("arm_msgs/srv/Odd", "{few: [1, 2, 3]}"), HasSubstr("2 elements at most"));
  EXPECT_THAT(why("arm_msgs/srv/None", ""), HasSubstr("None.srv with --message-path"));
  EXPECT_THAT(why("../srv/None", ""), HasSubstr("is no type of a service"));
}

TEST(ServiceCall, BelievesAnAnswerThatRefuses) {
  const auto trigger = call("std_srvs/srv/Trigger", "");
  const auto refused = trigger->judge(rtps::encode(ros2::srv::Trigger::Response{false, "too hot"}));
  ASSERT_TRUE(refused);
  EXPECT_FALSE(refused->is_done);
  EXPECT_EQ(refused->text, "too hot");
  EXPECT_TRUE(trigger->judge(rtps::encode(ros2::srv::Trigger::Response{true, ""}))->is_done);
  EXPECT_FALSE(trigger->judge(rtps::Bytes{0, 1, 0, 0})) << "it is cut";
  const auto atomically = call("rcl_interfaces/srv/SetParametersAtomically", "");
  const auto answer = atomically->judge(
      rtps::encode(ros2::srv::SetParametersAtomically::Response{{false, "read-only"}}));
  ASSERT_TRUE(answer);
  EXPECT_FALSE(answer->is_done);
  EXPECT_EQ(answer->text, "read-only");
  EXPECT_TRUE(
      call("std_srvs/srv/Empty", "")->judge(rtps::encode(ros2::srv::Trigger::Request{}))->is_done);
  const ControllerFiles files;
  const auto switching = files.call("controller_manager_msgs/srv/SwitchController", "");
  EXPECT_FALSE(switching->judge(rtps::Bytes{0, 1, 0, 0, 0})->is_done);
  EXPECT_TRUE(switching->judge(rtps::Bytes{0, 1, 0, 0, 1})->is_done);
}

}  // namespace
}  // namespace culprit::link
