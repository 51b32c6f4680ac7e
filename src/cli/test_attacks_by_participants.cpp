// Attackers with a middleware of their own: nodes that publish, claim and answer what they should not.
#include <atomic>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "base/lifecycle_state.h"
#include "base/value.h"
#include "cli/test_attacks.h"
#include "cli/test_repeatedly.h"
#include "ros2/live_test.h"
#include "ros2/messages.h"
#include "ros2/options.h"
#include "ros2/parameter_store.h"
#include "ros2/publisher.h"
#include "ros2/service_server.h"
#include "ros2/services.h"
#include "ros2/test_forger.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;

constexpr const char* kCamera = "/managed_subsystem/camera";
constexpr const char* kPictures = "/managed_subsystem/rgb_camera";

using Lies = std::vector<rtps::Bytes>;

ros2::ParticipantOptions own_options() { return *ros2::options_from_environment(); }

// A node that publishes the same again and again.
class Liar {
 public:
  Liar(const std::string& topic, std::string_view type, Lies lies,
       ros2::NodeName name = {"/", "liar"})
      : context_(own_options()),
        node_(*context_, std::move(name)),
        publisher_(std::move(
            *ros2::RawPublisher::create(node_, topic, std::string(type), rtps::qos::kDefault))),
        lies_(std::move(lies)),
        talk_(20ms, [this] { publisher_->publish(lies_[next_++ % lies_.size()]); }) {}

 private:
  ros2::LiveContext context_;
  ros2::NodeEntry node_;
  std::unique_ptr<ros2::RawPublisher> publisher_;
  const Lies lies_;
  std::size_t next_ = 0;
  Repeatedly talk_;  // ends first
};

