// Rows that the next run needs are never dropped, however long a run lasts and whatever the clock
// shows. Also measures what it costs to write them.
#include <atomic>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "journal/recorder.h"
#include "journal/recovery.h"
#include "language/checker.h"

namespace culprit::journal {
namespace {

namespace fs = std::filesystem;
using culprit::test::TestFolder;
using namespace std::chrono_literals;

constexpr const char* kRetentionRules = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Silent
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms
    STRATEGY redeploy 50 10
      ADAPTATION camera redeploy 2
)";
constexpr std::int64_t kWall = 1'800'000'000'000'000'000;
constexpr std::int64_t kDay = 86'400'000'000'000;

struct Recovered : testing::Test {
  // Writes down what a robot shows that is well, at the rate of SUNSET.
  void live(Recorder& recorder, Duration time) {
    for (const Time end = now + time; now < end; now += 50ms, clock += 50'000'000) {
      std::vector<Observation> observations;
      for (int i = 0; i < 5; ++i)
        observations.push_back({now - Duration(random() % 40'000'000), SampleArrived{TopicId(0)}});
      recorder.stepped(now, observations, {}, {});
      if (++steps % 420 == 0) wait_for_rows();
    }
  }
  // The recorder has its own thread; time is ours. After so many steps, some rows are written.
  void wait_for_rows() {
    const auto size = [&]() -> std::uintmax_t {
      std::error_code error;
      return fs::file_size(path.string() + "-wal", error);
    };
    const std::uintmax_t before = seen;
    for (int i = 0; i < 1000 && (seen = size()) == before; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  std::unique_ptr<Recorder> recorder(Writer::Options writer = {}) {
    Session session;
    session.boot = boot_id();
    session.start = now;
    Recorder::Options options;
    options.path = path;
    options.writer = writer;
    options.wall_clock = [this] { return clock.load(); };
    options.on_trouble = [this](const std::string& what) { troubles.push_back(what); };
    return std::make_unique<Recorder>(std::move(*Writer::open(path, writer)), options, session,
                                      knowledge);
  }
  std::uint64_t random() { return state = state * 6364136223846793005u + 1442695040888963407u; }
  Recovery recovered() {
    const auto reader = Reader::open(path);
    const auto recovery = recover(*reader, {}, rules, {now, clock});
    EXPECT_TRUE(recovery) << recovery.error();
    return *recovery;
  }

  const TestFolder folder;
  const fs::path path = folder / "a.journal";
  const RuleSet rules = *check(Source("test", kRetentionRules)).rules;
  Knowledge knowledge{rules};
  Time now = Time(1000s);
  std::atomic<std::int64_t> clock = kWall;  // what the wall clock shows; the recorder's thread asks
  std::uint64_t state = 1;
  int steps = 0;
  std::uintmax_t seen = 0;
  std::vector<std::string> troubles;  // of the recorder's thread: to be read when it has ended
};

TEST_F(Recovered, LacksASecondCopyOfWhatWasLearnedOnlyAfterThatWasSaid) {
  fs::create_directories(learned_beside(path) / "in the way");
  recorder().reset();
  ASSERT_EQ(troubles.size(), 1u);
  EXPECT_THAT(troubles[0], testing::HasSubstr("so only the journal has it"));
  EXPECT_THAT(troubles[0], testing::HasSubstr("a.journal-learned"));
}

TEST_F(Recovered, IsWhatARunLeftWhoseFirstRowsAreGone) {
  Writer::Options small;
  small.max_bytes = 128 << 10;
  auto run = recorder(small);
  {
    std::vector<Observation> none;
    const std::vector<Event> events = {{now, FailureDetected{RuleId(0)}}};
    run->stepped(now, none, {}, events);
  }
  live(*run, 630s);
  run.reset();
  const auto reader = Reader::open(path);
  EXPECT_GT(reader->anchor()->id, 2) << "the first session row is gone";
  const Recovery found = recovered();
  EXPECT_TRUE(found.had_run);
  ASSERT_EQ(found.past.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<FailureDetected>(found.past[0].what));
  EXPECT_LT(fs::file_size(path), 512u << 10);
}

// No battery: it begins in 1970, and a minute later the network gives the time.
TEST_F(Recovered, IsWhatARunLeftWhoseClockJumped) {
  clock = 0;
  auto run = recorder();
  live(*run, 60s);
  clock += 40 * kDay;
  live(*run, 60s);
  run.reset();
  EXPECT_TRUE(recovered().had_run);
}

TEST_F(Recovered, CostsFewBytesOfTheDisk) {
  const auto written = [] {
    std::ifstream io("/proc/self/io");
    std::string word;
    std::uint64_t value = 0;
    while (io >> word >> value) {
      if (word == "wchar:") return value;
    }
    return std::uint64_t{0};
  };
  Writer::Options often;  // so that moving it into the file counts as well
  often.max_wal_bytes = 512 << 10;
  auto run = recorder(often);
  live(*run, 42s);
  const std::uint64_t before = written();
  constexpr Duration kTime = 630s;
  live(*run, kTime);
  const double per_second = static_cast<double>(written() - before) / seconds(kTime);
  run.reset();
  const auto reader = Reader::open(path);
  const auto rows = reader->database().number("SELECT sum(length(body)) FROM entry");
  const double of_rows = static_cast<double>(*rows) / seconds(kTime);
  std::printf("%.0f bytes/s written, %.0f bytes/s of rows\n", per_second, of_rows);
  EXPECT_GT(of_rows, 800);
  EXPECT_LT(per_second, 2000);
}

}  // namespace
}  // namespace culprit::journal
