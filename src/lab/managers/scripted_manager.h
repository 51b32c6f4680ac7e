// A managing system that is written as the threads it consists of: they sleep, they ask the robot
// and wait for the answer, they wait for news. For managers of others, whose delays come from
// exactly that.
#pragma once

#include <coroutine>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "language/rule_set.h"
#include "manager/managing_system.h"
#include "managers/routine.h"
#include "simulation/random.h"

namespace culprit::study {

class ScriptedManager : public ManagingSystem {
 public:
  std::vector<Command> step(Time now, std::span<const Observation> observations) override;
  Time next_deadline() const override;
  // It reports no events.
  std::span<const Event> events() const override { return {}; }

 protected:
  using Request = decltype(Command::what);

  // `names` says what its components and signals are called. It must outlive the manager.
  ScriptedManager(const RuleSet& names, std::uint64_t seed);

  // A thread that begins with the first step.
  void run(Routine thread) { threads_.push_back(std::move(thread)); }
  // A message came, at now(). Called before threads that wait for news go on.
  virtual void on_signal(const std::string& /*name*/, const Value&) {}

  Time now() const { return now_; }
  simulation::Random& random() { return random_; }
  // Null while nothing was read.
  const Value* latest(const std::string& signal) const;
  double number(const std::string& signal, double otherwise) const;
  bool is_true(const std::string& signal) const;

  // ---- what a thread can wait for: co_await

  struct Sleep {
    ScriptedManager& manager;
    Duration time;
    bool await_ready() const { return time <= Duration::zero(); }
    void await_suspend(std::coroutine_handle<> thread) const;
    void await_resume() const {}
  };
  Sleep sleep(Duration time) { return {*this, time}; }
  Sleep sleep_until(Time time) { return {*this, time - now_}; }

  // Rung by one thread, heard by all that wait for it.
  struct Bell {
    std::vector<std::coroutine_handle<>> waiting;
  };
  struct Listening {
    Bell& bell;
    bool await_ready() const { return false; }
    void await_suspend(std::coroutine_handle<> thread) const { bell.waiting.push_back(thread); }
    void await_resume() const {}
  };
  Listening hear(Bell& bell) { return {bell}; }
  void ring(Bell& bell);
  // The next signal that is read.
  Listening news() { return {news_}; }

  struct Answer {
    ScriptedManager& manager;
    CommandId command;
    Reply reply;
    bool await_ready() const { return false; }
    void await_suspend(std::coroutine_handle<> thread);
    Reply await_resume() { return std::move(reply); }
  };
  // Asks the component, and waits for its answer at most for `timeout`.
  Answer ask(const std::string& component, Request what, Duration timeout);

  // A mutex whose waiting threads enter in the order of their arrival.
  struct Gate {
    bool is_taken = false;
    std::deque<std::coroutine_handle<>> waiting;
  };
  struct Entry {
    Gate& gate;
    bool await_ready() const { return !gate.is_taken; }
    void await_suspend(std::coroutine_handle<> thread) const { gate.waiting.push_back(thread); }
    void await_resume() const { gate.is_taken = true; }
  };
  Entry enter(Gate& gate) { return {gate}; }
  void leave(Gate& gate);

 private:
  void observe(const Observation& observation);
  void resume_all();

  const RuleSet& names_;
  simulation::Random random_;
  Time now_{};
  std::map<std::string, Value> latest_;  // by signal
  std::vector<Command> commands_;
  std::uint64_t last_command_ = 0;
  std::size_t begun_ = 0;  // threads
  struct Sleeper {
    Time until;
    std::coroutine_handle<> thread;
  };
  std::vector<Sleeper> sleepers_;
  struct Asker {
    Answer* answer;
    std::coroutine_handle<> thread;
  };
  std::map<CommandId, Asker> asking_;
  Bell news_;
  std::deque<std::coroutine_handle<>> ready_;
  std::vector<Routine> threads_;  // last: they go first
};

}  // namespace culprit::study
