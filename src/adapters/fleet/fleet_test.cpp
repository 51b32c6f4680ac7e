// Robots, a journal each, and a real PostgreSQL.
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <random>
#include <set>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <gtest/gtest.h>

#include "fleet/exchange.h"
#include "fleet/journal_tail.h"
#include "fleet/member.h"
#include "fleet/schema.h"
#include "fleet/test_journal.h"
#include "fleet/test_pooler.h"
#include "fleet/test_postgres.h"
#include "journal/reader.h"
#include "language/checker.h"

namespace culprit::fleet {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

struct Fleet : testing::Test {
  void SetUp() override {
    if (const std::string why = TestPostgres::why_not(); !why.empty()) GTEST_SKIP() << why;
    postgres = std::make_unique<TestPostgres>();
    postgres->set_up_fleet();
  }
  Counts sums() const {
    const Rows rows = postgres->query(
        "SELECT coalesce(sum(helped), 0), coalesce(sum(failed), 0) FROM culprit.outcome");
    return {integer_in(rows[0][0]), integer_in(rows[0][1])};
  }
  std::unique_ptr<TestPostgres> postgres;
  const test::TestFolder folder;
  const std::atomic<bool> stop = false;
};

using CountsByRun = std::map<std::string, Counts>;

// A robot that everything happens to. `heard`: the events that the database must hold, of all
// robots. Copies of a disk have the beginnings of the same runs, so the largest count of a run is
// that of all.
class SimulatedRobot {
 public:
  SimulatedRobot(fs::path folder, std::string machine, std::mt19937& random, CountsByRun& heard)
      : folder_(std::move(folder)), machine_(std::move(machine)), random_(random), heard_(heard) {
    fs::create_directories(folder_);
    journal_.emplace(folder_ / "a.journal");
    begins();
  }

  void begins() {
    // Clocks are wrong now and then.
    if (chance(0.1)) journal_->clock(chance(0.5) ? 0 : std::int64_t{4'000'000'000'000'000'000});
    journal_->begins();
    run_ = tally().run()->id;
  }
  void outcome() {
    const bool has_helped = chance(0.6);
    journal_->outcome(chance(0.5) ? "restart" : "redeploy", has_helped);
    Counts& counts = on_disk_[run_];
    ++(has_helped ? counts.helped : counts.failed);
  }
  // The database is visited, and what goes wrong goes wrong.
  enum class Luck : std::uint8_t { kAny, kGood };
  void visits(Postgres& server, Luck luck = Luck::kAny) {
    const std::atomic<bool> stop = false;
    const bool has_luck = luck == Luck::kGood;
    auto outbox = Outbox::open(outbox_beside(journal_->path()), machine_);
    ASSERT_TRUE(outbox) << outbox.error();
    JournalTail tail(journal_->path());
    ASSERT_TRUE(tail.follow(*outbox, stop));
    if (!has_luck && chance(0.2)) return;  // no link, or killed here
    const bool is_killed = !has_luck && chance(0.2);
    const fs::path kept = folder_ / "kept";
    if (is_killed) copy_outbox(outbox_beside(journal_->path()), kept);
    for (int times = chance(0.2) ? 2 : 1; times > 0; --times) {
      const auto sent = send(server, *outbox, {"robot", *tail.run()},
                             [](const std::string& what) { ADD_FAILURE() << what; });
      ASSERT_TRUE(sent) << sent.error();
    }
    for (const auto& [run, counts] : on_disk_) heard_[run] = std::max(heard_[run], counts, is_less);
    if (!is_killed) return;
    // After the database had it, and before that was written down.
    outbox = Error{""};
    copy_outbox(kept, outbox_beside(journal_->path()));
  }
  void backs_up() {
    journal_->ends();
    copy_disk(folder_ / "disk", folder_ / "backup");
    backup_ = on_disk_;
    begins();
  }
  void is_restored() {
    if (!fs::exists(folder_ / "backup")) return;
    journal_->ends();
    copy_disk(folder_ / "backup", folder_ / "disk");
    on_disk_ = backup_;  // what was lost with the disk and never sent is lost
    begins();
  }
  // Its disk in another robot, which goes on by itself.
  std::unique_ptr<SimulatedRobot> copy(const fs::path& folder, const std::string& machine) {
    journal_->ends();
    fs::create_directories(folder);
    for (const auto& each : fs::directory_iterator(folder_)) {
      if (each.is_regular_file())
        fs::copy_file(each.path(), folder / each.path().filename(),
                      fs::copy_options::overwrite_existing);
    }
    begins();
    auto other = std::make_unique<SimulatedRobot>(folder, machine, random_, heard_);
    other->on_disk_ = on_disk_;
    return other;
  }
  bool chance(double probability) {
    return std::uniform_real_distribution(0.0, 1.0)(random_) < probability;
  }

