#include "cli/journal_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::cli {
namespace {

// It may be of somebody else, who wrote it by hand.
TEST(JournalFile, ARowSteersNoTerminal) {
  journal::Entry entry;
  entry.kind = journal::kind::kEvent;
  entry.body = R"({"type": "trouble\u001b[2J", "text": "\u001b]0;evil\u0007"})";
  const std::string line = log_line(entry);
  EXPECT_THAT(line, testing::HasSubstr("\\x1b]0;evil\\x07"));
  EXPECT_THAT(line, testing::Not(testing::HasSubstr("\x1b")));
}

}  // namespace
}  // namespace culprit::cli
