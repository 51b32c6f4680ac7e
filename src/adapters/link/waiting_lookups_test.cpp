#include "link/waiting_lookups.h"

#include <gtest/gtest.h>

namespace culprit::link {
namespace {

using Room = WaitingLookups::Room;

rtps::Guid guid_of(std::size_t number) {
  rtps::Guid guid;
  guid.bytes[0] = static_cast<std::uint8_t>(number);
  guid.bytes[1] = static_cast<std::uint8_t>(number >> 8);
  return guid;
}

TEST(WaitingLookups, OfAFloodKeepNoOtherWriterUnknown) {
  WaitingLookups waiting(100);
  const rtps::Guid flood = guid_of(1);
  const rtps::Guid driver = guid_of(2);
  EXPECT_EQ(waiting.admit(flood, 100), Room::kMessage);
  EXPECT_EQ(waiting.admit(driver, 10), Room::kWriterOnly);
  EXPECT_EQ(waiting.admit(driver, 10), Room::kNone) << "it is looked up already";
  waiting.done(driver, 10, Room::kWriterOnly);
  EXPECT_EQ(waiting.admit(driver, 10), Room::kWriterOnly) << "no message of it has waited";
  waiting.done(flood, 100, Room::kMessage);
  EXPECT_EQ(waiting.admit(guid_of(3), 100), Room::kMessage);
}

TEST(WaitingLookups, AreBounded) {
  WaitingLookups waiting(0);
  std::size_t admitted = 0;
  for (std::size_t i = 0; i < 5000; ++i) admitted += waiting.admit(guid_of(i), 1) != Room::kNone;
  EXPECT_EQ(admitted, WaitingLookups::kMostWriters);
}

}  // namespace
}  // namespace culprit::link
