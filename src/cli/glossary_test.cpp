#include "cli/glossary.h"

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Glossary, HasEveryRowOfItsPage) {
  EXPECT_GT(glossary().size(), 50u);
  for (const Term& term : glossary()) {
    EXPECT_FALSE(term.name.empty());
    EXPECT_FALSE(term.section.empty()) << term.name;
    EXPECT_GT(term.meaning.size(), 20u) << term.name;
    EXPECT_FALSE(term.words.empty()) << term.name;
    EXPECT_THAT(term.meaning, Not(HasSubstr("](")));
    EXPECT_THAT(term.meaning, Not(HasSubstr("`")));
  }
}

TEST(Glossary, GivesEachWordOneMeaning) {
  std::map<std::string, std::string> terms;
  for (const Term& term : glossary()) {
    for (const std::string& word : term.words) {
      const auto [known, is_new] = terms.emplace(word, term.name);
      EXPECT_TRUE(is_new) << word << " is explained at '" << known->second << "' and at '"
                          << term.name << "'";
    }
  }
}

TEST(Glossary, FindsTermsAsPeopleWriteThem) {
  for (const char* word : {"component", "Component", "components", " component "}) {
    ASSERT_NE(find_term(word), nullptr) << word;
    EXPECT_EQ(find_term(word)->name, "component");
  }
  ASSERT_NE(find_term("downstream"), nullptr);
  EXPECT_EQ(find_term("downstream"), find_term("upstream"));
  EXPECT_EQ(find_term("policy"), find_term("policies"));
  EXPECT_EQ(find_term("frobnicate"), nullptr);
  EXPECT_EQ(nearest_term("componnet"), "component");
  EXPECT_NE(find_term("REPORT"), nullptr);
  for (const char* look :
       {"DEAD", "TIME_HELD", "time held", "UNWATCHED", "unreachable", "silenced"})
    EXPECT_NE(find_term(look), nullptr) << look;
  EXPECT_THAT(page(*find_term("blind")), HasSubstr("never acts.\n")) << "a link is no text";
  EXPECT_THAT(page(*find_term("component")), HasSubstr("A ROS 2 node that culprit manages"));
}

}  // namespace
}  // namespace culprit::cli
