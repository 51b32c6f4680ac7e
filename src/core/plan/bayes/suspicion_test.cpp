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

}  // namespace
}  // namespace culprit::plan
