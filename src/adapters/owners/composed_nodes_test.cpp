#include "owners/composed_nodes.h"

#include <atomic>
#include <csignal>
#include <random>
#include <sys/wait.h>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "base/test_folder.h"
#include "language/checker.h"
#include "owners/proc.h"
#include "owners/spawn.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kComposedRules = R"(
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
class OneContainer : public ContainerServices {
 public:
  OneContainer() { ask_anew(); }

  // As another run of culprit would: requests under way are lost.
  void ask_anew() {
    composed.reset();
    composed = std::make_unique<ComposedNodes>(
        rules, std::vector{kBox, kDetector, kTracker}, *this,
        ComposedNodes::ContainerOwner{
            [this](CommandId id, ComponentId) {
              begin({});
              tell(Reply{id, Outcome::kDone, Value(std::int64_t{pid}), ""});
            },
            [this](CommandId id, ComponentId, int, Ending, Hangs) {
              end();
              tell(Reply{id, Outcome::kDone, {}, ""});
            }},
        inbox);
    asked = composed.get();
    if (pid == 0) return;
    appears("/box");
    for (const LoadedNode& each : nodes) appears(each.name);
  }
  ~OneContainer() override {
    composed.reset();
    if (pid == 0) return;
    kill(pid, SIGKILL);
    waitpid(pid, nullptr, 0);
  }

