// A monitor with its knowledge, told one observation after the other.
#pragma once

#include <string>
#include <utility>

#include "language/checker.h"
#include "monitor/monitor.h"

namespace culprit::test {

inline Monitor::Writes writes(Knowledge& knowledge) {
  return {knowledge.signals,    knowledge.graph,      knowledge.components,
          knowledge.departures, knowledge.discovered, knowledge.reported_names,
          knowledge.clock_step, knowledge.events};
}

struct Watched {
  explicit Watched(const std::string& text)
      : rules(*check(Source("test.rules", text)).rules),
        knowledge(rules),
        monitor(knowledge, writes(knowledge), Time{}, Time(std::chrono::seconds(5))) {}
  template <class What>
  void observe(Duration at, What what) {
    const Time time(at);
    monitor.advance(time);
    monitor.observe({time, std::move(what)}, time);
  }
  std::size_t touched() { return knowledge.signals.take_touched().size(); }
  RuleSet rules;
  Knowledge knowledge;
  Monitor monitor;
};

inline std::string rule(const std::string& trigger) {
  return "COMPONENT c NODE /c\nRULE R\nPOLICIES ERROR\nTRIGGER " + trigger +
         "\nSTRATEGY s 50 10\nADAPTATION c restart 1\n";
}

}  // namespace culprit::test
