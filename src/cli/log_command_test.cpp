// culprit log as a user runs it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "base/test_folder.h"
#include "cli/commands.h"
#include "cli/test_command.h"
#include "journal/writer.h"

namespace culprit::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

struct LogCommand : testing::Test {
  void write(Duration age, std::string_view kind, const std::string& body) {
    rows.entries.push_back({0, wall_now() - age.count(), std::string(kind), body});
  }
  // Gives what `culprit log` prints.
  CommandEnd logged(std::vector<std::string> options = {}) {
    auto writer = journal::Writer::open(path, {});
    EXPECT_TRUE(writer) << writer.error();
    EXPECT_TRUE(writer->append(rows, wall_now(), journal::Durability::kPowerFailure));
    rows = {};
    options.insert(options.begin(), {"log", "--journal", path.string()});
    return end_of_command(add_log, std::move(options));
  }

  const test::TestFolder own;
  const std::filesystem::path path = own / "a.journal";
  journal::Batch rows;
};

TEST_F(LogCommand, TakesDurationsAsPeopleTypeThem) {
  write(std::chrono::hours(30), journal::kind::kEvent, R"({"type":"note","text":"of yesterday"})");
  write(std::chrono::minutes(40), journal::kind::kEvent, R"({"type":"note","text":"of today"})");
  for (const char* hour : {"1h", "60m", "60min", "3600", "3600s"}) {
    const CommandEnd end = logged({"--since", hour});
    EXPECT_EQ(end.exit_code, kOk) << hour << ": " << end.err;
    EXPECT_THAT(end.out, AllOf(HasSubstr("of today"), Not(HasSubstr("of yesterday")))) << hour;
  }
  for (const char* days : {"2d", "1.5d", "48h"})
    EXPECT_THAT(logged({"--since", days}).out, HasSubstr("of yesterday")) << days;
  EXPECT_THAT(logged({"--since", "m"}).err, HasSubstr("'m' is not a duration"));
}

}  // namespace
}  // namespace culprit::cli
