#include "link/link.h"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <future>
#include <iterator>
#include <map>
#include <mutex>
#include <random>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

#include <gtest/gtest.h>

#include "base/environment.h"
#include "base/test_folder.h"
#include "language/checker.h"
#include "ros2/helper_options.h"
#include "ros2/lifecycle.h"
#include "ros2/lifecycle_node.h"
#include "ros2/live_test.h"
#include "ros2/publisher.h"
#include "ros2/services.h"
#include "ros2/subscription.h"
#include "ros2/test_forger.h"
#include "ros2/timer.h"
#include "rtps/newcomers.h"
#include "rtps/test_hostile_process.h"

namespace culprit::link {
namespace {

using namespace std::chrono_literals;

constexpr const char* kRules = R"(
COMPONENT robot NODE /robot
COMPONENT absent NODE /absent
SIGNAL temperature DIAGNOSTIC motor KEY temperature
SIGNAL visibility  TOPIC /visibility FIELD data
SIGNAL wrong       TOPIC /visibility FIELD no.such.field
SIGNAL charge      TOPIC /battery FIELD cells[1].charge
RULE R
  POLICIES ERROR
  TRIGGER temperature > 50 || visibility < 1 || wrong > 1 || robot_speed > 1 || rate(/visibility) < 1 || level(motor) > 1 || parameter(robot, gain) > 2 || charge > 2 || lifecycle(robot) == "x"
    STRATEGY s 50 10
      ADAPTATION robot restart 5
)";

// A helper program of --link ros for this domain. It adds its process id to the file, if one is named.
std::shared_ptr<const ros2::HelperOptions> helper_of(const ros2::TestDomain& domain,
                                                     const std::string& pids = "/dev/null") {
  ros2::HelperOptions helper;
  helper.command = {"/bin/sh",
                    "-c",
                    "echo $$ >> \"$0\"; exec \"$@\"",
                    pids,
                    CULPRIT_PEER_HELPER,
                    std::to_string(domain.number())};
  for (char** each = environ; *each != nullptr; ++each) helper.environment.emplace_back(*each);
  return std::make_shared<const ros2::HelperOptions>(std::move(helper));
}

// The variable runs the tests that are not of DDS alone over a helper (src/CMakeLists.txt).
bool is_over_helper() { return environment("CULPRIT_LINK_OF_TESTS") == "ros"; }

// A link to whatever the test puts on the domain, and what it observes.
class Linked {
 public:
  explicit Linked(const ros2::TestDomain& domain, const std::filesystem::path& message_path = {},
                  const char* text = kRules,
                  std::shared_ptr<const ros2::HelperOptions> helper = nullptr)
      : rules(*check(Source("test.rules", text)).rules) {
    Link::Options options;
    if (!message_path.empty()) options.types.message_path = {message_path};
    options.participant = domain.options();
    options.participant.helper =
        helper || !is_over_helper() ? std::move(helper) : helper_of(domain);
    options.parameters = {{"rules", Value(std::string("test.rules"))}};
    auto opened = Link::open(rules, std::move(options), inbox_);
    if (!opened) throw std::runtime_error(opened.error());
    link = std::move(*opened);
  }

  // The first observation of this kind that fits, now or later.
  template <class What, class Fits>
  std::optional<What> wait(Fits fits, Duration patience = rtps::kPatience) {
    const Time end = live_now() + patience;
    for (std::size_t i = 0;; ++i) {
      while (i == seen_.size()) {
        if (live_now() >= end) return std::nullopt;
        inbox_.take(end, seen_);
      }
      const auto* what = std::get_if<What>(&seen_[i].what);
      if (what != nullptr && fits(*what)) return *what;
    }
  }
  // Whether one was among those that came so far.
  template <class What, class Fits>
  bool has_seen(Fits fits) const {
    return std::any_of(seen_.begin(), seen_.end(), [&](const Observation& observation) {
      const auto* what = std::get_if<What>(&observation.what);
      return what != nullptr && fits(*what);
    });
  }
  const std::vector<Observation>& seen() const { return seen_; }
  Reply ask(decltype(Command::what) what, Duration timeout = 5s,
            ComponentId component = ComponentId(0)) {
    const CommandId id{++last_};
    link->execute({id, component, std::move(what), timeout});
    const auto reply = wait<Reply>([&](const Reply& r) { return r.command == id; });
    EXPECT_TRUE(reply) << "a command must always be answered";
    return reply.value_or(Reply{});
  }
  bool sees(const std::string& node) {
    return wait<NodeAppeared>([&](const NodeAppeared& n) { return n.node == node; }).has_value();
  }
  std::optional<Value> reads(const std::string& signal) {
    const auto read =
        wait<SignalRead>([&](const SignalRead& r) { return rules[r.signal].name == signal; });
    return read ? std::optional(read->value) : std::nullopt;
  }

  RuleSet rules;

 private:
  Inbox inbox_;  // outlives the link
  std::vector<Observation> seen_;
  std::uint64_t last_ = 0;

 public:
  std::unique_ptr<Link> link;
};

struct Robot {
  explicit Robot(const ros2::TestDomain& domain) : context(domain.options()) {
    context.run([&] {
      managed = std::move(*ros2::LifecycleNode::create(*context, {"/", "robot"}, {}));
      ros2::ParameterStore& parameters = managed->node().parameters();
      EXPECT_TRUE(parameters.declare("gain", Value(1.5)));
      ros2::msg::ParameterValue names;
      names.type = 9;
      EXPECT_TRUE(parameters.declare("names", names));
    });
  }
  template <class Message>
  ros2::Publisher<Message> publisher(const std::string& topic) {
    return std::move(*managed->node().create_publisher<Message>(topic));
  }
  ros2::LiveContext context;
  std::unique_ptr<ros2::LifecycleNode> managed;
};

// It announces the port of no process, so its process is unknown.
TEST(Link, ANodeThatAnUnknownSourceDeclaredGoneHasTimeToComeBack) {
  const ros2::TestDomain domain;
  Linked linked(domain);
  ros2::Forger robot(domain.options(), ros2::free_port());
  robot.says_that_it_holds({"/", "robot", {}, {}});
  ASSERT_TRUE(linked.sees("/robot"));
  const auto left = [](const NodeVanished& n) { return n.node == "/robot"; };
  robot.says_that_it_holds({"/", "other", {}, {}});
  ASSERT_TRUE(linked.sees("/other"));
  robot.says_that_it_holds({"/", "robot", {}, {}});
  ASSERT_TRUE(linked.wait<NodeVanished>([](const NodeVanished& n) { return n.node == "/other"; }));
  EXPECT_FALSE(linked.wait<NodeVanished>(left, 5s)) << "it came back";
  const Time now = live_now();
  robot.says_that_it_holds({"/", "other", {}, {}});
  EXPECT_TRUE(linked.wait<NodeVanished>(left));
  EXPECT_GE(live_now() - now, 4s);
}

TEST(Link, SeesNodesWithTheirProcessAndTheirState) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  Linked linked(domain);
  const auto node =
      linked.wait<NodeAppeared>([](const NodeAppeared& n) { return n.node == "/robot"; });
  ASSERT_TRUE(node);
  EXPECT_EQ(node->pid, getpid());
  EXPECT_TRUE(linked.wait<LifecycleRead>(
      [](const LifecycleRead& r) { return r.state == Lifecycle::kUnconfigured; }));
  EXPECT_TRUE(
      linked.wait<ParameterRead>([](const ParameterRead& r) { return r.value == Value(1.5); }));
}

