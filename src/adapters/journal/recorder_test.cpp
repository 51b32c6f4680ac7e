// What is on the disk when, and what becomes of rows that cannot be written yet.
#include "journal/recorder.h"

#include <fstream>

#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "journal/reader.h"
#include "language/checker.h"

namespace culprit::journal {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr const char* kWatched = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Silent
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms
    STRATEGY redeploy 50 10
      ADAPTATION camera redeploy 2
)";

struct Recording : testing::Test {
  std::unique_ptr<Recorder> begin(std::optional<Writer> writer) {
    Session session;
    session.boot = "boot";
    session.start = now;
    Recorder::Options options;
    options.path = path;
    options.wall_clock = [] { return std::int64_t{1'800'000'000'000'000'000}; };
    return std::make_unique<Recorder>(std::move(writer), options, session, knowledge);
  }
  std::unique_ptr<Recorder> begin() { return begin(std::move(*Writer::open(path, {}))); }

  void sees_a_sample(Recorder& recorder) {
    std::vector<Observation> observations{{now, SampleArrived{TopicId(0)}}};
    recorder.stepped(now, observations, {}, {});
  }
  void asks_for_a_stop(Recorder& recorder) {
    std::vector<Observation> none;
    const std::vector<Command> commands{{CommandId{1}, ComponentId(0), StopProcess{}, 1s}};
    recorder.stepped(now, none, commands, {});
  }
  bool has(std::string_view kind) const {
    const auto reader = Reader::open(path);
    if (!reader) return false;
    auto rows = reader->entries(Which::kAll);
    Entry entry;
    for (bool is_there = rows.has_value(); is_there && *rows->next(entry);)
      if (entry.kind == kind) return true;
    return false;
  }
  // Where a folder should be there is a file, so that no journal can be made in it.
  void block_the_way() {
    path = folder / "blocked" / "a.journal";
    std::ofstream(path.parent_path()) << "in the way";
  }

  const culprit::test::TestFolder folder;
  fs::path path = folder / "a.journal";
  const RuleSet rules = *check(Source("test", kWatched)).rules;
  Knowledge knowledge{rules};
  Time now = Time(1000s);
};

TEST_F(Recording, ARequestIsOnTheDiskBeforeItGoesOut) {
  const auto recorder = begin();
  asks_for_a_stop(*recorder);  // its commands go out as soon as this returns
  EXPECT_TRUE(has(kind::kIntent));
}

TEST_F(Recording, WhatDecidesNothingIsWrittenAtTheEndAtTheLatest) {
  const auto recorder = begin();
  sees_a_sample(*recorder);
  EXPECT_TRUE(recorder->end());
  EXPECT_TRUE(has(kind::kSteps));
}

TEST_F(Recording, RowsWaitForAFileThatCannotBeOpened) {
  block_the_way();
  const auto recorder = begin(std::nullopt);
  asks_for_a_stop(*recorder);
  EXPECT_FALSE(has(kind::kIntent));
  fs::remove(path.parent_path());
  EXPECT_TRUE(recorder->end());
  EXPECT_TRUE(has(kind::kSession)) << "the first row";
  EXPECT_TRUE(has(kind::kIntent));
}

TEST_F(Recording, WhatIsLostIsToldAtTheEnd) {
  block_the_way();
  const auto recorder = begin(std::nullopt);
  sees_a_sample(*recorder);
  const auto ended = recorder->end();
  ASSERT_FALSE(ended);
  EXPECT_NE(ended.error().find("a.journal"), std::string::npos) << ended.error();
}

}  // namespace
}  // namespace culprit::journal
