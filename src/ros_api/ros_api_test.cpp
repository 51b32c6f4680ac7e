// culprit's node as nodes of ROS 2 see it, over DDS.
#include "ros_api/ros_api.h"

#include <array>
#include <chrono>
#include <future>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "language/checker.h"
#include "plan/bayes/bayes_planner.h"
#include "ros_api/test_ros_node.h"
#include "web/hub_observer.h"
#include "web/order_routes.h"

namespace culprit::ros_api {
namespace {

using rtps::Durability;

using testing::HasSubstr;

constexpr const char* kOrderedRules = R"(
ROBOT rover
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT lidar  NODE /lidar
RULE CameraGone
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY redeploy 50 10
      ADAPTATION camera redeploy 3
)";

constexpr const char* kPause = "culprit_msgs/srv/Pause";
constexpr const char* kResume = "culprit_msgs/srv/Resume";
constexpr const char* kApprove = "culprit_msgs/srv/Approve";
constexpr const char* kSilence = "culprit_msgs/srv/Silence";
constexpr const char* kRunStrategy = "culprit_msgs/srv/RunStrategy";
constexpr const char* kStatus = "culprit_msgs/msg/Status";

enum class Orders : std::uint8_t { kNone, kTaken };

// culprit's node, a manager, and the orders that it gets through the same desk as HTTP's.
struct OrderedCulprit {
  explicit OrderedCulprit(Orders orders = Orders::kNone, Approval approval = Approval::kNone)
      : OrderedCulprit(
            orders == Orders::kNone
                ? OrderServices::Give()
                : [this](const Json& order) { return web::give_order(desk, hub, order); },
            approval) {}
  explicit OrderedCulprit(OrderServices::Give give, Approval approval = Approval::kNone) {
    Manager::Options options;
    options.governor.approval = approval;
    manager.emplace(rules, std::make_unique<BayesPlanner>(), options);
    api.emplace(RosApi::Options{"1.2.3", std::move(give), [this](const std::string& trouble) {
                                  troubles.push_back(trouble);
                                }});
    observer.begins(*manager, {}, Time());
    api->joined(node);
    api->begins(*manager, {}, Time());
    desk.open(rules, [this](Order order) { step({{now, std::move(order)}}); });
    step({{now, NodeAppeared{"/camera"}}});
  }
  ~OrderedCulprit() {
    desk.close();
    api->leaves();
  }
  void step(std::vector<Observation> observations) {
    now += std::chrono::seconds(1);
    for (Observation& each : observations) each.at = now;
    const auto commands = manager->step(now, observations);
    const Runtime::Step step{now, {}, observations, commands, manager->events()};
    observer.stepped(step);
    api->stepped(step);
  }
  Json silence(const Json& request) { return panel.call("/culprit/silence", kSilence, request); }