// As a simulation that begins paused.
TEST(Link, HoldsASimulatedNodeUntilItsClockTicks) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  const ros2::msg::Parameter simulated{"use_sim_time", ros2::to_parameter_value(true)};
  std::unique_ptr<ros2::LifecycleNode> simulator;
  robot.context.run([&] {
    ASSERT_TRUE(robot.managed->node().parameters().set({&simulated, 1}).successful);
    simulator = std::move(*ros2::LifecycleNode::create(*robot.context, {"/", "simulator"}, {}));
  });
  auto clock = std::move(*ros2::RawPublisher::create(simulator->node().entry(), "/clock",
                                                     "rosgraph_msgs/msg/Clock", {}));
  Linked linked(domain);
  const auto is_held = [&](bool held) {
    return linked.wait<TimeHeld>([&](const TimeHeld& t) { return t.is_held == held; }).has_value();
  };
  EXPECT_TRUE(is_held(true)) << "no tick came yet";
  EXPECT_FALSE(linked.has_seen<TimeHeld>([](const TimeHeld& t) { return !t.is_held; }));

  std::int32_t shown = 0;
  auto ticking = std::make_unique<ros2::Timer>(robot.context->executor(), 20ms, [&] {
    clock->publish(rtps::encode(ros2::msg::Time{++shown, 0}));
  });
  EXPECT_TRUE(is_held(false));
  robot.context.run([&] { ticking.reset(); });
  clock.reset();
  robot.context.run([&] { simulator.reset(); });
}

TEST(Link, AsksLocalNodesTooWhetherTheyAnswer) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  Linked linked(domain, {},
                "COMPONENT robot NODE /robot\nRULE R\nPOLICIES ERROR\nTRIGGER !alive(robot)\n"
                "STRATEGY s 50 10\nADAPTATION robot restart 5\n");
  const auto answers = [&](bool answered) {
    return linked.wait<Probed>([&](const Probed& p) { return p.answered == answered; }).has_value();
  };
  EXPECT_TRUE(answers(true));
  std::promise<void> goes_on;
  std::thread hung([&] { robot.context.run([&] { goes_on.get_future().wait(); }); });
  EXPECT_TRUE(answers(false)) << "its callback hangs";
  goes_on.set_value();
  hung.join();
}

// An event is a reason to ask. Anybody may send one, in the name of whomever he likes.
TEST(Link, BelievesNoTransitionEventButTheNodesOwnAnswer) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  ros2::LiveContext stranger(domain.options());
  ros2::NodeEntry liar(*stranger, {"/", "liar"});
  Linked linked(domain);
  const auto reads = [&](Lifecycle expected, Duration patience = rtps::kPatience) {
    return linked
        .wait<LifecycleRead>([&](const LifecycleRead& r) { return r.state == expected; }, patience)
        .has_value();
  };
  ASSERT_TRUE(reads(Lifecycle::kUnconfigured));
  const auto forged = ros2::RawPublisher::create(liar, "/robot/transition_event",
                                                 ros2::msg::TransitionEvent::kType, {});
  // As its own would be, if another program uses its participant's identity.
  const auto own =
      ros2::RawPublisher::create(robot.managed->node().entry(), "/robot/transition_event",
                                 ros2::msg::TransitionEvent::kType, {});
  ASSERT_TRUE(forged && own);
  for (const LifecycleState state : {LifecycleState::kActive, LifecycleState::kErrorProcessing}) {
    ros2::msg::TransitionEvent event;
    event.goal_state.id = static_cast<std::uint8_t>(state);
    const rtps::Bytes bytes = rtps::encode(event);
    for (int i = 0; i < 20; ++i) {
      (*forged)->publish(bytes);
      (*own)->publish(bytes);
      std::this_thread::sleep_for(20ms);
    }
  }
  EXPECT_FALSE(reads(Lifecycle::kActive, 300ms));
  EXPECT_FALSE(linked.has_seen<LifecycleRead>(
      [](const LifecycleRead& r) { return r.state == Lifecycle::kTransition; }));
  EXPECT_EQ(linked.ask(ChangeLifecycle{Transition::kConfigure}).outcome, Outcome::kDone);
  EXPECT_TRUE(reads(Lifecycle::kInactive)) << "an event reported it, and the node confirmed it";
}

constexpr const char* kAliveRules =
    "COMPONENT robot NODE /robot LAUNCH \"robot\"\nRULE R\nPOLICIES ERROR\nTRIGGER !alive(robot)\n"
    "STRATEGY s 50 10\nADAPTATION robot redeploy 5\n";

auto tells(const std::string& part) {
  return [part](const LinkTrouble& told) { return told.text.find(part) != std::string::npos; };
}

// Any program that uses its participant's identity can do that.
TEST(Link, AsksANodeThatIsSaidToLeave) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  Linked linked(domain, {}, kAliveRules);
  ASSERT_TRUE(linked.sees("/robot"));
  ASSERT_TRUE(linked.wait<Probed>([](const Probed& p) { return p.answered; }));
  const auto forged =
      robot.context->participant().create_writer({.topic = std::string(ros2::kDiscoveryInfoTopic),
                                                  .type = std::string(ros2::kDiscoveryInfoType),
                                                  .qos = rtps::qos::kDiscoveryInfoWriter,
                                                  .user_data = {},
                                                  .on_match = {}});
  ASSERT_TRUE(forged);
  (*forged)->write(ros2::encode_discovery_info({robot.context->participant().guid(), {}},
                                               ros2::GidSize::kHumbleAndOlder));
  const auto leaves = [](const NodeVanished& n) { return n.node == "/robot"; };
  EXPECT_TRUE(linked.wait<LinkTrouble>(tells("but it answers and counts as present")));
  EXPECT_FALSE(linked.wait<NodeVanished>(leaves, 500ms));
  std::promise<void> goes_on;
  std::thread hung([&] { robot.context.run([&] { goes_on.get_future().wait(); }); });
  EXPECT_TRUE(linked.wait<NodeVanished>(leaves)) << "it is asked again, and answers no more";
  goes_on.set_value();
  hung.join();
}

TEST(Link, ANameThatWasProvenHereBelongsToNoStranger) {
  const ros2::TestDomain domain;
  std::optional<Robot> robot(std::in_place, domain);
  Linked linked(domain, {}, kAliveRules);
  ASSERT_TRUE(linked.wait<NodeAppeared>([](const NodeAppeared& n) { return n.pid == getpid(); }));
  ros2::Forger stranger(domain.options(), ros2::free_port());
  stranger.says_that_it_holds({"/", "robot", {}, {}});
  EXPECT_TRUE(linked.wait<LinkTrouble>(tells("claims the name /robot")));
  robot.reset();
  EXPECT_TRUE(linked.wait<NodeVanished>([](const NodeVanished& n) { return n.node == "/robot"; }));
  EXPECT_FALSE(
      linked.wait<NodeAppeared>([](const NodeAppeared& n) { return n.pid != getpid(); }, 1s))
      << "the stranger would keep it from being started again";
  EXPECT_FALSE(linked.has_seen<NamesakesSeen>([](const NamesakesSeen& n) { return n.others > 0; }));
}

TEST(Link, ReadsAStatusOnlyOfItsPublisher) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  ros2::LiveContext other(domain.options());
  ros2::NodeEntry liar(*other, {"/", "liar"});
  auto own = robot.publisher<ros2::msg::DiagnosticArray>("/diagnostics");
  auto forged = ros2::Publisher<ros2::msg::DiagnosticArray>(std::move(*ros2::RawPublisher::create(
      liar, "/diagnostics", ros2::msg::DiagnosticArray::kType, rtps::qos::kDefault)));
  const auto temperature = [](const std::string& text) {
    ros2::msg::DiagnosticArray array;
    array.status = {{1, "motor", "", "m1", {{"temperature", text}}}};
    return array;
  };
  Linked linked(domain);
  ASSERT_TRUE(linked.sees("/robot"));
  ros2::Timer speaks(robot.context->executor(), 20ms, [&] { own.publish(temperature("40")); });
  EXPECT_EQ(linked.reads("temperature"), Value(std::string("40")));
  EXPECT_TRUE(linked.wait<PublisherKnown>(
      [](const PublisherKnown& p) { return p.status == "motor" && p.node == "/robot"; }));
  ros2::Timer lies(other->executor(), 20ms, [&] { forged.publish(temperature("90")); });
  EXPECT_TRUE(linked.wait<LinkTrouble>(
      tells("status motor is published by /robot, and by /liar, too: culprit ignores /liar")));
  EXPECT_FALSE(linked.wait<SignalRead>(
      [](const SignalRead& r) { return r.value == Value(std::string("90")); }, 500ms));
}

