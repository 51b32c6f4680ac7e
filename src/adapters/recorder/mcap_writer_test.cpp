#include "recorder/mcap_writer.h"

#include <algorithm>
#include <csignal>
#include <fstream>
#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "bag/bag_file.h"
#include "base/test_folder.h"
#include "base/text_file.h"

namespace culprit::recorder {
namespace {

using testing::IsEmpty;

struct Read {
  std::vector<std::pair<std::int64_t, std::string>> messages;  // when, and what
  std::vector<std::string> losses;
};

Read read_back(const std::filesystem::path& path) {
  Read read;
  auto file = bag::BagFile::open(path);
  if (!file) return {{}, {file.error()}};
  for (bag::BagMessage message; file->next(message);)
    read.messages.emplace_back(message.at, message.bytes);
  read.losses = file->contents().losses();
  return read;
}

std::string as_written(const std::function<void(McapWriter&, std::uint16_t channel)>& write) {
  std::string bytes;
  McapWriter writer(
      [&](std::string_view piece) {
        bytes += piece;
        return true;
      },
      "ros2", "test");
  const std::uint16_t schema =
      writer.add_schema({"std_msgs/msg/String", "ros2msg", "string data\n"});
  write(writer, writer.add_channel({schema, "/chatter", "cdr", {{"a", "b"}}}));
  return bytes;
}

// How every message begins; the reader recognizes others.
const std::string kCdr("\0\1\0\0", 4);

RC_GTEST_PROP(McapWriter, IsReadBackAsItWasWritten, ()) {
  const auto payloads = *rc::gen::container<std::vector<std::string>>(rc::gen::map(
      rc::gen::arbitrary<std::string>(), [](std::string text) { return kCdr + text; }));
  const auto flushed = *rc::gen::inRange<std::size_t>(0, payloads.size() + 1);
  const test::TestFolder own;
  std::ofstream(own / "a.mcap") << as_written([&](McapWriter& writer, std::uint16_t channel) {
    for (std::size_t i = 0; i < payloads.size(); ++i) {
      writer.add({channel, 0, static_cast<std::int64_t>(i + 1), 5}, payloads[i]);
      if (i == flushed) writer.flush();
    }
    writer.end();
  });
  const Read read = read_back(own / "a.mcap");
  RC_ASSERT(read.losses.empty());
  RC_ASSERT(read.messages.size() == payloads.size());
  for (std::size_t i = 0; i < payloads.size(); ++i)
    RC_ASSERT(read.messages[i] == std::pair(static_cast<std::int64_t>(i + 1), payloads[i]));
}

// Wherever the file is cut, earlier flushed messages are there.
TEST(McapWriter, LosesNothingThatWasFlushedWhereverItIsCut) {
  std::vector<std::size_t> ends;  // of the file after each flush
  const std::string whole = as_written([&](McapWriter& writer, std::uint16_t channel) {
    for (int i = 0; i < 4; ++i) {
      writer.add({channel, 0, i + 1, 0}, "message " + std::to_string(i));
      writer.flush();
      ends.push_back(writer.size());
    }
    writer.end();
  });
  const test::TestFolder own;
  for (std::size_t cut = ends.front() / 2; cut <= whole.size(); ++cut) {
    std::ofstream(own / "cut.mcap") << whole.substr(0, cut);
    const Read read = read_back(own / "cut.mcap");
    const auto flushed =
        std::count_if(ends.begin(), ends.end(), [&](auto end) { return end <= cut; });
    ASSERT_GE(read.messages.size(), flushed) << "cut at " << cut;
    for (std::size_t i = 0; i < read.messages.size(); ++i)
      ASSERT_EQ(read.messages[i].second, "message " + std::to_string(i)) << "cut at " << cut;
  }
}

// A process that writes is killed at some moment; the part that it reported as flushed is in its
// file.
TEST(McapWriter, LeavesAFileThatCanBeReadWhenItsProcessIsKilled) {
  const test::TestFolder own;
  for (int round = 0; round < 20; ++round) {
    const std::filesystem::path path = own / (std::to_string(round) + ".mcap");
    int said[2];
    ASSERT_EQ(pipe(said), 0);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      std::ofstream file(path, std::ios::binary);
      McapWriter writer(
          [&](std::string_view piece) {
            return bool(file.write(piece.data(), std::streamsize(piece.size())).flush());
          },
          "ros2", "test");
      const auto schema = writer.add_schema({"t/msg/T", "ros2msg", "string data\n"});
      const auto channel = writer.add_channel({schema, "/t", "cdr", {}});
      for (char i = 1;; ++i) {
        for (int k = 0; k < 50; ++k) writer.add({channel, 0, 1, 1}, std::string(2000, char(k)));
        writer.flush();
        if (write(said[1], &i, 1) != 1) _exit(1);
      }
    }
    close(said[1]);
    char flushes = 0;
    for (int wanted = 1 + round % 7; flushes < wanted;) ASSERT_EQ(read(said[0], &flushes, 1), 1);
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    close(said[0]);
    const Read read = read_back(path);
    EXPECT_GE(read.messages.size(), 50u * static_cast<unsigned char>(flushes));
    for (const auto& [at, payload] : read.messages) ASSERT_EQ(payload.size(), 2000);
  }
}

TEST(McapWriter, StopsWhenTheSinkRefuses) {
  std::string bytes;
  bool has_room = true;
  McapWriter writer(
      [&](std::string_view piece) {
        if (has_room) bytes += piece;
        return has_room;
      },
      "ros2", "test");
  const auto channel =
      writer.add_channel({writer.add_schema({"t/msg/T", "", ""}), "/t", "cdr", {}});
  writer.add({channel, 0, 1, 1}, "kept");
  writer.flush();
  has_room = false;
  writer.add({channel, 0, 2, 2}, "lost");
  writer.flush();
  EXPECT_FALSE(writer.is_good());
  has_room = true;
  writer.add({channel, 0, 3, 3}, "never written");
  writer.end();
  const test::TestFolder own;
  std::ofstream(own / "a.mcap") << bytes;
  EXPECT_EQ(read_back(own / "a.mcap").messages.size(), 1);
}

}  // namespace
}  // namespace culprit::recorder
