// With real nodes: what was planted among them is found, and nothing else.
#include "doctor/look.h"

#include <future>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "doctor/baseline.h"
#include "doctor/examine.h"
#include "ros2/lifecycle_node.h"
#include "ros2/live_test.h"
#include "ros2/names.h"
#include "ros2/node.h"
#include "ros2/peer_process.h"
#include "ros2/test_keystore.h"
#include "ros2/timer.h"

namespace culprit::doctor {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

// A message of which only the content matters: defined as usual, without the fields that are not read.
template <const char* type>
struct Stamped {
  static constexpr std::string_view kType = type;
  ros2::msg::Header header;
  static void visit(auto& self, auto& each) { each(self.header); }
};
inline constexpr char kScanType[] = "sensor_msgs/msg/LaserScan";
inline constexpr char kImuType[] = "sensor_msgs/msg/Imu";
inline constexpr char kImageType[] = "sensor_msgs/msg/Image";
using Scan = Stamped<kScanType>;
using Imu = Stamped<kImuType>;
using Image = Stamped<kImageType>;

struct TransformMessage {
  static constexpr std::string_view kType = "tf2_msgs/msg/TFMessage";
  struct Edge {
    ros2::msg::Header header;
    std::string child;
    std::array<double, 7> transform{};
    static void visit(auto& self, auto& each) { each(self.header, self.child, self.transform); }
  };
  std::vector<Edge> transforms;
  static void visit(auto& self, auto& each) { each(self.transforms); }
};
struct ClockMessage {
  static constexpr std::string_view kType = "rosgraph_msgs/msg/Clock";
  ros2::msg::Time clock;
  static void visit(auto& self, auto& each) { each(self.clock); }
};

ros2::msg::Time now(Duration off = {}) {
  return ros2::msg::to_time(std::chrono::system_clock::now() +
                            std::chrono::duration_cast<std::chrono::system_clock::duration>(off));
}

// A node of a process of its own, as far as DDS shows.
class Member {
 public:
  Member(const ros2::ParticipantOptions& options, const std::string& name) : context_(options) {
    run([&] { node_ = std::move(*ros2::Node::create(*context_, {"/", name})); });
  }
  ~Member() {
    run([&] {
      timers_.clear();
      subscriptions_.clear();
      keep_.clear();
    });
  }

  template <class Message>
  ros2::Publisher<Message>& publishes(const std::string& topic, const rtps::Qos& qos = {}) {
    auto publisher = std::make_shared<std::optional<ros2::Publisher<Message>>>();
    run([&] { publisher->emplace(std::move(*node_->create_publisher<Message>(topic, qos))); });
    keep_.push_back(publisher);
    return **publisher;
  }
  template <class Message>
  Member& reads(const std::string& topic, const rtps::Qos& qos = {}) {
    run([&] {
      subscriptions_.push_back(
          std::move(*node_->create_subscription<Message>(topic, qos, [](const Message&) {})));
    });
    return *this;
  }
  Member& every(Duration period, std::function<void()> callback) {
    run([&] {
      timers_.push_back(
          std::make_unique<ros2::Timer>((*context_).executor(), period, std::move(callback)));
    });
    return *this;
  }
  // An endpoint that says more of itself than those of our nodes do.
  Member& publishes_as(const std::string& topic, const std::string& type,
                       const std::string& user_data) {
    run([&] {
      auto writer =
          context_->participant().create_writer({ros2::mangle_topic(ros2::Channel::kTopic, topic),
                                                 ros2::mangle_type(ros2::Channel::kTopic, type),
                                                 {},
                                                 user_data,
                                                 {}});
      node_->entry().add((*writer)->guid());
      keep_.push_back(std::shared_ptr<ros2::Writer>(std::move(*writer)));
    });
    return *this;
  }
  Member& reads_as(const std::string& topic, const std::string& type,
                   const std::string& user_data) {
    run([&] {
      auto reader =
          context_->participant().create_reader({ros2::mangle_topic(ros2::Channel::kTopic, topic),
                                                 ros2::mangle_type(ros2::Channel::kTopic, type),
                                                 {},
                                                 ros2::PayloadUse::kHeader,
                                                 user_data,
                                                 {}},
                                                [](const ros2::Sample&) {});
      node_->entry().add((*reader)->guid());
      keep_.push_back(std::shared_ptr<ros2::Reader>(std::move(*reader)));
    });
    return *this;
  }

  void run(const std::function<void()>& task) { context_.run(task); }
  ros2::LiveContext& context() { return context_; }
  ros2::Node& node() { return *node_; }

