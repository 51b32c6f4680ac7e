// Checks the promises of a journal file: all of a batch or nothing, a chain that shows every
// change, one writer, a bounded size. Also checks the file when the disk, the file or another
// program is in the way.
#include "journal/writer.h"

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <sys/resource.h>
#include <unistd.h>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_expected.h"
#include "base/test_folder.h"
#include "journal/reader.h"
#include "journal/verify.h"
#include "json/json.h"

namespace culprit::journal {
namespace {

using culprit::test::TestFolder;
using culprit::test::value_of;
using testing::HasSubstr;

constexpr std::int64_t kWrittenAt = 1'800'000'000'000'000'000;

Writer open(const std::filesystem::path& path, Writer::Options options = {}) {
  return value_of(Writer::open(path, options));
}

Batch batch(int events, std::size_t size = 10) {
  Batch all;
  for (int i = 0; i < events; ++i)
    all.entries.push_back(
        {0, kWrittenAt, std::string(kind::kEvent), to_line({{"text", std::string(size, 'x')}})});
  return all;
}

Expected<void> append(Writer& writer, const Batch& all) {
  return writer.append(all, kWrittenAt, Durability::kProcessEnd);
}

Verification verified(const std::filesystem::path& path, std::optional<Link> noted = {}) {
  const Reader reader = value_of(Reader::open(path));
  return value_of(verify(reader, noted));
}

void run_sql(const std::filesystem::path& path, const std::string& sql) {
  auto database = value_of(Database::open(path, Database::Mode::kWrite));
  const auto done = database.run(sql);
  ASSERT_TRUE(done) << done.error();
}

const LearnedBelief kBelief{"Rule", "strategy", {6.1, 4.3}, {5, 4}};

TEST(Writer, KeepsRowsAndWhatWasLearnedAcrossRuns) {
  const TestFolder folder;
  {
    Writer writer = open(folder / "a.journal");
    Batch all = batch(3);
    all.learned.beliefs = {kBelief};
    ASSERT_TRUE(append(writer, all));
  }
  Writer writer = open(folder / "a.journal");
  EXPECT_EQ(writer.last_id(), 4) << "three events, and the belief";
  EXPECT_EQ(value_of(writer.learned()).beliefs, std::vector{kBelief});
  ASSERT_TRUE(append(writer, batch(2)));
  const Verification result = verified(folder / "a.journal");
  EXPECT_EQ(result.rows, 6);
  EXPECT_TRUE(result.findings.empty());
}

TEST(Writer, ASecondOneIsTurnedAwayUntilTheFirstIsGone) {
  const TestFolder folder;
  {
    const Writer first = open(folder / "a.journal");
    const auto second = Writer::open(folder / "a.journal", {});
    ASSERT_FALSE(second);
    EXPECT_THAT(second.error(), HasSubstr("another culprit"));
  }
  EXPECT_TRUE(Writer::open(folder / "a.journal", {}));
}

TEST(Chain, ShowsEveryChange) {
  for (const char* change :
       {"UPDATE entry SET body = '{}'", "UPDATE entry SET at = at + 1",
        "UPDATE entry SET kind = 'gap'", "UPDATE entry SET hash = zeroblob(32)",
        "UPDATE entry SET hash = x'00'", "UPDATE entry SET id = id + 100"}) {
    for (const char* row : {" WHERE id = 1", " WHERE id = 3", " WHERE id = 5"}) {
      const TestFolder folder;
      {
        Writer writer = open(folder / "a.journal");
        ASSERT_TRUE(append(writer, batch(5)));
      }
      run_sql(folder / "a.journal", std::string(change) + row);
      EXPECT_FALSE(verified(folder / "a.journal").findings.empty()) << change << row;
    }
  }
}

TEST(Chain, ShowsRowsMissingInTheMiddleAndWithANotedHashAtTheEnd) {
  const TestFolder folder;
  {
    Writer writer = open(folder / "a.journal");
    ASSERT_TRUE(append(writer, batch(5)));
  }
  const Link noted = verified(folder / "a.journal").newest;
  EXPECT_TRUE(verified(folder / "a.journal", noted).findings.empty());
  run_sql(folder / "a.journal", "DELETE FROM entry WHERE id = 5");
  EXPECT_TRUE(verified(folder / "a.journal").findings.empty());
  EXPECT_THAT(verified(folder / "a.journal", noted).findings,
              testing::ElementsAre(HasSubstr("row 5")));
  run_sql(folder / "a.journal", "DELETE FROM entry WHERE id = 2");
  EXPECT_THAT(verified(folder / "a.journal").findings,
              testing::ElementsAre(HasSubstr("missing between 1 and 3")));
}

TEST(Chain, ShowsABeliefThatWasChangedBehindItsBack) {
  const TestFolder folder;
  {
    Writer writer = open(folder / "a.journal");
    ASSERT_TRUE(append(writer, Batch{.learned = {.beliefs = {kBelief}}}));
  }
  run_sql(folder / "a.journal", "UPDATE belief SET alpha = 1000");
  EXPECT_THAT(verified(folder / "a.journal").findings,
              testing::ElementsAre(HasSubstr("strategy of Rule")));
}

TEST(Rotation, DropsTheOldestRowsAndTheChainStillHolds) {
  const TestFolder folder;
  Writer::Options options;
  options.max_bytes = 1 << 20;
  Writer writer = open(folder / "a.journal", options);
  Batch first = batch(1);
  first.learned.beliefs = {kBelief};
  ASSERT_TRUE(append(writer, first));
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(append(writer, batch(100, 300)));
  const Verification result = verified(folder / "a.journal");
  EXPECT_TRUE(result.findings.empty()) << result.findings.front();
  EXPECT_GT(result.first, 1);
  EXPECT_LT(result.rows, 5000);
  EXPECT_GT(result.rows, 1000);
  EXPECT_EQ(value_of(writer.learned()).beliefs, std::vector{kBelief});
}

TEST(Rotation, DropsWhatIsTooOld) {
  const TestFolder folder;
  Writer writer = open(folder / "a.journal", {.max_age_ns = 1000});
  ASSERT_TRUE(append(writer, batch(10)));
  ASSERT_TRUE(writer.append({{{0, kWrittenAt + 2000, "gap", "{}"}}, {}}, kWrittenAt + 2000,
                            Durability::kProcessEnd));
  EXPECT_EQ(verified(folder / "a.journal").first, 11);
}

TEST(Faults, AFullDiskLosesNothingThatWasWrittenAndSaysSo) {
  const TestFolder folder;
  Writer writer = open(folder / "a.journal");
  ASSERT_TRUE(append(writer, batch(3)));
  // A disk that takes no more: files of this process may not grow.
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, SIG_IGN);
  rlimit tight = before;
  tight.rlim_cur = 64 << 10;
  setrlimit(RLIMIT_FSIZE, &tight);
  const auto failed = append(writer, batch(1000, 1000));
  setrlimit(RLIMIT_FSIZE, &before);
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error(), HasSubstr("a.journal"));
  ASSERT_TRUE(append(writer, batch(2)));
  EXPECT_EQ(verified(folder / "a.journal").rows, 5);
}