  const ros2::TestDomain domain;
  const RuleSet rules = *check(Source("test", kOrderedRules)).rules;
  Time now{};
  std::optional<Manager> manager;
  http::Hub hub;
  web::Metrics metrics;
  web::HubObserver observer{hub, metrics};
  live::OrderKeeper keeper{"this is a test"};
  web::OrderDesk desk{keeper.keeping()};
  std::vector<std::string> troubles;
  ros2::LiveContext context{domain.options()};
  ros2::NodeEntry node{*context, {"/", "culprit"}};
  std::optional<RosApi> api;
  TestRosNode panel{domain.options()};
};

TEST(RosApi, ALateSubscriberGetsTheNewestStatus) {
  OrderedCulprit culprit;
  culprit.step({{culprit.now, NodeAppeared{"/lidar"}}});
  auto& statuses = culprit.panel.hear("/culprit/status", kStatus, Durability::kTransientLocal);
  ASSERT_TRUE(statuses.wait_for_count(1));
  EXPECT_EQ(statuses.all()[0]["summary"], "all is well");
  EXPECT_EQ(statuses.all()[0]["components"][1]["is_present"], true) << "the newest, and only that";
  EXPECT_THAT(culprit.troubles, testing::IsEmpty());
}

TEST(RosApi, IsOfferedAsNodesOfRos2AskForIt) {
  OrderedCulprit culprit(Orders::kTaken);
  const auto is_offered = [&](EndpointKind kind, const std::string& name, const std::string& type,
                              Durability durability) {
    const bool is_service = kind == EndpointKind::kServer;
    const std::string hash = is_service ? culprit.panel.types.service(type).request.hash
                                        : culprit.panel.types.message(type).hash;
    return culprit.panel.context.changes().wait_for_one([&](const ros2::GraphChange& change) {
      const auto* joined = std::get_if<ros2::EndpointJoined>(&change);
      if (joined == nullptr || joined->node != "/culprit") return false;
      const ros2::GraphEndpoint& each = joined->endpoint;
      return each.kind == kind && each.name == name && each.type == type &&
             each.type_hash == hash && each.qos.durability == durability &&
             each.qos.reliability == rtps::Reliability::kReliable &&
             (!is_service || each.service_hash == culprit.panel.types.service(type).hash);
    });
  };
  EXPECT_TRUE(is_offered(EndpointKind::kPublisher, "/culprit/status", kStatus,
                         Durability::kTransientLocal));
  EXPECT_TRUE(is_offered(EndpointKind::kPublisher, "/culprit/incidents",
                         "culprit_msgs/msg/Incident", Durability::kVolatile));
  EXPECT_TRUE(is_offered(EndpointKind::kPublisher, "/culprit/decisions",
                         "culprit_msgs/msg/Decision", Durability::kVolatile));
  for (const OrderService& each : order_services())
    EXPECT_TRUE(is_offered(EndpointKind::kServer, "/culprit/" + std::string(each.name),
                           std::string(each.type), Durability::kVolatile))
        << each.name;
}

TEST(RosApi, TellsIncidentsAndDecisions) {
  OrderedCulprit culprit;
  auto& incidents = culprit.panel.hear("/culprit/incidents", "culprit_msgs/msg/Incident");
  auto& decisions = culprit.panel.hear("/culprit/decisions", "culprit_msgs/msg/Decision");
  ASSERT_TRUE(culprit.panel.is_known_to("/culprit"))
      << "or it would miss messages that are sent once";
  culprit.step({{culprit.now, ProcessSeen{ComponentId(0), ProcessState::kRunning, 12, ""}}});
  culprit.step({{culprit.now, ProcessSeen{ComponentId(0), ProcessState::kGone, 12,
                                          "killed by signal 9", Cause::kFault}}});
  ASSERT_TRUE(incidents.wait_for_count(1));
  EXPECT_EQ(incidents.all()[0]["rule"], "CameraGone");
  EXPECT_EQ(incidents.all()[0]["headline"], "camera is down");
  ASSERT_TRUE(decisions.wait_for_count(1));
  EXPECT_EQ(decisions.all()[0]["strategy"], "redeploy");
}

TEST(RosApi, TakesNoOrdersUnlessItIsToldTo) {
  OrderedCulprit culprit(Orders::kNone);
  ASSERT_TRUE(culprit.panel.context.sees_endpoint("/culprit", EndpointKind::kServer,
                                                  "/culprit/get_type_description"))
      << "which is offered last";
  for (const OrderService& each : order_services())
    EXPECT_EQ(culprit.panel.call("/culprit/" + std::string(each.name), std::string(each.type), {},
                                 std::chrono::milliseconds(300)),
              nullptr)
        << each.name;
  EXPECT_FALSE(culprit.manager->governor().is_paused());
}

TEST(RosApi, ObeysAPauseAndItsEnd) {
  OrderedCulprit culprit(Orders::kTaken);
  const Json paused = culprit.panel.call("/culprit/pause", kPause,
                                         {{"author", "ann"}, {"reason", "people on the floor"}});
  EXPECT_EQ(paused["success"], true) << paused;
  EXPECT_THAT(paused["message"].get<std::string>(), HasSubstr("not kept: this is a test"))
      << "the manager's answer, and whether the order outlives culprit";
  EXPECT_TRUE(culprit.manager->governor().is_paused());
  const auto orders = culprit.keeper.orders();
  ASSERT_TRUE(orders.pause);
  EXPECT_EQ(orders.pause->author, "ann (over DDS)");
  EXPECT_EQ(orders.pause->reason, "people on the floor");
  const Json resumed = culprit.panel.call("/culprit/resume", kResume, {{"author", "ann"}});
  EXPECT_EQ(resumed["success"], true) << resumed;
  EXPECT_FALSE(culprit.manager->governor().is_paused());
}

TEST(RosApi, ObeysASilenceAndItsEnd) {
  OrderedCulprit culprit(Orders::kTaken);
  const auto& silences = culprit.manager->governor().silences();
  EXPECT_EQ(culprit.silence({{"author", "ann"},
                             {"component", "camera"},
                             {"duration", {{"sec", 90}, {"nanosec", 500'000'000}}}})["success"],
            true);
  ASSERT_EQ(silences.size(), 1u);
  EXPECT_EQ(silences[0].what, Silenceable(ComponentId(0)));
  EXPECT_EQ(silences[0].until - culprit.now, std::chrono::milliseconds(90'500));
  EXPECT_EQ(
      culprit.silence({{"author", "ann"}, {"component", "camera"}, {"lift", true}})["success"],
      true);
  EXPECT_TRUE(silences.empty());
  EXPECT_EQ(culprit.silence({{"author", "ann"}, {"rule", "CameraGone"}})["success"], true);
  ASSERT_EQ(silences.size(), 1u);
  EXPECT_EQ(silences[0].until, kNever) << "zero is until it is lifted";
}

TEST(RosApi, ApprovesAndRefusesWhatIsAsked) {
  for (const bool refuse : {false, true}) {
    OrderedCulprit culprit(Orders::kTaken, Approval::kEach);
    const Json request{
        {"author", "ann"}, {"rule", "CameraGone"}, {"strategy", "redeploy"}, {"refuse", refuse}};
    const Json early = culprit.panel.call("/culprit/approve", kApprove, request);
    EXPECT_EQ(early["success"], false) << early;
    culprit.step({{culprit.now, ProcessSeen{ComponentId(0), ProcessState::kRunning, 12, ""}}});
    culprit.step(
        {{culprit.now, ProcessSeen{ComponentId(0), ProcessState::kGone, 12, "", Cause::kFault}}});
    ASSERT_EQ(culprit.manager->governor().asked().size(), 1u);
    const Json answer = culprit.panel.call("/culprit/approve", kApprove, request);
    EXPECT_EQ(answer["success"], true) << answer;
    EXPECT_TRUE(culprit.manager->governor().asked().empty());
    EXPECT_EQ(culprit.manager->knowledge().states[RuleId(0)].attempt.has_value(), !refuse);
  }
}

TEST(RosApi, RunsAStrategy) {
  OrderedCulprit culprit(Orders::kTaken);
  culprit.step({{culprit.now, ProcessSeen{ComponentId(0), ProcessState::kRunning, 12, ""}}});
  const Json answer =
      culprit.panel.call("/culprit/run_strategy", kRunStrategy,
                         {{"author", "ann"}, {"rule", "CameraGone"}, {"strategy", "redeploy"}});
  EXPECT_EQ(answer["success"], true) << answer;
  EXPECT_TRUE(culprit.manager->knowledge().states[RuleId(0)].attempt);
}

TEST(RosApi, TheManagersRefusalIsTheAnswer) {
  OrderedCulprit culprit(Orders::kTaken);
  ASSERT_EQ(culprit.panel.call("/culprit/pause", kPause, {{"author", "ann"}})["success"], true);
  const Json answer =
      culprit.panel.call("/culprit/run_strategy", kRunStrategy,
                         {{"author", "ann"}, {"rule", "CameraGone"}, {"strategy", "redeploy"}});
  EXPECT_EQ(answer["success"], false);
  EXPECT_THAT(answer["message"].get<std::string>(), HasSubstr("paused"));
  EXPECT_FALSE(culprit.manager->knowledge().states[RuleId(0)].attempt);
}

TEST(RosApi, AMistypedNameHasASuggestionAndNothingHappens) {
  OrderedCulprit culprit(Orders::kTaken);
  const auto message_of = [](const Json& answer) {
    EXPECT_EQ(answer["success"], false) << answer;
    return answer["message"].get<std::string>();
  };
  EXPECT_THAT(message_of(culprit.silence({{"author", "ann"}, {"component", "camra"}})),
              HasSubstr("there is no component 'camra'; did you mean 'camera'?"));
  EXPECT_THAT(message_of(culprit.silence({{"author", "ann"}, {"rule", "CameraGon"}})),
              HasSubstr("did you mean 'CameraGone'?"));
  EXPECT_THAT(message_of(culprit.silence(
                  {{"author", "ann"}, {"component", "camra"}, {"rule", "CameraGone"}})),
              HasSubstr("name a component or a rule, not both"));
  EXPECT_THAT(message_of(culprit.silence({{"author", "ann"}})),
              HasSubstr("name a 'component' or a 'rule' of the rules"));
  EXPECT_THAT(message_of(culprit.silence(
                  {{"author", "ann"}, {"component", "camera"}, {"duration", {{"sec", -5}}}})),
              HasSubstr("'seconds' has to be a number above 0"));
  EXPECT_THAT(message_of(culprit.panel.call(
                  "/culprit/run_strategy", kRunStrategy,
                  {{"author", "ann"}, {"rule", "CameraGone"}, {"strategy", "redeplyo"}})),
              HasSubstr("there is no strategy of CameraGone 'redeplyo'; did you mean 'redeploy'?"));
  EXPECT_THAT(message_of(culprit.panel.call("/culprit/approve", kApprove, {{"author", "ann"}})),
              HasSubstr("name a 'rule' and one of its strategies"));
  EXPECT_THAT(message_of(culprit.panel.call("/culprit/pause", kPause, {})),
              HasSubstr("name the author"));
  EXPECT_THAT(message_of(culprit.panel.call("/culprit/pause", kPause,
                                            {{"author", std::string(1000, 'a')}})),
              HasSubstr("short"));
  EXPECT_FALSE(culprit.manager->governor().is_paused());
  EXPECT_TRUE(culprit.manager->governor().silences().empty());
}

TEST(RosApi, AForgedRequestIsAnsweredWithAnErrorAndDoesNothing) {
  OrderedCulprit culprit(Orders::kTaken);
  rtps::CdrWriter no_text;
  no_text.write_string("ann\xff");
  no_text.write_string("");
  rtps::CdrWriter too_long;  // its length field is too large
  too_long.write(std::uint32_t{0xFFFFFFFF});
  for (const rtps::Bytes& request : {rtps::Bytes{0, 1, 0, 0}, rtps::Bytes{0, 9, 0, 0, 1, 2, 3, 4},
                                     no_text.take(), too_long.take()}) {
    const Json answer = culprit.panel.call_with("/culprit/pause", kPause, request);
    ASSERT_TRUE(answer.is_object()) << answer;
    EXPECT_EQ(answer["success"], false);
    EXPECT_FALSE(answer["message"].get<std::string>().empty());
  }
  EXPECT_FALSE(culprit.manager->governor().is_paused());
  EXPECT_EQ(culprit.panel.call("/culprit/pause", kPause, {{"author", "ann"}})["success"], true)
      << "and the next request is answered";
}

TEST(RosApi, APauseDoesNotWaitBehindAnotherOrder) {
  std::promise<void> disk;
  const auto disk_answers = disk.get_future().share();
  rtps::EventLog<std::string> given;
  {
    OrderedCulprit culprit([&](const Json& order) {
      given.add(order["order"]);
      if (order["order"] != "pause") disk_answers.wait();
      return http::Answer{200, {{"order", "done"}}};
    });
    std::thread slow([&] {
      TestRosNode other(culprit.domain.options());
      EXPECT_EQ(other.call("/culprit/resume", kResume, {{"author", "bob"}})["message"], "done");
    });
    EXPECT_TRUE(given.wait_for_count(1));
    EXPECT_EQ(culprit.panel.call("/culprit/pause", kPause, {{"author", "ann"}})["message"], "done");
    disk.set_value();
    slow.join();
  }
  EXPECT_THAT(given.all(), testing::ElementsAre("resume", "pause"));
}

TEST(RosApi, MoreOrdersThanItCanKeepAreRefusedAtOnce) {
  std::promise<void> disk;
  const auto disk_answers = disk.get_future().share();
  rtps::EventLog<std::string> given;
  OrderedCulprit culprit([&](const Json&) {
    given.add("");
    disk_answers.wait();
    return http::Answer{200, {{"order", "done"}}};
  });
  rtps::EventLog<std::string> answers;
  TestRosNode many(culprit.domain.options());
  std::vector<std::unique_ptr<ros2::ServiceClient>> clients;
  const auto& type = many.types.service(kPause);
  const std::size_t count = OrderServices::kMostWaiting + 5;
  for (std::size_t i = 0; i < count; ++i) {
    clients.push_back(many.client_of("/culprit/pause", kPause));
    clients.back()->call(*encode({{"author", "ann"}}, type.request), ros2::Repeat::kNever,
                         rtps::kPatience, [&](const ros2::CallResult& result) {
                           const auto answer = decode(result.reply, type.response);
                           answers.add(answer ? (*answer)["message"].get<std::string>() : "none");
                         });
  }
  EXPECT_TRUE(answers.wait_for_one([](const std::string& each) {
    return each.find("too many orders wait") != std::string::npos;
  }));
  disk.set_value();
  EXPECT_TRUE(answers.wait_for_count(count)) << "every request gets an answer";
}

constexpr const char* kAction = "/culprit/wait_for_recovery/_action/";
constexpr const char* kSendGoal = "culprit_msgs/action/WaitForRecovery_SendGoal";
constexpr const char* kGetResult = "culprit_msgs/action/WaitForRecovery_GetResult";
constexpr const char* kCancelGoal = "action_msgs/srv/CancelGoal";

Json goal_id(int number) {
  std::array<std::uint8_t, 16> uuid{};
  uuid[3] = static_cast<std::uint8_t>(number);
  return {{"uuid", uuid}};
}

Json wait_for(TestRosNode& node, int number, const std::string& component,
              const Json& timeout = {{"sec", 0}, {"nanosec", 0}}) {
  return node.call(
      kAction + std::string("send_goal"), kSendGoal,
      {{"goal_id", goal_id(number)}, {"goal", {{"component", component}, {"timeout", timeout}}}});
}

Json result_of(TestRosNode& node, int number) {
  return node.call(kAction + std::string("get_result"), kGetResult, {{"goal_id", goal_id(number)}});
}

void lose_camera(OrderedCulprit& culprit) {
  culprit.step({{culprit.now, ProcessSeen{ComponentId(0), ProcessState::kRunning, 12, ""}}});
  culprit.step({{culprit.now, ProcessSeen{ComponentId(0), ProcessState::kGone, 12,
                                          "killed by signal 9", Cause::kFault}}});
}

TEST(RosApi, AWaitForARecoveryIsAnsweredWhenItComes) {
  OrderedCulprit culprit;
  culprit.step({{culprit.now, NodeAppeared{"/lidar"}}});
  lose_camera(culprit);
  auto& feedback = culprit.panel.hear(kAction + std::string("feedback"),
                                      "culprit_msgs/action/WaitForRecovery_FeedbackMessage");
  auto& states = culprit.panel.hear(kAction + std::string("status"),
                                    "action_msgs/msg/GoalStatusArray", Durability::kTransientLocal);
  ASSERT_TRUE(culprit.panel.is_known_to("/culprit"));
  const auto asked = std::chrono::steady_clock::now();
  EXPECT_EQ(wait_for(culprit.panel, 1, "camera")["accepted"], true);
  ASSERT_TRUE(feedback.wait_for_count(1));
  EXPECT_GE(std::chrono::steady_clock::now() - asked, std::chrono::milliseconds(100))
      << "a client of rclcpp drops feedback that is there together with the answer";
  EXPECT_EQ(wait_for(culprit.panel, 1, "camera")["accepted"], false) << "the id is taken";
  EXPECT_EQ(feedback.all()[0]["goal_id"], goal_id(1));
  EXPECT_EQ(feedback.all()[0]["feedback"]["ill"], Json::array({"camera"}));
  EXPECT_EQ(wait_for(culprit.panel, 2, "lidar")["accepted"], true);
  EXPECT_EQ(result_of(culprit.panel, 2)["result"]["message"], "lidar is well");

  std::promise<Json> result;
  std::thread waits([&] {
    TestRosNode other(culprit.domain.options());
    result.set_value(result_of(other, 1));
  });
  auto answer = result.get_future();
  culprit.step({{culprit.now, NodeVanished{"/camera"}}});
  culprit.step({{culprit.now, NodeAppeared{"/camera"}},
                {culprit.now, ProcessSeen{ComponentId(0), ProcessState::kRunning, 13, ""}}});
  while (answer.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready)
    culprit.step({});  // until the strategy has its verdict
  waits.join();
  const Json said = answer.get();
  ASSERT_TRUE(said.is_object()) << said;
  EXPECT_EQ(said["status"], 4) << "succeeded";
  EXPECT_EQ(said["result"]["recovered"], true);
  EXPECT_TRUE(states.wait_for_one([](const Json& each) {
    const Json& all = each["status_list"];
    return all.size() == 2 && all[0]["status"] == 4 && all[0]["goal_info"]["goal_id"] == goal_id(1);
  })) << "and the topic shows it";
}

TEST(RosApi, AWaitForARecoveryMayBeCanceledOrTimeOut) {
  OrderedCulprit culprit;
  lose_camera(culprit);
  ASSERT_EQ(wait_for(culprit.panel, 1, "camera")["accepted"], true);
  ASSERT_EQ(wait_for(culprit.panel, 2, "camera", {{"sec", 0}, {"nanosec", 1}})["accepted"], true);
  EXPECT_EQ(result_of(culprit.panel, 2)["status"], 6) << "aborted";
  const auto cancel = [&](int number) {
    return culprit.panel.call(kAction + std::string("cancel_goal"), kCancelGoal,
                              {{"goal_info", {{"goal_id", goal_id(number)}}}});
  };
  EXPECT_EQ(cancel(3)["return_code"], 2) << "there is no such goal";
  EXPECT_EQ(cancel(2)["return_code"], 3) << "it has ended";
  const Json canceled = cancel(1);
  EXPECT_EQ(canceled["return_code"], 0);
  EXPECT_EQ(canceled["goals_canceling"][0]["goal_id"], goal_id(1));
  EXPECT_EQ(result_of(culprit.panel, 1)["status"], 5) << "canceled";
  EXPECT_EQ(result_of(culprit.panel, 3)["status"], 0) << "unknown";
}

TEST(RosApi, GoesOnAtTheNodeOfTheNextSession) {
  OrderedCulprit culprit(Orders::kTaken);
  culprit.api->leaves();
  ros2::LiveContext context(culprit.domain.options());
  ros2::NodeEntry next(*context, {"/", "culprit_2"});
  culprit.api->joined(next);
  culprit.api->begins(*culprit.manager, {}, Time());
  culprit.step({});
  auto& statuses = culprit.panel.hear("/culprit_2/status", kStatus, Durability::kTransientLocal);
  EXPECT_TRUE(statuses.wait_for_count(1));
  EXPECT_EQ(culprit.panel.call("/culprit_2/pause", kPause, {{"author", "ann"}})["success"], true);
  culprit.api->leaves();
}

}  // namespace
}  // namespace culprit::ros_api