// The liar comes first, publishes more often, and latches.
TEST(Link, ReadsASignalOnlyOfThePublisherThatIsDeclared) {
  const ros2::TestDomain domain;
  ros2::LiveContext other(domain.options());
  ros2::NodeEntry liar(*other, {"/", "liar"});
  auto forged = ros2::Publisher<ros2::msg::DiagnosticArray>(std::move(*ros2::RawPublisher::create(
      liar, "/diagnostics", ros2::msg::DiagnosticArray::kType, rtps::qos::kDefault)));
  constexpr rtps::Qos kLatched{.durability = rtps::Durability::kTransientLocal, .depth = 1};
  const auto forged_mode =
      ros2::RawPublisher::create(liar, "/level", ros2::msg::Float64::kType, kLatched);
  ASSERT_TRUE(forged_mode);
  (*forged_mode)->publish(rtps::encode(ros2::msg::Float64{90}));
  const auto temperature = [](const std::string& text) {
    ros2::msg::DiagnosticArray array;
    array.status = {{1, "motor", "", "m1", {{"temperature", text}}}};
    return array;
  };
  ros2::Timer lies(other->executor(), 10ms, [&] { forged.publish(temperature("90")); });
  Linked linked(domain, {},
                "COMPONENT robot NODE /robot\n"
                "SIGNAL temperature DIAGNOSTIC motor KEY temperature FROM robot\n"
                "SIGNAL level TOPIC /level FIELD data FROM robot\n"
                "RULE R\nPOLICIES ERROR REPORT\nTRIGGER temperature > 80 || level > 80\n");
  EXPECT_TRUE(
      linked.wait<LinkTrouble>(tells("status motor is published by /liar, but the rules "
                                     "read it FROM robot: culprit ignores /liar")));
  Robot robot(domain);
  auto own = robot.publisher<ros2::msg::DiagnosticArray>("/diagnostics");
  ros2::NodeEntry& entry = robot.managed->node().entry();
  const auto own_level =
      ros2::RawPublisher::create(entry, "/level", ros2::msg::Float64::kType, kLatched);
  ASSERT_TRUE(own_level);
  (*own_level)->publish(rtps::encode(ros2::msg::Float64{40}));  // once
  ros2::Timer speaks(robot.context->executor(), 20ms, [&] { own.publish(temperature("40")); });
  const auto is = [](Value value) {
    return [value](const SignalRead& r) { return r.value == value; };
  };
  EXPECT_TRUE(linked.wait<SignalRead>(is(Value(std::string("40")))));
  EXPECT_TRUE(linked.wait<SignalRead>(is(Value(40.0))));
  EXPECT_FALSE(linked.has_seen<SignalRead>(is(Value(std::string("90")))));
  EXPECT_FALSE(linked.has_seen<SignalRead>(is(Value(90.0))));
}

TEST(Link, BelievesNoParameterEventOfOthers) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  ros2::LiveContext other(domain.options());
  ros2::NodeEntry liar(*other, {"/", "liar"});
  const auto forged = ros2::RawPublisher::create(
      liar, "/parameter_events", ros2::msg::ParameterEvent::kType, rtps::qos::kDefault);
  ASSERT_TRUE(forged);
  Linked linked(domain);
  const auto is = [](double value) {
    return [value](const ParameterRead& r) { return r.value == Value(value); };
  };
  ASSERT_TRUE(linked.wait<ParameterRead>(is(1.5)));
  ros2::msg::ParameterEvent event;
  event.node = "/robot";
  event.changed_parameters = {{"gain", ros2::to_parameter_value(Value(9.0))}};
  ros2::Timer lies(other->executor(), 20ms,
                   [&, bytes = rtps::encode(event)] { (*forged)->publish(bytes); });
  EXPECT_TRUE(linked.wait<LinkTrouble>(tells("/liar published that parameters of /robot changed")));
  EXPECT_FALSE(linked.wait<ParameterRead>(is(9.0), 500ms));
  EXPECT_EQ(linked.ask(SetParameter{"gain", Value(3.0)}).outcome, Outcome::kDone);
  EXPECT_TRUE(linked.wait<ParameterRead>(is(3.0)));
}

TEST(Link, DiscoversANewProcessBesideAThousandParticipantsOfAStranger) {
  const ros2::TestDomain domain;
  Linked linked(domain, {}, kAliveRules);
  rtps::EventLog<std::uint16_t> ports;  // announced to the whole domain
  const auto spy =
      ros2::Participant::create(domain.options(), [&](const ros2::DiscoveryEvent& event) {
        const auto* info = std::get_if<ros2::ParticipantInfo>(&event);
        if (info != nullptr && !info->metatraffic.empty())
          ports.add(info->metatraffic.front().port);
      });
  ASSERT_TRUE(spy);
  ASSERT_TRUE(ports.wait_for_count(1));
  // One source would introduce no more than sixteen at once.
  std::vector<int> sockets;
  for (int i = 0; i < 1100 / rtps::Newcomers::kAtOnce + 1; ++i)
    sockets.push_back(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const auto announce = [&](std::uint16_t number) {
    const int socket = sockets[number / rtps::Newcomers::kAtOnce];
    const rtps::Bytes datagram = rtps::announcement_of(number);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons(ports.all().front());
    sendto(socket, datagram.data(), datagram.size(), 0, reinterpret_cast<sockaddr*>(&to),
           sizeof to);
  };
  bool is_full = false;
  for (int round = 0; round < 50 && !is_full; ++round) {  // a busy machine loses some
    for (std::uint16_t i = 0; i < 1100; ++i) {
      announce(i);
      if (i % 50 == 0) std::this_thread::sleep_for(5ms);
    }
    is_full = linked.wait<LinkTrouble>(tells("too many participants"), 200ms).has_value();
  }
  ASSERT_TRUE(is_full);
  Robot robot(domain);
  EXPECT_TRUE(linked.sees("/robot"));
  for (const int each : sockets) close(each);
}

// Before something is taken down that depends on it. No rule is about it, so nothing asks it periodically.
TEST(Link, AsksWhetherANodeAnswersWhenItIsToldTo) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  Linked linked(domain, {}, "COMPONENT robot NODE /robot\n");
  ASSERT_TRUE(linked.wait<Probed>([](const Probed& p) { return p.answered; }));
  const auto ask = [&] { return linked.ask(Probe{}, 500ms); };
  EXPECT_EQ(ask().outcome, Outcome::kDone);
  std::promise<void> hangs;
  std::promise<void> goes_on;
  std::thread hung([&] {
    robot.context.run([&] {
      hangs.set_value();
      goes_on.get_future().wait();
    });
  });
  hangs.get_future().wait();
  // Also on a machine that is too busy to prove it.
  EXPECT_NE(ask().outcome, Outcome::kDone) << "its callback hangs";
  goes_on.set_value();
  hung.join();
}

// As with nodes of other users, in containers or not: no visible process holds their sockets.
TEST(Link, MissesNoProofOfWhatAnEngineOrSystemdEnds) {
  const ros2::TestDomain domain;
  Linked linked(domain, {},
                "COMPONENT slam NODE /slam CONTAINER docker slam\n"
                "COMPONENT lidar NODE /lidar UNIT lidar.service\n"
                "COMPONENT robot NODE /robot\n");
  const auto is_missed = [](const std::string& node) {
    return [=](const LinkTrouble& told) {
      return told.text.find("the process of " + node + " is not proven") != std::string::npos;
    };
  };
  ros2::Forger slam(domain.options(), ros2::free_port());
  ros2::Forger lidar(domain.options(), ros2::free_port());
  ros2::Forger robot(domain.options(), ros2::free_port());
  slam.says_that_it_holds({"/", "slam", {}, {}});
  ASSERT_TRUE(linked.sees("/slam"));
  lidar.says_that_it_holds({"/", "lidar", {}, {}});
  ASSERT_TRUE(linked.sees("/lidar"));
  robot.says_that_it_holds({"/", "robot", {}, {}});
  EXPECT_TRUE(linked.wait<LinkTrouble>(is_missed("/robot")));
  EXPECT_FALSE(linked.has_seen<LinkTrouble>(is_missed("/slam")));
  EXPECT_FALSE(linked.has_seen<LinkTrouble>(is_missed("/lidar")));
}