 private:
  static bool is_less(const Counts& a, const Counts& b) {
    return a.helped + a.failed < b.helped + b.failed;
  }
  Tally tally() const {
    Tally tally;
    const auto reader = journal::Reader::open(journal_->path());
    auto rows = reader->entries(journal::Which::kReadable);
    journal::Entry entry;
    while (*rows->next(entry)) tally.take(entry, rows->hash());
    return tally;
  }
  static void copy_outbox(const fs::path& from, const fs::path& to) {
    for (const char* part : {"", "-wal", "-shm"}) {
      fs::remove(to.string() + part);
      if (fs::exists(from.string() + part)) fs::copy_file(from.string() + part, to.string() + part);
    }
  }
  void copy_disk(const fs::path& from, const fs::path& to) {
    const fs::path here = from.filename() == "disk" ? folder_ : from;
    const fs::path there = to.filename() == "disk" ? folder_ : to;
    fs::create_directories(there);
    for (const auto& each : fs::directory_iterator(there)) {
      if (each.is_regular_file()) fs::remove(each.path());
    }
    for (const auto& each : fs::directory_iterator(here)) {
      if (each.is_regular_file()) fs::copy_file(each.path(), there / each.path().filename());
    }
  }

  fs::path folder_;
  std::string machine_;
  std::mt19937& random_;
  std::optional<TestJournal> journal_;
  std::string run_;
  CountsByRun& heard_;
  CountsByRun on_disk_;
  CountsByRun backup_;
};

// CULPRIT_ROBOTS=1000 in `make soak`.
TEST_F(Fleet, CountsAreTheSumOfWhatHappenedWhateverHappensToRobots) {
  const char* asked = std::getenv("CULPRIT_ROBOTS");
  const int count = asked != nullptr ? std::atoi(asked) : 6;
  std::mt19937 random(7);
  CountsByRun heard;
  std::vector<std::unique_ptr<SimulatedRobot>> robots;
  for (int i = 0; i < count; ++i)
    robots.push_back(std::make_unique<SimulatedRobot>(
        folder / std::to_string(i), "machine " + std::to_string(i), random, heard));
  Postgres server = postgres->connect("rover");
  const auto one_of = [&](int most) { return std::uniform_int_distribution(0, most - 1)(random); };
  for (int step = 0; step < 40 * count; ++step) {
    SimulatedRobot& robot =
        *robots[static_cast<std::size_t>(one_of(static_cast<int>(robots.size())))];
    switch (one_of(12)) {
      case 0:
        robot.begins();
        break;
      case 1:
      case 2:
        robot.visits(server);
        break;
      case 3:
        if (one_of(3) == 0) robot.backs_up();
        break;
      case 4:
        if (one_of(3) == 0) robot.is_restored();
        break;
      case 5: {
        if (one_of(4) != 0) break;
        // On a computer that looks the same, or on another one.
        const std::string name = "copy " + std::to_string(robots.size());
        robots.push_back(robot.copy(folder / name, one_of(2) == 0 ? name : "machine 0"));
        break;
      }
      default:
        robot.outcome();
    }
  }
  for (auto& robot : robots) robot->visits(server, SimulatedRobot::Luck::kGood);
  Counts happened;
  for (const auto& [run, counts] : heard) {
    happened.helped += counts.helped;
    happened.failed += counts.failed;
  }
  EXPECT_EQ(sums(), happened);
  EXPECT_GT(happened.helped + happened.failed, 10 * count);
}

// A process of its own that is killed again and again, while it learns and while it reports.
TEST_F(Fleet, NothingIsLostOrCountedTwiceByOneThatIsKilledAtAnyInstant) {
  const fs::path journal = folder / "a.journal";
  std::mt19937 random(3);
  for (int kills = 0; kills < 12; ++kills) {
    int learned[2];
    ASSERT_EQ(pipe(learned), 0);
    const pid_t child = fork();
    if (child == 0) {
      Member::Pace pace{1ms, 1ms, 1ms, 1h, 1h, 10ms, 10ms};
      Member member({postgres->address("rover"), journal, "robot", "", "machine", pace});
      member.begin(*check(Source("rules", kFleetRules)).rules, {});
      TestJournal writer(journal);
      writer.begins();
      for (int i = 0;; ++i) {
        writer.outcome(i % 3 == 0 ? "restart" : "redeploy", i % 2 == 0);
        if (i == 0 && write(learned[1], "", 1) != 1) _exit(1);
        std::this_thread::sleep_for(2ms);
      }
    }
    close(learned[1]);
    char first = 0;
    EXPECT_EQ(read(learned[0], &first, 1), 1);
    close(learned[0]);
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 150));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
  }
  auto outbox = Outbox::open(outbox_beside(journal), "machine");
  ASSERT_TRUE(outbox) << outbox.error();
  JournalTail tail(journal);
  ASSERT_TRUE(tail.follow(*outbox, stop));
  Postgres server = postgres->connect("rover");
  ASSERT_TRUE(send(server, *outbox, {"robot", *tail.run()}, {}));
  Counts happened;
  const auto reader = journal::Reader::open(journal);
  auto rows = reader->entries(journal::Which::kReadable);
  for (journal::Entry entry; *rows->next(entry);) {
    if (entry.body.find("outcome_counted") == std::string::npos) continue;
    ++(entry.body.find("success") != std::string::npos ? happened.helped : happened.failed);
  }
  EXPECT_GT(happened.helped, 0);
  EXPECT_EQ(sums(), happened);
}

