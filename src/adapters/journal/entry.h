// One row of the journal, and the chain that holds the rows together (docs/journal.md).
//
//     hash_n = SHA-256( hash_(n-1) | n | at | size of kind | kind | body )
//
// Numbers are 8 bytes, most significant first; hash_0 is 32 zero bytes. A change to a row, a
// removed row or an inserted one changes every hash after it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace culprit::journal {

// The kinds of rows. Files hold these words: they must not change.
namespace kind {
inline constexpr std::string_view kSession = "session";    // culprit began to manage
inline constexpr std::string_view kSteps = "steps";        // what the manager was stepped with
inline constexpr std::string_view kEvent = "event";        // what it found and decided, and why
inline constexpr std::string_view kIntent = "intent";      // a change that is about to be asked for
inline constexpr std::string_view kOutcome = "outcome";    // how such a request ended
inline constexpr std::string_view kBelief = "belief";      // what is believed of a strategy now
inline constexpr std::string_view kCoupling = "coupling";  // which failures go away together
inline constexpr std::string_view kLatency = "latency";    // how late a rule shows a change
inline constexpr std::string_view kRobot = "robot";        // the known robot, all of it
inline constexpr std::string_view kGap = "gap";            // what could not be written
inline constexpr std::string_view kEnd = "end";            // culprit was asked to stop
}  // namespace kind

struct Entry {
  std::int64_t id = 0;  // 1, 2, 3 ...
  std::int64_t at = 0;  // nanoseconds since 1970, UTC
  std::string kind;
  std::string body;  // JSON; of `steps` bytes (step_codec.h)
};

using Hash = std::array<unsigned char, 32>;

std::string to_hex(const Hash& hash);

// Computes SHA-256; reused, because setting OpenSSL up costs more than a small row.
class Hasher {
 public:
  Hasher();
  ~Hasher();
  Hasher(Hasher&&) noexcept;
  Hasher& operator=(Hasher&&) noexcept;

  // The next link of the chain.
  Hash link(const Hash& previous, const Entry& entry);
  Hash of(std::string_view bytes);
  Hash of(const Hash& before, std::string_view bytes);  // of both, in this order

 private:
  Hash end_with(std::string_view bytes);

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace culprit::journal