// A node that answers a client that was made after the reader has also discovered the reader.
TEST(Link, KnowsThatASilentNodeKnowsItsListener) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  auto silent = robot.publisher<ros2::msg::Float64>("/silent");
  auto speaking = robot.publisher<ros2::msg::Float64>("/speaking");
  Linked linked(domain, {},
                "COMPONENT robot NODE /robot\nRULE R\nPOLICIES ERROR\n"
                "TRIGGER age(/silent) > 1h || age(/speaking) > 1h\n"
                "STRATEGY s 50 10\nADAPTATION robot restart 5\n");
  const auto is_about = [&](const std::string& topic) {
    return [&linked, topic](const auto& seen) { return linked.rules[seen.topic].name == topic; };
  };
  const auto begins_to_speak = [&] {
    for (int i = 0; i < 100; ++i) {
      speaking.publish(ros2::msg::Float64{1});
      if (linked.wait<SampleArrived>(is_about("/speaking"), 200ms)) return true;
    }
    return false;
  };
  ASSERT_TRUE(begins_to_speak());
  linked.link->prove_listening(live_now() + rtps::kPatience);
  EXPECT_TRUE(linked.wait<ListenerKnown>(is_about("/silent")));
  EXPECT_FALSE(linked.has_seen<ListenerKnown>(is_about("/speaking"))) << "no request is needed";
  silent.publish(ros2::msg::Float64{1});
  EXPECT_TRUE(linked.wait<SampleArrived>(is_about("/silent"))) << "the first one arrives";
}

TEST(Link, TakesTheListenerForUnknownToANodeThatDoesNotAnswer) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  const auto hung_topic = robot.publisher<ros2::msg::Float64>("/of_hung");
  ros2::LiveContext context(domain.options());
  std::unique_ptr<ros2::LifecycleNode> other;
  context.run([&] {
    other = std::move(*ros2::LifecycleNode::create(*context, {"/", "other"}, {}));
  });
  const auto well_topic = other->node().create_publisher<ros2::msg::Float64>("/of_well");
  Linked linked(domain, {},
                "COMPONENT robot NODE /robot\nRULE R\nPOLICIES ERROR\n"
                "TRIGGER age(/of_hung) > 1h || age(/of_well) > 1h\n"
                "STRATEGY s 50 10\nADAPTATION robot restart 5\n");
  const auto is_about = [&](const std::string& topic) {
    return [&linked, topic](const auto& seen) { return linked.rules[seen.topic].name == topic; };
  };
  std::promise<void> goes_on;
  std::promise<void> hangs;
  std::thread hung([&] {
    robot.context.run([&] {
      hangs.set_value();
      goes_on.get_future().wait();
    });
  });
  hangs.get_future().wait();
  linked.link->prove_listening(live_now() + rtps::kPatience);
  EXPECT_TRUE(linked.wait<ListenerKnown>(is_about("/of_well")));
  EXPECT_FALSE(linked.has_seen<ListenerKnown>(is_about("/of_hung"))) << "its callback hangs";
  goes_on.set_value();
  hung.join();
  EXPECT_TRUE(linked.wait<ListenerKnown>(is_about("/of_hung")));
}

TEST(Link, IsANodeThatOthersSee) {
  const ros2::TestDomain domain;
  ros2::LiveContext other(domain.options());
  Linked linked(domain);
  EXPECT_TRUE(other.sees_node("/culprit"));
  EXPECT_TRUE(other.sees_endpoint("/culprit", EndpointKind::kPublisher, "/diagnostics"));
  EXPECT_TRUE(other.sees_endpoint("/culprit", EndpointKind::kPublisher, "/rosout"));
  EXPECT_TRUE(other.sees_endpoint("/culprit", EndpointKind::kServer, "/culprit/get_parameters"));
}

TEST(Link, PublishesWhatItIsToldAgainAndAgain) {
  const ros2::TestDomain domain;
  ros2::LiveContext other(domain.options());
  ros2::NodeEntry listener(*other, {"/", "listener"});
  rtps::EventLog<ros2::msg::DiagnosticArray> heard;
  auto subscription = ros2::Subscription::create(
      listener, "/diagnostics", ros2::msg::DiagnosticArray::kType, rtps::qos::kDefault,
      [&](rtps::ByteView payload) {
        if (auto array = rtps::decode<ros2::msg::DiagnosticArray>(payload)) heard.add(*array);
      });
  ASSERT_TRUE(subscription);
  Linked linked(domain);
  linked.link->publish({{"culprit: R", 2, "a person must look", {{"attempts", "6"}}}});
  ASSERT_TRUE(heard.wait_for_count(2)) << "a late joiner must receive it too";
  const ros2::msg::DiagnosticStatus status = heard.all()[0].status.at(0);
  EXPECT_EQ(status.level, 2);
  EXPECT_EQ(status.name, "culprit: R");
  EXPECT_EQ(status.values.at(0).value, "6");
}

// A type that is not compiled in: two .msg files, one of which names the other.
TEST(Link, ReadsFieldsOfMessagesThatFilesDefine) {
  const std::filesystem::path folder = testing::TempDir() + "culprit_messages";
  std::filesystem::create_directories(folder / "my_msgs/msg");
  std::ofstream(folder / "my_msgs/msg/Cell.msg") << "string name\nfloat32 charge\n";
  std::ofstream(folder / "my_msgs/msg/Battery.msg") << "std_msgs/Header header\nCell[] cells\n";
  rtps::CdrWriter payload;
  payload(ros2::msg::Header{{1, 2}, "base"}, std::uint32_t{2}, std::string("left"), 0.25F,
          std::string("right"), 0.75F);
  const rtps::Bytes bytes = payload.take();

  const ros2::TestDomain domain;
  Robot robot(domain);
  const auto publisher = ros2::RawPublisher::create(robot.managed->node().entry(), "/battery",
                                                    "my_msgs/msg/Battery", {});
  ASSERT_TRUE(publisher);
  Linked linked(domain, folder);
  ASSERT_TRUE(linked.sees("/robot"));
  ros2::Timer timer(robot.context->executor(), 20ms, [&] { (*publisher)->publish(bytes); });
  EXPECT_EQ(linked.reads("charge"), Value(0.75));
  std::filesystem::remove_all(folder);
}

TEST(Link, ReadsWhatWasLatchedBeforeItCame) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  const auto publisher = ros2::RawPublisher::create(
      robot.managed->node().entry(), "/visibility", "std_msgs/msg/Float64",
      {.durability = rtps::Durability::kTransientLocal, .depth = 1});
  ASSERT_TRUE(publisher);
  (*publisher)->publish(rtps::encode(ros2::msg::Float64{3.5}));
  Linked linked(domain);
  EXPECT_EQ(linked.reads("visibility"), Value(3.5));
  EXPECT_FALSE(linked.has_seen<SampleArrived>([](const SampleArrived&) { return true; }))
      << "earlier samples are no beats of its rhythm";
  (*publisher)->publish(rtps::encode(ros2::msg::Float64{4.5}));
  EXPECT_TRUE(linked.wait<SignalRead>([](const SignalRead& r) { return r.value == Value(4.5); }));
}

TEST(Link, HearsTopicsWithKeys) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  const auto publisher = ros2::RawPublisher::create(
      robot.managed->node().entry(), "/visibility", "std_msgs/msg/Float64",
      {.durability = rtps::Durability::kTransientLocal, .keys = rtps::Keys::kSome});
  ASSERT_TRUE(publisher);
  Linked linked(domain);
  ASSERT_TRUE(linked.sees("/robot"));
  double value = 0;
  ros2::Timer timer(robot.context->executor(), 20ms,
                    [&] { (*publisher)->publish(rtps::encode(ros2::msg::Float64{value += 1})); });
  EXPECT_TRUE(linked.reads("visibility"));
  EXPECT_TRUE(linked.wait<SampleArrived>([](const SampleArrived&) { return true; }));
}

TEST(Link, TellsOfANodeThatHasItsName) {
  const ros2::TestDomain domain;
  ros2::LiveContext other(domain.options());
  ros2::NodeEntry namesake(*other, {"/", "culprit"});
  Linked linked(domain);
  EXPECT_TRUE(linked.wait<LinkTrouble>([](const LinkTrouble& t) {
    return t.text.find("another node is called /culprit, too") != std::string::npos &&
           t.text.find("--node-name") != std::string::npos;
  }));
}