  void begin(const std::vector<std::string>& loaded) {
    const std::lock_guard lock(happens);
    const auto started =
        spawn({.arguments = {"sleep", "300"}, .search_first = {}, .log = folder.path() / "log"});
    ASSERT_TRUE(started) << started.error();
    pid = *started;
    appears("/box");
    for (const std::string& each : loaded) {
      add(each);
      appears(each);
    }
    did("begin");
    ++began;
  }
  void end() {
    const std::lock_guard lock(happens);
    if (pid == 0) return;
    kill(pid, SIGKILL);
    waitpid(pid, nullptr, 0);
    for (const LoadedNode& each : take_all()) vanishes(each.name);
    vanishes("/box");
    pid = 0;
    ++ended;
    did("end");
  }
  void appears(const std::string& node) {
    asked->observe({live_now(), NodeAppeared{node, is_proven ? pid.load() : 0}});
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
        if (const auto* told = std::get_if<LinkTrouble>(&each.what)) told_last = told->text;
        const auto* reply = std::get_if<Reply>(&each.what);
        if (reply != nullptr && reply->command == id) return *reply;
      }
    }
    return {id, Outcome::kTimedOut, {}, "no reply"};
  }

  // The next report of a missing class or file; empty: it is there again.
  std::optional<std::string> missing() {
    for (const Time end = later(live_now(), 60s); live_now() < end;) {
      std::vector<Observation> seen;
      inbox.take(end, seen);
      for (const Observation& each : seen) {
        if (const auto* barred = std::get_if<StartBarred>(&each.what)) return barred->missing;
      }
    }
    return std::nullopt;
  }

  // Whether one is reported as unloaded by somebody else within that time.
  bool reports_unloaded(ComponentId component, Duration within = 60s) {
    for (const Time end = later(live_now(), within); live_now() < end;) {
      std::vector<Observation> seen;
      inbox.take(end, seen);
      for (const Observation& each : seen) {
        const auto* unloaded = std::get_if<Unloaded>(&each.what);
        if (unloaded != nullptr && unloaded->component == component) return true;
      }
    }
    return false;
  }

  ContainerAnswer list(const std::string&, int, Duration) override {
    const std::lock_guard lock(mutex);
    if (listing.outcome != Outcome::kDone) return listing;
    return {Outcome::kDone, "", nodes};
  }
  ContainerAnswer load(const Component& component, int of, Duration) override {
    const std::lock_guard lock(happens);
    if (of != pid) return {Outcome::kTimedOut, "it has ended"};
    did("load " + component.name);
    if (ContainerAnswer refused = loading_now(); refused.outcome != Outcome::kDone) return refused;
    const LoadedNode node = add(loads_as.empty() ? component.node : loads_as);
    appears(node.name);
    return {Outcome::kDone, "", {node}};
  }
  ContainerAnswer unload(const std::string&, int of, std::uint64_t id, Duration) override {
    const std::lock_guard lock(happens);
    if (of != pid) return {Outcome::kTimedOut, "it has ended"};
    std::string name;
    {
      const std::lock_guard its_nodes(mutex);
      const auto node = std::find_if(nodes.begin(), nodes.end(),
                                     [&](const LoadedNode& each) { return each.id == id; });
      if (node == nodes.end()) return {Outcome::kRefused, "no such id"};
      name = node->name;
      done.push_back("unload " + name);
      if (unloading.outcome != Outcome::kDone) return unloading;
      nodes.erase(node);
      if (takes_all_of_a_name)
        std::erase_if(nodes, [&](const LoadedNode& each) { return each.name == name; });
    }
    if (!keeps_nodes) vanishes(name);
    return {};
  }
  Expected<void> could_load(const Component&, int) const override {
    return is_loadable ? Expected<void>() : Expected<void>(Error{"no such class"});
  }
  std::optional<std::string> contest(const std::string&) const override { return contested; }
  void interrupt() override {}

  LoadedNode add(const std::string& node) {
    const std::lock_guard lock(mutex);
    return nodes.emplace_back(LoadedNode{node, ++last});
  }
  std::vector<LoadedNode> take_all() {
    const std::lock_guard lock(mutex);
    return std::exchange(nodes, {});
  }
  void lists(ContainerAnswer answer) {
    const std::lock_guard lock(mutex);
    listing = std::move(answer);
  }
  void loads(ContainerAnswer answer) {
    const std::lock_guard lock(mutex);
    loading = std::move(answer);
  }
  void unloads(ContainerAnswer answer) {
    const std::lock_guard lock(mutex);
    unloading = std::move(answer);
  }
  ContainerAnswer loading_now() {
    const std::lock_guard lock(mutex);
    return loading;
  }
  void did(const std::string& what) {
    const std::lock_guard lock(mutex);
    done.push_back(what);
  }
  std::vector<std::string> what_was_done() {
    const std::lock_guard lock(mutex);
    return std::exchange(done, {});
  }

  RuleSet rules = *check(Source("composed.rules", kComposedRules)).rules;
  test::TestFolder folder;
  Inbox inbox;
  ContainerAnswer listing{};
  ContainerAnswer loading{};
  ContainerAnswer unloading{};
  std::string loads_as;
  std::string told_last;
  std::optional<std::string> contested;
  bool keeps_nodes = false;
  bool takes_all_of_a_name = false;  // with the first that it unloads
  std::atomic<bool> is_loadable = true;
  bool is_proven = true;
  std::atomic<int> pid = 0;
  std::uint64_t last = 0;
  std::uint64_t commands = 0;
  std::atomic<int> began = 0;  // processes of the container
  std::atomic<int> ended = 0;
  std::vector<LoadedNode> nodes;
  std::mutex mutex;
  std::mutex
      happens;  // one thing after the other: nothing is loaded into a process that ends meanwhile
  std::vector<std::string> done;
  std::unique_ptr<ComposedNodes> composed;
  ComposedNodes* asked = nullptr;  // the same, also while it ends
};

TEST(ComposedNodes, OneIsUnloadedAndLoadedAgain) {
  OneContainer robot;
  robot.begin({"/detector", "/tracker"});
  EXPECT_EQ(robot.stop(kDetector).outcome, Outcome::kDone);
  const Reply loaded = robot.start(kDetector);
  EXPECT_EQ(loaded.outcome, Outcome::kDone) << loaded.text;
  EXPECT_EQ(loaded.value, decltype(loaded.value)(Value(std::int64_t{robot.pid.load()})));
  EXPECT_THAT(robot.what_was_done(), ElementsAre("begin", "unload /detector", "load detector"));
}

TEST(ComposedNodes, NoneIsLoadedTwice) {
  OneContainer robot;
  robot.begin({"/detector"});
  EXPECT_EQ(robot.start(kDetector).text, "it is loaded already");
  robot.loads({Outcome::kTimedOut, "no answer"});
  EXPECT_EQ(robot.start(kTracker).outcome, Outcome::kTimedOut);
  const Reply again = robot.start(kTracker);
  EXPECT_EQ(again.outcome, Outcome::kRefused);
  EXPECT_THAT(again.text, HasSubstr("still loading"));
  EXPECT_THAT(robot.what_was_done(), ElementsAre("begin", "load tracker"));
}