TEST(Faults, ALockedFileIsSaidToBeLocked) {
  const TestFolder folder;
  Writer writer = open(folder / "a.journal");
  auto other = value_of(Database::open(folder / "a.journal", Database::Mode::kWrite));
  ASSERT_TRUE(other.run("BEGIN IMMEDIATE"));
  const auto failed = append(writer, batch(1));
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error(), HasSubstr("another program holds it locked"));
  ASSERT_TRUE(other.run("COMMIT"));
  EXPECT_TRUE(append(writer, batch(1)));
}

TEST(Faults, AFileThatIsRemovedMeanwhileIsNotWrittenInSilence) {
  const TestFolder folder;
  Writer writer = open(folder / "a.journal");
  std::filesystem::remove(folder / "a.journal");
  const auto failed = append(writer, batch(1));
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error(), HasSubstr("removed"));
}

TEST(Faults, ADamagedFileIsSetAsideAndWhatWasLearnedIsCarriedOver) {
  const TestFolder folder;
  {
    Writer writer = open(folder / "a.journal");
    Batch all = batch(400, 300);
    all.learned.beliefs = {kBelief};
    ASSERT_TRUE(append(writer, all));
  }
  // The page with the newest row is nonsense now.
  const auto size = std::filesystem::file_size(folder / "a.journal");
  std::fstream file(folder / "a.journal", std::ios::in | std::ios::out | std::ios::binary);
  for (std::uintmax_t page = 12; page < size / 4096; ++page) {
    file.seekp(static_cast<std::streamoff>(page * 4096));
    file << std::string(4096, '\xff');
  }
  file.close();
  Writer writer = open(folder / "a.journal");
  EXPECT_THAT(writer.remark(), HasSubstr("a.journal.damaged-1"));
  EXPECT_EQ(value_of(writer.learned()).beliefs, std::vector{kBelief});
  EXPECT_EQ(std::filesystem::file_size(folder / "a.journal.damaged-1"), size);
}