// A member, and all its messages.
struct Listening {
  static constexpr Member::Pace kHurried{1ms, 1ms, 1ms, 1h, 1ms, 1ms, 5ms};

  explicit Listening(const TestPostgres& postgres, const fs::path& journal,
                     const std::string& login = "rover", Member::Pace pace = kHurried)
      : member({postgres.address(login), journal, "rover 7", "", "machine", pace}) {
    member.begin(rules, {[this](PriorsTold told) {
                           const std::lock_guard lock(mutex);
                           priors.push_back(std::move(told));
                         },
                         [this](const std::string& what) {
                           const std::lock_guard lock(mutex);
                           said.push_back(what);
                         }});
  }
  ~Listening() { member.end(); }
  bool says(const std::string& text) const {
    return eventually([&] { return times(text) > 0; });
  }
  int times(const std::string& text) const {
    const std::lock_guard lock(mutex);
    return static_cast<int>(std::count_if(said.begin(), said.end(), [&](const std::string& each) {
      return each.find(text) != std::string::npos;
    }));
  }
  template <class Condition>
  bool eventually(Condition is_true) const {
    for (int i = 0; i < 3000; ++i) {
      if (is_true()) return true;
      const_cast<Member&>(member).happened();
      std::this_thread::sleep_for(10ms);
    }
    const std::lock_guard lock(mutex);
    for (const std::string& each : said) ADD_FAILURE() << "it said: " << each;
    return false;
  }
  const RuleSet rules = *check(Source("rules", kFleetRules)).rules;
  mutable std::mutex mutex;
  std::vector<PriorsTold> priors;
  std::vector<std::string> said;
  Member member;
};

