// culprit log as a user runs it.
#include <algorithm>

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
    if (!rows.entries.empty()) {
      auto writer = journal::Writer::open(path, {});
      EXPECT_TRUE(writer) << writer.error();
      EXPECT_TRUE(writer->append(rows, wall_now(), journal::Durability::kPowerFailure));
      rows = {};
    }
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

// A repair in few lines: what was asked for is there, its answer only if it is not the usual one.
TEST_F(LogCommand, LeavesDetailsOutUnlessAllAreWanted) {
  namespace kind = journal::kind;
  const auto now = Duration::zero();
  write(now, kind::kRobot, R"({"text":"5 components were seen"})");
  write(now, kind::kEvent,
        R"({"type":"lifecycle_intended","component":"camera","lifecycle":"active"})");
  write(now, kind::kEvent, R"({"type":"failure_detected","text":"CameraDark detected"})");
  write(now, kind::kEvent,
        R"({"type":"incident_opened","incident":"a-1","headline":"it is down"})");
  write(now, kind::kIntent, R"({"command":1,"text":"camera: stop process"})");
  write(now, kind::kEvent,
        R"({"type":"incident_changed","incident":"a-1","headline":"it is late"})");
  write(now, kind::kOutcome,
        R"({"command":1,"outcome":"done","text":"camera: stop process: done"})");
  write(now, kind::kOutcome, R"({"command":2,"outcome":"failed","text":"camera: start: failed"})");
  write(now, kind::kBelief, R"({"rule":"CameraDark","strategy":"brighten","alpha":9,"beta":3})");
  const std::string few = logged().out;
  EXPECT_EQ(std::count(few.begin(), few.end(), '\n'), 5) << few;
  EXPECT_THAT(few, AllOf(HasSubstr("CameraDark detected"), HasSubstr("a-1: it is down"),
                         HasSubstr("camera: stop process\n"), HasSubstr("camera: start: failed"),
                         HasSubstr("brighten of CameraDark: success rate 75 %")));
  const std::string all = logged({"--all"}).out;
  EXPECT_EQ(std::count(all.begin(), all.end(), '\n'), 9) << all;
  EXPECT_THAT(logged({"--kind", "robot"}).out, HasSubstr("5 components were seen"));
  EXPECT_THAT(logged({"--json"}).out, HasSubstr("incident_changed"));
  // As many lines as are wanted, whatever lies between them.
  const std::string latest = logged({"--lines", "3"}).out;
  EXPECT_EQ(std::count(latest.begin(), latest.end(), '\n'), 3) << latest;
  EXPECT_THAT(latest, HasSubstr("camera: stop process\n"));
}

}  // namespace
}  // namespace culprit::cli
