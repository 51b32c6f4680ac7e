#include "language/reparse.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "language/test_edits.h"
#include "language/test_tree.h"

namespace culprit {
namespace {

std::string tree_and_words(const Parsed& parsed) {
  std::string out = tree_text(parsed.file, Places::kShown);
  for (const Diagnostic& d : parsed.said) {
    out += "\n" + std::to_string(d.span.begin) + "-" + std::to_string(d.span.end) + " " +
           render(d, parsed.source);
    if (d.fix)
      out +=
          std::to_string(d.fix->span.begin) + "-" + std::to_string(d.fix->span.end) + d.fix->text;
  }
  return out;
}

RC_GTEST_PROP(Reparse, GivesWhatAParseOfTheWholeTextGives, ()) {
  std::string text = random_start();
  Parsed parsed = parse_whole(Source("test.rules", text));
  for (int edits = *rc::gen::inRange(1, 12); edits > 0; --edits) {
    text = edited(std::move(text));
    const Source source("test.rules", text);
    parsed = reparse(std::move(parsed), source);
    RC_ASSERT(parsed.source.text() == source.text());
    RC_ASSERT(tree_and_words(parsed) == tree_and_words(parse_whole(source)));
  }
}

// A rule that is typed and taken away again between others that stay.
TEST(Reparse, MovesWhatStandsBehindTheChange) {
  const std::string first = "ROBOT a\nRULE First\n  POLICIES ERROR\n";
  const std::string last = "RULE Last\n  POLICIES ERROR\n  TRIGGER x > 1\nCONST broken\n";
  const std::string typed = "RULE Typed\r\n  TRIGGER y > \"ä\r\n";
  Parsed parsed = parse_whole(Source("test.rules", first + last));
  for (std::size_t size = 0; size <= typed.size(); ++size) {
    const Source source("test.rules", first + typed.substr(0, size) + last);
    parsed = reparse(std::move(parsed), source);
    EXPECT_EQ(tree_and_words(parsed), tree_and_words(parse_whole(source))) << size;
  }
  parsed = reparse(std::move(parsed), Source("test.rules", first + last));
  EXPECT_EQ(tree_and_words(parsed),
            tree_and_words(parse_whole(Source("test.rules", first + last))));
}

TEST(Reparse, KnowsThatASecondRobotIsTheFirstOneWhenThatGoes) {
  const std::string rules = "RULE A\n  POLICIES ERROR\nRULE B\nROBOT second\nCYCLE 1s\n";
  for (const std::string before : {"", "ROBOT first\n", "CYCLE 2s\n", "ROBOT first\nCYCLE 2s\n"}) {
    for (const std::string after : {"", "ROBOT other\n", "CYCLE 2s\n", "ROBOT first\nCYCLE 2s\n"}) {
      const Source source("test.rules", after + rules);
      const Parsed parsed = reparse(parse_whole(Source("test.rules", before + rules)), source);
      EXPECT_EQ(tree_and_words(parsed), tree_and_words(parse_whole(source)))
          << before << "to " << after;
    }
  }
}

// A part of a rule that stands in front breaks the next rule, wherever that is.
TEST(Reparse, KnowsThatAStrayPartBreaksARuleOfATemplate) {
  const std::string rest =
      "CONST a = 1\nTEMPLATE t\nRULE Inner\nPOLICIES ERROR\nEND\nCONST b = 2\nRULE Outer\n";
  for (const std::string before : {"", "TRIGGER x > 1\n"}) {
    for (const std::string after : {"", "TRIGGER x > 1\n", "CONST c = 3\n"}) {
      const Source source("test.rules", after + rest);
      const Parsed parsed = reparse(parse_whole(Source("test.rules", before + rest)), source);
      EXPECT_EQ(tree_and_words(parsed), tree_and_words(parse_whole(source)))
          << before << "to " << after;
    }
  }
}

}  // namespace
}  // namespace culprit
