// For tests with a live robot that outlives its manager.
#pragma once

#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "exemplars/sunset/experiment.h"
#include "owners/supervisor.h"
#include "terminal/test_program.h"

namespace culprit::lab {

// The seven processes of SUNSET, on the domain of a TestWorld.
class LiveSunset {
 public:
  explicit LiveSunset(const TestWorld& world);
  // Ends also those that some culprit started, which is long gone.
  ~LiveSunset();

  std::vector<int> processes(sunset::Member member) const;
  // Its current fault; empty if it is well.
  std::string complaint() const;
  // False if it does not get well in time.
  bool is_well_within(Duration patience) const;

  Expected<void> inject(const std::string& fault);
  // For three seconds the node gets a fifth of the time only, in pieces.
  void slow_down(sunset::Member member);
  // Any fault that can be healed, or a node is slow for a while. A node that is just being replaced
  // cannot be broken: then nothing is.
  void break_something(std::mt19937& random);
  // One of these, or a node is slow for a while.
  void break_something(std::mt19937& random, const std::vector<std::string>& faults);
  static std::vector<std::string> faults_of_processes();

 private:
  std::uint32_t domain_;
  RuleSet members_;
  Inbox inbox_;
  std::unique_ptr<owners::Supervisor> processes_;
  std::unique_ptr<sunset::Experiment> experiment_;
  std::jthread slow_;
};

}  // namespace culprit::lab