TEST(Faults, ATruncatedFileIsSetAside) {
  const TestFolder folder;
  {
    Writer writer = open(folder / "a.journal");
    ASSERT_TRUE(append(writer, batch(400, 300)));
  }
  std::filesystem::resize_file(folder / "a.journal", 30'000);
  const Writer writer = open(folder / "a.journal");
  EXPECT_THAT(writer.remark(), HasSubstr("damaged"));
  EXPECT_TRUE(std::filesystem::exists(folder / "a.journal.damaged-1"));
}

TEST(Faults, AFileThatIsNoJournalIsLeftAlone) {
  const TestFolder folder;
  std::ofstream(folder / "notes.txt") << "to do: nothing\n";
  const auto failed = Writer::open(folder / "notes.txt", {});
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error(), HasSubstr("it is no journal"));
  EXPECT_TRUE(std::filesystem::exists(folder / "notes.txt"));
  run_sql(folder / "other.journal", "CREATE TABLE t(a)");
  const auto foreign = Writer::open(folder / "other.journal", {});
  ASSERT_FALSE(foreign);
  EXPECT_THAT(foreign.error(), HasSubstr("another program"));
}

TEST(Faults, AJournalOfANewerCulpritIsLeftAlone) {
  const TestFolder folder;
  { const Writer writer = open(folder / "a.journal"); }
  run_sql(folder / "a.journal", "PRAGMA user_version = 99");
  const auto failed = Writer::open(folder / "a.journal", {});
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error(), HasSubstr("newer culprit"));
  const auto unread = Reader::open(folder / "a.journal");
  ASSERT_FALSE(unread);
  EXPECT_THAT(unread.error(), HasSubstr("newer culprit"));
}

// As version 2 left it: couplings without exposure, and no table of coincidences.
void make_version_2(const std::filesystem::path& path) {
  run_sql(path,
          "DROP TABLE coincidence; ALTER TABLE coupling DROP COLUMN spared; "
          "PRAGMA user_version = 2");
}

// As version 1 left it: also without the table of latencies.
void make_old(const std::filesystem::path& path) {
  make_version_2(path);
  run_sql(path, "DROP TABLE latency; PRAGMA user_version = 1");
}

Writer open_with_couplings(const std::filesystem::path& path,
                           const std::vector<LearnedCoupling>& couplings) {
  Writer writer = open(path);
  EXPECT_TRUE(append(writer, Batch{.learned = {.couplings = couplings}}));
  return writer;
}

TEST(OlderFile, IsReadAsItIs) {
  const TestFolder folder;
  {
    Writer writer = open(folder / "a.journal");
    Batch all = batch(3);
    all.learned.beliefs = {kBelief};
    ASSERT_TRUE(append(writer, all));
  }
  make_old(folder / "a.journal");
  const Reader reader = value_of(Reader::open(folder / "a.journal"));
  EXPECT_EQ(value_of(reader.learned()).beliefs, std::vector{kBelief});
  EXPECT_TRUE(value_of(reader.learned()).latencies.empty());
  EXPECT_TRUE(verified(folder / "a.journal").findings.empty());
}

TEST(OlderFile, IsBroughtUpToDateWhenItIsWritten) {
  const TestFolder folder;
  {
    Writer writer = open(folder / "a.journal");
    Batch all = batch(3);
    all.learned.beliefs = {kBelief};
    ASSERT_TRUE(append(writer, all));
  }
  make_old(folder / "a.journal");
  const std::vector<LearnedLatency> latencies = {{"Rule", 1, 0.25, 0.5}};
  {
    Writer writer = open(folder / "a.journal");
    EXPECT_EQ(writer.remark(), "");
    ASSERT_TRUE(append(writer, Batch{.learned = {.latencies = latencies}}));
  }
  const Writer writer = open(folder / "a.journal");
  EXPECT_EQ(writer.remark(), "");
  EXPECT_EQ(value_of(writer.learned()).beliefs, std::vector{kBelief});
  EXPECT_EQ(value_of(writer.learned()).latencies, latencies);
  EXPECT_TRUE(verified(folder / "a.journal").findings.empty());
}

