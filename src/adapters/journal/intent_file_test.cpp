// The file of intents: whatever happens to its bytes, a read gives a beginning of what was written.
#include "journal/intent_file.h"

#include <csignal>
#include <fstream>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_expected.h"
#include "base/test_folder.h"

namespace culprit::journal {
namespace {

namespace fs = std::filesystem;
using culprit::test::TestFolder;
using culprit::test::value_of;
using testing::HasSubstr;
using testing::IsEmpty;
using namespace std::chrono_literals;

const Link kRowBefore{7, {1, 2, 3}};

Entry intent_row(const std::string& body) { return {0, 42, std::string(kind::kIntent), body}; }

std::string part_of(const std::vector<Entry>& rows) {
  std::string bytes;
  for (const Entry& row : rows) append_row(row, bytes);
  return bytes;
}

std::vector<std::string> bodies(const SavedIntents& saved) {
  std::vector<std::string> all;
  for (const Entry& row : saved.rows) all.push_back(row.body);
  return all;
}

// No row would be known that the part follows: after a crash, nothing of it counted.
TEST(IntentFileDeathTest, NothingIsWrittenBeforeItsBeginning) {
  const TestFolder folder;
  std::ofstream(folder / "a.journal") << "a journal";
  IntentFile file = value_of(IntentFile::open(folder / "a.journal"));
  EXPECT_DEATH((void)file.append(Time(), part_of({intent_row("one")})), "does not hold");
}

struct Intents : testing::Test {
  Intents() { std::ofstream(journal) << "a journal"; }