TEST_F(Fleet, TroubleIsSaidOnceAndNothingIsLost) {
  TestJournal journal(folder / "a.journal");
  journal.begins();
  journal.outcome("restart", true);
  postgres->stop();
  fs::create_directory(outbox_beside(journal.path()));  // where the outbox cannot be written then
  Listening robot(*postgres, journal.path());
  std::int64_t happened = 1;
  const auto is_told = [&] { return sums().helped == happened; };
  const auto again = [&](int times) {
    return robot.eventually(
        [&] { return robot.times("reach the fleet's database again") == times; });
  };
  EXPECT_TRUE(robot.says("cannot be kept for the fleet: "));
  fs::remove(outbox_beside(journal.path()));
  EXPECT_TRUE(robot.says("is kept for the fleet again"));
  EXPECT_EQ(robot.times("cannot be kept"), 1);
  EXPECT_TRUE(robot.says("no outcomes reach the fleet's database: "));
  journal.outcome("restart", true);
  std::this_thread::sleep_for(50ms);
  postgres->start();
  ++happened;
  EXPECT_TRUE(again(1));
  EXPECT_TRUE(robot.eventually(is_told));

  struct Case {
    const char* breaks;
    const char* mends;
    const char* said;
  };
  int times = 1;
  for (const Case& each : {
           Case{"ALTER DATABASE postgres SET default_transaction_read_only = on",
                "ALTER DATABASE postgres RESET default_transaction_read_only", "read-only"},
           Case{
               "CREATE FUNCTION full_disk() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN RAISE "
               "EXCEPTION 'could not extend file: No space left on device' USING ERRCODE = "
               "'53100'; END $$; CREATE TRIGGER full_disk BEFORE INSERT ON culprit.outcome EXECUTE "
               "FUNCTION full_disk()",
               "DROP FUNCTION full_disk CASCADE", "No space left"},
           Case{"INSERT INTO culprit.schema_version VALUES(99)",
                "DELETE FROM culprit.schema_version WHERE version = 99", "newer culprit"},
           Case{"ALTER ROLE rover NOLOGIN", "ALTER ROLE rover LOGIN", "not permitted to log in"},
       }) {
    // Without this, a read-only database would also keep its owner's session from mending it.
    postgres->run("ALTER ROLE postgres SET default_transaction_read_only = off");
    postgres->run(each.breaks);
    journal.begins();
    journal.outcome("restart", true);
    ++happened;
    EXPECT_TRUE(robot.says(each.said)) << each.said;
    postgres->run(each.mends);
    EXPECT_TRUE(again(++times)) << each.said;
    EXPECT_TRUE(robot.eventually(is_told)) << each.said;
    EXPECT_EQ(robot.times(each.said), 1);
  }
}

// A connection is what costs.
TEST_F(Fleet, NewsWaitsForMoreUnlessAPersonHasToLook) {
  constexpr Member::Pace kPatient{1ms, 1h, 1ms, 1h, 1h, 1ms, 5ms};
  TestJournal journal(folder / "a.journal");
  journal.begins();
  const Listening robot(*postgres, journal.path(), "rover", kPatient);
  const auto count = [&](const std::string& what) {
    return text_in(postgres->query("SELECT count(*) FROM culprit." + what)[0][0]);
  };
  EXPECT_TRUE(robot.eventually([&] { return count("robot") == "1"; }));
  journal.event("failure_detected", R"(,"rule":"Silent","criticality":"ERROR")");
  journal.outcome("restart", false);
  const auto is_kept = [&] {
    const auto outbox = Outbox::open(outbox_beside(journal.path()), "machine");
    return outbox && outbox->news() && *outbox->news() == Outbox::News::kSome;
  };
  EXPECT_TRUE(robot.eventually(is_kept));
  for (int looks = 0; looks < 10; ++looks) {
    const_cast<Member&>(robot.member).happened();
    std::this_thread::sleep_for(5ms);
  }
  EXPECT_EQ(count("failure"), "0");
  EXPECT_EQ(sums(), Counts{});
  journal.event("rule_exhausted", R"(,"rule":"Silent")");
  EXPECT_TRUE(robot.eventually([&] { return count("failure WHERE exhausted") == "1"; }));
  EXPECT_EQ(sums(), (Counts{0, 1}));
}

TEST_F(Fleet, ADatabaseThatDoesNotAnswerIsNotWaitedFor) {
  TestJournal journal(folder / "a.journal");
  journal.begins();
  journal.outcome("restart", true);
  Postgres owner = postgres->connect();
  ASSERT_TRUE(owner.run("BEGIN; LOCK TABLE culprit.robot"));
  {
    Listening robot(*postgres, journal.path());
    EXPECT_TRUE(robot.eventually(
        [&] { return !owner.query("SELECT 1 FROM pg_locks WHERE NOT granted")->empty(); }));
  }  // ends while it waits
  ASSERT_TRUE(owner.run("ROLLBACK"));
  Listening robot(*postgres, journal.path());
  EXPECT_TRUE(robot.eventually([&] { return sums().helped == 1; }));
}

