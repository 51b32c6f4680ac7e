#include "link/waiting_lines.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace culprit::link {
namespace {

rtps::Guid writer_of_lines(std::uint8_t number) {
  rtps::Guid guid;
  guid.bytes[0] = number;
  return guid;
}

WaitingLines::Line line_of(std::uint8_t number) {
  return {writer_of_lines(number), LogLevel::kError, kLongAgo};
}

TEST(WaitingLines, OfAFloodDisplaceNoLineOfAnotherWriter) {
  WaitingLines waiting(10);
  for (int i = 0; i < 50; ++i) waiting.add(line_of(1));
  for (int i = 0; i < 3; ++i) waiting.add(line_of(2));
  for (int i = 0; i < 50; ++i) waiting.add(line_of(1));
  const auto lines = waiting.take();
  EXPECT_EQ(lines.size(), 10U);
  EXPECT_EQ(std::ranges::count(lines, writer_of_lines(2), &WaitingLines::Line::writer), 3);
}

TEST(WaitingLines, ComeInTheirOrderAndOnce) {
  WaitingLines waiting(10);
  for (const std::uint8_t number : {3, 1, 2}) waiting.add(line_of(number));
  const auto lines = waiting.take();
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0].writer, writer_of_lines(3));
  EXPECT_EQ(lines[2].writer, writer_of_lines(2));
  EXPECT_TRUE(waiting.take().empty());
}

TEST(WaitingLines, OfManyWritersAreBounded) {
  WaitingLines waiting(10);
  for (std::uint8_t number = 0; number < 200; ++number) waiting.add(line_of(number));
  EXPECT_EQ(waiting.take().size(), 10U);
}

}  // namespace
}  // namespace culprit::link
