#include "recorder/topic_choice.h"

#include <gtest/gtest.h>

namespace culprit::recorder {
namespace {

TEST(TopicChoice, IsOfAllThatAreNotHiddenByDefault) {
  const TopicChoice all({});
  EXPECT_TRUE(all.includes("/scan"));
  EXPECT_FALSE(all.includes("/navigate/_action/status"));
  EXPECT_FALSE(all.names("/scan")) << "it was not named";
}

TEST(TopicChoice, IsOfThoseThatAreNamedAndOfTheRobotsWordOnItself) {
  const TopicChoice some({"/scan", "/camera/*"});
  EXPECT_TRUE(some.names("/camera/left/image"));
  EXPECT_TRUE(some.includes("/scan"));
  EXPECT_FALSE(some.includes("/scan/raw"));
  EXPECT_TRUE(some.includes("/diagnostics"));
  EXPECT_TRUE(some.includes("/rosout"));
}

TEST(TopicChoice, LeavesOutWhatIsUnwanted) {
  const TopicChoice rest({"!/camera/*", "!/rosout"});
  EXPECT_TRUE(rest.includes("/scan"));
  EXPECT_FALSE(rest.includes("/camera/left"));
  EXPECT_FALSE(rest.includes("/rosout"));
}

}  // namespace
}  // namespace culprit::recorder
