// A value, or the reason why there is none.
//
// Everything that can fail for a reason outside the program (a file, the network, a process)
// returns Expected<T>; exceptions are for bugs. The message of an Error is one line for a person:
// what happened, where, what to do next.
#pragma once

#include <string>
#include <utility>
#include <variant>

#include "base/invariant.h"

namespace culprit {

struct Error {
  std::string message;
};

template <class T>
class [[nodiscard]] Expected {
 public:
  Expected(T value) : content_(std::move(value)) {}
  Expected(Error error) : content_(std::move(error)) {}

  bool has_value() const { return content_.index() == 0; }
  explicit operator bool() const { return has_value(); }

  // @pre has_value()
  T& operator*() { return std::get<0>(content_); }
  const T& operator*() const { return std::get<0>(content_); }
  T* operator->() { return &std::get<0>(content_); }
  const T* operator->() const { return &std::get<0>(content_); }

  // @pre !has_value()
  const std::string& error() const { return std::get<1>(content_).message; }

 private:
  std::variant<T, Error> content_;
};

// For operations that give nothing but success.
template <>
class [[nodiscard]] Expected<void> {
 public:
  Expected() = default;
  Expected(Error error) : error_(std::move(error.message)), failed_(true) {}

  bool has_value() const { return !failed_; }
  explicit operator bool() const { return !failed_; }

  // @pre !has_value()
  const std::string& error() const {
    CULPRIT_ASSERT(failed_);
    return error_;
  }

 private:
  std::string error_;
  bool failed_ = false;
};

}  // namespace culprit
