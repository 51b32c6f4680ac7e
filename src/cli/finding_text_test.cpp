#include "cli/finding_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

// A topic of a recording may be called like that.
TEST(FindingText, SteersNoTerminal) {
  doctor::Finding finding;
  finding.code = "D212";
  finding.subject = "log of /a\x1b]0;evil\x07";
  finding.seen = "\x1b[2J";
  finding.remedy = "read it";
  const std::string text = finding_text(finding, Colour::kOff);
  EXPECT_THAT(text, HasSubstr("log of /a\\x1b]0;evil\\x07"));
  EXPECT_THAT(text, Not(HasSubstr("\x1b")));
  EXPECT_THAT(text, Not(HasSubstr("\x07")));
}

}  // namespace
}  // namespace culprit::cli
