// A reference manager for tests, tick by tick, on a robot that answers whatever it is asked before
// the next one.
//
// Its rules are rules/sunset-reference.rules unless the test brings some. The robot's topics are
// those of SUNSET with an inactive enhancement.
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "reference/reference_manager.h"

namespace culprit::test {

RuleSet rules_of(const std::string& text);
std::string sunset_reference_rules();

// D and C on and off; S off, so that redeploys go first.
study::ReferenceOptions without_s(bool dependencies, bool criticality);

class Ticks {
 public:
  explicit Ticks(study::ReferenceOptions options = {},
                 const std::string& rules = sunset_reference_rules());

  // The value is there from the next tick on.
  void signal(const std::string& name, Value value);
  void subscribe(const std::string& component, const std::string& topic);
  void publish(const std::string& component, const std::string& topic);
  void run(int ticks = 1);

  // The events, each line with the number of its tick: "3 RGBDead detected". The requests to the
  // components: "3 camera: deactivate"; between ticks the number is of the one before.
  std::vector<std::string> said;
  std::vector<std::string> asked;
  bool has_said(const std::string& line) const;
  bool has_asked(const std::string& line) const;
  std::string transcript() const;

  std::set<std::string> mute;      // components that never answer
  std::set<std::string> refusing;  // components that say no
  const RuleSet& rules() const { return *rules_; }
  StrategyId strategy(const std::string& name) const;
  std::vector<Event> events;

 private:
  void observe(ObservationWhat what);
  void step(Time now);
  std::string words(const Event& event) const;

  std::unique_ptr<RuleSet> rules_;
  std::unique_ptr<study::ReferenceManager> manager_;
  int tick_ = -1;
  Time now_{};
  std::vector<Observation> inbox_;
  std::vector<Command> unanswered_;
};

}  // namespace culprit::test
