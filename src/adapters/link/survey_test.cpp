#include "link/survey.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "ros2/lifecycle_node.h"
#include "ros2/live_test.h"
#include "ros2/navigation_messages.h"
#include "ros2/timer.h"

namespace culprit::link {
namespace {

using namespace std::chrono_literals;

// A managed node with a parameter, a topic and a diagnostic.
struct SurveyedRobot {
  explicit SurveyedRobot(const ros2::TestDomain& domain) : context(domain.options()) {
    context.run([&] {
      managed = std::move(*ros2::LifecycleNode::create(*context, {"/", "robot"}, {}));
      EXPECT_TRUE(managed->node().parameters().declare("gain", Value(1.5)));
      visibility.emplace(publisher<ros2::msg::Float64>("/visibility"));
      diagnostics.emplace(publisher<ros2::msg::DiagnosticArray>("/diagnostics"));
      ticking = std::make_unique<ros2::Timer>(context->executor(), 20ms, [this] { tick(); });
    });
  }
  ~SurveyedRobot() {
    context.run([&] { ticking.reset(); });
  }
  template <class Message>
  ros2::Publisher<Message> publisher(const std::string& topic) {
    return std::move(*managed->node().create_publisher<Message>(topic));
  }
  void tick() {
    visibility->publish({2.5});
    ros2::msg::DiagnosticArray array;
    array.status = {{1, "motor", "", "m1", {{"temperature", "60.5"}}}};
    diagnostics->publish(array);
  }