TEST_F(Fleet, OddNamesAreTakenAndOneThatIsNotKeepsNothingElseBack) {
  TestJournal journal(folder / "a.journal");
  journal.begins();
  journal.event(
      "outcome_counted",
      R"(,"rule":"'; DROP SCHEMA culprit CASCADE; --","strategy":"a\u0000b","as":"success")");
  journal.event("outcome_counted", R"(,"rule":")" + std::string(5000, 'x') +
                                       R"(","strategy":"\\\"$1","as":"success")");
  journal.event("failure_detected", R"(,"rule":"{}","criticality":"\ud83d\ude00")");
  Listening robot(*postgres, journal.path());
  EXPECT_TRUE(robot.eventually([&] { return sums().helped == 2; }));
  postgres->run("ALTER TABLE culprit.outcome ADD CHECK (strategy <> 'unwanted')");
  journal.outcome("unwanted", true);
  journal.outcome("restart", true);
  EXPECT_TRUE(robot.eventually([&] { return sums().helped == 3; }));
  EXPECT_TRUE(robot.says("does not take outcomes of unwanted"));
  const Rows failures = postgres->query("SELECT rule, criticality FROM culprit.failure");
  ASSERT_EQ(failures.size(), 1u);
  EXPECT_EQ(text_in(failures[0][1]), "\xF0\x9F\x98\x80");
}

TEST_F(Fleet, ARobotReadsAndChangesNoRowsButItsOwn) {
  postgres->run("CREATE ROLE stranger LOGIN IN ROLE culprit_robot");
  TestJournal journal(folder / "a.journal");
  journal.begins();
  journal.outcome("restart", true);
  journal.event("failure_detected", R"(,"rule":"Silent","criticality":"ERROR")");
  auto outbox = Outbox::open(outbox_beside(journal.path()), "");
  JournalTail tail(journal.path());
  ASSERT_TRUE(tail.follow(*outbox, stop));
  Postgres rover = postgres->connect("rover");
  ASSERT_TRUE(send(rover, *outbox, {"rover", *tail.run()}, {}));
  const std::string robot = outbox->identity().robot;
  const std::string run = tail.run()->id;
  Postgres stranger = postgres->connect("stranger");
  for (const char* table : {"robot", "run", "outcome", "failure"}) {
    const std::string name = std::string("culprit.") + table;
    EXPECT_EQ(text_in((*rover.query("SELECT count(*) FROM " + name))[0][0]), "1") << table;
    EXPECT_EQ(text_in((*stranger.query("SELECT count(*) FROM " + name))[0][0]), "0") << table;
    EXPECT_FALSE(stranger.query("DELETE FROM " + name)) << table;
    EXPECT_FALSE(rover.query("DELETE FROM " + name)) << "rows cannot be deleted";
  }
  // Forged rows, in the other's name.
  EXPECT_FALSE(
      stranger.query("INSERT INTO culprit.run(run, robot, began, culprit, model, rule_set, "
                     "context) VALUES(gen_random_uuid(), '" +
                     robot + "', now(), '', '', '', '')"));
  EXPECT_FALSE(
      stranger.query("INSERT INTO culprit.outcome(robot, run, rule_set, rule, strategy, "
                     "context, definition, helped, failed) VALUES('" +
                     robot + "', '" + run + "', '', 'R', 's', '', '', 9, 0)"));
  EXPECT_FALSE(
      stranger.query("INSERT INTO culprit.robot(robot, login, name, model, culprit, "
                     "rule_set, context) VALUES(gen_random_uuid(), 'rover', '', '', '', '', '')"))
      << "the login of another robot";
  for (const char* change :
       {"UPDATE culprit.outcome SET helped = 1000", "UPDATE culprit.robot SET name = 'mine'",
        "UPDATE culprit.failure SET ended = now()"})
    (void)stranger.query(change);
  EXPECT_EQ(sums(), (Counts{1, 0}));
  EXPECT_EQ(postgres->query("SELECT 1 FROM culprit.robot WHERE name = 'mine'").size(), 0u);
  EXPECT_EQ(postgres->query("SELECT 1 FROM culprit.failure WHERE ended IS NULL").size(), 1u);
  // Nor may it take back its own rows, or change others.
  ASSERT_TRUE(rover.query("UPDATE culprit.outcome SET helped = 0"));
  EXPECT_EQ(sums(), (Counts{1, 0}));
  for (const char* change :
       {"UPDATE culprit.outcome SET recent_helped = 1000", "UPDATE culprit.robot SET login = 'x'",
        "UPDATE culprit.setting SET value = '0'", "SELECT culprit.maintain()",
        "INSERT INTO culprit.pool VALUES('', 'm', 'r', 's', 'd', 1, 1, 1, 1, 1)",
        "DELETE FROM culprit.failure_other", "SELECT * FROM culprit.failure_other",
        "CREATE TABLE culprit.mine(x int)", "SET ROLE postgres"})
    EXPECT_FALSE(rover.query(change)) << change;
  // It may read the sums of all, and they name no robot.
  EXPECT_TRUE(stranger.query("SELECT culprit.refresh_pool()"));
  EXPECT_EQ(text_in((*stranger.query("SELECT robots FROM culprit.pool"))[0][0]), "1");
  postgres->run("CREATE ROLE boss LOGIN IN ROLE culprit_reader");
  Postgres boss = postgres->connect("boss");
  EXPECT_EQ(text_in((*boss.query("SELECT count(*) FROM culprit.failure"))[0][0]), "1");
  EXPECT_FALSE(boss.query("UPDATE culprit.robot SET name = 'x'"));
}

