// For tests of owners that are asked (systemd, a container engine): one component, the first of the
// rules, and culprit's observations after a request.
#pragma once

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "inbox/inbox.h"
#include "language/checker.h"
#include "owners/service_units.h"

namespace culprit::owners {

struct AsksAnOwner : testing::Test {
  // `clauses` name the component's owner.
  void manage(const std::string& name, const std::string& clauses, Units::Of whose,
              const std::string& host = {}) {
    units.reset();
    rules = *check(Source("test.rules", "COMPONENT " + name + " NODE /" + name + " " + clauses +
                                            "\nCOMPONENT camera NODE /camera\n"))
                 .rules;
    units.emplace(rules, inbox, whose, host);
  }

  // The first observation of that kind that fits.
  template <class What, class Fits>
  std::optional<What> wait_for(Fits fits) {
    for (const Time end = later(live_now(), std::chrono::seconds(20)); live_now() < end;) {
      std::vector<Observation> seen;
      inbox.take(std::min(end, later(live_now(), std::chrono::seconds(1))), seen);
      for (const Observation& each : seen) {
        const auto* what = std::get_if<What>(&each.what);
        if (what != nullptr && fits(*what)) return *what;
      }
    }
    return std::nullopt;
  }
  Reply answer() {
    const auto reply =
        wait_for<Reply>([&](const Reply& each) { return each.command == CommandId{count}; });
    return reply ? *reply : Reply{{}, Outcome::kTimedOut, {}, "nothing was answered"};
  }
  Reply start() {
    units->start(CommandId{++count}, ComponentId(0));
    return answer();
  }
  Reply stop(int pid, Ending ending = Ending::kToStartAgain, Hangs hangs = Hangs::kNo) {
    units->stop(CommandId{++count}, ComponentId(0), pid, ending, hangs);
    return answer();
  }

  Inbox inbox;
  RuleSet rules;
  std::optional<Units> units;
  std::uint64_t count = 0;
};

}  // namespace culprit::owners
