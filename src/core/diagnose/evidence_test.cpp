#include "diagnose/evidence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plan/bayes/test_scene.h"

namespace culprit::diagnose {
namespace {

using namespace std::chrono_literals;
using plan::failure_of;
using plan::Scene;
using testing::ElementsAre;
using testing::StartsWith;

// a -> b -> c, each with a rule of its own.
class EvidenceFor : public ::testing::Test {
 protected:
  EvidenceFor() : scene_(failure_of("a", "A") + failure_of("b", "B") + failure_of("c", "C")) {
    scene_.link("a", "b").link("b", "c");
  }
  std::vector<Evidence> of(const char* suspect, const char* failure) {
    const Examination found(*scene_, scene_->states.active());
    const Causes& causes = found.causes();
    const std::size_t i = causes.index_of(scene_.rule(failure));
    const Otherwise otherwise(i, causes, found.diagnosis());
    const std::size_t j = causes.index_of(scene_.rule(suspect));
    std::vector<Evidence> all;
    for (PieceOfEvidence& each : evidence_for(j, i, otherwise, found, *scene_)) {
      if (each.otherwise) each.evidence.without = scene_->rules[causes[*each.otherwise].rule].name;
      all.push_back(std::move(each.evidence));
    }
    return all;
  }
  std::vector<std::string> texts(const char* suspect, const char* failure) {
    std::vector<std::string> all;
    for (const Evidence& each : of(suspect, failure)) all.push_back(describe(each));
    return all;
  }

  Scene scene_;
};

TEST_F(EvidenceFor, AFailureWithNothingUpstreamIsItsOwnCause) {
  scene_.fail("A");
  EXPECT_THAT(texts("A", "A"), ElementsAre("nothing upstream is wrong (measured, +6.9)"));
}

TEST_F(EvidenceFor, AnAlarmUpstreamSpeaksForIt) {
  scene_.fail("A").fail("B");
  const auto upstream = of("A", "B");
  ASSERT_EQ(upstream.size(), 1u);
  EXPECT_EQ(upstream.front().source, EvidenceSource::kAlarm);
  EXPECT_EQ(upstream.front().text, "A fires");
  EXPECT_GT(upstream.front().log_odds, 0);
  EXPECT_THAT(texts("B", "B"), ElementsAre(StartsWith("two faults at once are rare (model, -2.9)"),
                                           StartsWith("causes do not always pass on (model, +")));
}

TEST_F(EvidenceFor, AProcessThatIsGoneIsProof) {
  scene_.fail("A").fail("B");
  scene_.process("b", ProcessState::kGone);
  const auto own = of("B", "B");
  EXPECT_EQ(own.front().source, EvidenceSource::kKernel);
  EXPECT_EQ(own.front().text, "b exited or is stopped");
  EXPECT_GT(own.front().log_odds, 2);
}

// An alarm upstream makes no process hang.
TEST_F(EvidenceFor, AProcessThatHangsByItselfIsEvidence) {
  scene_.fail("A").fail("B");
  ComponentState& b = scene_->components[scene_.component("b")];
  b.in_graph = true;
  b.alive = false;
  EXPECT_THAT(texts("B", "B"), ElementsAre(StartsWith("b hangs by itself"),
                                           StartsWith("causes do not always pass on (model, +")));
}

TEST_F(EvidenceFor, ASupplierInTroubleNeedsNoRule) {
  scene_.fail("C");
  scene_.process("b", ProcessState::kGone);
  const Examination found(*scene_, scene_->states.active());
  const std::size_t i = found.causes().index_of(scene_.rule("C"));
  const Otherwise otherwise(i, found.causes(), found.diagnosis());
  std::vector<std::string> all;
  for_each(found.causes().causes(i), [&](std::size_t j) {
    for (const PieceOfEvidence& each : evidence_for(j, i, otherwise, found, *scene_))
      all.push_back(each.evidence.text);
  });
  EXPECT_THAT(all, ElementsAre("b exited"));
}

TEST_F(EvidenceFor, NamesWhoWouldBeResponsibleWithoutIt) {
  scene_.fail("A").fail("B");
  EXPECT_EQ(of("A", "B").front().without, "B") << "nothing else is upstream";
  scene_.process("b", ProcessState::kGone);
  EXPECT_EQ(of("B", "B").front().without, "A") << "that b exited is why A is not";
  EXPECT_EQ(of("A", "B").front().without, "") << "b is responsible with it and without it";
}

TEST_F(EvidenceFor, OfTwoCausesTheOtherOneIsLeft) {
  scene_.fail("A").fail("B").fail("C");
  scene_->couplings.set(scene_.rule("B"), scene_.rule("C"), {1, 9});
  EXPECT_EQ(of("A", "C").front().without, "B");
  EXPECT_EQ(of("B", "C").front().without, "");
}

// Seven rules say that a was given up long before: that is one cause of B, and only just likelier than its own.
TEST(Otherwise, CountsFailuresOfOneGivenUpComponentOnce) {
  std::string again;
  for (const char name : std::string("123456"))
    again += std::string("RULE Again") + name +
             "\nPOLICIES ERROR\nTRIGGER y > 1\nSTRATEGY again 50 10\nADAPTATION a restart 2\n";
  Scene scene(failure_of("a", "A") + failure_of("b", "B") + again);
  scene.link("a", "b").exhaust("A").fail("B");
  for (const char name : std::string("123456")) scene.exhaust(std::string("Again") + name);
  for (const RuleId given_up : scene->states.exhausted())
    scene->states.state(given_up).onset = Onset{Time(5s), Time(5s)};
  scene->states.state(scene.rule("B")).worked_until = Time(84s);
  const Examination found(*scene, scene->states.active());
  const Causes& causes = found.causes();
  const std::size_t b = causes.index_of(scene.rule("B"));
  ASSERT_LT(found.diagnosis().of(b), 0.5);
  const Otherwise otherwise(b, causes, found.diagnosis());
  const std::size_t a = causes.index_of(scene.rule("A"));
  EXPECT_EQ(otherwise.likeliest(), a);
  EXPECT_EQ(causes[otherwise.without(a)].rule, scene.rule("Again1"))
      << "the next of the same cause";
}

TEST_F(EvidenceFor, WhatWasLearnedCounts) {
  scene_.fail("A").fail("B");
  scene_->couplings.set(scene_.rule("A"), scene_.rule("B"), {1, 9});
  const auto upstream = of("A", "B");
  ASSERT_EQ(upstream.size(), 2u);
  EXPECT_EQ(upstream.back().text, "one stayed before when the other cleared");
  EXPECT_LT(upstream.back().log_odds, 0);
}

// map -> nav; navigation has been failing from the 90th second on, and ten seconds have passed.
class AnswersAbout : public ::testing::Test {
 protected:
  AnswersAbout() : scene_(failure_of("map", "Map") + failure_of("nav", "Nav")) {
    scene_.link("map", "nav").fail("Nav");
    scene_->states.state(scene_.rule("Nav")).onset = Onset{Time(89s), Time(90s)};
  }
  ComponentState& state(const char* component) {
    return scene_->components[scene_.component(component)];
  }
  std::vector<std::string> texts() {
    std::vector<std::string> all;
    for (const Evidence& each : answers_about(scene_.rule("Nav"), *scene_))
      all.push_back(describe(each));
    return all;
  }

