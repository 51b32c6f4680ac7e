// How values went while somebody looked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "base/value.h"

namespace culprit::link {

// The course of a value that was read again and again.
struct ValueCourse {
  std::size_t numbers = 0;
  std::size_t others = 0;  // texts, true and false, what is no finite number
  double least = 0;        // of the numbers, if there are any
  double most = 0;
  double last = 0;
  bool rose = false;  // ever, from one to the next
  bool fell = false;
  std::size_t changes = 0;  // from one to the next
  std::size_t turns = 0;    // those in the other direction than the change before
  std::size_t row = 0;      // of equal numbers, now
  std::size_t longest_row = 0;
  bool is_rising = false;  // at the last change
  std::string text{};      // the last one
  std::size_t texts = 0;
  bool texts_differ = false;  // ever, from one to the next
  bool operator==(const ValueCourse&) const = default;

  void note(const Value& value);

 private:
  void note_text(const Value& value);
};

// The course of a diagnostic status.
struct StatusCourse {
  std::size_t messages = 0;
  std::uint8_t worst = 0;                       // level
  std::map<std::string, ValueCourse> keys;      // the first kMostKeys
  static constexpr std::size_t kMostKeys = 64;  // strangers choose how many there are
  bool operator==(const StatusCourse&) const = default;
};

}  // namespace culprit::link
