#include "owners/composed_nodes.h"

#include <csignal>
#include <sys/wait.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "base/test_folder.h"
#include "language/checker.h"
#include "owners/spawn.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kRules = R"(
COMPONENT box      NODE /box      LAUNCH "box"
COMPONENT detector NODE /detector IN /box PLUGIN peer::Node
COMPONENT tracker  NODE /tracker  IN /box PLUGIN peer::Node
RULE Gone
  POLICIES ERROR
  TRIGGER !alive(detector) || !alive(tracker)
    STRATEGY both 90 10
      ADAPTATION detector redeploy 5
      ADAPTATION tracker redeploy 5
)";
const ComponentId kBox{0};
const ComponentId kDetector{1};
const ComponentId kTracker{2};

// One container, whose processes are real and do nothing, and all that it is asked for.
class Robot : public ContainerServices {
 public:
  Robot() {
    composed = std::make_unique<ComposedNodes>(
        rules, std::vector{kBox, kDetector, kTracker}, *this,
        ComposedNodes::ContainerOwner{[this](CommandId id, ComponentId) {
                                        begin({});
                                        tell(Reply{id, Outcome::kDone, {}, ""});
                                      },
                                      [this](CommandId id, ComponentId, int, Ending, Hangs) {
                                        end();
                                        tell(Reply{id, Outcome::kDone, {}, ""});
                                      }},
        inbox);
    asked = composed.get();
  }
  ~Robot() override {
    composed.reset();
    if (pid == 0) return;
    kill(pid, SIGKILL);
    waitpid(pid, nullptr, 0);
  }

  void begin(const std::vector<std::string>& loaded) {
    const auto started =
        spawn({.arguments = {"sleep", "300"}, .search_first = {}, .log = folder.path() / "log"});
    ASSERT_TRUE(started) << started.error();
    pid = *started;
    appears("/box");
    for (const std::string& each : loaded) {
      nodes.push_back({each, ++last});
      appears(each);
    }
    did("begin");
  }
  void end() {
    kill(pid, SIGKILL);
    waitpid(pid, nullptr, 0);
    for (const LoadedNode& each : std::exchange(nodes, {})) vanishes(each.name);
    vanishes("/box");
    pid = 0;
    did("end");
  }
  void appears(const std::string& node) {
    asked->observe({live_now(), NodeAppeared{node, is_proven ? pid : 0}});
  }
  void vanishes(const std::string& node) { asked->observe({live_now(), NodeVanished{node}}); }
  void tell(const Reply& reply) { EXPECT_TRUE(asked->answered(reply)); }

  Reply start(ComponentId component) {
    const CommandId id{++commands};
    composed->start(id, component, 5s);
    return reply_to(id);
  }
  Reply stop(ComponentId component, Ending ending = Ending::kToStartAgain, int which = 0) {
    const CommandId id{++commands};
    composed->stop(id, component, which, ending, Hangs::kNo);
    return reply_to(id);
  }
  Reply reply_to(CommandId id) {
    for (const Time end = later(live_now(), 60s); live_now() < end;) {
      std::vector<Observation> seen;
      inbox.take(end, seen);
      for (const Observation& each : seen) {
        if (const auto* told = std::get_if<LinkTrouble>(&each.what)) did(told->text);
        const auto* reply = std::get_if<Reply>(&each.what);
        if (reply != nullptr && reply->command == id) return *reply;
      }
    }
    return {id, Outcome::kTimedOut, {}, "no reply"};
  }

  ContainerAnswer list(const std::string&, int, Duration) override {
    if (listing.outcome != Outcome::kDone) return listing;
    return {Outcome::kDone, "", nodes};
  }
  ContainerAnswer load(const Component& component, int of, Duration) override {
    EXPECT_EQ(of, pid);
    did("load " + component.name);
    if (loading.outcome != Outcome::kDone) return loading;
    nodes.push_back({loads_as.empty() ? component.node : loads_as, ++last});
    appears(nodes.back().name);
    return {Outcome::kDone, "", {nodes.back()}};
  }
  ContainerAnswer unload(const std::string&, int of, std::uint64_t id, Duration) override {
    EXPECT_EQ(of, pid);
    const auto node = std::find_if(nodes.begin(), nodes.end(),
                                   [&](const LoadedNode& each) { return each.id == id; });
    if (node == nodes.end()) return {Outcome::kRefused, "no such id"};
    did("unload " + node->name);
    if (unloading.outcome != Outcome::kDone) return unloading;
    const std::string name = node->name;
    nodes.erase(node);
    if (!keeps_nodes) vanishes(name);
    return {};
  }
  Expected<void> could_load(const Component&, int) const override {
    return is_loadable ? Expected<void>() : Expected<void>(Error{"no such class"});
  }
  std::optional<std::string> contest(const std::string&) const override { return contested; }
  void interrupt() override {}

