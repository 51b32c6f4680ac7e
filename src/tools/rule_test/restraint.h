// What holds the manager back while a robot is played: what `culprit run` holds back by default,
// but for the quiet period at its start. A robot that is played has been there for long.
#pragma once

#include "execute/governor.h"

namespace culprit::rule_test {

inline Governor::Options restraint() {
  Governor::Options options = Governor::Options::recommended();
  options.quiet_at_start = Duration::zero();
  return options;
}

}  // namespace culprit::rule_test
