#include "rtps/writer_records.h"

#include <gtest/gtest.h>

namespace culprit::rtps {
namespace {

using namespace std::chrono_literals;
using Reading = WriterRecords::Reading;

constexpr WriterRecords::Clock::time_point kWritten{100s};
constexpr std::size_t kMegabyte = 1'000'000;

// A writer of the participant.
Guid recorded_writer(std::uint8_t number, std::uint8_t participant = 1) {
  Guid guid;
  guid.bytes[0] = participant;
  guid.bytes[15] = number;
  return guid;
}

// The first of the fragments of a sample of so many bytes.
WriterRecords::Fragments first_of(std::int64_t sequence, std::size_t size) {
  return {sequence, size, 1000, 1, 1, (size + 999) / 1000};
}

TEST(WriterRecords, KnowNothingOfAWriterThatIsNew) {
  EXPECT_FALSE(WriterRecords().furthest(recorded_writer(1), kWritten));
}

TEST(WriterRecords, BelieveMoreTheLongerAWriterIsSilent) {
  WriterRecords records;
  records.wrote(recorded_writer(1), 10, kWritten);
  records.wrote(recorded_writer(1), 7, kWritten);
  EXPECT_EQ(records.furthest(recorded_writer(1), kWritten), 10 + WriterRecords::kAhead);
  EXPECT_EQ(records.furthest(recorded_writer(1), kWritten + 2s),
            10 + WriterRecords::kAhead + 2 * WriterRecords::kPerSecond);
}

TEST(WriterRecords, AReliableReaderKeepsEachSampleUntilItIsComplete) {
  WriterRecords records;
  const Guid writer = recorded_writer(1);
  std::int64_t sequence = 0;
  while (records.reserve(writer, Reading::kReliable, first_of(++sequence, kMegabyte)) == nullptr) {
  }
  EXPECT_EQ(sequence, 5) << "four fit";
  EXPECT_EQ(records.reserve(writer, Reading::kReliable, {1, kMegabyte, 1000, 2, 999, 1000}),
            nullptr);
  EXPECT_EQ(records.reserve(writer, Reading::kReliable, first_of(5, kMegabyte)), nullptr)
      << "the first is complete";
  records.has_none_before(writer, 3);
  EXPECT_EQ(records.reserve(writer, Reading::kReliable, first_of(6, kMegabyte)), nullptr);
}

TEST(WriterRecords, ABestEffortReaderKeepsTheNewest) {
  WriterRecords records;
  for (std::int64_t sequence = 1; sequence < 100; ++sequence)
    EXPECT_EQ(records.reserve(recorded_writer(1), Reading::kBestEffort,
                              first_of(sequence, 20 * kMegabyte)),
              nullptr);
  EXPECT_NE(records.reserve(recorded_writer(2), Reading::kBestEffort, first_of(1, 20 * kMegabyte)),
            nullptr)
      << "both would be too much";
}

TEST(WriterRecords, RefuseFragmentsThatContradictOneAnother) {
  WriterRecords records;
  const Guid writer = recorded_writer(1);
  EXPECT_EQ(records.reserve(writer, Reading::kReliable, first_of(1, kMegabyte)), nullptr);
  EXPECT_NE(records.reserve(writer, Reading::kReliable, first_of(1, 2 * kMegabyte)), nullptr);
}

TEST(WriterRecords, FreeWhatAWriterReservedWithIt) {
  WriterRecords records;
  for (std::uint8_t participant = 1; participant <= 2; ++participant)
    EXPECT_EQ(records.reserve(recorded_writer(1, participant), Reading::kReliable,
                              first_of(1, 4 * kMegabyte)),
              nullptr);
  const Guid third = recorded_writer(1, 3);
  EXPECT_NE(records.reserve(third, Reading::kReliable, first_of(1, 4 * kMegabyte)), nullptr);
  records.forget(recorded_writer(1, 1).prefix());
  EXPECT_EQ(records.reserve(third, Reading::kReliable, first_of(1, 4 * kMegabyte)), nullptr);
  records.forget(recorded_writer(1, 2));
  EXPECT_EQ(records.size(), 1u);
}

}  // namespace
}  // namespace culprit::rtps
