#include "plan/bayes/suspicion.h"

#include <gtest/gtest.h>

#include "plan/bayes/test_scene.h"

namespace culprit::plan {
namespace {

TEST(Suspicion, ARuleIsSuspiciousIfOneOfItsComponentsIsDown) {
  std::string text = failure_of("a", "A") + failure_of("b", "B");
  text.replace(text.find("ADAPTATION a"), 0, "ADAPTATION b restart 2\n");
  Scene scene(text);
  EXPECT_FALSE(is_suspicious(scene.rule("A"), *scene));
  scene->components[scene.component("b")].alive = false;
  EXPECT_TRUE(is_suspicious(scene.rule("A"), *scene));
}

TEST(Suspicion, ARuleHearsByWhicheverOfItsInputsIsReadFirst) {
  Scene scene(
      "COMPONENT a NODE /a\nRULE A\nPOLICIES ERROR\n"
      "TRIGGER age(/x) > 1s && age(/y) > 1s\nSTRATEGY s 50 10\nADAPTATION a restart 2\n");
  const Time now(std::chrono::seconds(90));
  const auto inputs = scene.rules()[scene.rule("A")].inputs;
  ASSERT_EQ(inputs.size(), 2u);
  for (const InputId id : inputs) scene->signals.set_read_at(id, later(now, std::chrono::hours(1)));
  EXPECT_FALSE(is_heard_by(now, scene.rule("A"), *scene));
  scene->signals.set_read_at(inputs[1], now - std::chrono::minutes(1));
  EXPECT_TRUE(is_heard_by(now, scene.rule("A"), *scene));
}

}  // namespace
}  // namespace culprit::plan