 private:
  ros2::LiveContext context_;
  std::unique_ptr<ros2::Node> node_;
  std::vector<std::shared_ptr<void>> keep_;
  std::vector<std::unique_ptr<ros2::Subscription>> subscriptions_;
  std::vector<std::unique_ptr<ros2::Timer>> timers_;
};

LookOptions options(const ros2::TestDomain& domain, Duration time,
                    Extent extent = Extent::kFindings) {
  return {.participant = domain.options(), .time = time, .extent = extent};
}

std::vector<std::string> found_in(const Picture& picture) {
  std::vector<std::string> all;
  for (const Finding& finding : examine(picture)) {
    // Findings about the machine that runs the tests may vary.
    if (finding.code == "D018" || finding.code == "D060") continue;
    all.push_back(finding.code + " " + finding.subject);
  }
  return all;
}

// Looks until that many findings are there, or for long enough that there would be.
std::vector<std::string> found(const ros2::TestDomain& domain, std::size_t wanted,
                               Duration time = 1500ms) {
  std::vector<std::string> all;
  for (int tries = 0; tries < 5; ++tries) {
    const auto picture = look(options(domain, time));
    EXPECT_TRUE(picture) << picture.error();
    if (!picture) return {};
    all = found_in(*picture);
    if (all.size() == wanted) break;
  }
  return all;
}

TEST(Look, FindsNodesThatDoNotReceiveFromOthersAndNothingElse) {
  const ros2::TestDomain domain;
  auto iron = domain.options();
  iron.gid_size = ros2::GidSize::kIronAndNewer;
  Member lidar(domain.options(), "lidar");
  Member slam(domain.options(), "slam");
  Member camera(iron, "camera");
  Member first(domain.options(), "twin");
  Member second(domain.options(), "twin");

  lidar.publishes<Scan>("/scan", {.reliability = rtps::Reliability::kBestEffort});
  slam.reads<Scan>("/scan", {.liveliness_lease = 3s});
  lidar.publishes<Imu>("/imu");
  slam.reads_as("/imu", kScanType, "");
  lidar.publishes<Scan>("/front/points");
  slam.reads<Scan>("/points");
  lidar.publishes_as("/image", kImageType, "typehash=RIHS01_aaaaaaaa;");
  slam.reads_as("/image", kImageType, "typehash=RIHS01_bbbbbbbb;");
  // An endpoint that is never announced.
  rtps::Guid nowhere = camera.context()->participant().guid();
  nowhere.bytes[13] = 99;
  nowhere.bytes[15] = 3;
  camera.run([&] { camera.node().entry().add(nowhere); });
  // The thread that should answer waits.
  Member hangs(domain.options(), "hangs");
  std::promise<void> let_go;
  ros2::TaskGroup tasks(hangs.context()->executor());
  tasks.post([waits = let_go.get_future().share()] { waits.wait(); });

  EXPECT_THAT(found(domain, 8),
              ElementsAre("D001 /scan: /lidar → /slam", "D002 /imu: /lidar → /slam", "D010 /twin",
                          "D012 /hangs", "D034 /hangs, /lidar, /slam and /twin",
                          "D003 /points: no publisher → /slam", "D005 /image: /lidar → /slam",
                          "D009 /camera"));
  let_go.set_value();
}

TEST(Look, FindsNothingAmongHealthyNodesAndSaysWhenNobodyIsThere) {
  const ros2::TestDomain domain;
  EXPECT_THAT(found(domain, 1), ElementsAre("D030 domain " + std::to_string(domain.number())));
  Member lidar(domain.options(), "lidar");
  Member slam(domain.options(), "slam");
  auto& scan = lidar.publishes<Scan>("/scan");
  lidar.every(50ms, [&] { scan.publish({{now(), "laser"}}); });
  slam.reads<Scan>("/scan", rtps::qos::kSensorData);
  EXPECT_THAT(found(domain, 0), IsEmpty());
}

TEST(Look, FindsWrongTimesAndBrokenTreesAndNothingElse) {
  const ros2::TestDomain domain;
  Member robot(domain.options(), "robot");
  Member other(domain.options(), "other");
  Member reader(domain.options(), "reader");

  auto& old = robot.publishes<Scan>("/old");
  auto& early = robot.publishes<Scan>("/early");
  auto& jumps = robot.publishes<Scan>("/jumps");
  auto& late = robot.publishes<Imu>("/late", {.deadline = 40ms});
  auto& lost = robot.publishes<Scan>("/lost");
  robot.publishes<Image>("/silent");
  auto& latched = robot.publishes<ros2::msg::String>(
      "/latched", {.durability = rtps::Durability::kTransientLocal});
  latched.publish({"a map"});
  for (const char* topic : {"/old", "/early", "/jumps", "/lost"}) reader.reads<Scan>(topic);
  reader.reads<Imu>("/late", {.deadline = 60ms});
  reader.reads<Image>("/silent");
  reader.reads<ros2::msg::String>("/latched");
  robot.every(100ms, [&, beat = 0]() mutable {
    ++beat;
    old.publish({{now(-5s), "base"}});
    early.publish({{now(5s), "base"}});
    jumps.publish({{now(beat % 10 == 0 ? -900ms : 0ms), "base"}});
    late.publish({{now(), "base"}});
    lost.publish({{now(), "nowhere"}});
  });
  reader.reads<TransformMessage>("/tf");
  auto& tree = robot.publishes<TransformMessage>("/tf");
  auto& rival = other.publishes<TransformMessage>("/tf");
  robot.every(50ms, [&] {
    tree.publish({{{{now(), "odom"}, "base", {}},
                   {{now(), "base"}, "arm", {}},
                   {{now(), "base"}, "hand", {}},
                   {{now(-5s), "base"}, "tail", {}},
                   {{now(), "island"}, "palm", {}}}});
  });
  other.every(50ms, [&] {
    rival.publish({{{{now(), "base"}, "arm", {}}, {{now(), "odom"}, "hand", {}}}});
  });
  auto& status = other.publishes<ros2::msg::DiagnosticArray>("/diagnostics");
  other.every(100ms, [&] { status.publish({{}, {{2, "motor", "overheated", "m1", {}}}}); });

  const auto picture = look(options(domain, 5500ms));
  ASSERT_TRUE(picture) << picture.error();
  EXPECT_THAT(found_in(*picture),
              UnorderedElementsAre("D020 motor", "D040 /late: /robot → /reader",
                                   "D041 /silent: /robot → /reader", "D042 /old: /robot",
                                   "D043 /early: /robot", "D044 /jumps: /robot", "D050 tf: nowhere",
                                   "D051 tf: base → tail", "D052 tf: hand", "D053 tf: base → arm",
                                   "D054 tf: island and odom"));
  ASSERT_TRUE(picture->flows.contains("/latched"));
  EXPECT_TRUE(picture->flows.at("/latched").last_sent) << "it was published before";
}

TEST(Look, FindsClocksThatDoNotAgreeAndNothingElse) {
  const ros2::TestDomain domain;
  std::atomic<int> tick = 0;  // outlives who counts it
  Member simulator(domain.options(), "simulator");
  Member right(domain.options(), "right");
  Member wrong(domain.options(), "wrong");
  Member real(domain.options(), "real");
  Member reader(domain.options(), "reader");
  for (Member* each : {&right, &wrong, &reader}) {
    each->run([&] {
      const ros2::msg::Parameter simulated{"use_sim_time", ros2::to_parameter_value(true)};
      ASSERT_TRUE(each->node().parameters().set({&simulated, 1}).successful);
    });
  }
  auto& clock = simulator.publishes<ClockMessage>("/clock");
  simulator.every(10ms, [&] { clock.publish({{100 + tick / 100, 0}}), ++tick; });
  auto& rights = right.publishes<Scan>("/right");
  auto& wrongs = wrong.publishes<Scan>("/wrong");
  auto& reals = real.publishes<Scan>("/real");
  for (const char* topic : {"/right", "/wrong", "/real"}) reader.reads<Scan>(topic);
  right.every(50ms, [&] { rights.publish({{{100 + tick / 100, 0}, "base"}}); });
  wrong.every(50ms, [&] { wrongs.publish({{now(), "base"}}); });
  real.every(50ms, [&] { reals.publish({{now(), "base"}}); });
  EXPECT_THAT(found(domain, 2, 1800ms), ElementsAre("D045 /wrong: /wrong", "D047 /real"));
}

// A managed node of a process of its own.
struct Managed {
  Managed(const ros2::TestDomain& domain, const std::string& name,
          std::vector<ros2::TransitionId> transitions)
      : context(domain.options()) {
    context.run([&] {
      node = std::move(*ros2::LifecycleNode::create(*context, {"/", name}, {}));
      for (const auto transition : transitions) EXPECT_TRUE(node->trigger(transition));
      publisher = std::move(
          *ros2::RawPublisher::create(node->node().entry(), "~/out", "std_msgs/msg/String", {}));
    });
  }
  ~Managed() {
    context.run([&] { publisher.reset(); });
  }
  ros2::LiveContext context;
  std::unique_ptr<ros2::LifecycleNode> node;
  std::unique_ptr<ros2::RawPublisher> publisher;
};

TEST(Look, FindsNodesThatComeGoOrAreNotDrivenOn) {
  using enum ros2::TransitionId;
  const ros2::TestDomain domain;
  const Managed active(domain, "active", {kConfigure, kActivate});
  const Managed waiting(domain, "waiting", {kConfigure});
  Member reader(domain.options(), "reader");
  reader.reads<ros2::msg::String>("/waiting/out").reads<ros2::msg::String>("/active/out");
  auto circles = std::make_unique<Member>(domain.options(), "circles");
  ros2::PeerProcess victim({CULPRIT_PEER_NODE, std::to_string(domain.number()), "/victim"});
  ros2::LiveContext watcher(domain.options());
  ASSERT_TRUE(watcher.sees_node("/victim"));

  auto picture = std::async(std::launch::async, [&] { return look(options(domain, 4s)); });
  ASSERT_TRUE(watcher.sees_node("/_culprit_doctor"));
  // A node is asked once the doctor has discovered it; the doctor asks after a third of its time.
  ASSERT_TRUE(
      watcher.sees_endpoint("/_culprit_doctor", EndpointKind::kClient, "/circles/get_parameters"));
  victim.end(SIGKILL);
  for (int i = 0; i < 2; ++i) {
    circles.reset();
    circles = std::make_unique<Member>(domain.options(), "circles");
    std::this_thread::sleep_for(200ms);  // until it is discovered
  }
  const auto taken = picture.get();
  ASSERT_TRUE(taken) << taken.error();
  EXPECT_THAT(found_in(*taken),
              UnorderedElementsAre("D011 /victim", "D013 /circles", "D015 /waiting"));
}

TEST(Look, TellsWhatIsNotAsItWas) {
  const ros2::TestDomain domain;
  std::atomic<int> skipped = 1;  // outlives who reads it
  auto gone = std::make_unique<Member>(domain.options(), "gone");
  Member robot(domain.options(), "robot");
  Member reader(domain.options(), "reader");
  auto& fast = robot.publishes<ros2::msg::Float64>("/fast");
  reader.reads<ros2::msg::Float64>("/fast").reads<ros2::msg::Float64>("/extra");
  robot.every(20ms, [&, beat = 0]() mutable {
    if (beat++ % skipped == 0) fast.publish({1});
  });
  robot.run([&] { ASSERT_TRUE(robot.node().parameters().declare("gain", Value(0.5))); });
  const auto healthy = look(options(domain, 1500ms, Extent::kEverything));
  ASSERT_TRUE(healthy) << healthy.error();
  const Baseline baseline = baseline_of(*healthy);
  EXPECT_EQ(baseline.nodes.at("/robot").parameters.at("gain"), "0.5");
  EXPECT_THAT(compare(baseline, baseline), IsEmpty());

  gone.reset();
  const Member fresh(domain.options(), "fresh");
  skipped = 5;
  robot.run([&] {
    const ros2::msg::Parameter more{"gain", ros2::to_parameter_value(0.7)};
    ASSERT_TRUE(robot.node().parameters().set({&more, 1}).successful);
  });
  const auto now = look(options(domain, 1500ms, Extent::kEverything));
  ASSERT_TRUE(now) << now.error();
  std::vector<std::string> all;
  for (const Finding& finding : compare(baseline, baseline_of(*now)))
    all.push_back(finding.code + " " + finding.subject);
  EXPECT_THAT(all, ElementsAre("D100 /gone", "D101 /fresh", "D104 /fast", "D105 /robot"));
}

TEST(Look, SeesWhichNodesAreSecured) {
  const ros2::TestDomain domain;
  ros2::TestKeystore keystore;
  keystore.add("/robot", ros2::TestKeystore::everything("/robot"));
  auto secured = domain.options();
  secured.enclave = "/robot";
  secured.security = ros2::Security{"/robot", keystore.path() + "/enclaves/robot"};
  Member keys(secured, "keys");
  Member none(domain.options(), "none");
  EXPECT_THAT(found(domain, 1), ElementsAre("D033 /none"));
}

TEST(Watch, LooksAgainAndAgainUntilItIsStopped) {
  const ros2::TestDomain domain;
  Member lidar(domain.options(), "lidar");
  Member slam(domain.options(), "slam");
  std::stop_source stop;
  std::vector<std::vector<std::string>> all;
  std::optional<ros2::Publisher<Scan>> scan;
  const auto watched = watch(
      options(domain, 1s),
      [&](const Picture& picture) {
        all.push_back(found_in(picture));
        if (all.size() == 1) {
          lidar.publishes<Scan>("/scan", {.reliability = rtps::Reliability::kBestEffort});
          slam.reads<Scan>("/scan");
        }
        if (all.back().size() == 1 || all.size() > 5) stop.request_stop();
      },
      stop.get_token());
  ASSERT_TRUE(watched) << watched.error();
  EXPECT_THAT(all.front(), IsEmpty());
  EXPECT_THAT(all.back(), ElementsAre("D001 /scan: /lidar → /slam"));
}

TEST(Look, IsStopped) {
  const ros2::TestDomain domain;
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(look(options(domain, 1h), stop.get_token()));
}

}  // namespace
}  // namespace culprit::doctor
