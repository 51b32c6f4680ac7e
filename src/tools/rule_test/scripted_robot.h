// A robot that plays a scenario in virtual time.
//
// All components of the rules are there at time 0 and work, unless the scenario says otherwise. A
// component works if its process runs and answers, its lifecycle (if it has one) is active, and
// all that it needs works. None of its topics and signals may be silent. A topic or signal of a
// component is silent while the component does not work.
//
// Requests are obeyed after a moment: 5 ms, 300 ms for a process to come up. A parameter that
// strategies write and the scenario does not set is there, with nothing in it (false, 0, "").
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "knowledge/event.h"
#include "knowledge/known_robot.h"
#include "robot/robot.h"
#include "rule_test/rule_scenario.h"
#include "simulation/body.h"

namespace culprit::rule_test {

class ScriptedRobot : public Robot {
 public:
  static constexpr Duration kAnswerTime = std::chrono::milliseconds(5);
  static constexpr Duration kStartTime = std::chrono::milliseconds(300);
  static constexpr Duration kPeriod = std::chrono::milliseconds(100);  // of signals and levels
  static constexpr Duration kProbePeriod =
      std::chrono::milliseconds(400);  // of what does not answer

  // Both must outlive the robot.
  ScriptedRobot(const RuleSet& rules, const Scenario& scenario);

  Time now() const override { return now_; }
  void observe(Time until, std::vector<Observation>& observations) override;
  void execute(const Command& command) override;

  // All that the rules name counts as seen, except absent components, and topics that only they
  // publish.
  KnownRobot declared() const;

  // Takes the manager's events. They tell the robot which strategy a command serves, and when an
  // adaptation took effect.
  void hear(const Event& event);

 private:
  struct Component : simulation::Body {
    std::string node;
    Lifecycle state_at_start = Lifecycle::kActive;
    std::optional<StrategyId> adapted_by;
    std::vector<std::pair<EndpointKind, std::string>> endpoints{};
    std::vector<ComponentId> needs;
  };
  struct Voice {
    Subject subject;
    std::vector<Stretch> stretches;
    Duration period{};
    std::vector<ComponentId> tellers;  // it is silent while one of them does not work
    std::optional<Value> value;        // now; nothing: silent
    bool is_heard = false;             // value, and all tellers work
    Time next{};
  };

  void build_components(const Scenario& scenario);
  void build_voices(const Scenario& scenario);
  void set_default_parameters();
  void appear(ComponentId id);
  void incident(const Incident& incident);
  void kill(ComponentId id);
  void probe(ComponentId id, int pid);
  void tell_goals(TopicId topic);
  void write_log(const LogCourse& log);
  void heal(const std::vector<Subject>& subjects);
  void follow_parameter(ParameterId id, const Value& value);
  void refresh_voices();
  std::vector<bool> working() const;
  void speak(Voice& voice);

  // How a command is answered.
  struct Conduct {
    Answer::Manner manner = Answer::Manner::kObeys;
    std::optional<Duration> takes;
  };
  Conduct conduct(const Command& command) const;
  void serve(const Command& command);
  void carry_out(const Command& command);
  void tell_change(const Command& command);
  void tell_parameter(ComponentId component, const std::string& name, const Value& value);
  void start(const Command& command, Duration takes);
  void stop(const Command& command);
  void time_out(const Command& command);
  void reply(const Command& command, Outcome outcome, decltype(Reply::value) value = {},
             std::string text = "");

  template <class What>
  void tell(What what) {
    inbox_.push_back({now_, std::move(what)});
  }
  void plan(Time at, std::function<void()> action) { agenda_.emplace(at, std::move(action)); }

  const RuleSet& rules_;
  const Scenario& scenario_;
  Time now_{};
  std::vector<Component> components_;
  std::vector<Voice> voices_;
  std::multimap<Time, std::function<void()>> agenda_;
  std::vector<Observation> inbox_;
  bool has_changed_ = true;  // what can be heard has to be found out anew
  int last_pid_ = 100;
};

}  // namespace culprit::rule_test
