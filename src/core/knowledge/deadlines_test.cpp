#include "knowledge/deadlines.h"

#include <map>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit {
namespace {

Time at(int ns) { return Time(Duration(ns)); }

RC_GTEST_PROP(Deadlines, AgreeWithASortedMap, ()) {
  constexpr std::size_t kThings = 20;
  Deadlines deadlines(kThings);
  std::map<std::size_t, Time> model;
  const int operations = *rc::gen::inRange(0, 200);
  for (int i = 0; i < operations; ++i) {
    const auto thing = *rc::gen::inRange<std::size_t>(0, kThings);
    const Time when = at(*rc::gen::inRange(0, 50));
    switch (*rc::gen::inRange(0, 3)) {
      case 0:
        deadlines.set(thing, when);
        model[thing] = when;
        break;
      case 1:
        deadlines.clear(thing);
        model.erase(thing);
        break;
      default: {
        const auto due = deadlines.pop_due(when);
        const auto earliest =
            std::min_element(model.begin(), model.end(), [](const auto& a, const auto& b) {
              return std::pair(a.second, a.first) < std::pair(b.second, b.first);
            });
        const bool expected = earliest != model.end() && earliest->second <= when;
        RC_ASSERT(due.has_value() == expected);
        if (!due) break;
        RC_ASSERT(*due == earliest->first);
        model.erase(earliest);
      }
    }
    Time next = kNever;
    for (const auto& [id, time] : model) next = std::min(next, time);
    RC_ASSERT(deadlines.next() == next);
    RC_ASSERT(deadlines.at(thing) == (model.contains(thing) ? model[thing] : kNever));
  }
}

}  // namespace
}  // namespace culprit