TEST(OlderFile, OnlyByItsVersionKeepsItsLatencies) {
  const TestFolder folder;
  const std::vector<LearnedLatency> latencies = {{"Rule", 1, 0.25, 0.5}};
  {
    Writer writer = open(folder / "a.journal");
    ASSERT_TRUE(append(writer, Batch{.learned = {.latencies = latencies}}));
  }
  run_sql(folder / "a.journal", "PRAGMA user_version = 1");
  EXPECT_EQ(value_of(open(folder / "a.journal").learned()).latencies, latencies);
}

TEST(Writer, KeepsTheExposureOfCouplings) {
  const TestFolder folder;
  const std::vector<LearnedCoupling> couplings = {{"Rule", "Other", {2, 1, 5.1}},
                                                  {"Rule", "Third", {0, 0, 0.7}}};
  { const Writer first = open_with_couplings(folder / "a.journal", couplings); }
  const Writer writer = open(folder / "a.journal");
  EXPECT_EQ(writer.remark(), "");
  EXPECT_EQ(value_of(writer.learned()).couplings, couplings);
  EXPECT_EQ(value_of(value_of(Reader::open(folder / "a.journal")).learned()).couplings, couplings);
}

TEST(OlderFile, HasCouplingsWithoutExposure) {
  const TestFolder folder;
  const std::vector<LearnedCoupling> couplings = {{"Rule", "Other", {2, 1, 0}}};
  { const Writer first = open_with_couplings(folder / "a.journal", couplings); }
  make_old(folder / "a.journal");
  EXPECT_EQ(value_of(value_of(Reader::open(folder / "a.journal")).learned()).couplings, couplings);
  const std::vector<LearnedCoupling> later = {{"Rule", "Other", {2, 1, 3.5}}};
  {
    const Writer writer = open_with_couplings(folder / "a.journal", later);
    EXPECT_EQ(writer.remark(), "");
  }
  EXPECT_EQ(value_of(open(folder / "a.journal").learned()).couplings, later);
}

Writer open_with_coincidences(const std::filesystem::path& path,
                              const std::vector<LearnedCoincidence>& coincidences) {
  Writer writer = open(path);
  EXPECT_TRUE(append(writer, Batch{.learned = {.coincidences = coincidences}}));
  return writer;
}

const std::vector<LearnedCoincidence> kTogether = {{"Other", "Other", 5}, {"Other", "Rule", 3}};

TEST(Writer, KeepsHowOftenFailuresBeganTogether) {
  const TestFolder folder;
  { const Writer first = open_with_coincidences(folder / "a.journal", kTogether); }
  const Writer writer = open_with_coincidences(folder / "a.journal", {{"Other", "Rule", 4}});
  EXPECT_EQ(writer.remark(), "");
  const std::vector<LearnedCoincidence> now = {{"Other", "Other", 5}, {"Other", "Rule", 4}};
  EXPECT_EQ(value_of(writer.learned()).coincidences, now);
  EXPECT_EQ(value_of(value_of(Reader::open(folder / "a.journal")).learned()).coincidences, now);
  EXPECT_EQ(writer.last_id(), 0) << "they make no rows";
}

TEST(OlderFile, OfVersion2HasNoFailuresThatBeganTogether) {
  const TestFolder folder;
  {
    Writer writer = open_with_couplings(folder / "a.journal", {{"Rule", "Other", {2, 1, 0}}});
    ASSERT_TRUE(append(writer, batch(3)));
  }
  make_version_2(folder / "a.journal");
  EXPECT_TRUE(
      value_of(value_of(Reader::open(folder / "a.journal")).learned()).coincidences.empty());
  {
    const Writer writer = open_with_coincidences(folder / "a.journal", kTogether);
    EXPECT_EQ(writer.remark(), "");
  }
  const Writer writer = open_with_couplings(folder / "a.journal", {{"Rule", "Other", {2, 1, 3.5}}});
  EXPECT_EQ(writer.remark(), "");
  EXPECT_EQ(value_of(writer.learned()).coincidences, kTogether);
  EXPECT_TRUE(verified(folder / "a.journal").findings.empty());
}

TEST(OlderFile, OnlyByItsVersionKeepsFailuresThatBeganTogether) {
  const TestFolder folder;
  { const Writer first = open_with_coincidences(folder / "a.journal", kTogether); }
  run_sql(folder / "a.journal", "PRAGMA user_version = 2");
  EXPECT_EQ(value_of(open(folder / "a.journal").learned()).coincidences, kTogether);
}

