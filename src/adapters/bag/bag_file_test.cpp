// Bags as ros2 bag record writes them, in every storage and compression; and what is still read of
// broken ones.
#include "bag/bag_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

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
    all.messages.push_back(bag.contents().topics()[message.topic].name + "@" +
                           std::to_string(message.at) + "=" + std::string(message.bytes.substr(4)));
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

TEST_F(BagTest, MessagesThatCannotBeAreCounted) {
  const Read all =
      read(write("a.mcap", mcap(two_topics() + said(7, 10, "whose?") +
                                    said(1, std::uint64_t{1} << 63, "when?") +
                                    message(1, 20, "\x04\x22lz4") + test::record(0x05, "short"),
                                4)));
  EXPECT_EQ(all.messages.size(), 1);
  EXPECT_THAT(all.losses, ElementsAre(HasSubstr("1 message cut short"),
                                      HasSubstr("1 message neither in CDR nor compressed"),
                                      HasSubstr("1 message of a topic"),
                                      HasSubstr("1 message with a time that cannot be")));
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
  EXPECT_THAT(all.losses, ElementsAre(HasSubstr("bag_0.db3: it is no"),
                                      HasSubstr("bag_1.db3: the database is damaged")));
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

// Whatever is cut off or changed, reading ends, and what it gives was written.
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