TEST(ComposedNodes, AContainerThatDoesNotUnloadIsReplacedWithAllThatItHadInOrder) {
  for (const bool says_so : {true, false}) {
    OneContainer robot;
    robot.begin({"/tracker", "/detector"});
    if (says_so) robot.unloads({Outcome::kRefused, "cannot"});
    robot.keeps_nodes = !says_so;  // it reports that it did
    EXPECT_EQ(robot.stop(kTracker).outcome, Outcome::kDone);
    robot.unloads({});
    EXPECT_EQ(robot.start(kTracker).outcome, Outcome::kDone);
    robot.composed.reset();
    EXPECT_THAT(robot.what_was_done(), ElementsAre("begin", "unload /tracker", "end", "begin",
                                                   "load detector", "load tracker"));
    EXPECT_THAT(robot.told_last, HasSubstr("its container is replaced, with all that it has"));
  }
}

TEST(ComposedNodes, AContainerThatIsStoppedIsNotWaitedForAndReplaced) {
  OneContainer box;
  box.begin({"/detector", "/tracker"});
  box.what_was_done();
  // It would report every request: so this shows that it is not asked, and not waited for.
  kill(box.pid, SIGSTOP);
  while (state_letter(box.pid) != 'T') std::this_thread::sleep_for(1ms);
  EXPECT_EQ(box.stop(kDetector).outcome, Outcome::kDone);
  EXPECT_THAT(box.what_was_done(), ElementsAre("end"));
  EXPECT_THAT(box.told_last, HasSubstr("/box did not unload detector: its process is stopped"));
  EXPECT_EQ(box.start(kDetector).outcome, Outcome::kDone);
  box.composed.reset();
  EXPECT_THAT(box.what_was_done(), ElementsAre("begin", "load detector", "load tracker"));
}

TEST(ComposedNodes, AContainerThatHasEndedIsStartedOnceForAll) {
  OneContainer robot;
  robot.begin({"/detector", "/tracker"});
  const int old = robot.pid.load();
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
  OneContainer robot;
  robot.begin({"/detector", "/tracker"});
  EXPECT_EQ(robot.stop(kBox).outcome, Outcome::kDone);
  EXPECT_EQ(robot.start(kBox).outcome, Outcome::kDone);
  EXPECT_EQ(robot.start(kDetector).outcome, Outcome::kDone);  // waits for its turn
  robot.composed.reset();
  EXPECT_THAT(robot.what_was_done(),
              ElementsAre("begin", "end", "begin", "load detector", "load tracker"));
}

// Somebody unloaded it on purpose.
TEST(ComposedNodes, WhatWasUnloadedLongBeforeTheContainerEndedIsNotLoaded) {
  OneContainer robot;
  robot.begin({"/detector"});
  robot.appears("/tracker");
  robot.composed->observe({live_now() - 60s, NodeVanished{"/tracker"}});
  robot.end();
  EXPECT_EQ(robot.start(kDetector).outcome, Outcome::kDone);
  EXPECT_EQ(robot.start(kDetector).outcome, Outcome::kDone);
  EXPECT_THAT(robot.what_was_done(), ElementsAre("begin", "end", "begin", "load detector"));
}

TEST(ComposedNodes, WhatSomebodyElseUnloadedIsReportedOnceAndNotLoadedWithTheOthers) {
  OneContainer robot;
  robot.begin({"/detector", "/tracker"});
  robot.unload("/box", robot.pid, 2, 1s);
  EXPECT_TRUE(robot.reports_unloaded(kTracker));
  robot.appears("/planner");  // so that the container is asked once more
  EXPECT_FALSE(robot.reports_unloaded(kTracker, 2s));
  robot.end();
  EXPECT_EQ(robot.start(kDetector).outcome, Outcome::kDone);
  EXPECT_EQ(robot.start(kDetector).outcome, Outcome::kDone);
  EXPECT_THAT(robot.what_was_done(),
              ElementsAre("begin", "unload /tracker", "end", "begin", "load detector"));
}

