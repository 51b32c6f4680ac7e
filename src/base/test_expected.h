// Unwraps results that tests expect to succeed.
#pragma once

#include <stdexcept>
#include <utility>

#include "base/expected.h"

namespace culprit::test {

// Fails the test, with the error, where there is no value.
template <class T>
T value_of(Expected<T> expected) {
  if (!expected) throw std::runtime_error(expected.error());
  return std::move(*expected);
}

}  // namespace culprit::test