TEST(Link, ReadsFieldsRhythmsAndDiagnostics) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  auto visibility = robot.publisher<ros2::msg::Float64>("/visibility");
  auto diagnostics = robot.publisher<ros2::msg::DiagnosticArray>("/diagnostics");
  Linked linked(domain);
  ASSERT_TRUE(linked.sees("/robot"));
  // Volatile data: published until it arrives.
  ros2::Timer timer(robot.context->executor(), 20ms, [&] {
    visibility.publish({2.5});
    ros2::msg::DiagnosticStatus motor{1, "motor", "", "m1", {{"temperature", "60.5"}}};
    ros2::msg::DiagnosticStatus base{0, "base", "", "robot", {{"speed", "1"}}};
    ros2::msg::DiagnosticArray array;
    array.status = {motor, base};
    diagnostics.publish(array);
  });
  EXPECT_EQ(linked.reads("visibility"), Value(2.5));
  EXPECT_EQ(linked.reads("temperature"), Value(std::string("60.5"))) << "by the status's name";
  EXPECT_EQ(linked.reads("robot_speed"), Value(std::string("1")))
      << "not declared: hardware id and key";
  EXPECT_TRUE(linked.wait<SampleArrived>([](const SampleArrived&) { return true; }));
  EXPECT_TRUE(linked.wait<DiagnosticRead>([](const DiagnosticRead& d) { return d.level == 1; }));
  const auto trouble = linked.wait<LinkTrouble>(
      [](const LinkTrouble& t) { return t.text.find("signal wrong") != std::string::npos; });
  EXPECT_TRUE(trouble) << "a missing field must be reported";
  EXPECT_FALSE(linked.has_seen<StatusHeard>([](const StatusHeard&) { return true; }))
      << "all that the rules name was found";
}

TEST(Link, TellsWhichOfTwoNodesPublished) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  ros2::LiveContext context(domain.options());
  std::unique_ptr<ros2::LifecycleNode> other;
  context.run([&] {
    other = std::move(*ros2::LifecycleNode::create(*context, {"/", "other"}, {}));
  });
  auto of_robot = robot.publisher<ros2::msg::Float64>("/scan");
  auto of_other = std::move(*other->node().create_publisher<ros2::msg::Float64>("/scan"));
  Linked linked(domain, {},
                "COMPONENT robot NODE /robot\nCOMPONENT other NODE /other\nRULE R\n"
                "POLICIES ERROR REPORT\nTRIGGER age(/scan FROM robot) > 1h || "
                "age(/scan FROM other) > 1h || age(/scan) > 1h\n");
  const auto is_of = [](std::size_t topic) {
    return [topic](const SampleArrived& seen) { return seen.topic == TopicId(topic); };
  };
  ros2::Timer timer(robot.context->executor(), 20ms,
                    [&] { of_robot.publish(ros2::msg::Float64{1}); });
  EXPECT_TRUE(linked.wait<SampleArrived>(is_of(0)));
  EXPECT_TRUE(linked.wait<SampleArrived>(is_of(2))) << "the signal of all publishers has it, too";
  EXPECT_FALSE(linked.has_seen<SampleArrived>(is_of(1)));
  ros2::Timer another(context->executor(), 20ms, [&] { of_other.publish(ros2::msg::Float64{1}); });
  EXPECT_TRUE(linked.wait<SampleArrived>(is_of(1)));
}

TEST(Link, ReadsTheGoalsOfAnAction) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  auto status = robot.publisher<ros2::msg::GoalStatusArray>("/go/_action/status");
  Linked linked(domain, {},
                "COMPONENT robot NODE /robot\nRULE R\nPOLICIES ERROR REPORT\n"
                "TRIGGER !alive(robot) || goals(/go, aborted, 60s) > 1 || goal_age(/go) > 1h\n");
  ros2::msg::GoalStatusArray array;
  array.status_list.resize(1);
  array.status_list[0].status = 6;
  ros2::Timer timer(robot.context->executor(), 20ms, [&] { status.publish(array); });
  const auto seen = linked.wait<GoalsSeen>([](const GoalsSeen&) { return true; });
  ASSERT_TRUE(seen);
  ASSERT_EQ(seen->goals.size(), 1u);
  EXPECT_EQ(seen->goals[0].status, GoalStatus::kAborted);
}

TEST(Link, CountsTheLogOfAComponent) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  auto log = robot.publisher<ros2::msg::Log>("/rosout");
  Linked linked(domain, {},
                "COMPONENT robot NODE /robot\nRULE R\nPOLICIES ERROR REPORT\n"
                "TRIGGER !alive(robot) || logs(robot, ERROR, 60s) > 3\n");
  ros2::msg::Log line;
  line.name = "robot.driver";
  ros2::Timer timer(robot.context->executor(), 20ms, [&] {
    line.level = line.level == 40 ? 30 : 40;
    log.publish(line);
  });
  const auto seen = linked.wait<LogSeen>([](const LogSeen&) { return true; });
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->component, ComponentId(0));
  EXPECT_FALSE(
      linked.has_seen<LogSeen>([](const LogSeen& s) { return s.level < LogLevel::kError; }));
}

TEST(Link, AsksEachNodeOfAProcessAndMeasuresIt) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  std::unique_ptr<ros2::LifecycleNode> costmap;
  robot.context.run([&] {
    costmap = std::move(*ros2::LifecycleNode::create(*robot.context, {"/", "costmap"}, {}));
  });
  Linked linked(domain, {},
                "COMPONENT robot NODE /robot /costmap\nRULE R\nPOLICIES ERROR REPORT\n"
                "TRIGGER !alive(robot) || cpu(robot) > 90 || memory(robot) > 1000000\n");
  EXPECT_TRUE(linked.wait<Probed>([](const Probed& p) { return p.answered && p.node == 1; }));
  const auto usage = linked.wait<UsageSeen>([](const UsageSeen&) { return true; });
  ASSERT_TRUE(usage);
  EXPECT_GE(usage->cores, 0);
  EXPECT_GT(usage->mib, 1);
  EXPECT_FALSE(linked.has_seen<LifecycleRead>(
      [](const LifecycleRead& r) { return r.component != ComponentId(0); }));
}

// If many messages come each second, most lie in their socket for a moment. A topic timeout counts
// from the arrival of the last one.
TEST(Link, KnowsWhenMessagesCameThatItReadsLater) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  auto speaking = robot.publisher<ros2::msg::Float64>("/speaking");
  Linked linked(domain, {}, R"(
COMPONENT robot NODE /robot
RULE R
  POLICIES ERROR
  TRIGGER age(/speaking) > 10s
    STRATEGY s 50 10
      ADAPTATION robot restart 5
)");
  ASSERT_TRUE(linked.sees("/robot"));
  std::vector<Time> said;
  const auto is_about_it = [](const SampleArrived&) { return true; };
  const Time end = later(live_now(), rtps::kPatience);
  do {
    speaking.publish({1.0});
  } while (!linked.wait<SampleArrived>(is_about_it, 20ms) && live_now() < end);
  // More than wake the thread that receives.
  for (int i = 0; i < 150; ++i) {
    said.push_back(live_now());
    speaking.publish({1.0});
    said.push_back(live_now());
    std::this_thread::sleep_for(10ms);
  }
  const auto comes_after = [&](Time time) {
    return std::ranges::any_of(linked.seen(), [&](const Observation& each) {
      return std::holds_alternative<SampleArrived>(each.what) && each.at >= time;
    });
  };
  while (!comes_after(said[said.size() - 2]) && live_now() < end)
    (void)linked.wait<LinkTrouble>([](const LinkTrouble&) { return false; }, 20ms);
  int between = 0;  // two messages, by the publisher's count
  for (const Observation& each : linked.seen()) {
    if (!std::holds_alternative<SampleArrived>(each.what) || each.at < said.front()) continue;
    constexpr Duration kClocks = 1ms;  // of the kernel and of us
    const auto next = std::ranges::upper_bound(said, each.at + kClocks);
    const bool is_while_it_was_said = (next - said.begin()) % 2 == 1;
    const bool is_just_after = next != said.begin() && each.at - *(next - 1) <= 2 * kClocks;
    between += is_while_it_was_said || is_just_after ? 0 : 1;
  }
  EXPECT_LE(between, 15) << "but for a few, when somebody else had the processor";
}

