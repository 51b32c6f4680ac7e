// A robot for tests of the manager: a pipeline of components in virtual time, with faults and with
// every way in which an adaptation can go wrong.
//
// A component works if its process runs, it is active, it has no fault, and everything that it
// needs works. While it works it publishes each of its topics periodically. Requests are answered
// after a few milliseconds.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "knowledge/describe.h"
#include "language/checker.h"
#include "manager/manager.h"
#include "plan/bayes/bayes_planner.h"
#include "simulation/body.h"

namespace culprit::test {

using namespace std::chrono_literals;

class TestRobot {
 public:
  explicit TestRobot(const std::string& rules,
                     std::unique_ptr<const Planner> planner = std::make_unique<BayesPlanner>(),
                     Autonomy autonomy = Autonomy::kAct)
      : TestRobot(rules, std::move(planner), options_of(autonomy)) {}
  // `options.start` is when the robot's time begins.
  TestRobot(const std::string& rules, std::unique_ptr<const Planner> planner,
            Manager::Options options);
  // Prints all that was said and asked for if a check of the test failed.
  ~TestRobot();
  TestRobot(TestRobot&&) = default;

  struct Component : simulation::Body {
    std::string name;
    bool has_lifecycle = true;
    std::vector<std::string> needs;
    std::vector<std::string> hears{};  // what it subscribes to, and can do without
    std::string fault;  // "", or what resolves it: "restart", "redeploy", or "parameter=value"
    // How it fails to serve.
    bool refuses = false;
    bool ignores_parameters = false;  // says yes and does nothing
    bool loses_replies = false;       // does it, and the answer is lost
    Duration lateness{};              // with which it is reported that no answer came
    bool dies_at_start = false;
    std::string start_missing{};  // why it cannot be started: "there is no program 'camera'"
    bool ends_only_if_killed = false;
    Duration start_time = 300ms;
    Duration answers_after_start{};  // until then it is busy loading
    Lifecycle state_at_start = Lifecycle::kActive;
    // A timer of its own activates it so long after its start. It ends if somebody was there first.
    Duration activates_itself_after{};
    bool leaves_before_it_ends = false;  // the graph, as nodes in Python do
    bool fails_to_activate = false;      // with an error: it falls back to unconfigured
    int launcher = 0;    // of the launch in which what culprit starts takes its place; 0: none
    std::string host{};  // another computer, where nobody can start or end it; empty: this one
  };
  Component& operator[](const std::string& name) { return components_.at(name); }
  Component& add(const std::string& name, std::vector<std::string> needs = {},
                 const std::string& topic = "", Duration period = 100ms);

  void run_for(Duration time);
  // After each of these, the robot runs for `then`.
  void fail(const std::string& name, const std::string& fault, Duration then);
  void signal(const std::string& name, Value value, Duration then = {});
  // -9: its process is gone, its node lingers until its lease ends
  void kill(const std::string& name, Duration then = {});
  void stop(const std::string& name, Duration then = {});           // -STOP
  void leave(const std::string& name, Duration then = {});          // good-bye, as after Ctrl-C
  void start_by_hand(const std::string& name, Duration then = {});  // a person does
  // Cuts that computer off, and reports it as the link does: that it is silent after some seconds,
  // and that its nodes left the graph when their leases expired.
  void cut(const std::string& host, Duration then = {});
  void mend(const std::string& host, Duration then = {});
  // All stands still, the manager too.
  void freeze(Duration time);
  void order(Order order, Duration then = {}) { tell(std::move(order), then); }
  // An observation that comes now.
  template <class What>
  void tell(What what, Duration then = {}) {
    observe(std::move(what));
    step(then);
  }

  // Says each node, topic and state to the manager, as discovery does. Call once, after add().
  void discover(Duration then = {});

  bool works(const std::string& name) const;
  ComponentId id(const std::string& name) const;
  Manager& manager() { return *manager_; }
  const RuleSet& rules() const { return *rules_; }

  // The manager's events in words, and its commands: "camera: activate".
  std::vector<std::string> said;
  std::vector<std::string> asked;
  std::vector<Event> events;
  std::size_t count(const std::string& part) const;  // lines of `said` that contain it
  std::size_t count_asked(const std::string& part) const;
  bool was_asked(const std::string& part) const { return count_asked(part) > 0; }

  // Whether the message that is sent now on this topic is lost on the way to the manager.
  std::function<bool(const std::string& topic)> loses;
  // Called after each step of the manager.
  std::function<void()> after_step;
  // Called after each step and before its commands are served. If it gives false they never are:
  // the manager died with them.
  std::function<bool(std::vector<Observation>&, std::span<const Command>)> before_commands;
  // Another process of culprit takes over: it knows nothing, and discovers the robot anew.
  void replace_manager(std::unique_ptr<Manager> manager);

  Time now{};

 private:
  static Manager::Options options_of(Autonomy autonomy) {
    Manager::Options options;
    options.autonomy = autonomy;
    return options;
  }
  struct Topic {
    std::string name;
    std::string producer;
    Duration period;
    Time next{};
    std::uint32_t lost = 0;  // since the last one that came
  };
  template <class What>
  void observe(What what) {
    inbox_.push_back({now, std::move(what)});
  }
  void step(Duration then = {});
  void serve(const Command& command);
  void reply(const Command& command, Outcome outcome, decltype(Reply::value) value = {},
             std::string text = "");
  simulation::Answer answer(Component& component, const Command& command);
  void resolve_fault(Component& component, const Command& command, bool is_done);
  void start(Component& component, const Command& command);
  void come_up(Component& component);
  void appear(const Component& component);
  bool is_cut_off(const Component& component) const { return cut_.contains(component.host); }
  void activate_itself(Component& component, int pid);
  void show_ends();  // of what runs
  void later(Duration delay, std::function<void()> action);

  std::unique_ptr<RuleSet> rules_;
  std::unique_ptr<Manager> manager_;
  std::map<std::string, Component> components_;
  std::vector<Topic> topics_;
  std::set<std::string> cut_;          // computers
  std::set<std::string> told_silent_;  // of them
  std::multimap<Time, std::function<void()>> agenda_;
  std::vector<Observation> inbox_;
  int last_pid_ = 100;
};

// A camera, what needs it, and a lamp that has nothing to do with either, each with a rule. `head`: lines before them;
// `camera`: clauses of the camera.
std::string rules_of_camera_and_lamp(const std::string& head = "", const std::string& camera = "");
void add_camera_and_lamp(TestRobot& robot);

// All that was said and asked for, a line each.
std::string transcript(const TestRobot& robot);

}  // namespace culprit::test
