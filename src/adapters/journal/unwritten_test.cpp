// Which rows of the intent file the journal lacks.
#include "journal/unwritten.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_expected.h"
#include "base/test_folder.h"
#include "journal/json.h"
#include "journal/writer.h"

namespace culprit::journal {
namespace {

using culprit::test::TestFolder;
using culprit::test::value_of;
using testing::HasSubstr;
using testing::IsEmpty;
using namespace std::chrono_literals;

constexpr std::int64_t kUnwrittenAt = 1'800'000'000'000'000'000;

struct UnwrittenRows : testing::Test {
  UnwrittenRows() {
    writer = value_of(Writer::open(path, {}));
    write({{0, kUnwrittenAt, std::string(kind::kSession), "{}"}});
    file = value_of(IntentFile::open(path));
    file->begin_after(IntentFile::Head(writer->newest()));
  }
  static Entry row(int number) {
    return {0, kUnwrittenAt + number, std::string(kind::kIntent), to_line({{"command", number}})};
  }
  void write(std::vector<Entry> rows) {
    const auto written =
        writer->append({std::move(rows), {}}, kUnwrittenAt, Durability::kProcessEnd);
    ASSERT_TRUE(written) << written.error();
  }
  void keep(const std::vector<Entry>& rows) {
    std::string bytes;
    for (const Entry& each : rows) append_row(each, bytes);
    const auto written = file->append(Time(5s), bytes);
    ASSERT_TRUE(written) << written.error();
  }
  Unwritten found() const {
    return unwritten_rows(intents_beside(path), value_of(Reader::open(path)));
  }
  std::vector<std::int64_t> commands() const {
    std::vector<std::int64_t> all;
    for (const Entry& each : found().rows)
      all.push_back(integer_of(parse_json(each.body), "command"));
    return all;
  }
  void change(const std::string& sql) {
    auto database = value_of(Database::open(path, Database::Mode::kWrite));
    const auto done = database.run(sql);
    ASSERT_TRUE(done) << done.error();
  }

  const TestFolder folder;
  const std::filesystem::path path = folder / "a.journal";
  std::optional<Writer> writer;
  std::optional<IntentFile> file;
};

TEST_F(UnwrittenRows, AreAllIfTheJournalHasNoneOfThem) {
  keep({row(1), row(2)});
  keep({row(3)});
  EXPECT_EQ(commands(), (std::vector<std::int64_t>{1, 2, 3}));
  EXPECT_EQ(found().latest, Time(5s));
  EXPECT_THAT(found().remark, IsEmpty());
}

TEST_F(UnwrittenRows, AreThoseAfterTheLastThatTheJournalHas) {
  keep({row(1), row(2)});
  keep({row(3)});
  write({{0, kUnwrittenAt, std::string(kind::kSteps), "steps"}, row(1), row(2)});
  write({{0, kUnwrittenAt, std::string(kind::kRobot), "{}"}});
  EXPECT_EQ(commands(), std::vector<std::int64_t>{3});
  write({row(3)});
  EXPECT_THAT(commands(), IsEmpty());
}

TEST_F(UnwrittenRows, ThatAreAlikeCountOneByOne) {
  keep({row(1)});
  keep({row(1)});
  write({row(1)});
  EXPECT_EQ(commands(), std::vector<std::int64_t>{1});
}

// A changed row must not make culprit believe that it was never written.
TEST_F(UnwrittenRows, AreNotThoseBeforeOneThatTheJournalHas) {
  keep({row(1)});
  keep({row(2)});
  write({row(1), row(2)});
  change("UPDATE entry SET body = '{}' WHERE kind = 'intent' AND id = 2");
  EXPECT_THAT(commands(), IsEmpty());
}

TEST_F(UnwrittenRows, AreOverIfAnotherRunFollowedOrAllWasWritten) {
  for (const std::string_view kind : {kind::kSession, kind::kEnd}) {
    keep({row(1)});
    write({{0, kUnwrittenAt, std::string(kind), "{}"}});
    EXPECT_THAT(commands(), IsEmpty());
    file->begin_after(IntentFile::Head(writer->newest()));
  }
}

TEST_F(UnwrittenRows, GoOnInARunThatBeganANewSession) {
  keep({row(1)});
  write({{0, kUnwrittenAt, std::string(kind::kSession), to_line({{"continued", true}})}});
  EXPECT_EQ(commands(), std::vector<std::int64_t>{1});
}

// The disk was full for long: the rows about their results are later than they.
TEST_F(UnwrittenRows, AreOverIfRowsWereDropped) {
  keep({row(1)});
  write({{0, kUnwrittenAt, std::string(kind::kGap), to_line({{"text", "odd"}})}});
  EXPECT_EQ(commands(), std::vector<std::int64_t>{1});
  write({{0, kUnwrittenAt, std::string(kind::kGap), to_line({{"rows", 3}, {"steps", 9}})}});
  EXPECT_THAT(commands(), IsEmpty());
}

TEST_F(UnwrittenRows, OfAnotherJournalAreLeftOutAndThatIsSaid) {
  file->begin_after(IntentFile::Head({1, {9, 9, 9}}));
  keep({row(1)});
  EXPECT_THAT(commands(), IsEmpty());
  EXPECT_THAT(found().remark, HasSubstr("row 1, which the journal no longer has"));
  file->begin_after(IntentFile::Head({1000, writer->newest().hash}));
  keep({row(1)});
  EXPECT_THAT(commands(), IsEmpty());
  EXPECT_THAT(found().remark, HasSubstr("row 1000"));
  for (const std::int64_t id : {INT64_MAX, INT64_MIN}) {
    file->begin_after(IntentFile::Head({id, writer->newest().hash}));
    keep({row(1)});
    EXPECT_THAT(commands(), IsEmpty());
  }
}

TEST_F(UnwrittenRows, AfterRowsThatWereDroppedForSizeAreOver) {
  Writer::Options options;
  options.max_age_ns = 1000;
  keep({row(1)});
  write({row(1), row(2)});
  writer.reset();
  writer = value_of(Writer::open(path, options));
  const std::int64_t later = kUnwrittenAt + 10'000;
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(writer->append({{{0, later, std::string(kind::kSession), "{}"}}, {}}, later,
                               Durability::kProcessEnd));
  }
  ASSERT_GT(value_of(value_of(Reader::open(path)).anchor()).id, 1);
  EXPECT_THAT(commands(), IsEmpty());
  EXPECT_THAT(found().remark, IsEmpty());
}

TEST_F(UnwrittenRows, OfADamagedFileAreThoseBeforeTheDamage) {
  keep({row(1)});
  keep({row(2)});
  std::filesystem::resize_file(intents_beside(path),
                               std::filesystem::file_size(intents_beside(path)) - 10);
  EXPECT_EQ(commands(), std::vector<std::int64_t>{1});
  EXPECT_THAT(found().remark, HasSubstr("a.journal-intents"));
  EXPECT_THAT(found().remark, HasSubstr("is not whole"));
}

}  // namespace
}  // namespace culprit::journal