  ros2::LiveContext context;
  std::unique_ptr<ros2::LifecycleNode> managed;
  std::optional<ros2::Publisher<ros2::msg::Float64>> visibility;
  std::optional<ros2::Publisher<ros2::msg::DiagnosticArray>> diagnostics;
  std::unique_ptr<ros2::Timer> ticking;
};

std::unique_ptr<Survey> survey_of(const ros2::TestDomain& domain) {
  Survey::Options options;
  options.participant = domain.options();
  auto survey = Survey::open(std::move(options));
  if (!survey) throw std::runtime_error(survey.error());
  return std::move(*survey);
}

// Looks again and again until the inventory is as wanted.
template <class Predicate>
bool shows(const Survey& survey, Predicate wanted) {
  const auto end = std::chrono::steady_clock::now() + rtps::kPatience;
  while (!wanted(survey.inventory())) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(5ms);
  }
  return true;
}

TEST(Survey, SeesTheGraphAndTheDiagnosticsButNotItself) {
  const ros2::TestDomain domain;
  const SurveyedRobot robot(domain);
  const auto survey = survey_of(domain);
  EXPECT_TRUE(shows(*survey, [](const LiveInventory& seen) {
    const auto topic = seen.topics.find("/visibility");
    return seen.nodes.contains("/robot") && seen.services.contains("/robot/change_state") &&
           topic != seen.topics.end() && topic->second.is_published() &&
           topic->second.type == "std_msgs/msg/Float64" && seen.diagnostics.size() == 1;
  }));
  const LiveInventory seen = survey->inventory();
  EXPECT_EQ(seen.nodes.size(), 1u);
  EXPECT_FALSE(seen.nodes.at("/robot").parameters) << "they were not requested";
  EXPECT_TRUE(seen.topics.at("/visibility").fields.empty());
  EXPECT_EQ(seen.diagnostics[0].values.at("temperature"), "60.5");
  const StatusCourse course = survey->statuses().at({"motor", "m1"});
  EXPECT_EQ(course.worst, 1);
  EXPECT_EQ(course.keys.at("temperature").numbers, course.messages);
  EXPECT_EQ(course.keys.at("temperature").most, 60.5);
}

TEST(Survey, ReadsWhatIsAskedForAndFollowsIt) {
  const ros2::TestDomain domain;
  SurveyedRobot robot(domain);
  const auto survey = survey_of(domain);
  survey->ask_for({{"robot"}, {{"/visibility", {"data", "no.such.field"}}}});
  const auto has = [](const LiveInventory& seen, double gain, const char* state) {
    const auto node = seen.nodes.find("/robot");
    return node != seen.nodes.end() && node->second.lifecycle == state &&
           seen.value_of_parameter("/robot", "gain") == Value(gain);
  };
  EXPECT_TRUE(shows(*survey, [&](const auto& seen) { return has(seen, 1.5, "unconfigured"); }));
  EXPECT_TRUE(shows(*survey, [](const LiveInventory& seen) {
    const auto topic = seen.topics.find("/visibility");
    return topic != seen.topics.end() && topic->second.rate && *topic->second.rate > 0 &&
           topic->second.fields == std::map<std::string, Value>{{"data", Value(2.5)}};
  }));
  EXPECT_EQ(survey->fields().at("/visibility").at("data").least, 2.5);

  robot.context.run([&] {
    const ros2::msg::Parameter gain{"gain", ros2::to_parameter_value(Value(2.5))};
    EXPECT_TRUE(robot.managed->node().parameters().set({&gain, 1}).successful);
  });
  EXPECT_TRUE(shows(*survey, [&](const auto& seen) { return has(seen, 2.5, "unconfigured"); }));

  survey->ask_for({});
  EXPECT_TRUE(shows(*survey, [](const LiveInventory& seen) {
    return !seen.nodes.at("/robot").parameters && !seen.topics.at("/visibility").rate;
  })) << "after the request ends, it is no longer read";
}

TEST(Survey, MeasuresTheRhythmOfEachPublisherOfATopic) {
  const ros2::TestDomain domain;
  const SurveyedRobot robot(domain);
  ros2::LiveContext other(domain.options());
  std::unique_ptr<ros2::Node> node;
  std::optional<ros2::Publisher<ros2::msg::Float64>> also;
  other.run([&] {
    node = std::move(*ros2::Node::create(*other, {"/", "other"}));
    also.emplace(std::move(*node->create_publisher<ros2::msg::Float64>("/visibility")));
  });
  const auto survey = survey_of(domain);
  survey->ask_for({.nodes = {}, .fields_of_topics = {{"/visibility", {}}}});
  EXPECT_TRUE(shows(*survey, [&](const LiveInventory& seen) {
    const auto all = survey->rhythms_of_publishers();
    const auto found = all.find("/visibility");
    return seen.nodes.contains("/other") && found != all.end() &&
           found->second.contains("/robot") && found->second.at("/robot").messages > 3 &&
           !found->second.contains("/other");
  }));
  other.run([&] {
    also.reset();
    node.reset();
  });
}

// A robot that drives: its map is published once, before anybody looks.
struct DrivingRobot {
  explicit DrivingRobot(const ros2::TestDomain& domain) : context(domain.options()) {
    context.run([&] {
      node = std::move(*ros2::Node::create(*context, {"/", "robot"}));
      constexpr rtps::Qos kLatched{.durability = rtps::Durability::kTransientLocal, .depth = 1};
      maps.emplace(publisher<ros2::msg::OccupancyGrid>("/map", kLatched));
      costs.emplace(publisher<ros2::msg::OccupancyGrid>("/costmap", rtps::qos::kDefault));
      moving.emplace(publisher<ros2::msg::TFMessage>("/tf", rtps::qos::kDefault));
      fixed.emplace(publisher<ros2::msg::TFMessage>("/tf_static", kLatched));
      plans.emplace(publisher<ros2::msg::Path>("/plan", rtps::qos::kDefault));
      scans.emplace(publisher<ros2::msg::LaserScan>("/scan", rtps::qos::kSensorData));
      maps->publish(map("map", {0, 100}));
      fixed->publish({{edge("base_link", "laser", 0.5)}});
      ticking = std::make_unique<ros2::Timer>(context->executor(), 20ms, [this] { tick(); });
    });
  }
  ~DrivingRobot() {
    context.run([&] {
      ticking.reset();
      maps.reset(), costs.reset(), moving.reset(), fixed.reset(), plans.reset(), scans.reset();
      node.reset();
    });
  }
  template <class Message>
  ros2::Publisher<Message> publisher(const std::string& topic, const rtps::Qos& qos) {
    return std::move(*node->create_publisher<Message>(topic, qos));
  }
  static ros2::msg::OccupancyGrid map(const char* frame, std::vector<std::int8_t> cells) {
    const auto width = static_cast<std::uint32_t>(cells.size());
    return {{{}, frame}, {{}, 1, width, 1, {}}, std::move(cells)};
  }
  static ros2::msg::TransformStamped edge(const char* parent, const char* child, double x) {
    return {{{}, parent}, child, {{x, 0, 0}, {}}};
  }
  void tick() {
    moving->publish({{edge("map", "odom", 1), edge("odom", "base_link", 2)}});
    costs->publish(map("odom", {50, 50, 50}));
    plans->publish({{{}, "map"}, {{{}, {{3, 0, 0}, {}}}, {{}, {{4, 0, 0}, {}}}}});
    scans->publish({{{}, "laser"}, 0, 0, 0, 0, 0, 0, 10, {2}, {}});
  }