TEST(ComposedNodes, NoneIsReportedAsUnloadedThatTheContainerListsOrCulpritUnloaded) {
  OneContainer robot;
  robot.begin({"/detector", "/tracker"});
  robot.vanishes("/tracker");  // its node has left the graph, and the container has it
  EXPECT_FALSE(robot.reports_unloaded(kTracker, 2s));
  EXPECT_EQ(robot.stop(kDetector).outcome, Outcome::kDone);
  EXPECT_FALSE(robot.reports_unloaded(kDetector, 2s));
}

TEST(ComposedNodes, WhatSomebodyElseUnloadsThatCulpritDidNotIsReported) {
  OneContainer robot;
  robot.begin({"/detector", "/tracker"});
  robot.unloads({Outcome::kRefused, "cannot"});
  EXPECT_EQ(robot.stop(kTracker, Ending::kForGood).outcome, Outcome::kRefused);
  robot.unloads({});
  robot.unload("/box", robot.pid, 2, 1s);
  EXPECT_TRUE(robot.reports_unloaded(kTracker));
}

TEST(ComposedNodes, WhatTheContainerUnloadsLateIsNotReported) {
  OneContainer robot;
  robot.begin({"/detector", "/tracker"});
  robot.unloads({Outcome::kTimedOut, ""});
  EXPECT_EQ(robot.stop(kTracker, Ending::kForGood).outcome, Outcome::kTimedOut);
  robot.unloads({});
  robot.unload("/box", robot.pid, 2, 1s);
  EXPECT_FALSE(robot.reports_unloaded(kTracker, 2s));
}

TEST(ComposedNodes, WhatCulpritUnloadedIsNotReportedThoughOneMoreOfItsNameWasRefused) {
  OneContainer robot;
  robot.begin({"/detector", "/tracker", "/tracker"});
  robot.takes_all_of_a_name = true;
  robot.keeps_nodes = true;  // they leave the graph later
  EXPECT_EQ(robot.stop(kTracker, Ending::kForGood).outcome, Outcome::kRefused);
  EXPECT_THAT(robot.what_was_done(), ElementsAre("begin", "unload /tracker"));
  robot.vanishes("/tracker");
  EXPECT_FALSE(robot.reports_unloaded(kTracker, 2s));
}

TEST(ComposedNodes, WhatAnEarlierRunSawInAProcessThatHasEndedIsLoadedToo) {
  OneContainer robot;
  robot.composed->remember(kTracker, 1 << 30);
  EXPECT_EQ(robot.start(kDetector).outcome, Outcome::kDone);
  EXPECT_EQ(robot.start(kTracker).outcome, Outcome::kDone);
  EXPECT_THAT(robot.what_was_done(), ElementsAre("begin", "load detector", "load tracker"));
}

TEST(ComposedNodes, NoneIsEndedThatCouldNotComeBack) {
  OneContainer robot;
  robot.begin({"/detector", "/planner"});
  robot.unloads({Outcome::kRefused, "cannot"});
  EXPECT_THAT(robot.stop(kDetector).text, HasSubstr("/planner lives there, too"));
  robot.is_loadable = false;
  EXPECT_THAT(robot.stop(kDetector).text, HasSubstr("no such class"));
  EXPECT_THAT(robot.what_was_done(), ElementsAre("begin", "unload /detector"));
}

TEST(ComposedNodes, ALoadThatCannotHappenSaysWhatIsMissingAndWhenItIsThere) {
  OneContainer robot;
  robot.begin({});
  robot.is_loadable = false;
  robot.composed->start(CommandId{++robot.commands}, kDetector, 5s);
  EXPECT_EQ(robot.missing(), "no such class");
  robot.is_loadable = true;
  EXPECT_EQ(robot.missing(), "");
  EXPECT_EQ(robot.start(kDetector).outcome, Outcome::kDone);
}

TEST(ComposedNodes, AContainerThatIsNotProvenIsNotAsked) {
  OneContainer robot;
  robot.is_proven = false;
  robot.begin({"/detector"});
  EXPECT_THAT(robot.stop(kDetector).text, HasSubstr("not proven"));
  EXPECT_THAT(robot.start(kTracker).text, HasSubstr("not proven"));
  EXPECT_THAT(robot.what_was_done(), ElementsAre("begin"));
}

