#include "fleet/clean.h"

#include <gtest/gtest.h>

namespace culprit::fleet {
namespace {

TEST(Clean, LeavesNamesAsTheyAre) {
  EXPECT_EQ(clean("CameraSilent"), "CameraSilent");
  EXPECT_EQ(clean("gr\xC3\xBC\xC3\x9F"), "gr\xC3\xBC\xC3\x9F");
  EXPECT_EQ(clean(""), "");
}

TEST(Clean, TakesOutWhatADatabaseCannotHold) {
  EXPECT_EQ(clean(std::string_view("a\0b\n", 4)), "a?b?");
  EXPECT_EQ(clean("\xFF\xC3.\xED\xA0\x80"), "??.???");
  EXPECT_EQ(clean("\xC0\xAF"), "??");
  EXPECT_EQ(clean("x\xF0\x9F"), "x??");
}

TEST(Clean, CutsBetweenCharacters) {
  const std::string cut = clean(std::string(199, 'x') + "\xC3\xBC");
  EXPECT_EQ(cut, std::string(199, 'x'));
}

}  // namespace
}  // namespace culprit::fleet
