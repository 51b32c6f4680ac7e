// How far each writer has counted, and how much memory its samples take that come in fragments.
//
//   numbers    After a writer's last known number the next ones are believed up to kAhead, and kPerSecond for
//              each second of silence.
//   fragments  A reliable reader keeps what it has of each sample until it is complete. One that is best effort
//              keeps what it has of the newest, and its memory for the next.
//
// Only for writers that a reader of this participant receives: anybody can make up millions of others. Not thread-safe.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>
#include <vector>

#include "rtps/guid.h"

namespace culprit::rtps {

class WriterRecords {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Reading : std::uint8_t { kBestEffort, kReliable };

  static constexpr std::int64_t kAhead = 256;
  static constexpr std::int64_t kPerSecond = 10'000;

  // Limits in bytes for samples that come in fragments: those that reliable readers keep until they
  // are complete, of one writer and of all; and the largest samples of best effort writers, of one
  // and of all.
  static constexpr std::size_t kReliableOfOne = 4u << 20;
  static constexpr std::size_t kReliableOfAll = 8u << 20;
  static constexpr std::size_t kLargest = 32u << 20;
  static constexpr std::size_t kLargestOfAll = 32u << 20;

  // The greatest number that the writer can have written by `now`; nothing: none of it is known.
  std::optional<std::int64_t> furthest(const Guid& writer, Clock::time_point now) const;
  // It wrote, or announced, that number.
  void wrote(const Guid& writer, std::int64_t sequence, Clock::time_point now);

  // Some fragments of one sample.
  struct Fragments {
    std::int64_t sequence = 0;
    std::size_t size = 0;             // of the sample
    std::uint16_t fragment_size = 0;  // bytes
    std::uint32_t first = 0;          // from 1 on
    std::uint32_t count = 0;
    std::size_t all = 0;  // fragments of the sample
  };
  // Makes room for them. Otherwise gives the reason: there is too little, or they contradict earlier ones.
  // As long as a writer is known, it is always read in one way: forget() it before that changes.
  const char* reserve(const Guid& writer, Reading how, const Fragments& fragments);
  // The writer, which is read reliably, has no samples any more before that one.
  void has_none_before(const Guid& writer, std::int64_t sequence);

  // Frees what the writer reserves, too; the same for all of a participant.
  void forget(const Guid& writer);
  void forget(const GuidPrefix& participant);
  std::size_t size() const { return writers_.size(); }

 private:
  struct Assembly {
    std::size_t size = 0;
    std::uint16_t fragment_size = 0;
    std::vector<bool> seen;  // by fragment; of reliable writers only
    std::size_t missing = 0;
  };
  struct Writer {
    std::int64_t last = 0;  // written, as far as is known
    Clock::time_point heard;
    std::map<std::int64_t, Assembly> assemblies;  // by sequence number; of best effort writers one
    std::size_t reserved = 0;                     // bytes
    Reading how = Reading::kBestEffort;           // as they were reserved
  };
  static std::size_t kept_for(const Assembly& sample);
  void release(Writer& writer, std::map<std::int64_t, Assembly>::iterator which);
  void give_back(const Writer& writer, std::size_t bytes);
  std::size_t& total(Reading how) {
    return how == Reading::kReliable ? reserved_reliable_ : reserved_best_effort_;
  }

  std::unordered_map<Guid, Writer> writers_;
  std::size_t reserved_reliable_ = 0;
  std::size_t reserved_best_effort_ = 0;
};

}  // namespace culprit::rtps
