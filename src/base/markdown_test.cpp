#include "base/markdown.h"

#include <gtest/gtest.h>

namespace culprit {
namespace {

TEST(Markdown, SectionsGoFromOneHeadingToTheNext) {
  const auto sections =
      markdown_sections("# Page\n\nIntroduction.\n\n## A\n\nOf A.\n\n## B\nOf B.");
  ASSERT_EQ(sections.size(), 2u);
  EXPECT_EQ(sections[0].heading, "A");
  EXPECT_EQ(sections[0].text, "\n\nOf A.\n");
  EXPECT_EQ(sections[1].heading, "B");
  EXPECT_EQ(sections[1].text, "\nOf B.");
  EXPECT_TRUE(markdown_sections("# Page\n").empty());
}

TEST(Markdown, TextIsFoundBetweenItsMarks) {
  EXPECT_EQ(text_between("**Title.** Text.", "**", ".**"), "Title");
  EXPECT_EQ(text_between("**Title.** Text.", ".** ", "**"), "Text.");
  EXPECT_EQ(text_between("Text.", "**", ".**"), "");
}

TEST(Markdown, CodeIsWhatFourBlanksIndent) {
  EXPECT_EQ(indented_code("\nWrong:\n\n    RULE a\n      POLICIES\n\nRight:\n"),
            "RULE a\n  POLICIES\n");
}

}  // namespace
}  // namespace culprit
