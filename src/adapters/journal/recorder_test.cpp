// Checks which rows are on the disk at which time, and what happens to rows that cannot be written
// yet.
#include "journal/recorder.h"

#include <csignal>
#include <fstream>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_expected.h"
#include "base/test_folder.h"
#include "journal/reader.h"
#include "journal/unwritten.h"
#include "language/checker.h"

namespace culprit::journal {
namespace {

namespace fs = std::filesystem;
using culprit::test::value_of;
using testing::HasSubstr;
using testing::IsEmpty;
using namespace std::chrono_literals;

constexpr const char* kWatched = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Silent
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms
    STRATEGY redeploy 50 10
      ADAPTATION camera redeploy 2
    STRATEGY brighten 50 10
      ADAPTATION camera increase_parameter gain 0.5 2
RULE Blurred
  POLICIES ERROR
  TRIGGER blur > 0.5
    STRATEGY again 50 10
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
    options.unwritten = unwritten;
    options.on_trouble = [this](const std::string& what) {
      const MutexLock lock(mutex);
      troubles.push_back(what);
    };
    return std::make_unique<Recorder>(std::move(writer), options, session, knowledge);
  }
  std::unique_ptr<Recorder> begin() { return begin(std::move(*Writer::open(path, {}))); }

  void sees_a_sample(Recorder& recorder) {
    std::vector<Observation> observations{{now, SampleArrived{TopicId(0)}}};
    recorder.stepped(now, observations, {}, {});
  }
  void asks_for_a_stop(Recorder& recorder) {
    std::vector<Observation> none;
    const std::vector<Command> commands{{CommandId{++asked}, ComponentId(0), StopProcess{}, 1s}};
    recorder.stepped(now, none, commands, {});
  }
  void asks_for_more(Recorder& recorder) {
    std::vector<Observation> none;
    Command command{CommandId{++asked}, ComponentId(0), SetParameter{"gain", Value(1.5)}, 1s};
    command.purpose.strategy = StrategyId(1);
    recorder.stepped(now, none, std::vector{command}, {});
  }
  void sees_a_failure(Recorder& recorder) {
    std::vector<Observation> none;
    const std::vector<Event> events{{now, FailureDetected{RuleId(0)}}};
    recorder.stepped(now, none, {}, events);
  }
  void hears_that_it_is_done(Recorder& recorder) {
    std::vector<Observation> observations{{now, Reply{CommandId{asked}, Outcome::kDone, {}, ""}}};
    recorder.stepped(now, observations, {}, {});
  }
  // The kinds of rows that the next run would find beside the journal.
  std::vector<std::string> beside(const fs::path& journal) const {
    std::vector<std::string> kinds;
    const Unwritten found =
        unwritten_rows(intents_beside(journal), value_of(Reader::open(journal)));
    EXPECT_THAT(found.remark, IsEmpty());
    for (const Entry& row : found.rows) kinds.push_back(row.kind);
    return kinds;
  }
  bool comes_true(const std::function<bool()>& is_true) const {
    for (int i = 0; i < 3000 && !is_true(); ++i) std::this_thread::sleep_for(10ms);
    return is_true();
  }
  // While this exists, no other process writes the journal: the recorder's thread hangs.
  Database lock_the_file() const {
    Database other = value_of(Database::open(path, Database::Mode::kWrite));
    EXPECT_TRUE(other.run("BEGIN IMMEDIATE"));
    return other;
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
  std::uint64_t asked = 0;
  std::vector<Entry> unwritten;
  Mutex mutex;
  std::vector<std::string> troubles CULPRIT_GUARDED_BY(mutex);
};

// Its camera is a process on this machine.
struct RecordingHere : Recording {
  RecordingHere() { knowledge.components[ComponentId(0)].node_pid = 4711; }
};

TEST_F(Recording, ARequestIsOnTheDiskBeforeItGoesOut) {
  const auto recorder = begin();
  asks_for_a_stop(*recorder);  // its commands go out as soon as this returns
  EXPECT_TRUE(has(kind::kIntent));
}

TEST_F(RecordingHere, ARequestThatIsReadBackIsBesideTheJournalBeforeItGoesOut) {
  const auto recorder = begin();
  auto locked = lock_the_file();
  asks_for_a_stop(*recorder);
  EXPECT_FALSE(has(kind::kIntent));
  EXPECT_EQ(beside(path), std::vector<std::string>{"intent"});
  ASSERT_TRUE(locked.run("ROLLBACK"));
  EXPECT_TRUE(comes_true([&] { return has(kind::kIntent); }));
  EXPECT_THAT(beside(path), IsEmpty());
}

// A culprit that is killed in between leaves the intent; the journal need not wait for its next
// time.
TEST_F(RecordingHere, TheJournalFollowsWhenTheRequestIsOut) {
  const auto recorder = begin();
  sees_a_failure(*recorder);
  ASSERT_TRUE(comes_true([&] { return has(kind::kEvent); })) << "and its thread waits again";
  std::vector<Observation> none;
  const std::vector<Command> commands{{CommandId{1}, ComponentId(0), StopProcess{}, 1s}};
  const auto began = std::chrono::steady_clock::now();
  recorder->before_commands(now, none, commands, {});
  EXPECT_TRUE(has(kind::kIntent) || !beside(path).empty());
  recorder->after_commands();
  EXPECT_TRUE(comes_true([&] { return has(kind::kIntent); }));
  EXPECT_LT(std::chrono::steady_clock::now() - began, Recorder::kPeriod / 2);
}

TEST_F(RecordingHere, WhatAnIntentFollowsFromIsBesideItUnlessTheJournalHasIt) {
  const auto recorder = begin();
  asks_for_a_stop(*recorder);
  ASSERT_TRUE(comes_true([&] { return has(kind::kIntent); }));
  auto locked = lock_the_file();
  hears_that_it_is_done(*recorder);
  sees_a_failure(*recorder);
  asks_for_a_stop(*recorder);
  EXPECT_EQ(beside(path), (std::vector<std::string>{"outcome", "event", "intent"}));
  ASSERT_TRUE(locked.run("ROLLBACK"));
  ASSERT_TRUE(comes_true([&] { return beside(path).empty(); }));
}

TEST_F(RecordingHere, WhatCannotBeReadBackIsOnTheDiskFirst) {
  const auto recorder = begin();
  asks_for_more(*recorder);
  EXPECT_TRUE(has(kind::kIntent));
}

TEST_F(RecordingHere, WhatWasLearnedWithTheRequestIsOnTheDiskFirst) {
  const auto recorder = begin();
  knowledge.beliefs.set(StrategyId(0), {9, 5});
  std::vector<Observation> none;
  const std::vector<Command> commands{{CommandId{1}, ComponentId(0), StopProcess{}, 1s}};
  const std::vector<Event> events{{now, FailureDetected{RuleId(0)}}};
  recorder->stepped(now, none, commands, events);
  EXPECT_TRUE(has(kind::kIntent));
  EXPECT_TRUE(has(kind::kBelief));
}

TEST_F(Recording, HowLateARuleIsIsOnRecordWhenItChanges) {
  constexpr RuleId kBlurred{std::size_t{1}};
  const auto learned = [&] { return value_of(value_of(Reader::open(path)).learned()).latencies; };
  knowledge.latencies.cleared(kBlurred, 1s);
  const auto recorder = begin();
  sees_a_failure(*recorder);
  EXPECT_THAT(learned(), IsEmpty()) << "the session has it already";
  knowledge.latencies.cleared(kBlurred, 2s);
  sees_a_failure(*recorder);
  EXPECT_EQ(learned(), (std::vector<LearnedLatency>{{"Blurred", 2, 1, 2}}));
  EXPECT_TRUE(has(kind::kLatency));
  knowledge.latencies.forget(kBlurred);
  sees_a_failure(*recorder);
  EXPECT_EQ(learned(), (std::vector<LearnedLatency>{{"Blurred", 0, 0, 0}}));
}

TEST_F(Recording, ExposureIsOnRecordOnceWhenItChanges) {
  const auto recorder = begin();
  knowledge.couplings.stayed_away(RuleId(0), RuleId(1), 1.3);
  for (int i = 0; i < 3; ++i) sees_a_failure(*recorder);
  EXPECT_TRUE(recorder->end());
  const Reader reader = value_of(Reader::open(path));
  EXPECT_EQ(value_of(reader.learned()).couplings,
            (std::vector<LearnedCoupling>{{"Silent", "Blurred", {0, 0, 1.3}}}));
  int written = 0;
  auto rows = value_of(reader.entries(Which::kReadable));
  Entry entry;
  while (value_of(rows.next(entry))) written += entry.kind == kind::kCoupling ? 1 : 0;
  EXPECT_EQ(written, 1);
}

TEST_F(Recording, FailuresThatClearByThemselvesAreOnRecord) {
  constexpr RuleId kBlurred{std::size_t{1}};
  const auto recorder = begin();
  knowledge.transients.add(kBlurred, {2, 1, 3s});
  sees_a_failure(*recorder);
  EXPECT_EQ(value_of(value_of(Reader::open(path)).learned()).latencies,
            (std::vector<LearnedLatency>{{"Blurred clears by itself", 2, 3, 3},
                                         {"Blurred stays", 1, 0, 0}}));
}

// The file is locked: waiting would take Recorder::kPatience.
TEST_F(Recording, ADetectionDoesNotWaitUntilFailuresThatBeganTogetherAreOnTheDisk) {
  const auto recorder = begin();
  auto locked = lock_the_file();
  knowledge.coincidences.began(RuleId(1), {});
  knowledge.coincidences.began(RuleId(0), std::vector{RuleId(1)});
  const auto began = std::chrono::steady_clock::now();
  sees_a_failure(*recorder);
  EXPECT_LT(std::chrono::steady_clock::now() - began, Recorder::kPatience / 2);
  ASSERT_TRUE(locked.run("ROLLBACK"));
  const auto learned = [&] {
    return value_of(value_of(Reader::open(path)).learned()).coincidences;
  };
  const std::vector<LearnedCoincidence> once = {
      {"Blurred", "Blurred", 1}, {"Blurred", "Silent", 1}, {"Silent", "Silent", 1}};
  EXPECT_TRUE(comes_true([&] { return learned() == once; })) << "soon, without the next row";
  knowledge.coincidences.began(RuleId(0), {});
  sees_a_failure(*recorder);
  EXPECT_TRUE(recorder->end());
  EXPECT_THAT(learned(), testing::Contains(LearnedCoincidence{"Silent", "Silent", 2}));
}

// A thread that writes to such a disk may not come back.
TEST_F(RecordingHere, WhileTheDiskDoesNotAnswerARequestWaitsForTheJournalAndNotForEver) {
  const auto recorder = begin();
  auto locked = lock_the_file();
  asks_for_a_stop(*recorder);
  // The recorder's thread has to have tried for a while before the disk counts as stalled.
  using Clock = std::chrono::steady_clock;
  std::size_t before = 0;
  Duration waited{};
  for (const auto end = Clock::now() + 60s; before < beside(path).size() && Clock::now() < end;) {
    std::this_thread::sleep_for(20ms);
    before = beside(path).size();
    const auto began = Clock::now();
    asks_for_a_stop(*recorder);
    waited = Clock::now() - began;
  }
  EXPECT_EQ(beside(path).size(), before) << "what waited for the journal is not beside it";
  EXPECT_GE(before, 1u) << "the first is";
  EXPECT_LT(waited, Recorder::kPatience + 10s);
  ASSERT_TRUE(locked.run("ROLLBACK"));
  EXPECT_TRUE(recorder->end());
  EXPECT_THAT(beside(path), IsEmpty());
}

TEST_F(RecordingHere, WithoutTheFileBesideItARequestIsOnTheDiskFirst) {
  const auto recorder = begin();
  fs::remove(intents_beside(path));
  asks_for_a_stop(*recorder);
  EXPECT_TRUE(has(kind::kIntent));
  // The recorder's thread makes it again.
  ASSERT_TRUE(comes_true([&] { return fs::exists(intents_beside(path)); }));
  auto locked = lock_the_file();
  asks_for_a_stop(*recorder);
  EXPECT_EQ(beside(path), std::vector<std::string>{"intent"});
  ASSERT_TRUE(locked.run("ROLLBACK"));
}

TEST_F(RecordingHere, WhereNoFileCanBeBesideItThatIsSaidAndARequestIsOnTheDiskFirst) {
  fs::create_directory(intents_beside(path));
  const auto recorder = begin();
  asks_for_a_stop(*recorder);
  EXPECT_TRUE(has(kind::kIntent));
  EXPECT_TRUE(recorder->end());
  const MutexLock lock(mutex);
  ASSERT_EQ(troubles.size(), 1u) << "once";
  EXPECT_THAT(troubles[0], HasSubstr("a.journal-intents"));
}

TEST_F(RecordingHere, TheFileBesideItIsEmptyAtTheEnd) {
  const auto recorder = begin();
  for (int i = 0; i < 5; ++i) asks_for_a_stop(*recorder);
  EXPECT_TRUE(recorder->end());
  EXPECT_EQ(fs::file_size(intents_beside(path)), 0u);
}

TEST_F(RecordingHere, WhatTheLastRunCouldNotWriteComesBeforeTheFirstRow) {
  unwritten = {{0, 1'800'000'000'000'000'000, std::string(kind::kIntent), "{}"}};
  EXPECT_TRUE(begin()->end());
  const auto row = value_of(value_of(Reader::open(path)).entry(1));
  ASSERT_TRUE(row);
  EXPECT_EQ(row->kind, kind::kIntent);
  EXPECT_EQ(value_of(value_of(Reader::open(path)).entry(2))->kind, kind::kSession);
}

// Each time in a process of its own, which is killed so long after the request may go out.
TEST_F(RecordingHere, AKilledProcessLeavesTheIntentOnce) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  constexpr const char* kPlace = "CULPRIT_RECORDER_TEST_FOLDER";
  if (std::getenv(kPlace) == nullptr) setenv(kPlace, folder.path().c_str(), 1);
  const fs::path place = std::getenv(kPlace);
  for (const int micros : {0, 200, 1000, 5000, 50'000}) {
    path = place / (std::to_string(micros) + ".journal");
    EXPECT_EXIT(
        {
          const auto recorder = begin();
          sees_a_failure(*recorder);
          asks_for_a_stop(*recorder);
          std::this_thread::sleep_for(std::chrono::microseconds(micros));
          kill(getpid(), SIGKILL);
        },
        testing::KilledBySignal(SIGKILL), "");
    const Reader reader = value_of(Reader::open(path));
    int intents = 0;
    auto rows = value_of(reader.entries(Which::kReadable));
    Entry entry;
    while (value_of(rows.next(entry))) intents += entry.kind == kind::kIntent ? 1 : 0;
    for (const std::string& kind : beside(path)) intents += kind == kind::kIntent ? 1 : 0;
    EXPECT_EQ(intents, 1) << micros;
  }
  unsetenv(kPlace);
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