// For misspelled names: the existing names are reported once, and only while something is missing.
TEST(Link, TellsWhatDiagnosticsAndParametersAreReallyCalled) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  auto diagnostics = robot.publisher<ros2::msg::DiagnosticArray>("/diagnostics");
  Linked linked(domain, {},
                "COMPONENT robot NODE /robot\nSIGNAL hot DIAGNOSTIC moter KEY temperature\n"
                "RULE R\nPOLICIES ERROR\nTRIGGER hot > 50 || parameter(robot, gian) > 2\n"
                "STRATEGY s 50 10\nADAPTATION robot restart 5\n");
  ASSERT_TRUE(linked.sees("/robot"));
  ros2::Timer timer(robot.context->executor(), 20ms, [&] {
    ros2::msg::DiagnosticArray array;
    array.status = {{1, "motor", "", "m1", {{"temperature", "60.5"}}},
                    {1, std::string(300, 'x'), "", "", {}}};
    diagnostics.publish(array);
  });
  const auto heard =
      linked.wait<StatusHeard>([](const StatusHeard& s) { return s.name == "motor"; });
  ASSERT_TRUE(heard);
  EXPECT_EQ(heard->hardware_id, "m1");
  EXPECT_EQ(heard->keys, std::vector<std::string>{"temperature"});
  const auto listed = linked.wait<ParametersListed>([](const ParametersListed&) { return true; });
  ASSERT_TRUE(listed);
  EXPECT_NE(std::find(listed->names.begin(), listed->names.end(), "gain"), listed->names.end());
  EXPECT_FALSE(linked.has_seen<StatusHeard>([](const StatusHeard& s) { return s.name != "motor"; }))
      << "no strangers' endless names";
}

// A best effort reader passes over what it takes for old.
TEST(Link, HearsAWriterAgainWhoseNumbersWereForged) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  std::mutex mutex;
  std::optional<rtps::Guid> writer;
  std::uint16_t port = 0;
  std::atomic<int> published = 0;
  auto visibility = robot.publisher<ros2::msg::Float64>("/visibility");
  ros2::Timer timer(robot.context->executor(), 10ms,
                    [&] { visibility.publish({static_cast<double>(++published)}); });
  const auto spy =
      ros2::Participant::create(domain.options(), [&](const ros2::DiscoveryEvent& event) {
        const std::lock_guard lock(mutex);
        const auto* endpoint = std::get_if<rtps::EndpointInfo>(&event);
        if (endpoint != nullptr && endpoint->topic == "rt/visibility" &&
            !endpoint->guid.is_reader())
          writer = endpoint->guid;
        const auto* info = std::get_if<ros2::ParticipantInfo>(&event);
        const bool is_robot = info != nullptr && info->guid == robot.context->participant().guid();
        if (info != nullptr && !is_robot && !info->metatraffic.empty())
          port = info->metatraffic.front().port;
      });
  ASSERT_TRUE(spy) << spy.error();
  Linked linked(domain);
  ASSERT_TRUE(linked.reads("visibility"));
  for (const Time end = live_now() + rtps::kPatience; live_now() < end;) {
    const std::lock_guard lock(mutex);
    if (writer && port != 0) break;
  }
  ASSERT_TRUE(writer && port != 0);
  // Each a little ahead of the last, which nothing can object to: minutes of what it publishes. The socket is of
  // the robot's process.
  const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  to.sin_port = htons(static_cast<std::uint16_t>(port + 1));
  for (int i = 1; i <= 100; ++i) {
    const rtps::TestDatagram forged =
        rtps::TestDatagram(writer->prefix()).data(*writer, published + i * std::int64_t{250});
    sendto(socket, forged.bytes().data(), forged.bytes().size(), 0,
           reinterpret_cast<sockaddr*>(&to), sizeof to);
  }
  EXPECT_TRUE(linked.wait<LinkTrouble>([](const LinkTrouble& trouble) {
    return trouble.text.find("cannot be put together") != std::string::npos;
  })) << "it was not deaf, so this proves nothing";
  const double now = published;
  EXPECT_TRUE(linked.wait<SignalRead>([&](const SignalRead& read) {
    const auto* value = std::get_if<double>(&read.value);
    return linked.rules[read.signal].name == "visibility" && value != nullptr && *value > now;
  }));
  close(socket);
}

TEST(Link, SurvivesHostileMessages) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  auto& entry = robot.managed->node().entry();
  auto diagnostics = std::move(*ros2::RawPublisher::create(
      entry, "/diagnostics", ros2::msg::DiagnosticArray::kType, rtps::qos::kDefault));
  auto visibility = std::move(*ros2::RawPublisher::create(
      entry, "/visibility", ros2::msg::Float64::kType, rtps::qos::kDefault));
  auto honest = robot.publisher<ros2::msg::Float64>("/visibility");
  Linked linked(domain);
  ASSERT_TRUE(linked.sees("/robot"));
  const rtps::Bytes cut = {0, 1, 0, 0, 0xff};
  const rtps::Bytes huge = {0, 1, 0, 0, 0, 0, 0, 0, 0,    0,    0,    0,
                            1, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 0xff, 0xff};
  ros2::Timer timer(robot.context->executor(), 20ms, [&] {
    for (const rtps::Bytes& payload : {cut, huge}) {
      diagnostics->publish(payload);
      visibility->publish(payload);
    }
    honest.publish({0.5});
  });
  EXPECT_TRUE(linked.wait<SignalRead>([](const SignalRead& r) { return r.value == Value(0.5); }));
}

TEST(Link, SteersLifecycleAndParameters) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  Linked linked(domain);
  EXPECT_EQ(linked.ask(ChangeLifecycle{Transition::kConfigure}).outcome, Outcome::kDone);
  EXPECT_EQ(linked.ask(ChangeLifecycle{Transition::kActivate}).outcome, Outcome::kDone);
  const Reply state = linked.ask(ReadLifecycle{});
  EXPECT_EQ(std::get<Lifecycle>(state.value), Lifecycle::kActive);
  EXPECT_EQ(linked.ask(ChangeLifecycle{Transition::kConfigure}).outcome, Outcome::kRefused);

  EXPECT_EQ(linked.ask(SetParameter{"gain", Value(3.0)}).outcome, Outcome::kDone);
  EXPECT_EQ(std::get<Value>(linked.ask(ReadParameter{"gain"}).value), Value(3.0));
  EXPECT_TRUE(linked.wait<ParameterRead>([](const ParameterRead& r) {
    return r.value == Value(3.0);
  })) << "announced";
}

// The helper is killed at any moment: each command has one reply, and the node was asked once at most.
TEST(Link, DoesNothingTwiceAndForgetsNothingWhenItsHelperIsKilled) {
  constexpr int kKills = 3;
  const ros2::TestDomain domain;
  const test::TestFolder folder;
  Robot robot(domain);
  std::mutex mutex;
  std::map<double, int> set;
  robot.context.run([&] {
    robot.managed->node().parameters().on_set(
        [&](std::span<const ros2::msg::Parameter> parameters) -> Expected<void> {
          const std::lock_guard lock(mutex);
          for (const ros2::msg::Parameter& each : parameters) ++set[each.value.double_value];
          return {};
        });
  });
  const std::string pids = (folder / "pids").string();
  Linked linked(domain, {}, kRules, helper_of(domain, pids));
  EXPECT_TRUE(linked.sees("/robot"));
  const auto started = [&] {
    std::ifstream file(pids);
    return std::vector<int>{std::istream_iterator<int>(file), {}};
  };
  std::mt19937 random(7);
  for (int i = 0; i < kKills; ++i) {
    const auto before = started();
    std::thread killer([&, after = std::chrono::milliseconds(random() % 30)] {
      std::this_thread::sleep_for(after);
      kill(before.back(), SIGKILL);
    });
    const double wished = 100.0 + i;
    const Reply reply = linked.ask(SetParameter{"gain", Value(wished)}, 2s);
    killer.join();
    while (started().size() == before.size()) std::this_thread::sleep_for(10ms);
    const Reply now = linked.ask(ReadParameter{"gain"});
    ASSERT_EQ(now.outcome, Outcome::kDone) << now.text;
    const std::lock_guard lock(mutex);
    EXPECT_LE(set[wished], 1);
    EXPECT_EQ(set[wished] == 1, std::get<Value>(now.value) == Value(wished));
    EXPECT_TRUE(reply.outcome != Outcome::kDone || set[wished] == 1);
  }
  EXPECT_FALSE(linked.has_seen<NodeVanished>([](const NodeVanished&) { return true; }));
}

