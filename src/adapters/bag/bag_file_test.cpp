// Bags as ros2 bag record writes them, in every storage and compression; and what is still read of
// broken ones.
#include "bag/bag_file.h"

#include <algorithm>
#include <fstream>
#include <sys/stat.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "bag/bag_contents.h"
#include "bag/test_bag.h"
#include "bag/test_mcap.h"

namespace culprit::bag {
namespace {

using test::BagTest;
using test::channel;
using test::chunk;
using test::mcap;
using test::mcap_begin;
using test::message;
using test::schema;
using test::value_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

const std::string kCdr("\0\1\0\0", 4);

struct Read {
  std::vector<std::string> messages;  // "topic@time=bytes after the CDR header"
  std::vector<std::string> losses;
  std::uint64_t out_of_order = 0;
};

Read read(const fs::path& path, BagFile::Limits limits = {}) {
  Read all;
  BagFile bag = value_of(BagFile::open(path, limits));
  for (BagMessage message; bag.next(message);)
    all.messages.push_back(
        bag.contents().topics()[message.topic].name + "@" + std::to_string(message.at) + "=" +
        std::string(message.bytes.substr(std::min<std::size_t>(4, message.bytes.size()))));
  all.losses = bag.contents().losses();
  all.out_of_order = bag.out_of_order();
  return all;
}

std::string two_topics() {
  return schema(1, "std_msgs/msg/String", "string data") + channel(1, 1, "/a") +
         channel(2, 1, "/b");
}
std::string said(std::uint16_t channel, std::uint64_t at, const std::string& what) {
  return message(channel, at, kCdr + what);
}

TEST_F(BagTest, ReadsMcapInChunksOfEveryCompressionAndWithout) {
  for (const std::string compression : {"", "zstd", "lz4"}) {
    const std::string first = two_topics() + said(1, 20, "y") + said(2, 10, "x");
    const std::string second = said(1, 30, std::string(100'000, 'z'));
    const fs::path path =
        write("a.mcap", mcap(chunk(first, compression) + chunk(second, compression), 3));
    const Read all = read(path);
    EXPECT_THAT(all.messages,
                ElementsAre("/b@10=x", "/a@20=y", "/a@30=" + std::string(100'000, 'z')))
        << compression;
    EXPECT_THAT(all.losses, IsEmpty()) << compression;
  }
  const Read bare =
      read(write("a.mcap", mcap(two_topics() + said(1, 1, "u") + said(2, 2, "v"), 2)));
  EXPECT_THAT(bare.messages, ElementsAre("/a@1=u", "/b@2=v"));
  EXPECT_THAT(bare.losses, IsEmpty());
}

TEST_F(BagTest, PassesOverRecordsThatItDoesNotKnow) {
  const std::string strange = test::record(0x09, std::string(200'000, 'a')) +
                              test::record(0x0c, "metadata") + test::record(0x90, "private");
  const Read all = read(write("a.mcap", mcap(two_topics() + strange + said(1, 1, "u"), 1)));
  EXPECT_THAT(all.messages, ElementsAre("/a@1=u"));
  EXPECT_THAT(all.losses, IsEmpty());
}

TEST_F(BagTest, ReadsBagsThatAreCompressedAsAWholeOrMessageByMessage) {
  {
    auto part = make("bag_0.db3");
    add(part, 1, 100, kCdr + "one");
    add(part, 1, 200, test::zstd(kCdr + std::string(1000, '2')));
  }
  write("bag_0.db3.zstd", test::zstd(bytes_of("bag_0.db3")));
  fs::remove(folder_ / "bag_0.db3");
  const std::string second = two_topics() + message(1, 300, test::zstd(kCdr + "three"));
  write("bag_1.mcap.zstd", test::zstd(mcap(chunk(second, "lz4"), 1)));
  write("bag_2.mcap", mcap(two_topics() + said(2, 400, "four"), 1));
  write("bag_2.mcap.zstd", "left by somebody; the part beside it is what counts");
  write("metadata.yaml", "rosbag2_bagfile_information:\n");
  const Read all = read(folder_);
  EXPECT_THAT(all.messages, ElementsAre("/water_visibility@100=one",
                                        "/water_visibility@200=" + std::string(1000, '2'),
                                        "/a@300=three", "/b@400=four"));
  EXPECT_THAT(all.losses, IsEmpty());
}

TEST_F(BagTest, MessagesThatWereWrittenLateAreReadByTheirTimes) {
  write("bag_0.mcap", mcap(two_topics() + said(1, 50, "x") + said(1, 40, "y"), 2));
  write("bag_1.mcap", mcap(two_topics() + said(1, 45, "z") + said(1, 60, "u"), 2));
  const Read all = read(folder_);
  EXPECT_THAT(all.messages, ElementsAre("/a@40=y", "/a@45=z", "/a@50=x", "/a@60=u"));
  EXPECT_EQ(all.out_of_order, 0);
  EXPECT_THAT(all.losses, IsEmpty());
}

TEST_F(BagTest, ARecordingThatWasCutOffShowsAllThatIsWholeInIt) {
  for (const std::string compression : {"", "zstd", "lz4"}) {
    std::string records = two_topics();
    for (std::uint32_t i = 0; i < 1000; ++i) {
      std::string noise;  // that compresses badly, as sensors' data do
      for (std::uint32_t k = 0; k < 300; ++k) noise += static_cast<char>(i * 7919 * (k + 3) >> 5);
      records += said(1, i, noise);
    }
    std::string bytes = mcap_begin() + chunk(records, compression);
    bytes.resize(bytes.size() / 2);
    const Read all = read(write("a.mcap", bytes));
    EXPECT_GT(all.messages.size(), 200) << compression;
    EXPECT_LT(all.messages.size(), 600) << compression;
    EXPECT_THAT(all.losses, ElementsAre(HasSubstr("a.mcap: what follows byte 33 is lost")));
  }
  const Read unfinished = read(write("a.mcap", mcap_begin() + two_topics() + said(1, 1, "u")));
  EXPECT_THAT(unfinished.messages, ElementsAre("/a@1=u"));
  EXPECT_THAT(unfinished.losses, ElementsAre(HasSubstr("before it was finished")));
  std::string long_one = two_topics();
  for (int i = 0; i < 100; ++i) long_one += said(1, 1, std::string(5000, 'x'));
  std::string packed = test::zstd(mcap(long_one, 100));
  packed.resize(packed.size() - 3);
  const Read cut = read(write("b.mcap.zstd", packed));
  EXPECT_GT(cut.messages.size(), 20);
  EXPECT_THAT(cut.losses, ElementsAre(HasSubstr("its compressed data are cut short")));
}

TEST_F(BagTest, ADamagedChunkIsLeftOutAndTheRestIsRead) {
  const std::string good = said(1, 30, "good");
  for (const std::string& bad :
       {chunk(said(1, 20, "bad"), "", said(1, 20, "bad").size(), 12345),
        chunk(said(1, 20, "bad"), "zstd", said(1, 20, "bad").size() + 9, 1),
        chunk(said(1, 20, "bad"), "lz4", said(1, 20, "bad").size() - 9, 1),
        test::record(0x06, std::string(24, '\0') + test::little(0, 4) + test::text("zstd") +
                               test::little(9, 8) + "no zstd!!"),
        chunk(said(1, 20, "bad"), "brotli"), test::record(0x06, "short")}) {
    const Read all =
        read(write("a.mcap", mcap(two_topics() + said(1, 10, "first") + bad + chunk(good, ""), 3)));
    EXPECT_THAT(all.messages, ElementsAre("/a@10=first", "/a@30=good"));
    EXPECT_THAT(all.losses, ElementsAre(HasSubstr("a.mcap: the chunk at byte "),
                                        HasSubstr("1 of its 3 messages are missing")));
  }
}

TEST_F(BagTest, SaysThatAFileWithoutChunksWasChanged) {
  std::string bytes = mcap(two_topics() + said(1, 10, "first"), 1);
  bytes[bytes.find("first")] = 'F';
  const Read all = read(write("a.mcap", bytes));
  EXPECT_THAT(all.messages, ElementsAre("/a@10=First"));
  EXPECT_THAT(all.losses, ElementsAre(HasSubstr("checksum of the file")));
}

TEST_F(BagTest, FewBytesThatClaimToBeManyAreLeftOut) {
  const BagFile::Limits limits{100'000};
  const std::string zeros = said(1, 20, std::string(1'000'000, '\0'));
  for (const std::string& bomb :
       {chunk(zeros, "zstd"), chunk(zeros, "lz4"), chunk(zeros, "zstd", 90'000, 1),
        chunk(zeros, "lz4", 90'000, 1), chunk(zeros, ""),
        message(1, 20, test::zstd(kCdr + std::string(1'000'000, '\0')))}) {
    const Read all =
        read(write("a.mcap", mcap(two_topics() + bomb + said(1, 30, "good"), 1)), limits);
    EXPECT_THAT(all.messages, ElementsAre("/a@30=good"));
    EXPECT_EQ(all.losses.size(), 1);
  }
}

TEST_F(BagTest, AFileOfChunksWithoutAnEndIsReadAsFarAsMemoryIsSpent) {
  const BagFile::Limits limits{10'000};
  std::string chunks;
  for (int i = 0; i < 1000; ++i) chunks += chunk("", "");
  const std::string file = mcap(two_topics() + said(1, 30, "good") + chunks, 1);
  for (const std::string name : {"a.mcap", "b.mcap.zstd"}) {
    const Read all = read(write(name, name == "a.mcap" ? file : test::zstd(file)), limits);
    EXPECT_THAT(all.messages, ElementsAre("/a@30=good"));
    EXPECT_THAT(all.losses, ElementsAre(HasSubstr("takes too much memory")));
  }
}

TEST_F(BagTest, QosProfilesOfManyMegabytesAreLeftOut) {
  BagContents contents;
  const std::string profiles(std::size_t{5} << 20, ' ');
  for (int i = 0; i < 10; ++i)
    contents.place_of({"/t" + std::to_string(i), "std_msgs/msg/String", "cdr", profiles});
  EXPECT_EQ(contents.topics().size(), 10u);
  EXPECT_EQ(std::ranges::count(contents.topics(), profiles, &BagTopic::offered_qos), 3);
}

TEST_F(BagTest, APipeInAFolderIsNoPart) {
  ASSERT_EQ(mkfifo((folder_ / "a_0.db3").c_str(), 0600), 0);
  const auto opened = BagFile::open(folder_);
  ASSERT_FALSE(opened) << "and it waited for no writer";
  EXPECT_THAT(opened.error(), HasSubstr("no .db3 or .mcap file"));
}

TEST_F(BagTest, MessagesThatCannotBeAreCounted) {
  const Read all = read(write(
      "a.mcap",
      mcap(two_topics() + said(7, 10, "whose?") + said(1, std::uint64_t{1} << 63, "when?") +
               message(1, 20, "\x04\x22lz4") + message(1, 21, "") + test::record(0x05, "short"),
           5)));
  EXPECT_EQ(all.messages.size(), 2);
  EXPECT_THAT(all.losses, ElementsAre(HasSubstr("1 message cut short"),
                                      HasSubstr("1 message neither in CDR nor compressed"),
                                      HasSubstr("1 message of a topic"),
                                      HasSubstr("1 message with a time that cannot be"),
                                      HasSubstr("1 message without content")));
}

TEST_F(BagTest, APartThatCannotBeReadDoesNotHideTheOthers) {
  write("bag_0.db3", "no database at all, but long enough to be looked at");
  {
    auto part = make("bag_1.db3");
    EXPECT_TRUE(part.run("BEGIN"));
    for (int i = 0; i < 400; ++i) add(part, 1, i, kCdr + std::string(300, 'x'));
    EXPECT_TRUE(part.run("COMMIT"));
  }
  std::string cut = bytes_of("bag_1.db3");
  std::fill(cut.begin() + static_cast<std::ptrdiff_t>(cut.size() / 2), cut.end(), '\xff');
  write("bag_1.db3", cut);
  write("bag_2.mcap", mcap(two_topics() + said(1, 1000, "u"), 1));
  const Read all = read(folder_);
  EXPECT_THAT(all.losses,
              ElementsAre(HasSubstr("bag_0.db3: it is no"), HasSubstr("bag_1.db3: it is damaged")));
  EXPECT_EQ(all.messages.back(), "/a@1000=u");
}

TEST_F(BagTest, SaysWhyABagCannotBeRead) {
  const auto why = [](const fs::path& path) {
    const auto opened = BagFile::open(path);
    return opened ? "" : opened.error();
  };
  EXPECT_THAT(why(folder_ / "nowhere.db3"), HasSubstr("there is no such bag"));
  EXPECT_THAT(why(folder_), HasSubstr("no .db3 or .mcap file"));
  EXPECT_THAT(why(write("a.mcap", "MCAP")), HasSubstr("a.mcap: it is not MCAP"));
  EXPECT_THAT(why(write("a.mcap.zstd", "MCAP")), HasSubstr("compression is damaged"));
  EXPECT_THAT(why(write("a.db3.zstd", "SQLite")), HasSubstr("compression is damaged"));
  EXPECT_THAT(why(write("a.db3", "no database at all")), HasSubstr("a.db3: it is no"));
  (void)value_of(journal::Database::open(folder_ / "b.db3", journal::Database::Mode::kWrite))
      .run("CREATE TABLE t(a)");
  EXPECT_THAT(why(folder_ / "b.db3"), HasSubstr("it is no bag"));
}

// It would be read without an end.
TEST_F(BagTest, AViewInPlaceOfMessagesIsRefused) {
  auto database =
      value_of(journal::Database::open(folder_ / "a.db3", journal::Database::Mode::kWrite));
  ASSERT_TRUE(database.run(
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format "
      "TEXT, "
      "offered_qos_profiles TEXT);"
      "INSERT INTO topics VALUES (1, '/a', 'std_msgs/msg/Float64', 'cdr', '');"
      "CREATE VIEW messages AS WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) "
      "SELECT x AS id, 1 AS topic_id, x AS timestamp, '' AS data FROM n WHERE x < 0"));
  const auto opened = BagFile::open(folder_ / "a.db3");
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error(), HasSubstr("it is no bag"));
}

// Each row would take a gigabyte.
TEST_F(BagTest, AComputedColumnIsRefused) {
  auto database =
      value_of(journal::Database::open(folder_ / "a.db3", journal::Database::Mode::kWrite));
  ASSERT_TRUE(database.run(
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format "
      "TEXT, "
      "offered_qos_profiles TEXT);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, "
      "data BLOB AS (zeroblob(999999000)));"));
  const auto opened = BagFile::open(folder_ / "a.db3");
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error(), HasSubstr("it has computed columns"));
}

std::vector<double> times_of(const fs::path& path) {
  std::vector<double> times;
  BagFile bag = value_of(BagFile::open(path));
  for (BagMessage message; bag.next(message);)
    times.push_back(static_cast<double>(message.at - test::kBagStart) / 1e9);
  return times;
}

double longest_gap(const std::vector<double>& times) {
  double longest = 0;
  for (std::size_t i = 1; i < times.size(); ++i)
    longest = std::max(longest, times[i] - times[i - 1]);
  return longest;
}

// The same messages in both formats; MCAP with a chunk for 25 and for 40, so that the clock is set
// between two chunks and within one.
void write_all(const fs::path& folder, const test::TestRecording& recording) {
  test::write_db3(folder / "a.db3", recording);
  test::write_mcap(folder / "b.mcap", recording, 25);
  test::write_mcap(folder / "c.mcap", recording, 40);
}
constexpr const char* kAllFormats[] = {"a.db3", "b.mcap", "c.mcap"};

TEST_F(BagTest, TimeGoesOnWhereTheClockWasSetInEveryFormat) {
  for (const std::int64_t by : {std::int64_t{-3600}, std::int64_t{7200}}) {
    const culprit::test::TestFolder own;
    test::TestRecording recording = test::regular_recording();
    for (std::size_t m = 150; m < 300; ++m) recording.messages[m].at += by * 1'000'000'000;
    write_all(own.path(), recording);
    for (const char* name : kAllFormats) {
      BagFile bag = value_of(BagFile::open(own.path() / name));
      ASSERT_EQ(bag.contents().jumps().size(), 1u) << name;
      const ClockJump& jump = bag.contents().jumps()[0];
      EXPECT_NEAR(static_cast<double>(jump.by) / 1e9, static_cast<double>(by), 0.01) << name;
      EXPECT_NEAR(static_cast<double>(jump.at - test::kBagStart) / 1e9, 15.0, 0.01) << name;
      const std::vector<double> times = times_of(own.path() / name);
      EXPECT_EQ(times.size(), 300u) << name;
      EXPECT_NEAR(longest_gap(times), 0.1, 0.01) << name;
    }
  }
}

TEST_F(BagTest, AFileThatWasWrittenInAnotherOrderIsReadByItsTimes) {
  test::TestRecording recording = test::regular_recording();
  std::rotate(recording.messages.begin(), recording.messages.begin() + 150,
              recording.messages.end());
  write_all(folder_, recording);
  for (const char* name : kAllFormats) {
    const std::vector<double> times = times_of(folder_ / name);
    EXPECT_EQ(times.size(), 300u) << name;
    EXPECT_NEAR(longest_gap(times), 0.1, 1e-6) << name;
    EXPECT_TRUE(value_of(BagFile::open(folder_ / name)).contents().jumps().empty()) << name;
  }
}

TEST_F(BagTest, CountsMessagesThatWereWrittenAfterLaterOnes) {
  test::TestRecording recording = test::regular_recording();
  for (const std::size_t m : {10, 100, 200}) recording.messages[m].at -= 250 * test::kMillisecond;
  write_all(folder_, recording);
  for (const char* name : kAllFormats) {
    BagFile bag = value_of(BagFile::open(folder_ / name));
    for (BagMessage message; bag.next(message);) {
    }
    EXPECT_EQ(bag.late(), 3u) << name;
  }
}

TEST_F(BagTest, RecordersThatRanAtTheSameTimeAreMerged) {
  test::write_db3(folder_ / "left.db3", test::regular_recording("/a"));
  test::write_mcap(folder_ / "right.mcap", test::regular_recording("/a"), 25);
  const std::vector<double> times = times_of(folder_);
  EXPECT_EQ(times.size(), 600u);
  EXPECT_NEAR(longest_gap(times), 0.1, 1e-6);
  EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
}

TEST_F(BagTest, MetadataSaysWhichPartsBelong) {
  const test::TestRecording whole = test::regular_recording();
  const auto part = [&](std::size_t from, std::size_t until) {
    test::TestRecording some = whole;
    some.messages.assign(whole.messages.begin() + static_cast<std::ptrdiff_t>(from),
                         whole.messages.begin() + static_cast<std::ptrdiff_t>(until));
    return some;
  };
  test::write_db3(folder_ / "z_first.db3", part(0, 100));
  test::write_db3(folder_ / "a_last.db3", part(200, 300));
  test::write_db3(folder_ / "old.db3", part(0, 300));
  test::write_metadata(folder_, {"z_first.db3", "middle.db3", "a_last.db3", "a_last.db3"}, 300);
  BagFile bag = value_of(BagFile::open(folder_));
  std::vector<std::int64_t> after_holes;
  std::size_t count = 0;
  for (BagMessage message; bag.next(message); ++count) {
    if (message.is_after_hole) after_holes.push_back((message.at - test::kBagStart) / 1'000'000);
  }
  EXPECT_EQ(count, 200u);
  EXPECT_THAT(after_holes, ElementsAre(20'000));
  EXPECT_THAT(bag.contents().losses(), ElementsAre(HasSubstr("middle.db3: metadata.yaml names")));
  EXPECT_THAT(bag.contents().remarks(), ElementsAre(HasSubstr("old.db3: metadata.yaml does not")));
}

TEST_F(BagTest, MetadataCountsWhatIsMissing) {
  test::write_db3(folder_ / "a_0.db3", test::regular_recording());
  test::write_metadata(folder_, {"a_0.db3"}, 310);
  const Read all = read(folder_);
  EXPECT_THAT(all.losses, ElementsAre(HasSubstr("310 messages, of which 10 are missing")));
}

// The parser would take gigabytes for it.
TEST_F(BagTest, MetadataOfAMillionPiecesIsPassedOver) {
  test::write_db3(folder_ / "a_0.db3", test::regular_recording());
  test::write_metadata(folder_, {"a_0.db3"}, 310);
  std::ofstream more(folder_ / "metadata.yaml", std::ios::app);
  more << "more: [a";
  for (int i = 0; i < 1'000'000; ++i) more << ",a";
  more << "]\n";
  more.close();
  const Read all = read(folder_);
  EXPECT_EQ(all.messages.size(), 300u);
  EXPECT_THAT(all.losses, IsEmpty()) << "it counts 310";
}

TEST_F(BagTest, PartsThatWereRenamedAreRead) {
  test::write_db3(folder_ / "my_bag.db3", test::regular_recording());
  test::write_metadata(folder_, {"rosbag2_2026_01_30-15_32_05_0.db3"}, 300);
  BagFile bag = value_of(BagFile::open(folder_));
  std::size_t count = 0;
  for (BagMessage message; bag.next(message);) ++count;
  EXPECT_EQ(count, 300u);
  EXPECT_THAT(bag.contents().losses(), IsEmpty());
  EXPECT_THAT(bag.contents().remarks(),
              ElementsAre("my_bag.db3: metadata.yaml calls this part "
                          "rosbag2_2026_01_30-15_32_05_0.db3; the file was renamed"));
}

TEST_F(BagTest, TypesOfTwoPartsAreThoseOfMessages) {
  test::TestRecording recording = test::regular_recording();
  recording.types[0].second = "std_msgs/Float64";
  test::write_db3(folder_ / "a.db3", recording);
  const BagFile bag = value_of(BagFile::open(folder_ / "a.db3"));
  EXPECT_EQ(bag.contents().topics()[0].type, "std_msgs/msg/Float64");
  const std::string data = schema(1, "my_msgs/Thing", "float64 x") + channel(1, 1, "/x");
  write("b.mcap", mcap(data + said(1, 1, "u"), 1));
  BagFile other = value_of(BagFile::open(folder_ / "b.mcap"));
  for (BagMessage message; other.next(message);) continue;
  EXPECT_NE(other.contents().definition_of("my_msgs/msg/Thing"), nullptr);
}

TEST_F(BagTest, NamesGetTheirLeadingSlash) {
  test::write_db3(folder_ / "a.db3", test::regular_recording("x"));
  const BagFile bag = value_of(BagFile::open(folder_ / "a.db3"));
  EXPECT_EQ(bag.contents().topics()[0].name, "/x");
}

TEST_F(BagTest, ATopicMayChangeItsType) {
  const std::string data = schema(1, "std_msgs/msg/Float64", "") + channel(1, 1, "/x") +
                           schema(2, "std_msgs/msg/Float32", "") + channel(2, 2, "/x");
  const Read all = read(write("a.mcap", mcap(data + said(1, 1, "u") + said(2, 2, "v"), 2)));
  EXPECT_THAT(all.messages, ElementsAre("/x@1=u", "/x@2=v"));
  const BagFile bag = value_of(BagFile::open(folder_ / "a.mcap"));
  EXPECT_EQ(bag.contents().topics().size(), 2u);
}

// Recorders that do not find the definition of a type write an empty one.
TEST_F(BagTest, AnEmptyDefinitionIsNone) {
  write(
      "bag.mcap",
      mcap(schema(1, "std_msgs/msg/String", " \n") + channel(1, 1, "/a") + message(1, 5, kCdr), 1));
  BagFile bag = value_of(BagFile::open(folder_ / "bag.mcap"));
  for (BagMessage each; bag.next(each);) continue;
  EXPECT_EQ(bag.contents().definition_of("std_msgs/msg/String"), nullptr);
}

TEST_F(BagTest, ADatabaseThatWasCutOffIsReadAsFarAsItGoes) {
  test::TestRecording recording{{{"/x", "std_msgs/msg/Float64"}}, {}};
  for (int i = 0; i < 3000; ++i)
    recording.messages.push_back({test::kBagStart + i * 10 * test::kMillisecond, "/x",
                                  std::string(test::text_of(test::number(i)))});
  test::write_db3(folder_ / "a.db3", recording);
  const std::string whole = bytes_of("a.db3");
  for (const double share : {0.9, 0.5}) {
    const auto size = static_cast<std::size_t>(static_cast<double>(whole.size()) * share);
    const Read all = read(write("cut.db3", whole.substr(0, size)));
    EXPECT_GT(static_cast<double>(all.messages.size()), 3000 * share * 0.8) << share;
    EXPECT_THAT(all.losses, ElementsAre(HasSubstr(".recover"))) << share;
  }
}

TEST_F(BagTest, ADamagedPageOfADatabaseIsPassed) {
  test::TestRecording recording = test::regular_recording();
  for (auto& each : recording.messages) each.bytes += std::string(300, 'x');
  test::write_db3(folder_ / "a.db3", recording);
  std::string bytes = bytes_of("a.db3");
  const auto page = static_cast<std::ptrdiff_t>(bytes.size() / 4096 / 2 * 4096);
  std::fill(bytes.begin() + page, bytes.begin() + page + 4096, '\xff');
  write("a.db3", bytes);
  BagFile bag = value_of(BagFile::open(folder_ / "a.db3"));
  std::size_t count = 0;
  std::size_t holes = 0;
  for (BagMessage message; bag.next(message); ++count) holes += message.is_after_hole ? 1 : 0;
  EXPECT_GT(count, 250u);
  EXPECT_LT(count, 300u);
  EXPECT_EQ(holes, 1u);
}

// A page that refers to another one twice; of pages that refer to one another there would be no end.
TEST_F(BagTest, ADatabaseWhoseRowsRepeatIsReadOnce) {
  test::TestRecording recording = test::regular_recording();
  for (auto& each : recording.messages) each.bytes += std::string(300, 'x');
  test::write_db3(folder_ / "a.db3", recording);
  std::string bytes = bytes_of("a.db3");
  constexpr std::size_t kPage = 4096, kCells = 12;
  constexpr char kInnerPageOfTable = 5;
  const auto number_at = [&](std::size_t at) {
    return std::size_t{static_cast<std::uint8_t>(bytes[at])} << 8 |
           static_cast<std::uint8_t>(bytes[at + 1]);
  };
  std::size_t page = kPage;
  while (page < bytes.size() && bytes[page] != kInnerPageOfTable) page += kPage;
  ASSERT_LT(page, bytes.size());
  const std::size_t count = number_at(page + 3);
  ASSERT_GT(count, 10u);
  const auto cell = [&](std::size_t n) { return page + number_at(page + kCells + 2 * n); };
  bytes.replace(cell(count / 2), 4, bytes.substr(cell(0), 4));
  write("a.db3", bytes);
  const std::vector<double> times = times_of(folder_ / "a.db3");
  EXPECT_GT(times.size(), 250u);
  EXPECT_LT(times.size(), 300u);
  EXPECT_TRUE(std::ranges::adjacent_find(times, std::greater_equal()) == times.end());
}

TEST_F(BagTest, SaysWhatElseAFileIs) {
  const auto why = [](const fs::path& path) {
    const auto opened = BagFile::open(path);
    return opened ? "" : opened.error();
  };
  EXPECT_THAT(why(write("a.bag", "#ROSBAG V2.0\n")), HasSubstr("ROS 1 bag"));
  EXPECT_THAT(why(write("b.db3", "#ROSBAG V2.0\n")), HasSubstr("ROS 1 bag"));
  EXPECT_THAT(why(write("c.mcap", "version https://git-lfs.github.com/spec/v1\noid sha256:1\n")),
              HasSubstr("git lfs pull"));
  EXPECT_THAT(why(write("d.mcap", "")), HasSubstr("empty"));
  const fs::path folder = folder_ / "ros1";
  fs::create_directory(folder);
  std::ofstream(folder / "a.bag") << "#ROSBAG V2.0\n";
  EXPECT_THAT(why(folder), HasSubstr("ROS 1 bag"));
  const fs::path days = folder_ / "days";
  for (const char* day : {"monday", "tuesday", "notes"}) fs::create_directories(days / day);
  test::write_db3(days / "monday" / "a_0.db3", test::regular_recording());
  test::write_db3(days / "tuesday" / "b.db3", test::regular_recording());
  EXPECT_THAT(why(days), HasSubstr("it holds the recordings monday, tuesday; name one"));
}

// Reading a damaged file always ends, and gives only messages that were written.
RC_GTEST_PROP(DamagedBag, IsReadToItsEnd, ()) {
  const std::string name = (fs::temp_directory_path() / "culprit-bag-").string() +
                           std::to_string(getpid()) + "-damaged.mcap";
  std::string bytes = mcap(chunk(two_topics() + said(1, 1, "u") + said(2, 2, "v"), "zstd") +
                               chunk(said(1, 3, "w"), "lz4") + chunk(said(1, 4, "x"), ""),
                           4);
  const auto changes = *rc::gen::container<std::vector<std::pair<std::size_t, char>>>(
      rc::gen::pair(rc::gen::inRange<std::size_t>(8, bytes.size()), rc::gen::arbitrary<char>()));
  for (const auto& [place, byte] : changes) bytes[place] = byte;
  bytes.resize(*rc::gen::inRange<std::size_t>(8, bytes.size() + 1));
  std::ofstream(name, std::ios::binary) << bytes;
  const Read all = read(name);
  fs::remove(name);
  RC_ASSERT(all.messages.size() <= 50);
}

}  // namespace
}  // namespace culprit::bag