// Writing it takes the time of the disk. It need not be written, because no row names what it lacks.
TEST(Writer, LeavesTheSecondCopyAloneForFailuresThatBeganTogether) {
  const TestFolder folder;
  const auto copied = [&] {
    return value_of(read_copy(learned_beside(folder / "a.journal"))).value().learned.coincidences;
  };
  {
    Writer writer = open_with_coincidences(folder / "a.journal", {{"Other", "Rule", 1}});
    ASSERT_TRUE(append(writer, Batch{.learned = {.coincidences = kTogether}}));
    EXPECT_EQ(copied(), (std::vector<LearnedCoincidence>{{"Other", "Rule", 1}}));
  }
  Writer writer = open(folder / "a.journal");
  EXPECT_EQ(writer.remark(), "") << "an older copy is no damage";
  EXPECT_EQ(value_of(writer.learned()).coincidences, kTogether);
  ASSERT_TRUE(append(writer, Batch{.learned = {.beliefs = {kBelief}}}));
  EXPECT_EQ(copied(), kTogether);
}

TEST(Faults, TheSecondCopyRestoresTheRestAndKeepsFailuresThatBeganTogether) {
  const TestFolder folder;
  const std::vector<LearnedCoupling> couplings = {{"Rule", "Other", {2, 1, 3.5}}};
  {
    Writer writer = open_with_couplings(folder / "a.journal", couplings);
    ASSERT_TRUE(append(writer, Batch{.learned = {.coincidences = kTogether}}));
  }
  run_sql(folder / "a.journal", "UPDATE coupling SET spared = 1000");
  const Writer writer = open(folder / "a.journal");
  EXPECT_THAT(writer.remark(), HasSubstr("second copy"));
  EXPECT_EQ(value_of(writer.learned()).couplings, couplings);
  EXPECT_EQ(value_of(writer.learned()).coincidences, kTogether);
}

TEST(OlderFile, OnlyByItsVersionHasTheExposureOfTheSecondCopy) {
  const TestFolder folder;
  const std::vector<LearnedCoupling> couplings = {{"Rule", "Other", {2, 1, 3.5}}};
  { const Writer first = open_with_couplings(folder / "a.journal", couplings); }
  run_sql(folder / "a.journal", "PRAGMA user_version = 2");
  EXPECT_EQ(value_of(open(folder / "a.journal").learned()).couplings, couplings);
}

TEST(Faults, AnExposureThatWasChangedBehindItsBackIsKnownFromTheSecondCopy) {
  const TestFolder folder;
  const std::vector<LearnedCoupling> couplings = {{"Rule", "Other", {2, 1, 3.5}}};
  { const Writer first = open_with_couplings(folder / "a.journal", couplings); }
  run_sql(folder / "a.journal", "UPDATE coupling SET spared = 1000");
  const Writer writer = open(folder / "a.journal");
  EXPECT_THAT(writer.remark(), HasSubstr("second copy"));
  EXPECT_EQ(value_of(writer.learned()).couplings, couplings);
}

TEST(OlderFile, HasRowsOfCouplingsWithoutExposure) {
  const TestFolder folder;
  {
    Writer writer = open_with_couplings(folder / "a.journal", {{"Rule", "Other", {2, 1, 3.5}}});
    ASSERT_TRUE(append(
        writer,
        Batch{.entries = {{0, kWrittenAt, std::string(kind::kCoupling),
                           R"({"cause":"Rule","effect":"Third","cleared":1,"stayed":4})"}}}));
  }
  EXPECT_THAT(value_of(open(folder / "a.journal").learned()).couplings,
              testing::ElementsAre(LearnedCoupling{"Rule", "Other", {2, 1, 3.5}},
                                   LearnedCoupling{"Rule", "Third", {1, 4, 0}}));
}

TEST(Faults, ALatencyThatWasChangedBehindItsBackIsKnownFromTheSecondCopy) {
  const TestFolder folder;
  const std::vector<LearnedLatency> latencies = {{"Rule", 1, 0.25, 0.5}};
  {
    Writer writer = open(folder / "a.journal");
    ASSERT_TRUE(append(writer, Batch{.learned = {.latencies = latencies}}));
  }
  run_sql(folder / "a.journal", "UPDATE latency SET most = 1000");
  const Writer writer = open(folder / "a.journal");
  EXPECT_THAT(writer.remark(), HasSubstr("second copy"));
  EXPECT_EQ(value_of(writer.learned()).latencies, latencies);
}