TEST(Link, KnowsTheStateOfANodeWhoseTransitionsItDoesNotHearOf) {
  const ros2::TestDomain domain;
  ros2::LiveContext context(domain.options());
  std::unique_ptr<ros2::Node> node;
  std::vector<std::unique_ptr<ros2::ServiceServer>> services;
  std::atomic<std::uint8_t> state = static_cast<std::uint8_t>(LifecycleState::kInactive);
  context.run([&] {
    node = std::move(*ros2::Node::create(*context, {"/", "robot"}));
    services.push_back(std::move(*node->create_service<ros2::srv::ChangeState>(
        "~/change_state", [](const ros2::srv::ChangeState::Request&) {
          return ros2::srv::ChangeState::Response{false};
        })));
    services.push_back(std::move(*node->create_service<ros2::srv::GetState>(
        "~/get_state", [&](const ros2::srv::GetState::Request&) {
          return ros2::srv::GetState::Response{{state, ""}};
        })));
  });
  Linked linked(domain);
  const auto reads = [&](Lifecycle expected) {
    return linked.wait<LifecycleRead>([&](const LifecycleRead& r) { return r.state == expected; })
        .has_value();
  };
  EXPECT_TRUE(reads(Lifecycle::kInactive));
  state = static_cast<std::uint8_t>(LifecycleState::kActive);
  EXPECT_TRUE(reads(Lifecycle::kActive));
  context.run([&] { services.clear(); });
}

TEST(Link, SaysWhyAParameterCannotBe) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  Linked linked(domain);
  const Reply none = linked.ask(ReadParameter{"volume"});
  EXPECT_EQ(none.outcome, Outcome::kRefused);
  EXPECT_EQ(none.text, "there is no parameter volume");
  EXPECT_EQ(linked.ask(SetParameter{"volume", Value(1.0)}).outcome, Outcome::kRefused);
  EXPECT_EQ(linked.ask(SetParameter{"gain", Value(std::string("x"))}).outcome, Outcome::kRefused);
}

TEST(Link, ReadsAndSetsParametersThatAreLists) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  Linked linked(domain);
  const auto reads = [&] {
    const Reply reply = linked.ask(ReadParameter{"names"});
    const auto* value = std::get_if<Value>(&reply.value);
    return value != nullptr ? std::get<std::string>(*value) : reply.text;
  };
  const auto set = [&](const std::string& text) {
    return linked.ask(SetParameter{"names", Value(text)});
  };
  EXPECT_EQ(reads(), "[]");
  EXPECT_EQ(set("[left, \"the right one\"]").outcome, Outcome::kDone);
  EXPECT_EQ(reads(), "[\"left\", \"the right one\"]");
  EXPECT_EQ(set("left").outcome, Outcome::kRefused);
  EXPECT_NE(set("[1, 2]").text.find("parameter names is a list"), std::string::npos);
  EXPECT_EQ(reads(), "[\"left\", \"the right one\"]");
}

TEST(Link, CallsRoutines) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  std::vector<std::unique_ptr<ros2::ServiceServer>> services;
  int calls = 0;
  robot.context.run([&] {
    ros2::Node& node = robot.managed->node();
    services.push_back(std::move(*node.create_service<ros2::srv::Trigger>(
        "~/calibrate", [&](const ros2::srv::Trigger::Request&) {
          ++calls;
          return ros2::srv::Trigger::Response{calls == 1, "call " + std::to_string(calls)};
        })));
    services.push_back(std::move(*node.create_service<ros2::srv::SetBool>(
        "~/light", [](const ros2::srv::SetBool::Request& request) {
          return ros2::srv::SetBool::Response{request.data, request.data ? "" : "it is day"};
        })));
  });
  Linked linked(domain);
  for (const char* name : {"/robot/calibrate", "/robot/light"}) {
    EXPECT_TRUE(
        linked.wait<EndpointAppeared>([&](const EndpointAppeared& e) { return e.name == name; }));
  }
  EXPECT_EQ(linked.ask(CallService{"/robot/calibrate"}).outcome, Outcome::kDone);
  const Reply second = linked.ask(CallService{"/robot/calibrate"});
  EXPECT_EQ(second.outcome, Outcome::kRefused);
  EXPECT_EQ(second.text, "call 2");
  EXPECT_EQ(linked.ask(CallService{"/robot/light", "data: true"}).outcome, Outcome::kDone);
  EXPECT_EQ(linked.ask(CallService{"/robot/light"}).text, "it is day") << "it was asked for false";
  const Reply mistyped = linked.ask(CallService{"/robot/light", "dat: true"});
  EXPECT_EQ(mistyped.outcome, Outcome::kRefused);
  EXPECT_NE(mistyped.text.find("did you mean 'data'?"), std::string::npos) << mistyped.text;
  EXPECT_EQ(linked.ask(CallService{"/robot/nothing"}).outcome, Outcome::kUnreachable);
}

TEST(Link, ChangesModes) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  std::vector<std::unique_ptr<ros2::ServiceServer>> services;
  std::string mode = "slow";
  robot.context.run([&] {
    ros2::Node& node = robot.managed->node();
    services.push_back(std::move(*node.create_service<ros2::srv::ChangeMode>(
        "~/change_mode", [&](const ros2::srv::ChangeMode::Request& r) {
          mode = r.mode_name;
          return ros2::srv::ChangeMode::Response{true};
        })));
    services.push_back(std::move(*node.create_service<ros2::srv::GetMode>(
        "~/get_mode",
        [&](const ros2::srv::GetMode::Request&) { return ros2::srv::GetMode::Response{mode}; })));
  });
  Linked linked(domain);
  EXPECT_EQ(linked.ask(ChangeMode{"fast"}).outcome, Outcome::kDone);
  EXPECT_EQ(std::get<Value>(linked.ask(ReadMode{}).value), Value(std::string("fast")));
}

TEST(Link, TellsSystemsFromNodesWhoseModesAManagerChanges) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  Linked linked(domain);
  ASSERT_TRUE(linked.sees("/robot"));
  const auto is = [](const char* name) {
    return [=](const auto& seen) { return seen.node == name; };
  };
  {
    ros2::LiveContext context(domain.options());
    std::unique_ptr<ros2::Node> manager;
    std::vector<std::unique_ptr<ros2::ServiceServer>> services;
    context.run([&] {
      manager = std::move(*ros2::Node::create(*context, {"/", "modes"}));
      for (const char* service : {"/robot/change_mode", "/absent/change_mode"})
        services.push_back(std::move(*manager->create_service<ros2::srv::ChangeMode>(
            service, [](const ros2::srv::ChangeMode::Request&) {
              return ros2::srv::ChangeMode::Response{true};
            })));
    });
    EXPECT_TRUE(linked.sees("/absent")) << "a system is there with its manager";
    context.run([&] {
      services.clear();
      manager.reset();
    });
  }
  EXPECT_TRUE(linked.wait<NodeVanished>(is("/modes")));
  EXPECT_TRUE(linked.has_seen<NodeVanished>(is("/absent")));
  EXPECT_FALSE(linked.has_seen<NodeVanished>(is("/robot"))) << "a node is there by itself";
}

TEST(Link, AnswersForNodesThatAreNotThere) {
  const ros2::TestDomain domain;
  Linked linked(domain);
  const Reply reply = linked.ask(ReadLifecycle{}, 300ms, ComponentId(1));
  EXPECT_EQ(reply.outcome, Outcome::kUnreachable);
  EXPECT_EQ(reply.text, "/absent offers no lifecycle_msgs/srv/GetState that answers");
}