Ongoing forged_diagnostics(const Target&) {
  ros2::msg::DiagnosticArray array;
  array.status = {{2, "camera_heartbeat", "broken", "camera", {}}};
  return std::make_shared<Liar>("/diagnostics", ros2::msg::DiagnosticArray::kType,
                                Lies{rtps::encode(array)});
}
// Names, keys and values of other statuses, with what steers a terminal.
Ongoing flood_of_statuses(const Target&) {
  Lies all;
  for (int i = 0; i < 500; ++i) {
    ros2::msg::DiagnosticArray array;
    const std::string name = "\x1b[2J\n" + std::to_string(i) + std::string(200, 'x');
    array.status = {{2, name, name, name, {{name, name}}}};
    all.push_back(rtps::encode(array));
  }
  return std::make_shared<Liar>("/diagnostics", ros2::msg::DiagnosticArray::kType, std::move(all));
}
Ongoing forged_transitions(const Target&) {
  Lies all;
  for (const auto state : {LifecycleState::kInactive, LifecycleState::kFinalized}) {
    ros2::msg::TransitionEvent event;
    event.goal_state.id = static_cast<std::uint8_t>(state);
    all.push_back(rtps::encode(event));
  }
  return std::make_shared<Liar>(std::string(kCamera) + "/transition_event",
                                ros2::msg::TransitionEvent::kType, std::move(all));
}
Ongoing forged_parameter_events(const Target&) {
  ros2::msg::ParameterEvent event;
  event.node = kCamera;
  event.changed_parameters = {{"image_degradation", ros2::to_parameter_value(Value(9.0))}};
  return std::make_shared<Liar>("/parameter_events", ros2::msg::ParameterEvent::kType,
                                Lies{rtps::encode(event)});
}
Ongoing forged_clock(const Target&) {
  Lies all;
  for (const std::int32_t second : {0, 2'000'000'000, 1, 5})
    all.push_back(rtps::encode(ros2::msg::Time{second, 0}));
  return std::make_shared<Liar>("/clock", "rosgraph_msgs/msg/Clock", std::move(all));
}
// The dead camera's topic goes on.
Ongoing forged_pictures(const Target&) {
  return std::make_shared<Liar>(kPictures, "sensor_msgs/msg/Image", Lies{rtps::Bytes(100, 0)});
}
Ongoing pictures_of_another_type(const Target&) {
  return std::make_shared<Liar>(kPictures, "std_msgs/msg/String", Lies{rtps::Bytes(12, 0)});
}
Ongoing garbage_as_a_lease(const Target&) {
  return std::make_shared<Liar>("/_culprit_lease", "culprit/msg/Lease",
                                Lies{rtps::Bytes(64, 0xff), rtps::Bytes(5, 0)});
}
Ongoing garbage_as_discovery_info(const Target&) {
  rtps::Bytes many(64, 0xff);
  many[0] = 0, many[1] = 1;
  return std::make_shared<Liar>("/ros_discovery_info", "rmw_dds_common/msg/ParticipantEntitiesInfo",
                                Lies{many, rtps::Bytes(5, 0)});
}
Ongoing a_namesake(const Target&) {
  return std::make_shared<Liar>(kPictures, "sensor_msgs/msg/Image", Lies{rtps::Bytes(100, 0)},
                                ros2::NodeName{"/managed_subsystem", "camera"});
}

// Answers each question to the camera.
class FalseAnswers {
 public:
  FalseAnswers()
      : context_(own_options()),
        node_(*context_, {"/", "liar"}),
        states_(std::move(*ros2::ServiceServer::create(
            node_, {std::string(kCamera) + "/get_state", std::string(ros2::srv::GetState::kType)},
            rtps::qos::kServices,
            [this](rtps::ByteView) {
              ++asked_;
              ros2::srv::GetState::Response response;
              response.current_state.id = static_cast<std::uint8_t>(LifecycleState::kFinalized);
              return rtps::encode(response);
            }))),
        changes_(std::move(*ros2::ServiceServer::create(
            node_,
            {std::string(kCamera) + "/change_state", std::string(ros2::srv::ChangeState::kType)},
            rtps::qos::kServices,
            [](rtps::ByteView) { return rtps::encode(ros2::srv::ChangeState::Response{true}); }))) {
  }

  // culprit asks each server of the service.
  ~FalseAnswers() { EXPECT_GT(asked_, 0); }
  FalseAnswers(const FalseAnswers&) = delete;
  FalseAnswers& operator=(const FalseAnswers&) = delete;

 private:
  std::atomic<int> asked_ = 0;
  ros2::LiveContext context_;
  ros2::NodeEntry node_;
  std::unique_ptr<ros2::ServiceServer> states_;
  std::unique_ptr<ros2::ServiceServer> changes_;
};
Ongoing false_answers(const Target&) { return std::make_shared<FalseAnswers>(); }

// A participant that says of itself what it likes.
Ongoing claims(std::vector<ros2::NodeEntities> nodes) {
  auto forger = std::make_shared<ros2::Forger>(own_options(), ros2::free_port());
  forger->says_that_it_holds(std::move(nodes));
  return forger;
}
Ongoing claims_the_camera(const Target&) {
  return claims({{"/managed_subsystem", "camera", {}, {}}});
}
Ongoing claims_names_that_steer_terminals(const Target&) {
  return claims({{"/", "\x1b[2J\x1b]0;owned\a", {}, {}}, {"/\n\r", "line\n\rline", {}, {}}});
}
Ongoing claims_endless_names(const Target&) {
  return claims({{"/" + std::string(30'000, 'a'), std::string(30'000, 'b'), {}, {}}});
}
Ongoing claims_two_thousand_nodes(const Target&) {
  std::vector<ros2::NodeEntities> all;
  for (int i = 0; i < 2000; ++i) all.push_back({"/", "node_" + std::to_string(i), {}, {}});
  return claims(std::move(all));
}
// The camera's writers, as its own.
Ongoing claims_the_writers(const Target& target) {
  ros2::NodeEntities thief{"/", "thief", {}, {}};
  for (const auto& each : target.eavesdropper->of(target.camera).endpoints)
    (each.guid.is_reader() ? thief.readers : thief.writers).push_back(each.guid);
  return claims({thief});
}

Ongoing participants_come_and_go(const Target&) {
  return std::make_shared<Repeatedly>(100ms,
                                      [] { const ros2::LiveContext context(own_options()); });
}
class ComingAndGoing {
 public:
  ComingAndGoing()
      : context_(own_options()), node_(*context_, {"/", "flapping"}), flap_(20ms, [this] {
          (void)ros2::RawPublisher::create(node_, kPictures, "sensor_msgs/msg/Image",
                                           rtps::qos::kDefault);
        }) {}

 private:
  ros2::LiveContext context_;
  ros2::NodeEntry node_;
  Repeatedly flap_;  // ends first
};
Ongoing publishers_come_and_go(const Target&) { return std::make_shared<ComingAndGoing>(); }

}  // namespace

std::vector<Attack> attacks_by_participants() {
  const auto there = Place::kElsewhere;
  return {
      {"forged_diagnostics", forged_diagnostics, there},
      {"flood_of_statuses", flood_of_statuses, there},
      {"forged_transitions", forged_transitions, there, true},
      {"forged_parameter_events", forged_parameter_events, there},
      {"forged_clock", forged_clock, there},
      {"forged_pictures", forged_pictures, there},
      {"pictures_of_another_type", pictures_of_another_type},
      {"garbage_as_a_lease", garbage_as_a_lease},
      {"garbage_as_discovery_info", garbage_as_discovery_info},
      {"a_namesake", a_namesake, there},
      {"false_answers", false_answers, Place::kHere, true},
      {"false_answers_from_elsewhere", false_answers, there},
      {"claims_the_camera", claims_the_camera, Place::kHere, true,
       "claims the name /managed_subsystem/camera"},
      {"claims_names_that_steer_terminals", claims_names_that_steer_terminals},
      {"claims_endless_names", claims_endless_names},
      {"claims_two_thousand_nodes", claims_two_thousand_nodes},
      {"claims_the_writers", claims_the_writers},
      {"participants_come_and_go", participants_come_and_go},
      {"publishers_come_and_go", publishers_come_and_go, there},
  };
}

}  // namespace culprit::cli