  Scene scene_;
};

TEST_F(AnswersAbout, NamesWhatWasAskedAndWhetherItAnswered) {
  EXPECT_THAT(texts(), ElementsAre()) << "nothing was asked";
  state("map").questioned = {.at = Time(98s), .unanswered = Time(98s)};
  state("nav").questioned = {.at = Time(99s), .is_open = true};
  EXPECT_THAT(texts(), ElementsAre("nav was asked, and may still answer, 1.00 s before (answer)",
                                   "map did not answer, 2.00 s before (answer)"));
  state("nav").answered = Time(99500ms);
  EXPECT_THAT(texts(), ElementsAre("nav answered, 0.50 s before (answer)",
                                   "map did not answer, 2.00 s before (answer)"));
}

TEST_F(AnswersAbout, LeavesOutQuestionsFromBeforeTheFailure) {
  state("map").questioned.at = Time(80s);
  state("map").answered = Time(99s);
  EXPECT_THAT(texts(), ElementsAre());
}

TEST_F(AnswersAbout, SaysNothingOfAQuestionWhoseAnswerWasLost) {
  state("map").questioned.at = Time(98s);
  EXPECT_THAT(texts(), ElementsAre());
}

TEST_F(AnswersAbout, WeighsNothing) {
  state("map").questioned = {.at = Time(98s), .unanswered = Time(98s)};
  EXPECT_EQ(answers_about(scene_.rule("Nav"), *scene_).front().log_odds, 0);
}

}  // namespace
}  // namespace culprit::diagnose