  ros2::LiveContext context;
  std::unique_ptr<ros2::Node> node;
  std::optional<ros2::Publisher<ros2::msg::OccupancyGrid>> maps;
  std::optional<ros2::Publisher<ros2::msg::OccupancyGrid>> costs;
  std::optional<ros2::Publisher<ros2::msg::TFMessage>> moving;
  std::optional<ros2::Publisher<ros2::msg::TFMessage>> fixed;
  std::optional<ros2::Publisher<ros2::msg::Path>> plans;
  std::optional<ros2::Publisher<ros2::msg::LaserScan>> scans;
  std::unique_ptr<ros2::Timer> ticking;
};

// Asks again and again until the map is as wanted, which is returned.
template <class Predicate>
MapPicture map_of(Survey& survey, const std::string& topic, std::uint64_t known, Predicate wanted) {
  const auto end = std::chrono::steady_clock::now() + rtps::kPatience;
  while (true) {
    MapPicture map = survey.map(topic, known);
    if (wanted(map) || std::chrono::steady_clock::now() > end) return map;
    std::this_thread::sleep_for(5ms);
  }
}

TEST(Survey, DrawsARobotOnItsMapWhileSomebodyLooks) {
  const ros2::TestDomain domain;
  DrivingRobot robot(domain);
  const auto survey = survey_of(domain);
  const auto is_whole = [](const MapPicture& map) {
    return map.grid && map.robots.size() == 1 && map.path && map.scan;
  };
  const MapPicture map = map_of(*survey, "", 0, is_whole);
  ASSERT_TRUE(is_whole(map));
  EXPECT_EQ(map.topics, (std::vector<std::string>{"/map", "/costmap"}));
  EXPECT_EQ(map.grid->cells, "09");
  EXPECT_DOUBLE_EQ(map.robots[0].at.x, 3) << "in the map's frame";
  EXPECT_DOUBLE_EQ(map.path->points.back().x, 4);
  EXPECT_DOUBLE_EQ(map.scan->points.at(0).x, 5.5);
  EXPECT_TRUE(map.troubles.empty()) << map.troubles[0];
  EXPECT_FALSE(survey->map("", map.number).grid) << "it is sent once";

  const auto is_other = [](const MapPicture& other) {
    return other.topic == "/costmap" && other.grid && other.robots.size() == 1;
  };
  const MapPicture costs = map_of(*survey, "/costmap", map.number, is_other);
  ASSERT_TRUE(is_other(costs));
  EXPECT_EQ(costs.grid->cells, "444");
  EXPECT_DOUBLE_EQ(costs.robots[0].at.x, 2) << "in this map's frame";
  EXPECT_EQ(costs.troubles.size(), 1u) << "the path is in a frame that is not below this one";

  EXPECT_TRUE(robot.context.changes().wait_for_one([](const ros2::GraphChange& change) {
    const auto* left = std::get_if<ros2::EndpointLeft>(&change);
    return left != nullptr && left->name == "/tf" && left->kind == EndpointKind::kSubscriber;
  })) << "nobody looks any more";
}

TEST(Survey, SaysWhyItDoesNotDrawAMap) {
  const ros2::TestDomain domain;
  DrivingRobot robot(domain);
  ros2::msg::OccupancyGrid hostile = DrivingRobot::map("map", {0});
  hostile.info.width = hostile.info.height = 100'000;
  robot.context.run([&] { robot.maps->publish(hostile); });
  const auto survey = survey_of(domain);
  const auto is_told = [](const MapPicture& map) { return !map.troubles.empty(); };
  const MapPicture map = map_of(*survey, "", 0, is_told);
  ASSERT_TRUE(is_told(map));
  EXPECT_EQ(map.troubles[0], "/map is not drawn: it claims 100000 × 100000 cells, and has 1");
  EXPECT_FALSE(map.grid);
}

TEST(Survey, KeepsNoStatusThatOnlyTakesMemory) {
  const ros2::TestDomain domain;
  SurveyedRobot robot(domain);
  const auto survey = survey_of(domain);
  const std::string long_name(300, 'n');
  ros2::msg::DiagnosticArray array;
  array.status = {{0, long_name, "", "", {}},
                  {0, "large", "", "", {{"key", std::string(20'000, 'v')}}},
                  {0, "usual", "", "", {}}};
  const auto has = [](const LiveInventory& seen, const std::string& name) {
    return std::ranges::any_of(seen.diagnostics,
                               [&](const auto& status) { return status.name == name; });
  };
  EXPECT_TRUE(shows(*survey, [&](const LiveInventory& seen) {
    robot.context.run([&] { robot.diagnostics->publish(array); });
    return has(seen, "usual");
  }));
  const LiveInventory seen = survey->inventory();
  EXPECT_FALSE(has(seen, "large"));
  EXPECT_FALSE(has(seen, long_name));
}

TEST(Survey, ForgetsWhatIsGone) {
  const ros2::TestDomain domain;
  const auto survey = survey_of(domain);
  {
    const SurveyedRobot robot(domain);
    ASSERT_TRUE(shows(*survey, [](const LiveInventory& seen) {
      return seen.nodes.contains("/robot") && seen.topics.contains("/visibility");
    }));
  }
  EXPECT_TRUE(shows(*survey, [](const LiveInventory& seen) {
    return seen.nodes.empty() && seen.topics.empty() && seen.services.empty();
  }));
}

}  // namespace
}  // namespace culprit::link