TEST(Link, AnswersForServicesThatNeverAnswer) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  Linked linked(domain);
  EXPECT_EQ(linked.ask(ReadLifecycle{}).outcome, Outcome::kDone);
  EXPECT_EQ(linked.ask(ChangeLifecycle{Transition::kConfigure}).outcome, Outcome::kDone);
  std::promise<void> hang;
  ros2::TaskGroup tasks(robot.context->executor());
  tasks.post([&] { hang.get_future().wait(); });  // the node's only thread
  EXPECT_EQ(linked.ask(ReadLifecycle{}, 300ms).outcome, Outcome::kTimedOut);
  EXPECT_EQ(linked.ask(ChangeLifecycle{Transition::kActivate}, 300ms).outcome, Outcome::kTimedOut);
  hang.set_value();
}

TEST(Link, AnswersForRepliesOfTheWrongType) {
  const ros2::TestDomain domain;
  ros2::LiveContext liar(domain.options());
  ros2::NodeEntry entry(*liar, {"/", "robot"});
  // Named and typed as the real service, but its answers are none of its responses.
  auto server = ros2::ServiceServer::create(
      entry, {"/robot/get_state", std::string(ros2::srv::GetState::kType)}, rtps::qos::kServices,
      [](rtps::ByteView) { return rtps::Bytes{0, 1, 0, 0, 1, 0, 0, 0, 0xff, 0xff, 0xff, 0x7f}; });
  ASSERT_TRUE(server);
  Linked linked(domain);
  const Reply reply = linked.ask(ReadLifecycle{});
  EXPECT_EQ(reply.outcome, Outcome::kRefused);
  EXPECT_EQ(reply.text, "the answer is no lifecycle_msgs/srv/GetState response");
}

TEST(Link, LosesSightOfANodeThatLeaves) {
  const ros2::TestDomain domain;
  Linked linked(domain);
  {
    Robot robot(domain);
    ASSERT_TRUE(linked.sees("/robot"));
  }
  EXPECT_TRUE(linked.wait<NodeVanished>([](const NodeVanished& n) { return n.node == "/robot"; }));
}

// ---- simulated time, without an option

void use_simulated_time(Robot& robot) {
  robot.context.run([&] {
    const ros2::msg::Parameter use{"use_sim_time", ros2::to_parameter_value(Value(true))};
    EXPECT_TRUE(robot.managed->node().parameters().set(std::array{use}).successful);
  });
}

// A node of the robot's process that publishes /clock, fifty times a second.
struct ClockNode {
  explicit ClockNode(Robot& robot) : context(robot.context) {
    context.run([&] {
      node = std::move(*ros2::LifecycleNode::create(*context, {"/", "simulator"}, {}));
      publisher = std::move(*ros2::RawPublisher::create(
          node->node().entry(), SimulatedClock::kTopic, "rosgraph_msgs/msg/Clock", {}));
      ticks = std::make_unique<ros2::Timer>(context->executor(), 20ms, [this] {
        if (runs)
          publisher->publish(rtps::encode(ros2::msg::Time{1, static_cast<std::uint32_t>(++shown)}));
      });
    });
  }
  ~ClockNode() {
    context.run([&] {
      ticks.reset();
      publisher.reset();
      node.reset();
    });
  }
  ros2::LiveContext& context;
  std::unique_ptr<ros2::LifecycleNode> node;
  std::unique_ptr<ros2::RawPublisher> publisher;
  std::unique_ptr<ros2::Timer> ticks;
  std::atomic<bool> runs = true;
  std::int32_t shown = 0;
};

bool is_followed(Linked& linked) {
  return linked
      .wait<LinkTrouble>([](const LinkTrouble& told) {
        return told.text.find("/robot uses simulated time (use_sim_time): culprit follows") == 0;
      })
      .has_value();
}

TEST(Link, FollowsTheClockOfNodesThatUseSimulatedTimeAndSaysSo) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  use_simulated_time(robot);
  ClockNode clock(robot);
  Linked linked(domain);
  EXPECT_TRUE(is_followed(linked));
  clock.runs = false;
  for (const Time end = live_now() + rtps::kPatience; !linked.link->is_paused();) {
    ASSERT_LT(live_now(), end);
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_EQ(linked.link->doubt(), "the simulated time stands still");
}

// It loads a model before it spins, for longer than one request waits.
TEST(Link, AsksANodeThatLoadsUntilItAnswers) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  use_simulated_time(robot);
  ClockNode clock(robot);
  std::promise<void> loaded;
  ros2::TaskGroup tasks(robot.context->executor());
  tasks.post([&] { loaded.get_future().wait(); });
  Linked linked(
      domain, {},
      "COMPONENT robot NODE /robot LAUNCH \"robot\"\nRULE R\nPOLICIES ERROR\n"
      "TRIGGER parameter(robot, gain) > 2\nSTRATEGY s 50 10\nADAPTATION robot redeploy 5\n");
  EXPECT_TRUE(linked.sees("/robot"));
  std::this_thread::sleep_for(6s);
  EXPECT_FALSE(linked.has_seen<ParameterRead>([](const ParameterRead&) { return true; }));
  loaded.set_value();
  EXPECT_TRUE(
      linked.wait<ParameterRead>([](const ParameterRead& r) { return r.value == Value(1.5); }));
  EXPECT_TRUE(linked.wait<LifecycleRead>(
      [](const LifecycleRead& r) { return r.state == Lifecycle::kUnconfigured; }));
  EXPECT_TRUE(linked.wait<Probed>([](const Probed& p) { return p.answered; }));
  EXPECT_TRUE(is_followed(linked));
}

TEST(Link, HoldsOnlyTheNodesThatUseSimulatedTimeBesideOthers) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  use_simulated_time(robot);
  ClockNode clock(robot);
  Linked linked(domain, {}, "COMPONENT robot NODE /robot\nCOMPONENT simulator NODE /simulator\n");
  EXPECT_TRUE(is_followed(linked));
  const auto is_told = [&](bool is_held) {
    return linked
        .wait<TimeHeld>([&](const TimeHeld& t) {
          return t.component == ComponentId(0) && t.is_held == is_held;
        })
        .has_value();
  };
  clock.runs = false;
  EXPECT_TRUE(is_told(true));
  EXPECT_FALSE(linked.link->is_paused()) << "the simulator itself is judged";
  EXPECT_TRUE(linked.wait<LinkTrouble>([](const LinkTrouble& told) {
    return told.text.find("the simulated time stands still") == 0;
  }));
  clock.runs = true;
  EXPECT_TRUE(is_told(false));
}

// As after `ros2 param set /robot use_sim_time true`: a node then subscribes to /clock.
TEST(Link, LearnsThatANodeUsesSimulatedTimeFromNowOn) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  ClockNode clock(robot);
  Linked linked(domain, {}, "COMPONENT robot NODE /robot\nCOMPONENT simulator NODE /simulator\n");
  ASSERT_TRUE(linked.sees("/robot"));
  std::this_thread::sleep_for(2s);  // it has said that its time is the real one
  clock.runs = false;
  use_simulated_time(robot);
  std::unique_ptr<ros2::RawSubscription> follows;
  robot.context.run([&] {
    auto made = ros2::RawSubscription::create(robot.managed->node().entry(), SimulatedClock::kTopic,
                                              "rosgraph_msgs/msg/Clock", {},
                                              ros2::PayloadUse::kWhole, [](const ros2::Sample&) {});
    ASSERT_TRUE(made);
    follows = std::move(*made);
  });
  EXPECT_TRUE(linked.wait<TimeHeld>([&](const TimeHeld& t) { return t.is_held; }));
  robot.context.run([&] {
    const ros2::msg::Parameter real{"use_sim_time", ros2::to_parameter_value(Value(false))};
    EXPECT_TRUE(robot.managed->node().parameters().set(std::array{real}).successful);
    follows.reset();
  });
  EXPECT_TRUE(linked.wait<TimeHeld>([&](const TimeHeld& t) { return !t.is_held; }));
}

TEST(Link, SaysThatNodesWaitForAClockThatNobodyPublishes) {
  const ros2::TestDomain domain;
  Robot robot(domain);
  use_simulated_time(robot);
  Linked linked(domain);
  EXPECT_TRUE(linked.wait<LinkTrouble>([](const LinkTrouble& told) {
    return told.text.find("no node publishes /clock") != std::string::npos;
  }));
  EXPECT_FALSE(linked.link->is_paused()) << "what does not exist is not followed";
}

}  // namespace
}  // namespace culprit::link