  void did(const std::string& what) {
    const std::lock_guard lock(mutex);
    done.push_back(what);
  }
  std::vector<std::string> what_was_done() {
    const std::lock_guard lock(mutex);
    return std::exchange(done, {});
  }

  RuleSet rules = *check(Source("composed.rules", kRules)).rules;
  test::TestFolder folder;
  Inbox inbox;
  ContainerAnswer listing{};
  ContainerAnswer loading{};
  ContainerAnswer unloading{};
  std::string loads_as;
  std::optional<std::string> contested;
  bool keeps_nodes = false;
  bool is_loadable = true;
  bool is_proven = true;
  int pid = 0;
  std::uint64_t last = 0;
  std::uint64_t commands = 0;
  std::vector<LoadedNode> nodes;
  std::mutex mutex;
  std::vector<std::string> done;
  std::unique_ptr<ComposedNodes> composed;
  ComposedNodes* asked = nullptr;  // the same, also while it ends
};

TEST(ComposedNodes, OneIsUnloadedAndLoadedAgain) {
  Robot robot;
  robot.begin({"/detector", "/tracker"});
  EXPECT_EQ(robot.stop(kDetector).outcome, Outcome::kDone);
  const Reply loaded = robot.start(kDetector);
  EXPECT_EQ(loaded.outcome, Outcome::kDone) << loaded.text;
  EXPECT_EQ(loaded.value, decltype(loaded.value)(Value(std::int64_t{robot.pid})));
  EXPECT_THAT(robot.what_was_done(), ElementsAre("begin", "unload /detector", "load detector"));
}

TEST(ComposedNodes, NoneIsLoadedTwice) {
  Robot robot;
  robot.begin({"/detector"});
  EXPECT_EQ(robot.start(kDetector).text, "it is loaded already");
  robot.loading = {Outcome::kTimedOut, "no answer"};
  EXPECT_EQ(robot.start(kTracker).outcome, Outcome::kTimedOut);
  const Reply again = robot.start(kTracker);
  EXPECT_EQ(again.outcome, Outcome::kRefused);
  EXPECT_THAT(again.text, HasSubstr("still loading"));
  EXPECT_THAT(robot.what_was_done(), ElementsAre("begin", "load tracker"));
}

TEST(ComposedNodes, AContainerThatDoesNotUnloadIsReplacedWithAllThatItHadInOrder) {
  for (const bool says_so : {true, false}) {
    Robot robot;
    robot.begin({"/tracker", "/detector"});
    if (says_so) robot.unloading = {Outcome::kRefused, "cannot"};
    robot.keeps_nodes = !says_so;  // it says that it did
    EXPECT_EQ(robot.stop(kTracker).outcome, Outcome::kDone);
    robot.unloading = {};
    EXPECT_EQ(robot.start(kTracker).outcome, Outcome::kDone);
    robot.composed.reset();
    EXPECT_THAT(robot.what_was_done(),
                ElementsAre("begin", "unload /tracker",
                            HasSubstr("its container is replaced, with all that it has"), "end",
                            "begin", "load detector", "load tracker"));
  }
}

TEST(ComposedNodes, AContainerThatHasEndedIsStartedOnceForAll) {
  Robot robot;
  robot.begin({"/detector", "/tracker"});
  const int old = robot.pid;
  robot.end();
  EXPECT_EQ(robot.stop(kTracker).outcome, Outcome::kDone);
  EXPECT_EQ(robot.stop(kDetector).outcome, Outcome::kDone);
  EXPECT_EQ(robot.start(kTracker).outcome, Outcome::kDone);
  // Which its own rule asks for late.
  EXPECT_EQ(robot.stop(kBox, Ending::kToStartAgain, old).outcome, Outcome::kDone);
  EXPECT_EQ(robot.start(kDetector).text, "it is loaded already");
  EXPECT_EQ(robot.nodes.size(), 2u);
}

TEST(ComposedNodes, ARedeployedContainerHasAllThatItHad) {
  Robot robot;
  robot.begin({"/detector", "/tracker"});
  EXPECT_EQ(robot.stop(kBox).outcome, Outcome::kDone);
  EXPECT_EQ(robot.start(kBox).outcome, Outcome::kDone);
  EXPECT_EQ(robot.start(kDetector).outcome, Outcome::kDone);  // waits for its turn
  robot.composed.reset();
  EXPECT_THAT(robot.what_was_done(),
              ElementsAre("begin", "end", "begin", "load detector", "load tracker"));
}