// However many robots share a login, the owner of a row is found without going through all of them.
TEST_F(Fleet, TheRobotOfARowIsLookedUp) {
  postgres->run(R"sql(
SET session_replication_role = replica;
INSERT INTO culprit.robot(robot, login, name, model, culprit, rule_set, context)
  SELECT md5('r' || i)::uuid, 'rover', '', '', '', '', '' FROM generate_series(1, 5000) i;
INSERT INTO culprit.run(run, robot, began, culprit, model, rule_set, context)
  SELECT md5('u' || i)::uuid, md5('r' || i)::uuid, now(), '', '', '', '' FROM generate_series(1, 5000) i;
ANALYZE;
)sql");
  Postgres rover = postgres->connect("rover");
  for (const std::string statement :
       {"UPDATE culprit.run SET last_heard = now() WHERE run = md5('u1')::uuid",
        "SELECT 1 FROM culprit.outcome WHERE robot = md5('r1')::uuid",
        "SELECT 1 FROM culprit.failure WHERE robot = md5('r1')::uuid"}) {
    const auto plan = rover.query("EXPLAIN " + statement);
    ASSERT_TRUE(plan) << plan.error();
    for (const Row& line : *plan)
      EXPECT_EQ(text_in(line[0]).find("Seq Scan on robot"), std::string::npos) << statement;
  }
}

// Rows go by the login, whoever had its session before.
TEST_F(Fleet, ManyShareTheSessionsOfAPooler) {
  if (const std::string why = TestPooler::why_not(); !why.empty()) GTEST_SKIP() << why;
  postgres->run("CREATE ROLE other LOGIN IN ROLE culprit_robot");
  const TestPooler pooler(*postgres, {"rover", "other"});
  const auto session = [&](const std::string& login) {
    auto server = Postgres::connect(pooler.address(login), stop);
    EXPECT_TRUE(server) << server.error();
    return std::move(*server);
  };
  std::set<std::string> processes;
  for (const std::string login : {"rover", "other"}) {
    for (int i = 0; i < 5; ++i) {
      TestJournal journal(folder / (login + std::to_string(i)));
      journal.begins();
      for (int n = 0; n <= i; ++n) journal.outcome("restart", true);
      auto outbox = Outbox::open(outbox_beside(journal.path()), "");
      JournalTail tail(journal.path());
      ASSERT_TRUE(tail.follow(*outbox, stop));
      Postgres server = session(login);
      ASSERT_TRUE(check_schema(server));
      const auto sent = send(server, *outbox, {login, *tail.run()}, {});
      ASSERT_TRUE(sent) << sent.error();
      processes.insert(text_in((*server.query("SELECT pg_backend_pid()"))[0][0]));
    }
  }
  EXPECT_EQ(processes.size(), 2u) << "one of each login, however many come";
  EXPECT_EQ(sums().helped, 30);
  EXPECT_EQ(text_in((*session("rover").query("SELECT count(*) FROM culprit.robot"))[0][0]), "5");
  EXPECT_EQ(
      text_in(postgres->query("SELECT count(*) FROM culprit.robot WHERE login::text = name")[0][0]),
      "10");
}