TEST(ComposedNodes, NoneIsAskedWhileSeveralHaveItsName) {
  OneContainer robot;
  robot.begin({"/detector"});
  robot.contested = "several nodes have the name /box";
  EXPECT_THAT(robot.stop(kDetector).text, HasSubstr("several nodes"));
  EXPECT_THAT(robot.start(kTracker).text, HasSubstr("several nodes"));
  EXPECT_THAT(robot.what_was_done(), ElementsAre("begin"));
}

// An answer that is not the container's, that is.
TEST(ComposedNodes, NothingIsEndedOnAStrangersWord) {
  OneContainer robot;
  robot.begin({"/detector"});
  robot.lists({Outcome::kRefused, "another process answers"});
  EXPECT_EQ(robot.stop(kDetector).text, "another process answers");
  EXPECT_EQ(robot.start(kTracker).text, "another process answers");
  EXPECT_THAT(robot.what_was_done(), ElementsAre("begin"));
}

TEST(ComposedNodes, WhatLivesElsewhereIsNotEnded) {
  OneContainer robot;
  robot.begin({});
  robot.composed->observe({live_now(), NodeAppeared{"/detector", getpid()}});
  EXPECT_THAT(robot.stop(kDetector).text, HasSubstr("does not live in the container /box"));
  EXPECT_THAT(robot.start(kDetector).text, HasSubstr("is there already"));
}

TEST(ComposedNodes, WhatIsLoadedUnderAnotherNameIsUnloadedAgain) {
  OneContainer robot;
  robot.begin({});
  robot.loads_as = "/other";
  const Reply reply = robot.start(kDetector);
  EXPECT_EQ(reply.outcome, Outcome::kRefused);
  EXPECT_THAT(reply.text, HasSubstr("loaded it as /other in place of /detector"));
  EXPECT_THAT(robot.nodes, IsEmpty());
}

TEST(ComposedNodes, WhatIsToEndForGoodIsUnloadedAndNotReplaced) {
  OneContainer robot;
  robot.begin({"/detector", "/tracker"});
  EXPECT_EQ(robot.stop(kDetector, Ending::kForGood).outcome, Outcome::kDone);
  robot.unloads({Outcome::kRefused, "cannot"});
  EXPECT_EQ(robot.stop(kTracker, Ending::kForGood).outcome, Outcome::kRefused);
  EXPECT_THAT(robot.what_was_done(), ElementsAre("begin", "unload /detector", "unload /tracker"));
}

// Containers that are killed, that do not unload, that refuse to load, and culprits that are killed in
// between: once it settles each is there once, in one container.
TEST(ComposedNodes, AreThereOnceAfterAnySequenceOfFaults) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    OneContainer robot;
    robot.begin({"/detector", "/tracker"});
    for (int step = 0; step < 6; ++step) {
      const ComponentId part = random() % 2 == 0 ? kDetector : kTracker;
      switch (random() % 6) {
        case 0:
          if (robot.pid != 0) robot.end();
          break;
        case 1:
          robot.unloads({Outcome::kRefused, "cannot"});
          break;
        case 2:
          robot.loads({Outcome::kRefused, "cannot"});
          break;
        case 3:
          robot.composed->stop(CommandId{++robot.commands}, part, 0, Ending::kToStartAgain,
                               Hangs::kNo);
          robot.ask_anew();
          for (const ComponentId each : {kDetector, kTracker})
            robot.composed->remember(each, 1 << 30);
          break;
        case 4:
          robot.stop(kBox, Ending::kToStartAgain, robot.pid);
          robot.start(kBox);
          break;
        default:
          robot.stop(part);
          robot.start(part);
          robot.unloads({});
          robot.loads({});
      }
    }
    robot.unloads({});
    robot.loads({});
    for (const ComponentId each : {kDetector, kTracker}) {
      EXPECT_EQ(robot.stop(each).outcome, Outcome::kDone);
      const Reply reply = robot.start(each);
      EXPECT_EQ(reply.outcome, Outcome::kDone) << reply.text;
    }
    robot.composed.reset();
    std::vector<std::string> names;
    for (const LoadedNode& each : robot.nodes) names.push_back(each.name);
    EXPECT_THAT(names, testing::UnorderedElementsAre("/detector", "/tracker"));
    EXPECT_EQ(robot.began.load(), robot.ended + 1) << "containers that run";
  }
}

}  // namespace
}  // namespace culprit::owners
