// A journal that is damaged anywhere: the beliefs survive or their loss is reported, and the file
// is written again.
#include <fstream>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "journal/learned_copy.h"
#include "journal/reader.h"
#include "journal/writer.h"
#include "json/json.h"

namespace culprit::journal {
namespace {

namespace fs = std::filesystem;
using culprit::test::TestFolder;
using testing::HasSubstr;

constexpr std::int64_t kNow = 1'800'000'000'000'000'000;
constexpr int kBeliefs = 20;

Batch batch(std::string_view kind, const std::string& body) {
  return {{{0, kNow, std::string(kind), body}}, {}};
}

LearnedBelief belief(int number, double alpha) {
  return {
      "Rule" + std::to_string(number % 4), "strategy" + std::to_string(number), {alpha, 4}, {5, 4}};
}

// Appends until it is in a file, as the recorder does.
void append_somehow(Writer& writer, const fs::path& path, const Batch& all) {
  if (writer.append(all, kNow, Durability::kProcessEnd)) return;
  Writer::Options options;
  options.is_damaged = writer.is_damaged();
  { const Writer useless = std::move(writer); }
  auto next = Writer::open(path, options);
  ASSERT_TRUE(next) << next.error();
  writer = std::move(*next);
  const auto written = writer.append(all, kNow, Durability::kProcessEnd);
  ASSERT_TRUE(written) << written.error();
}

struct Corruption : testing::Test {
  Corruption() {
    Writer::Options options;
    options.max_wal_bytes = 64 << 10;
    Writer writer = std::move(*Writer::open(folder / "a.journal", options));
    append(writer, batch(kind::kSession, to_line({{"text", std::string(3000, 's')}})));
    for (int i = 0; i < kBeliefs; ++i) {
      Batch all = batch(kind::kSteps, std::string(700, 'o'));
      for (int k = 0; k < 5; ++k)
        all.entries.push_back({0, kNow, std::string(kind::kEvent), to_line({{"text", "event"}})});
      all.learned.beliefs = {belief(i, 5 + i)};
      append(writer, all);
      expected.beliefs.push_back(all.learned.beliefs[0]);
    }
    append(writer, batch(kind::kEvent, to_line({{"text", "the last"}})));
    copy("a.journal", "killed.journal");  // with what is in the -wal file
  }
  static void append(Writer& writer, const Batch& all) {
    const auto written = writer.append(all, kNow, Durability::kProcessEnd);
    if (!written) throw std::runtime_error(written.error());
  }
  void copy(const std::string& from, const std::string& to) const {
    for (const char* part : {"", "-wal", "-learned"}) {
      fs::remove(folder.path() / (to + part));
      if (fs::exists(folder.path() / (from + part)))
        fs::copy_file(folder.path() / (from + part), folder.path() / (to + part));
    }
    fs::remove(folder.path() / (to + "-shm"));
  }
  // A damaged file: gives what was done to it.
  static std::string damage(const fs::path& path, std::mt19937_64& random) {
    const auto below = [&](std::uintmax_t end) {
      return random() % std::max<std::uintmax_t>(end, 1);
    };
    const auto kind = below(6);
    const bool is_wal = below(4) == 0 && fs::exists(path.string() + "-wal");
    const fs::path file = is_wal ? path.string() + "-wal" : path.string();
    const std::uintmax_t size = fs::file_size(file);
    const std::string name = file.filename().string();
    if (is_wal && kind == 0) {
      fs::remove(file);
      return name + " removed";
    }
    if (kind == 1) {
      const auto rest = below(size);
      fs::resize_file(file, rest);
      return name + " cut after " + std::to_string(rest);
    }
    std::fstream content(file, std::ios::in | std::ios::out | std::ios::binary);
    const auto put = [&](std::uintmax_t at, const std::string& bytes) {
      content.seekp(static_cast<std::streamoff>(at));
      content << bytes;
    };
    if (kind <= 3) {
      const std::uintmax_t at = below(size / 4096) * 4096;
      std::string page(4096, kind == 2 ? '\0' : '\xff');
      if (kind == 0)
        std::generate(page.begin(), page.end(), [&] { return static_cast<char>(random()); });
      put(at, page);
      return name + " page at " + std::to_string(at) + " overwritten";
    }
    std::string what = name + " bits changed at";
    for (auto i = below(8) + 1; i > 0; --i) {
      const std::uintmax_t at =
          kind == 4 ? below(std::min<std::uintmax_t>(size, 8192)) : below(size);
      content.seekg(static_cast<std::streamoff>(at));
      const char old = static_cast<char>(content.get());
      put(at, std::string(1, static_cast<char>(old ^ (1 << below(8)))));
      what += " " + std::to_string(at);
    }
    return what;
  }

