// The kill switch is never forgotten: whatever becomes of the disk, the journal and the clock
// between two runs, who was paused is paused.
#include "live/order_keeper.h"

#include <csignal>
#include <fstream>
#include <mutex>
#include <sys/mount.h>
#include <sys/resource.h>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "inbox/inbox.h"
#include "journal/order_reserve.h"
#include "language/checker.h"
#include "live/run_journal.h"

namespace culprit::live {
namespace {

namespace fs = std::filesystem;
using culprit::test::TestFolder;
using journal::StandingOrders;
using testing::HasSubstr;
using namespace std::chrono_literals;

constexpr const char* kRules = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Silent
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms
    STRATEGY redeploy 50 10
      ADAPTATION camera redeploy 2
)";
constexpr std::int64_t kWall = 1'800'000'000'000'000'000;
constexpr std::int64_t kDay = 86'400'000'000'000;

// Files may not grow beyond so much while it lives: a disk that is full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit tight = before_;
    tight.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &tight);
  }
  ~FullDisk() { setrlimit(RLIMIT_FSIZE, &before_); }
  FullDisk(const FullDisk&) = delete;

 private:
  rlimit before_{};
};

struct KillSwitch : testing::Test {
  // A run of culprit as far as orders are concerned.
  struct Run {
    Run(const fs::path& path, const RuleSet& rules, std::int64_t wall = kWall)
        : rules_(rules), beginning(begin_journal(path, rules, {live_now(), wall})) {
      std::string trouble;
      beginning.orders = keeper.begin(journal::orders_beside(path), beginning.orders,
                                      beginning.are_orders_kept, trouble);
      if (!beginning.writer) return;
      journal::Session session;
      session.boot = journal::boot_id();
      session.start = live_now();
      session.orders_kept = keeper.is_kept();
      session.is_paused = is_paused();
      write(journal::kind::kSession, to_json(session), wall);
    }
    void write(std::string_view kind, const Json& body, std::int64_t wall) {
      const journal::Batch batch{{{0, wall, std::string(kind), to_line(body)}}, {}};
      const auto written =
          beginning.writer->append(batch, wall, journal::Durability::kPowerFailure);
      ASSERT_TRUE(written) << written.error();
    }
    Kept order(decltype(Order::what) what) {
      const auto keep = keeper.keeping()({1, "ada", "why", std::move(what)}, rules_);
      return keep([this] { ++given; });
    }
    bool is_paused() const { return keeper.orders().pause.has_value(); }
    std::string findings() const {
      std::string all;
      for (const std::string& each : beginning.findings) all += each + "\n";
      return all;
    }

    const RuleSet& rules_;
    OrderKeeper keeper{"the run has not begun"};
    RunBeginning beginning;
    int given = 0;
  };

  const TestFolder folder;
  const fs::path path = folder / "a.journal";
  const RuleSet rules = *check(Source("test", kRules)).rules;
};

TEST_F(KillSwitch, IsOffAtAFirstStart) {
  const Run run(path, rules);
  EXPECT_FALSE(run.is_paused()) << run.findings();
  EXPECT_TRUE(run.keeper.is_kept());
}

TEST_F(KillSwitch, OutlivesTheRunWithDryRunAndSilences) {
  {
    Run run(path, rules);
    EXPECT_TRUE(run.order(Pause{}).is_kept);
    EXPECT_TRUE(run.order(SetDryRun{true}).is_kept);
    EXPECT_TRUE(run.order(Silence{ComponentId(0), {}}).is_kept);
    EXPECT_EQ(run.given, 3);
  }
  {
    Run run(path, rules);
    EXPECT_TRUE(run.is_paused());
    EXPECT_TRUE(run.keeper.orders().dry_run);
    EXPECT_EQ(run.keeper.orders().silences.size(), 1u);
    EXPECT_THAT(run.findings(), HasSubstr("paused"));
    EXPECT_TRUE(run.order(Resume{}).is_kept);
  }
  EXPECT_FALSE(Run(path, rules).is_paused());
}

TEST_F(KillSwitch, IsInForceAndSaidNotToBeKeptOnAFullDisk) {
  Run run(path, rules);
  const FullDisk full(16);
  const Kept kept = run.order(Pause{});
  EXPECT_EQ(run.given, 1) << "at once, whatever the disk does";
  EXPECT_TRUE(kept.is_given);
  EXPECT_FALSE(kept.is_kept);
  EXPECT_THAT(kept.why_not, HasSubstr("a.journal-orders"));
}

