// ln Γ(x) for any thread: std::lgamma writes a global variable, which threads would share.
#pragma once

#include <cmath>

namespace culprit {

inline double log_gamma(double x) {
  int sign = 0;
  return lgamma_r(x, &sign);
}

}  // namespace culprit