  const TestFolder folder;
  Learned expected;
};

TEST_F(Corruption, LosesNothingThatWasLearnedAndTheJournalIsWrittenAgain) {
  copy("a.journal", "closed.journal");
  int said = 0;
  for (std::uint64_t seed = 1; seed <= 110; ++seed) {
    std::mt19937_64 random(seed);
    copy(seed % 2 == 0 ? "killed.journal" : "closed.journal", "b.journal");
    const fs::path path = folder / "b.journal";
    const std::string what = "seed " + std::to_string(seed) + ": " + damage(path, random);
    SCOPED_TRACE(what);
    auto writer = Writer::open(path, {});
    if (!writer && writer.error().find("newer culprit") != std::string::npos) continue;
    ASSERT_TRUE(writer) << writer.error();
    said += writer->remark().empty() ? 0 : 1;
    const auto learned = writer->learned();
    ASSERT_TRUE(learned) << learned.error();
    EXPECT_TRUE(is_same(*learned, expected)) << writer->remark();

    Learned now = expected;
    for (int i = 0; i < 2; ++i) {
      Batch more = batch(kind::kEvent, to_line({{"text", std::string(1500, 'x')}}));
      more.learned.beliefs = {belief(0, 100 + i)};
      now.beliefs[0] = more.learned.beliefs[0];
      append_somehow(*writer, path, more);
    }
    { const Writer done = std::move(*writer); }
    auto again = Writer::open(path, {});
    ASSERT_TRUE(again) << again.error();
    EXPECT_TRUE(is_same(*again->learned(), now)) << again->remark();
    const auto newest =
        Reader(std::move(*Database::open(path, Database::Mode::kRead))).newest(kind::kEvent);
    ASSERT_TRUE(newest) << newest.error();
    ASSERT_TRUE(*newest);
    EXPECT_THAT((*newest)->body, HasSubstr("xxx"));
    for (const auto& each : fs::directory_iterator(folder.path())) {
      if (each.path().string().find("b.journal.damaged") != std::string::npos) fs::remove(each);
    }
  }
  EXPECT_GT(said, 10);
}

TEST_F(Corruption, OfTheSecondCopyLosesNothingAndIsSaid) {
  for (const bool is_gone : {false, true}) {
    copy("killed.journal", "b.journal");
    if (is_gone) fs::remove(learned_beside(folder / "b.journal"));
    if (!is_gone) std::ofstream(learned_beside(folder / "b.journal")) << "nonsense";
    Writer writer = std::move(*Writer::open(folder / "b.journal", {}));
    EXPECT_TRUE(is_same(*writer.learned(), expected));
    EXPECT_EQ(writer.remark().empty(), is_gone) << writer.remark();
    append(writer, batch(kind::kEvent, "{}"));
    const auto copied = read_copy(learned_beside(folder / "b.journal"));
    ASSERT_TRUE(copied && *copied);
    EXPECT_TRUE(is_same((*copied)->learned, expected));
  }
}

TEST_F(Corruption, OfWhatIsBelievedIsNoticedThoughTheFileIsWhole) {
  copy("killed.journal", "b.journal");
  {
    auto database = Database::open(folder / "b.journal", Database::Mode::kWrite);
    ASSERT_TRUE(database->run("UPDATE belief SET alpha = 1000 WHERE strategy = 'strategy3'"));
  }
  const auto writer = Writer::open(folder / "b.journal", {});
  ASSERT_TRUE(writer) << writer.error();
  EXPECT_THAT(writer->remark(), HasSubstr("second copy"));
  EXPECT_TRUE(is_same(*writer->learned(), expected));
}

TEST_F(Corruption, ALostWalFileIsSaid) {
  copy("killed.journal", "b.journal");
  ASSERT_TRUE(fs::remove(folder.path() / "b.journal-wal"));
  const auto writer = Writer::open(folder / "b.journal", {});
  ASSERT_TRUE(writer) << writer.error();
  EXPECT_THAT(writer->remark(), HasSubstr("-wal file"));
  EXPECT_TRUE(is_same(*writer->learned(), expected));
}

TEST_F(Corruption, AJournalThatIsGoneIsBegunAnewWithWhatWasLearned) {
  copy("killed.journal", "b.journal");
  fs::remove(folder / "b.journal");
  fs::remove(folder / "b.journal-wal");
  const auto writer = Writer::open(folder / "b.journal", {});
  ASSERT_TRUE(writer) << writer.error();
  EXPECT_THAT(writer->remark(), HasSubstr("the journal file is missing"));
  EXPECT_TRUE(is_same(*writer->learned(), expected));
}

}  // namespace
}  // namespace culprit::journal