// A small disk of its own, that can be filled to the last byte. It needs root.
class SmallDisk {
 public:
  explicit SmallDisk(const fs::path& folder) : folder_(folder) {
    fs::create_directory(folder);
    is_there_ = mount("culprit-test", folder.c_str(), "tmpfs", 0, "size=8m") == 0;
  }
  ~SmallDisk() {
    if (is_there_) umount2(folder_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  bool is_there() const { return is_there_; }
  void fill() const {
    std::FILE* file = std::fopen((folder_ / "filler").c_str(), "wb");
    std::setvbuf(file, nullptr, _IONBF, 0);
    for (const std::size_t size : {std::size_t{4096}, std::size_t{1}}) {
      const std::string bytes(size, 'x');
      while (std::fwrite(bytes.data(), 1, size, file) == size) continue;
    }
    std::fclose(file);
  }
  void free() const { fs::remove(folder_ / "filler"); }

 private:
  const fs::path folder_;
  bool is_there_ = false;
};

// Also by a process that is killed right after: its successor finds the pause.
TEST_F(KillSwitch, IsKeptOnADiskThatIsFull) {
  const SmallDisk disk(folder / "disk");
  if (!disk.is_there()) GTEST_SKIP() << "only root can mount a small disk";
  const fs::path there = folder / "disk" / "a.journal";
  Run run(there, rules);
  disk.fill();
  ASSERT_FALSE(std::ofstream(folder / "disk" / "more") << "x" << std::flush);
  const Kept kept = run.order(Pause{});
  EXPECT_TRUE(kept.is_kept) << kept.why_not;
  EXPECT_TRUE(Run(there, rules).is_paused());
  EXPECT_TRUE(run.order(Resume{}).is_kept);
  EXPECT_FALSE(Run(there, rules).is_paused());
  EXPECT_TRUE(run.order(Silence{ComponentId(0), {}}).is_kept);
  EXPECT_TRUE(run.order(Pause{}).is_kept) << "again and again";
  disk.free();
  EXPECT_TRUE(Run(there, rules).is_paused());
  EXPECT_TRUE(run.order(Resume{}).is_kept) << "in the file again";
  EXPECT_FALSE(Run(there, rules).is_paused()) << "which is newer than the room that was taken";
}

TEST_F(KillSwitch, OfAFileThatIsGoneIsNotFoundInTheRoomBesideIt) {
  {
    Run run(path, rules);
    ASSERT_TRUE(run.order(Pause{}).is_kept);
  }
  const fs::path reserve = journal::reserve_beside(journal::orders_beside(path));
  EXPECT_EQ(fs::file_size(reserve), 32u << 10);
  ASSERT_TRUE(journal::write_reserve(reserve, "what an older run wrote"));
  for (const auto& each : fs::directory_iterator(folder.path())) {
    if (each.path() != reserve) fs::remove(each.path());
  }
  EXPECT_FALSE(Run(path, rules).is_paused()) << "it is a first start";
  EXPECT_EQ(journal::read_reserve(reserve), std::nullopt);
}

TEST_F(KillSwitch, IsLeftOnlyOnceThatIsKept) {
  Run run(path, rules);
  ASSERT_TRUE(run.order(Pause{}).is_kept);
  {
    const FullDisk full(16);
    EXPECT_FALSE(run.order(Resume{}).is_given);
    EXPECT_EQ(run.given, 1);
    EXPECT_TRUE(run.is_paused());
  }
  EXPECT_TRUE(Run(path, rules).is_paused());
  EXPECT_TRUE(run.order(Resume{}).is_kept);
  EXPECT_EQ(run.given, 2);
}

TEST_F(KillSwitch, ThatWasNotKeptNeedsNoDiskToBeLeft) {
  Run run(path, rules);
  const FullDisk full(16);
  EXPECT_FALSE(run.order(Pause{}).is_kept);
  EXPECT_TRUE(run.order(Resume{}).is_given) << "the file says so already";
  EXPECT_FALSE(run.is_paused());
}

TEST_F(KillSwitch, IsKeptAsSoonAsTheDiskIsBack) {
  Run run(path, rules);
  {
    const FullDisk full(16);
    ASSERT_FALSE(run.order(Pause{}).is_kept);
  }
  for (const Time end = live_now() + 30s; !run.keeper.is_kept() && live_now() < end;)
    std::this_thread::sleep_for(20ms);
  EXPECT_TRUE(run.keeper.is_kept_again());
  EXPECT_FALSE(run.keeper.is_kept_again()) << "said once";
  EXPECT_TRUE(Run(path, rules).is_paused());
}

TEST_F(KillSwitch, IsKeptAnewIfItsFileIsRemovedMeanwhile) {
  Run run(path, rules);
  EXPECT_TRUE(run.order(Pause{}).is_kept);
  fs::remove(journal::orders_beside(path));
  for (const Time end = live_now() + 20s;
       !fs::exists(journal::orders_beside(path)) && live_now() < end;)
    std::this_thread::sleep_for(10ms);
  EXPECT_TRUE(fs::exists(journal::orders_beside(path)));
  const Run next(path, rules);
  EXPECT_TRUE(next.is_paused());
}

TEST_F(KillSwitch, OfAnotherMachineRestrainsOnceAndFreesNothing) {
  Run run(path, rules);
  ASSERT_TRUE(run.order(Silence{RuleId(0), {}}).is_kept);
  StandingOrders theirs;
  theirs.pause = StandingOrders::Said{"ann", "hands in the machine"};
  theirs.revision = 5;
  const auto heeded = run.keeper.heed(theirs, rules, live_now());
  ASSERT_EQ(heeded.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<Pause>(heeded[0].what));
  EXPECT_EQ(heeded[0].author, "ann");
  EXPECT_TRUE(run.is_paused());
  EXPECT_EQ(run.keeper.told().silences.size(), 1u);
  EXPECT_TRUE(run.order(Resume{}).is_given);
  EXPECT_THAT(run.keeper.heed(theirs, rules, live_now()), testing::IsEmpty())
      << "a person has resumed it since";
  theirs.pause.reset();
  theirs.revision = 99;
  EXPECT_THAT(run.keeper.heed(theirs, rules, live_now()), testing::IsEmpty());
  EXPECT_EQ(run.keeper.orders().silences.size(), 1u) << "nobody here has lifted it";
}

TEST_F(KillSwitch, IsToldAtOnceAndWhatFreesOnlyOnceItIsKept) {
  Run run(path, rules);
  {
    const FullDisk full(16);
    ASSERT_FALSE(run.order(Pause{}).is_kept);
    EXPECT_TRUE(run.keeper.told().pause);
  }
  ASSERT_TRUE(run.order(Resume{}).is_kept);
  EXPECT_FALSE(run.keeper.told().pause);
  EXPECT_GT(run.keeper.told().revision, 1u);
}

TEST_F(KillSwitch, OfOneThatOnlyAdvisesCannotMakeItAct) {
  Run run(path, rules);
  run.keeper.begin_advising("another culprit manages this robot");
  const Kept kept = run.order(SetDryRun{false});
  EXPECT_FALSE(kept.is_given);
  EXPECT_THAT(kept.why_not, HasSubstr("another culprit"));
  EXPECT_EQ(run.given, 0);
  EXPECT_TRUE(run.order(Pause{}).is_given);
}

TEST_F(KillSwitch, WithoutAJournalIsInForceAndSaidNotToBeKept) {
  Run run(path, rules);
  run.keeper.begin_without("of --no-journal", {});
  EXPECT_FALSE(run.order(Pause{}).is_kept);
  EXPECT_THAT(run.order(Pause{}).why_not, HasSubstr("--no-journal"));
  EXPECT_TRUE(run.order(Resume{}).is_given);
}

TEST_F(KillSwitch, IsOnIfItsFileIsMissingOrDamaged) {
  { const Run run(path, rules); }
  fs::remove(journal::orders_beside(path));
  {
    Run run(path, rules);
    EXPECT_TRUE(run.is_paused());
    EXPECT_THAT(run.findings(), AllOf(HasSubstr("is missing"), HasSubstr("culprit resume")));
    ASSERT_TRUE(run.order(Resume{}).is_kept);
  }
  std::ofstream(journal::orders_beside(path)) << "nonsense";
  EXPECT_TRUE(Run(path, rules).is_paused());
  EXPECT_TRUE(Run(path, rules).is_paused()) << "until a person resumes it";
}

// (b) of the cases: also where the page is that the newest row or the beginning of the run is in.
TEST_F(KillSwitch, OutlivesEveryBadPageOfTheJournal) {
  {
    Run run(path, rules);
    for (int i = 0; i < 200; ++i)
      run.write(journal::kind::kEvent, {{"text", std::string(500, 'x')}}, kWall);
    ASSERT_TRUE(run.order(Pause{}).is_kept);
  }
  const auto pages = fs::file_size(path) / 4096;
  ASSERT_GT(pages, 10u);
  for (std::uintmax_t page = 0; page < pages; ++page) {
    const TestFolder other;
    for (const char* part : {"", "-orders"})
      fs::copy_file(path.string() + part, (other / "a.journal").string() + part);
    std::fstream file(other / "a.journal", std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(page * 4096));
    file << std::string(4096, '\xff');
    file.close();
    EXPECT_TRUE(begin_journal(other / "a.journal", rules, {live_now(), kWall}).orders.pause)
        << page;
  }
}

// (c): no battery, so it begins in 1970; then the network sets the time.
TEST_F(KillSwitch, OutlivesAJumpOfTheClock) {
  {
    Run run(path, rules, 0);
    ASSERT_TRUE(run.order(Pause{}).is_kept);
    ASSERT_TRUE(run.order(Silence{RuleId(0), 1h}).is_kept);
    for (int i = 0; i < 300; ++i) run.write(journal::kind::kEvent, {{"text", "x"}}, 40 * kDay);
  }
  const Run run(path, rules, 40 * kDay);
  EXPECT_TRUE(run.is_paused());
  EXPECT_EQ(run.keeper.orders().silences.size(), 1u);
}

// After a crash something restarts culprit, and no person: what one ended stays down, also with --launch.
TEST_F(KillSwitch, KnowsWhetherTheLastRunWasAskedToEnd) {
  const auto ended_unexpectedly = [&] {
    return begin_journal(path, rules, {live_now(), kWall}).ended_unexpectedly;
  };
  EXPECT_FALSE(ended_unexpectedly()) << "there was none";
  { const Run crashed(path, rules); }
  EXPECT_TRUE(ended_unexpectedly());
  {
    Run stopped(path, rules);
    stopped.write(journal::kind::kEnd, {{"ending", "stopped"}}, kWall);
  }
  EXPECT_FALSE(ended_unexpectedly());
}

TEST_F(KillSwitch, IsKnownFromTheRowsOfAnOlderCulprit) {
  {
    auto writer = journal::Writer::open(path, {});
    ASSERT_TRUE(writer);
    journal::Session session;
    session.boot = journal::boot_id();
    const Json pause = {{"type", "order_accepted"}, {"order", "pause"}, {"author", "ada"}};
    const journal::Batch batch{
        {{0, kWall, "session", to_line(to_json(session))}, {0, kWall, "event", to_line(pause)}},
        {}};
    ASSERT_TRUE(writer->append(batch, kWall, journal::Durability::kProcessEnd));
  }
  {
    Run run(path, rules);
    EXPECT_TRUE(run.is_paused());
    EXPECT_TRUE(run.keeper.is_kept());
    EXPECT_TRUE(run.order(Resume{}).is_kept);
  }
  EXPECT_FALSE(Run(path, rules).is_paused());
}

// The two of them are one after the other, on the disk and in force.
TEST_F(KillSwitch, EndsAsItIsKeptIfTwoPeopleOrderAtOnce) {
  Run run(path, rules);
  std::vector<bool> in_force;
  std::mutex mutex;
  const auto give = [&](decltype(Order::what) what) {
    const bool pauses = std::holds_alternative<Pause>(what);
    const auto keep = run.keeper.keeping()({1, "ada", "", std::move(what)}, rules);
    keep([&, pauses] {
      const std::lock_guard lock(mutex);
      in_force.push_back(pauses);
    });
  };
  for (int i = 0; i < 20; ++i) {
    std::thread other([&] { give(Resume{}); });
    give(Pause{});
    other.join();
    EXPECT_EQ(in_force.back(), run.is_paused());
    EXPECT_EQ(journal::read_orders(journal::orders_beside(path), journal::clocks_now(live_now()))
                  ->value()
                  .pause.has_value(),
              run.is_paused());
  }
}

}  // namespace
}  // namespace culprit::live
