// The rows of decisions that are in no file yet, as far as is known. An intent may follow from them, so they are written to
// the intent file together with it.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <string>

#include "journal/entry.h"

namespace culprit::journal {

class RecentRows {
 public:
  // Keeps the rows of a decision instead of those that it had. `saved`: gives the newest decision that the journal has;
  // called only if the rows are too many.
  template <class Saved>
  void keep(std::uint64_t decision, std::span<const Entry> rows, Saved saved) {
    replace(decision, rows);
    if (bytes_ > kMaxBytes) forget(saved());
    if (bytes_ <= kMaxBytes) return;
    forgotten_ = decision;
    forget(decision);
  }
  // The rows of this decision and of those before it.
  void forget(std::uint64_t upto);

  // The newest decision whose rows were too many to be kept; 0: there was none.
  std::uint64_t forgotten() const { return forgotten_; }
  void append_to(std::string& all) const;

 private:
  static const std::size_t kMaxBytes;

  struct Recent {
    std::uint64_t decision;
    std::string rows;
  };

  void replace(std::uint64_t decision, std::span<const Entry> rows);

  std::deque<Recent> recent_;
  std::size_t bytes_ = 0;
  std::uint64_t forgotten_ = 0;
};

}  // namespace culprit::journal
