#include "diagnose/questions.h"

#include <gtest/gtest.h>

#include "plan/bayes/test_scene.h"

namespace culprit::diagnose {
namespace {

using namespace std::chrono_literals;
using plan::failure_of;
using plan::Scene;

const Strategy& first_strategy(const Scene& scene, const std::string& rule) {
  return scene.rules()[scene.rules()[scene.rule(rule)].strategies.front()];
}

// map -> nav; navigation was silent from the 90th second on.
class AMap : public ::testing::Test {
 protected:
  AMap() : scene_(rules()) {
    scene_.link("map", "nav").fail("Nav");
    scene_->states.state(scene_.rule("Nav")).onset = Onset{Time(89s), Time(90s)};
    for (const char* each : {"map", "nav"}) state(each).in_graph = true;
  }

  static std::string rules() {
    std::string text = failure_of("map", "Map") + failure_of("nav", "Nav");
    text.replace(text.rfind("x > 1"), 5, "age(/cmd) > 1s");
    text.replace(text.find("x > 1"), 5, "!alive(map)");
    return text;
  }
  ComponentState& state(const char* component) {
    return scene_->components[scene_.component(component)];
  }
  Questions questions() {
    const auto troubles = all_troubles(*scene_);
    return Questioner(*scene_, troubles).about(first_strategy(scene_, "Nav"));
  }
  bool is_asked() { return !questions().asks.empty(); }

  Scene scene_;
};

TEST_F(AMap, IsAskedIfItGaveNoSignOfLifeSinceTheOutageBegan) {
  state("map").answered = Time(89s);
  EXPECT_EQ(questions().asks, std::vector{scene_.component("map")});
  EXPECT_EQ(questions().awaited, scene_.component("map"));
  state("map").answered = Time(91s);
  EXPECT_FALSE(is_asked());
}

TEST_F(AMap, IsNotAskedWhereItGaveAnotherSign) {
  const TopicId cmd(0);
  EXPECT_TRUE(is_asked());
  scene_->graph.endpoint_appeared("/map", EndpointKind::kPublisher, scene_.rules()[cmd].name);
  scene_->signals.set_rhythm(cmd, {Time(91s), 100ms, 100ms, 1h});
  EXPECT_FALSE(is_asked()) << "it sends what it alone publishes";
  scene_->graph.endpoint_appeared("/nav", EndpointKind::kPublisher, scene_.rules()[cmd].name);
  EXPECT_TRUE(is_asked()) << "somebody else may have sent that";
  state("map").node_seen = Time(91s);
  EXPECT_FALSE(is_asked()) << "it has just come";
}

TEST_F(AMap, IsNotAskedWhatIsKnown) {
  state("map").questioned.is_pointless = true;
  EXPECT_FALSE(is_asked()) << "it never answers";
  state("map").questioned = {};
  state("map").lifecycle = Lifecycle::kInactive;
  EXPECT_FALSE(is_asked()) << "it is in trouble";
  state("map").lifecycle = Lifecycle::kTransition;
  EXPECT_FALSE(is_asked()) << "it has no time to answer";
}

TEST_F(AMap, IsAskedAboutABadValueToo) {
  Scene scene(failure_of("map", "Map") + failure_of("nav", "Nav"));
  scene.link("map", "nav").fail("Nav");
  for (const char* each : {"map", "nav"}) scene->components[scene.component(each)].in_graph = true;
  const auto troubles = all_troubles(*scene);
  const Questions questions = Questioner(*scene, troubles).about(first_strategy(scene, "Nav"));
  EXPECT_EQ(questions.asks, std::vector{scene.component("map")}) << "it may serve nothing any more";
}

// Navigation and the arm read them all.
class Suppliers : public ::testing::Test {
 protected:
  static constexpr std::size_t kSuppliers = kMostQuestions + 4;