// Root may write everywhere: while this exists, the test runs as nobody, and owns the folder as
// nobody.
class AsNobody {
 public:
  explicit AsNobody(const TestFolder& folder) : was_(geteuid()) {
    if (was_ != 0) return;
    chown(folder.path());
    for (const auto& each : std::filesystem::recursive_directory_iterator(folder.path()))
      chown(each.path());
    if (seteuid(kNobody) != 0) throw std::runtime_error("cannot become nobody");
  }
  ~AsNobody() {
    if (was_ == 0 && seteuid(0) != 0) std::abort();
  }
  AsNobody(const AsNobody&) = delete;

 private:
  static constexpr uid_t kNobody = 65534;
  static void chown(const std::filesystem::path& path) {
    if (::chown(path.c_str(), kNobody, static_cast<gid_t>(-1)) != 0)
      throw std::runtime_error("cannot give " + path.string() + " away");
  }

  const uid_t was_;
};

TEST(Faults, AReadOnlyFolderIsReadAndNotWritten) {
  const TestFolder folder;
  {
    Writer writer = open(folder / "a.journal");
    ASSERT_TRUE(append(writer, batch(3)));
  }
  const AsNobody nobody(folder);
  std::filesystem::permissions(
      folder.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  EXPECT_EQ(verified(folder / "a.journal").rows, 3);
  const auto failed = Writer::open(folder / "b.journal", {});
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error(), HasSubstr("ermission denied"));
}

TEST(Faults, AJournalThatMayNotBeReadIsLeftAloneAndNamed) {
  const TestFolder folder;
  {
    Writer writer = open(folder / "a.journal");
    ASSERT_TRUE(append(writer, batch(3)));
  }
  const AsNobody nobody(folder);
  std::filesystem::permissions(folder / "a.journal", std::filesystem::perms::none);
  const auto unread = Reader::open(folder / "a.journal");
  ASSERT_FALSE(unread);
  EXPECT_THAT(unread.error(), HasSubstr("a.journal"));
  const auto unwritten = Writer::open(folder / "a.journal", {});
  ASSERT_FALSE(unwritten);
  EXPECT_THAT(unwritten.error(), HasSubstr("a.journal"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.journal.damaged-1"));
}

TEST(Faults, AFolderThatCannotBeMadeIsNamed) {
  const auto failed = Writer::open("/proc/culprit/a.journal", {});
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error(), HasSubstr("/proc/culprit/a.journal"));
}

TEST(Writer, ForgetsOneRuleOrAll) {
  const TestFolder folder;
  Writer writer = open(folder / "a.journal");
  ASSERT_TRUE(
      append(writer, Batch{.learned = {.beliefs = {kBelief, {"Other", "s", {2, 1}, {1, 1}}},
                                       .couplings = {{"Rule", "Other", {1, 0}}},
                                       .latencies = {{"Other", 1, 2, 2}, {"Rule", 3, 0.5, 2}},
                                       .coincidences = kTogether}}));
  EXPECT_EQ(value_of(writer.forget("Rule", kWrittenAt)), 1);
  EXPECT_EQ(value_of(writer.learned()).beliefs.size(), 1u);
  EXPECT_TRUE(value_of(writer.learned()).couplings.empty());
  EXPECT_EQ(value_of(writer.learned()).latencies,
            (std::vector<LearnedLatency>{{"Other", 1, 2, 2}}));
  EXPECT_EQ(value_of(writer.learned()).coincidences,
            (std::vector<LearnedCoincidence>{{"Other", "Other", 5}}));
  EXPECT_EQ(value_of(writer.forget("", kWrittenAt)), 1);
  EXPECT_TRUE(value_of(writer.learned()).is_empty());
  EXPECT_TRUE(verified(folder / "a.journal").findings.empty());
}

TEST(Writer, WritesOnAfterItCouldNotForget) {
  const TestFolder folder;
  Writer writer = open(folder / "a.journal");
  Batch all{.learned = {.beliefs = {kBelief}}};
  ASSERT_TRUE(append(writer, all));
  run_sql(folder / "a.journal", "DROP TABLE coincidence; PRAGMA user_version = 2");
  EXPECT_FALSE(writer.forget("", kWrittenAt));
  EXPECT_EQ(value_of(writer.learned()).beliefs.size(), 1u) << "all or nothing";
  const auto written = append(writer, batch(1));
  EXPECT_TRUE(written) << written.error();
}

}  // namespace
}  // namespace culprit::journal
