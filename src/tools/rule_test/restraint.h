// The limits of the governor while a robot is played: the defaults of `culprit run` without the
// quiet period at its start. A played robot has run for long.
#pragma once

#include "execute/governor.h"

namespace culprit::rule_test {

inline Governor::Options restraint() {
  Governor::Options options = Governor::Options::recommended();
  options.quiet_at_start = Duration::zero();
  return options;
}

}  // namespace culprit::rule_test