  Suppliers() : scene_(rules()) {
    for (std::size_t s = 0; s < kSuppliers; ++s) {
      for (const char* consumer : {"nav", "arm"}) scene_.link("s" + std::to_string(s), consumer);
    }
    for (const char* failure : {"Nav", "Arm"}) {
      scene_.fail(failure);
      scene_->states.state(scene_.rule(failure)).onset = Onset{Time(89s), Time(90s)};
    }
  }
  static std::string rules() {
    std::string rules = failure_of("nav", "Nav") + failure_of("arm", "Arm");
    for (std::size_t s = 0; s < kSuppliers; ++s)
      rules += "COMPONENT s" + std::to_string(s) + " NODE /s" + std::to_string(s) + "\n";
    return rules;
  }
  void silence(std::size_t silent) {
    for (std::size_t s = 0; s < kSuppliers; ++s) {
      ComponentState& state = scene_->components[scene_.component("s" + std::to_string(s))];
      state.in_graph = true;
      state.answered = Time(s < silent ? 89s : 91s);
    }
    troubles_ = all_troubles(*scene_);
  }

  Scene scene_;
  std::vector<std::optional<TroubleSeen>> troubles_;
};

TEST_F(Suppliers, AreAskedTogether) {
  silence(3);
  EXPECT_EQ(Questioner(*scene_, troubles_).about(first_strategy(scene_, "Nav")).asks.size(), 3u);
}

TEST_F(Suppliers, AreNeverAskedTooManyAtOnce) {
  silence(kSuppliers);
  Questioner questioner(*scene_, troubles_);
  const Questions first = questioner.about(first_strategy(scene_, "Nav"));
  EXPECT_EQ(first.asks.size(), kMostQuestions);
  const Questions second = questioner.about(first_strategy(scene_, "Arm"));
  EXPECT_EQ(second.asks, first.asks) << "one answer counts for both failures";
}

// Another failure asks first.
TEST_F(Suppliers, AreWaitedForUntilTheyCanBeAsked) {
  silence(kSuppliers);
  const std::vector last{scene_.component("s9")};  // by name
  scene_->components[last.front()].answers_probes = true;
  Questioner questioner(*scene_, troubles_);
  EXPECT_EQ(questioner.about(first_strategy(scene_, "Nav")).asks.size(), kMostQuestions);
  const Questions more = questioner.to(last, scene_.rule("Arm"));
  EXPECT_TRUE(more.asks.empty());
  EXPECT_EQ(more.awaited, last.front());
}

TEST_F(AMap, IsAwaitedForAWhile) {
  state("map").questioned.at = scene_->now - 550ms;
  state("map").questioned.is_open = true;
  EXPECT_FALSE(is_asked());
  EXPECT_EQ(questions().awaited, scene_.component("map"));
  state("map").questioned.at = scene_->now - 650ms;
  EXPECT_EQ(questions().awaited, std::nullopt);
}

TEST_F(AMap, HangsIfItAnsweredBeforeAndDoesNotAnswer) {
  ComponentState& map = state("map");
  map.answered = Time(80s);
  map.questioned.unanswered = Time(95s);
  map.questioned.at = Time(99s);
  EXPECT_EQ(trouble_of(scene_.component("map"), *scene_), std::nullopt) << "it may never answer";
  map.answers_probes = true;
  const auto seen = trouble_of(scene_.component("map"), *scene_);
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->trouble, Trouble::kHung);
  EXPECT_EQ(seen->onset.earliest, Time(80s));
  EXPECT_EQ(seen->onset.latest, Time(95s));
  EXPECT_FALSE(is_to_be_asked_again(scene_.component("map"), *scene_));
  map.questioned.at = Time(98s);
  EXPECT_TRUE(is_to_be_asked_again(scene_.component("map"), *scene_));
  map.node_seen = Time(96s);
  EXPECT_EQ(trouble_of(scene_.component("map"), *scene_), std::nullopt) << "it came back";
}

// It hung when it answered last, not when that was noticed: it can be the cause of what came between.
TEST_F(AMap, HungBeforeItsRuleNoticed) {
  ComponentState& map = state("map");
  map.answered = Time(80s);
  map.alive = false;
  map.alive_since = Time(99s);
  const Onset onset = onset_now(scene_.rule("Map"), scene_->now, *scene_);
  EXPECT_EQ(onset.earliest, Time(80s));
  EXPECT_EQ(onset.latest, Time(99s));
}

// A few probes without an answer are needed, so it is found later. A busy one may publish meanwhile.
TEST_F(AMap, HungWhenTwoProbesGotNoAnswerAndItsLastMessageHadCome) {
  ComponentState& map = state("map");
  map.answered = Time(80s);
  map.alive = false;
  map.alive_since = Time(99s);
  map.missed_probes = 3;
  map.missed_since = Time(82s);
  const auto began = [&] {
    const Time published = published_last(*scene_)[scene_.component("map").index];
    return onset_of_hang(map, published).latest;
  };
  EXPECT_EQ(began(), Time(82s));
  scene_->graph.endpoint_appeared("/map", EndpointKind::kPublisher, "/cmd");
  SignalStore::Rhythm rhythm;
  rhythm.last = Time(90s);
  scene_->signals.set_rhythm(TopicId(0u), rhythm);
  EXPECT_EQ(began(), Time(90s));
  map.missed_probes = 1;  // that may be chance
  EXPECT_EQ(began(), Time(99s));
  map.missed_probes = 0;  // another node of its process hangs
  EXPECT_EQ(began(), Time(99s));
}

// A component that a strategy would send requests to, because of its failure of the 90th second.
class ASuspect : public AMap {
 protected:
  ASuspect() {
    nav().answers_probes = true;
    nav().answered = Time(80s);
  }
  ComponentState& nav() { return state("nav"); }
  Questions questions() {
    const std::vector<ComponentId> own{scene_.component("nav")};
    const auto troubles = all_troubles(*scene_);
    return Questioner(*scene_, troubles).to(own, scene_.rule("Nav"));
  }
  void asked_in_vain_at(Time at) {
    nav().questioned.at = at;
    if (!nav().questioned.unanswered) nav().questioned.unanswered = at;
  }
};

TEST_F(ASuspect, IsAskedIfItGaveNoSignOfLifeSinceItsFailure) {
  EXPECT_EQ(questions().asks, std::vector{scene_.component("nav")});
  EXPECT_EQ(questions().awaited, scene_.component("nav"));
  nav().answered = Time(91s);
  EXPECT_FALSE(questions().awaited);
}

TEST_F(ASuspect, ThatNeverAnsweredIsNotAsked) {
  nav().answers_probes = false;
  EXPECT_FALSE(questions().awaited) << "its requests wait for no answer that never comes";
}

TEST_F(ASuspect, IsWaitedForWhileItMayAnswer) {
  nav().questioned.at = scene_->now;
  nav().questioned.is_open = true;
  EXPECT_TRUE(questions().asks.empty());
  EXPECT_EQ(questions().awaited, scene_.component("nav"));
}

TEST_F(ASuspect, IsAskedASecondTimeAtOnceAndNoThirdTime) {
  asked_in_vain_at(scene_->now - 600ms);
  EXPECT_FALSE(answers_no_question(nav())) << "one answer may be late";
  EXPECT_EQ(questions().asks.size(), 1u);
  asked_in_vain_at(scene_->now);
  EXPECT_TRUE(answers_no_question(nav()));
  EXPECT_TRUE(questions().asks.empty());
  EXPECT_FALSE(questions().awaited);
}

TEST_F(ASuspect, ThatSendsItsTopicsIsNotAsked) {
  scene_->graph.endpoint_appeared("/nav", EndpointKind::kPublisher, "/cmd");
  scene_->signals.set_rhythm(TopicId(0u), {Time(91s), 100ms, 100ms, 1h});
  EXPECT_FALSE(questions().awaited);
}

}  // namespace
}  // namespace culprit::diagnose