  IntentFile open() const {
    IntentFile file = value_of(IntentFile::open(journal));
    file.begin_after(IntentFile::Head(kRowBefore));
    return file;
  }
  static void append(IntentFile& file, const std::string& body, Time step = Time(1s)) {
    const auto written = file.append(step, part_of({intent_row(body)}));
    ASSERT_TRUE(written) << written.error();
  }
  std::string bytes() const {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  SavedIntents read() const { return value_of(read_intents(path)); }

  const TestFolder folder;
  const fs::path journal = folder / "a.journal";
  const fs::path path = intents_beside(journal);
};

TEST_F(Intents, AreReadAsTheyWereWritten) {
  IntentFile file = open();
  append(file, "one", Time(1s));
  ASSERT_TRUE(file.append(
      Time(3s), part_of({{0, -5, std::string(kind::kEvent), "two"}, intent_row("three")})));
  const SavedIntents saved = read();
  EXPECT_EQ(bodies(saved), (std::vector<std::string>{"one", "two", "three"}));
  EXPECT_EQ(saved.rows[1].at, -5);
  EXPECT_EQ(saved.rows[1].kind, kind::kEvent);
  EXPECT_EQ(saved.after.id, 7);
  EXPECT_EQ(saved.after.hash, kRowBefore.hash);
  EXPECT_EQ(saved.latest, Time(3s));
  EXPECT_THAT(saved.damage, IsEmpty());
}

TEST_F(Intents, OfNoFileAndOfAnEmptyOneAreNone) {
  EXPECT_THAT(read().rows, IsEmpty());
  EXPECT_THAT(read().damage, IsEmpty());
  (void)open();
  EXPECT_THAT(read().rows, IsEmpty());
  EXPECT_THAT(read().damage, IsEmpty());
}

TEST_F(Intents, ThatTheJournalHasAreWrittenOver) {
  IntentFile file = open();
  for (int i = 0; i < 20; ++i) append(file, "long ago, and long " + std::to_string(i));
  const std::size_t size = bytes().size();
  file.begin_after(IntentFile::Head({99, {4}}));
  append(file, "now");
  EXPECT_EQ(bodies(read()), std::vector<std::string>{"now"}) << "what is behind the end is old";
  EXPECT_EQ(read().after.id, 99);
  EXPECT_THAT(read().damage, IsEmpty());
  EXPECT_EQ(bytes().size(), size);
  file.empty();
  EXPECT_EQ(bytes().size(), 0u);
}

TEST_F(Intents, CutShortAnywhereAreReadUpToThereAndThatIsSaid) {
  {
    IntentFile file = open();
    append(file, "one");
    append(file, "two");
  }
  const std::string whole = bytes();
  for (std::size_t size = 1; size < whole.size(); ++size) {
    const SavedIntents saved = decode_intents(std::string_view(whole).substr(0, size));
    EXPECT_NE(saved.damage, "") << size;
    const auto all = bodies(saved);
    const std::vector<std::string> written{"one", "two"};
    ASSERT_LE(all.size(), 2u);
    EXPECT_TRUE(std::equal(all.begin(), all.end(), written.begin())) << size;
    EXPECT_TRUE(all.size() == 2 || size < whole.size() - 4) << size;
  }
}

TEST_F(Intents, WithAnyByteChangedAreReadUpToThere) {
  {
    IntentFile file = open();
    append(file, "one");
    append(file, "two");
  }
  const std::string whole = bytes();
  const std::vector<std::string> written{"one", "two"};
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const int bit : {0, 3, 7}) {
      std::string changed = whole;
      changed[at] = static_cast<char>(changed[at] ^ (1 << bit));
      const SavedIntents saved = decode_intents(changed);
      const auto all = bodies(saved);
      ASSERT_LE(all.size(), 2u);
      EXPECT_TRUE(std::equal(all.begin(), all.end(), written.begin())) << at;
      EXPECT_NE(saved.damage, "") << at;
    }
  }
}

// A power cut leaves pages of several moments.
TEST_F(Intents, MixedWithWhatWasThereBeforeAreReadAsFarAsTheyAreWhole) {
  IntentFile file = open();
  for (int i = 0; i < 40; ++i) append(file, "before " + std::string(100, 'b'));
  const std::string before = bytes();
  file.begin_after(IntentFile::Head({99, {4}}));
  for (int i = 0; i < 30; ++i) append(file, "after " + std::string(100, 'a'));
  const std::string after = bytes();
  constexpr std::size_t kSector = 512;
  for (std::size_t sector = 0; sector * kSector < after.size(); ++sector) {
    std::string mixed = after;
    const std::size_t at = sector * kSector;
    mixed.replace(at, kSector, before.substr(at, kSector));
    const SavedIntents saved = decode_intents(mixed);
    for (const std::string& body : bodies(saved))
      EXPECT_EQ(body.substr(0, 3), sector == 0 ? "bef" : "aft") << sector;
    EXPECT_LE(bodies(saved).size(), 30u);
  }
}

TEST_F(Intents, OfOtherKindsAreNotTaken) {
  for (const std::string_view kind : {kind::kSession, kind::kBelief, kind::kEnd, kind::kSteps}) {
    IntentFile file = open();
    append(file, "one");
    ASSERT_TRUE(file.append(Time(), part_of({{0, 1, std::string(kind), "{}"}})));
    append(file, "three");
    EXPECT_EQ(bodies(read()), std::vector<std::string>{"one"}) << kind;
    EXPECT_THAT(read().damage, HasSubstr("damaged after byte")) << kind;
  }
}

TEST_F(Intents, MayNotBeMoreThanTheFileHolds) {
  IntentFile file = open();
  int written = 0;
  while (file.append(Time(), part_of({intent_row(std::string(1000, 'x'))})) && written < 10'000)
    ++written;
  EXPECT_GT(written, 200);
  EXPECT_LE(bytes().size(), IntentFile::kMaxBytes);
  EXPECT_EQ(read().rows.size(), static_cast<std::size_t>(written));
  EXPECT_THAT(read().damage, IsEmpty());
}

TEST_F(Intents, OnAFullDiskAreAnErrorAndThoseBeforeStay) {
  IntentFile file = open();
  append(file, "one");
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, SIG_IGN);
  rlimit tight = before;
  tight.rlim_cur = bytes().size() + 20;  // part of the next fits
  setrlimit(RLIMIT_FSIZE, &tight);
  const auto written = file.append(Time(), part_of({intent_row(std::string(100, 'x'))}));
  setrlimit(RLIMIT_FSIZE, &before);
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error(), HasSubstr("a.journal-intents"));
  EXPECT_EQ(bodies(read()), std::vector<std::string>{"one"});
  append(file, "two");
  EXPECT_EQ(bodies(read()), (std::vector<std::string>{"one", "two"}));
  EXPECT_THAT(read().damage, IsEmpty());
}

TEST_F(Intents, InAFileThatWasRemovedOrReplacedAreAnError) {
  for (const bool is_replaced : {false, true}) {
    IntentFile file = open();
    append(file, "one");
    fs::remove(path);
    if (is_replaced) std::ofstream(path.string() + "x") << "another";
    if (is_replaced) fs::rename(path.string() + "x", path);
    const auto written = file.append(Time(), part_of({intent_row("two")}));
    ASSERT_FALSE(written);
    EXPECT_THAT(written.error(), HasSubstr("removed or replaced"));
  }
}

TEST_F(Intents, MayBeReadByReadersOfTheJournal) {
  for (const mode_t mode : {0600, 0640, 0644}) {
    ASSERT_EQ(chmod(journal.c_str(), mode), 0);
    (void)open();
    struct stat status {};
    ASSERT_EQ(stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, mode);
  }
}

TEST_F(Intents, HaveOneWriter) {
  const IntentFile first = open();
  const auto second = IntentFile::open(journal);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error(), HasSubstr("another process"));
}

TEST_F(Intents, AreNotLookedForInWhatIsNoFile) {
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_FALSE(read_intents(path));
  EXPECT_FALSE(IntentFile::open(journal));
  fs::remove(path);
  fs::create_directory(path);
  EXPECT_FALSE(read_intents(path));
  EXPECT_FALSE(IntentFile::open(journal));
}

}  // namespace
}  // namespace culprit::journal