// By somebody who wanted it so.
TEST(ComposedNodes, WhatWasUnloadedLongBeforeTheContainerEndedIsNotLoaded) {
  Robot robot;
  robot.begin({"/detector", "/tracker"});
  robot.composed->observe({live_now() - 60s, NodeVanished{"/tracker"}});
  robot.nodes.pop_back();
  robot.end();
  EXPECT_EQ(robot.start(kDetector).outcome, Outcome::kDone);
  EXPECT_EQ(robot.start(kDetector).outcome, Outcome::kDone);
  EXPECT_THAT(robot.what_was_done(), ElementsAre("begin", "end", "begin", "load detector"));
}

TEST(ComposedNodes, WhatAnEarlierRunSawInAProcessThatHasEndedIsLoadedToo) {
  Robot robot;
  robot.composed->remember(kTracker, 1 << 30);
  EXPECT_EQ(robot.start(kDetector).outcome, Outcome::kDone);
  EXPECT_EQ(robot.start(kTracker).outcome, Outcome::kDone);
  EXPECT_THAT(robot.what_was_done(), ElementsAre("begin", "load detector", "load tracker"));
}

TEST(ComposedNodes, NoneIsEndedThatCouldNotComeBack) {
  Robot robot;
  robot.begin({"/detector", "/planner"});
  robot.unloading = {Outcome::kRefused, "cannot"};
  EXPECT_THAT(robot.stop(kDetector).text, HasSubstr("/planner lives there, too"));
  robot.is_loadable = false;
  EXPECT_THAT(robot.stop(kDetector).text, HasSubstr("no such class"));
  EXPECT_THAT(robot.what_was_done(), ElementsAre("begin", "unload /detector"));
}

TEST(ComposedNodes, AContainerThatIsNotProvenIsNotAsked) {
  Robot robot;
  robot.is_proven = false;
  robot.begin({"/detector"});
  EXPECT_THAT(robot.stop(kDetector).text, HasSubstr("not proven"));
  EXPECT_THAT(robot.start(kTracker).text, HasSubstr("not proven"));
  EXPECT_THAT(robot.what_was_done(), ElementsAre("begin"));
}

TEST(ComposedNodes, NoneIsAskedWhileSeveralHaveItsName) {
  Robot robot;
  robot.begin({"/detector"});
  robot.contested = "several nodes have the name /box";
  EXPECT_THAT(robot.stop(kDetector).text, HasSubstr("several nodes"));
  EXPECT_THAT(robot.start(kTracker).text, HasSubstr("several nodes"));
  EXPECT_THAT(robot.what_was_done(), ElementsAre("begin"));
}

// An answer that is not the container's, that is.
TEST(ComposedNodes, NothingIsEndedOnAStrangersWord) {
  Robot robot;
  robot.begin({"/detector"});
  robot.listing = {Outcome::kRefused, "somebody else answers"};
  EXPECT_EQ(robot.stop(kDetector).text, "somebody else answers");
  EXPECT_EQ(robot.start(kTracker).text, "somebody else answers");
  EXPECT_THAT(robot.what_was_done(), ElementsAre("begin"));
}

TEST(ComposedNodes, WhatLivesElsewhereIsNotEnded) {
  Robot robot;
  robot.begin({});
  robot.composed->observe({live_now(), NodeAppeared{"/detector", getpid()}});
  EXPECT_THAT(robot.stop(kDetector).text, HasSubstr("does not live in the container /box"));
  EXPECT_THAT(robot.start(kDetector).text, HasSubstr("is there already"));
}

TEST(ComposedNodes, WhatIsLoadedUnderAnotherNameIsUnloadedAgain) {
  Robot robot;
  robot.begin({});
  robot.loads_as = "/other";
  const Reply reply = robot.start(kDetector);
  EXPECT_EQ(reply.outcome, Outcome::kRefused);
  EXPECT_THAT(reply.text, HasSubstr("loaded it as /other in place of /detector"));
  EXPECT_THAT(robot.nodes, IsEmpty());
}

TEST(ComposedNodes, WhatIsToEndForGoodIsUnloadedAndNotReplaced) {
  Robot robot;
  robot.begin({"/detector", "/tracker"});
  EXPECT_EQ(robot.stop(kDetector, Ending::kForGood).outcome, Outcome::kDone);
  robot.unloading = {Outcome::kRefused, "cannot"};
  EXPECT_EQ(robot.stop(kTracker, Ending::kForGood).outcome, Outcome::kRefused);
  EXPECT_THAT(robot.what_was_done(), ElementsAre("begin", "unload /detector", "unload /tracker"));
}

}  // namespace
}  // namespace culprit::owners