TEST_F(Fleet, ANewRobotBeginsWithWhatTheOthersLearned) {
  postgres->run("UPDATE culprit.setting SET value = '0' WHERE name = 'pool_seconds'");
  for (int i = 0; i < 8; ++i) {
    TestJournal journal(folder / ("veteran " + std::to_string(i)));
    journal.begins();
    for (int n = 0; n < 10; ++n) journal.outcome("restart", n == 0);
    auto outbox = Outbox::open(outbox_beside(journal.path()), "");
    JournalTail tail(journal.path());
    ASSERT_TRUE(tail.follow(*outbox, stop));
    Postgres server = postgres->connect("rover");
    ASSERT_TRUE(send(server, *outbox, {"veteran", *tail.run()}, {}));
  }
  TestJournal journal(folder / "novice.journal");
  journal.begins();
  {
    Listening robot(*postgres, journal.path());
    ASSERT_TRUE(robot.eventually([&] {
      const std::lock_guard lock(robot.mutex);
      return robot.priors.size() == 2;
    }));
    const std::lock_guard lock(robot.mutex);
    EXPECT_EQ(robot.priors[0].source, "") << "until the database answers, those of the rules";
    EXPECT_EQ(robot.priors[0].priors.size(), 2u);
    const PriorsTold& told = robot.priors[1];
    EXPECT_EQ(told.source, "8 robots of rover");
    ASSERT_EQ(told.priors.size(), 1u) << "no robot tried the other strategy";
    EXPECT_LT(told.priors[0].alpha / (told.priors[0].alpha + told.priors[0].beta), 0.2);
    EXPECT_LE(told.priors[0].alpha + told.priors[0].beta, 12.1);
  }
  // Without a database it begins where it was.
  postgres->stop();
  Listening robot(*postgres, journal.path());
  ASSERT_TRUE(robot.eventually([&] {
    const std::lock_guard lock(robot.mutex);
    return !robot.priors.empty();
  }));
  {
    const std::lock_guard lock(robot.mutex);
    EXPECT_EQ(robot.priors[0].source, "8 robots of rover");
  }
  // And a database that differs from the others is reported.
  postgres->start();
  for (int n = 0; n < 12; ++n) journal.outcome("restart", true);
  EXPECT_TRUE(
      robot.says("this robot is not like the others of the fleet: restart for Silent helped"));
}

TEST_F(Fleet, OfTwoThatReportAsOneTheSecondBecomesARobotOfItsOwn) {
  TestJournal journal(folder / "a.journal");
  journal.begins();
  journal.outcome("restart", true);
  const auto robots = [&] { return postgres->query("SELECT 1 FROM culprit.robot").size(); };
  Listening first(*postgres, journal.path());
  ASSERT_TRUE(first.eventually([&] { return robots() == 1; }));
  for (const char* part : {"", "-wal", "-shm", "-fleet", "-fleet-wal", "-fleet-shm"}) {
    if (fs::exists(journal.path().string() + part))
      fs::copy_file(journal.path().string() + part, (folder / "b.journal").string() + part);
  }
  TestJournal copy(folder / "b.journal");
  copy.begins();
  copy.outcome("restart", true);
  Listening second(*postgres, copy.path());
  for (int i = 0; i < 3000 && robots() < 2; ++i) {
    if (i % 10 == 0) {
      journal.outcome("restart", true);
      copy.outcome("restart", true);
    }
    first.member.happened();
    second.member.happened();
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_EQ(robots(), 2u);
  EXPECT_TRUE(second.says("another computer reports to the fleet as this robot"));
  EXPECT_EQ(first.times("another computer"), 0);
}

TEST_F(Fleet, ADatabaseIsSetUpAsOftenAsOneLikes) {
  Postgres owner = postgres->connect();
  const auto again = set_up(owner, {});
  ASSERT_TRUE(again) << again.error();
  EXPECT_TRUE(again->empty()) << again->front();
  // Rows older than the retention period are dropped with their month.
  postgres->run(
      "CREATE TABLE culprit.failure_2019_01 PARTITION OF culprit.failure FOR VALUES FROM "
      "('2019-01-01') TO ('2019-02-01')");
  const auto kept = set_up(owner, {.keep_days = 100});
  ASSERT_TRUE(kept) << kept.error();
  ASSERT_EQ(kept->size(), 1u);
  EXPECT_EQ(kept->front(), "dropped the partition failure_2019_01");
  postgres->run("INSERT INTO culprit.schema_version VALUES(99)");
  const auto newer = set_up(owner, {});
  ASSERT_FALSE(newer);
  EXPECT_NE(newer.error().find("newer culprit"), std::string::npos);
  // A login that may not.
  postgres->run("CREATE ROLE somebody LOGIN");
  Postgres somebody = postgres->connect("somebody");
  EXPECT_FALSE(set_up(somebody, {}));
}

}  // namespace
}  // namespace culprit::fleet
