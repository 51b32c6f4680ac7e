// For tests of the programs as users run them: a world of their own, and programs in it.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/test_folder.h"
#include "base/units.h"
#include "ros2/domain_lock.h"

namespace culprit {

// A DDS domain on loopback and a folder for state, both gone with it. Sets the environment that
// programs started meanwhile obey.
class TestWorld {
 public:
  TestWorld();

  const std::filesystem::path& folder() const { return folder_; }
  std::string write(const std::string& name, const std::string& text) const;

 private:
  ros2::DomainLock domain_;
  test::TestFolder own_;
  std::filesystem::path folder_ = own_.path();
};

// The process that culprit said last `component` to be; 0 if it did not.
int pid_in(const std::string& output, const std::string& component);

// A program of the project that runs, or has run. The destructor kills its remaining processes.
class TestProgram {
 public:
  // Only failures need it.
  static constexpr Duration kPatience = std::chrono::seconds(30);

  TestProgram(const TestWorld& world, std::vector<std::string> arguments);
  ~TestProgram();
  TestProgram(const TestProgram&) = delete;
  TestProgram& operator=(const TestProgram&) = delete;

  int pid() const { return pid_; }
  void signal(int number) const;
  // Waits for its end. Gives the exit code; minus the signal that ended it; nothing if it does not
  // end.
  std::optional<int> wait(Duration patience = kPatience);

  // All that it has printed so far.
  std::string output() const;
  // Waits until it has printed `text`. False if it does not.
  bool prints(const std::string& text, Duration patience = kPatience) const;

 private:
  std::filesystem::path log_;
  int pid_ = 0;
  std::optional<int> exit_;
};

// A component that is this node of SUNSET, and a rule that starts it again once it is gone: for the camera, CameraGone with
// the strategy camera_redeploy. `odds`: of the strategy, as it has them.
std::string replaced_when_gone(const std::string& node, const std::string& policies = "ERROR",
                               const std::string& odds = "90 10");

// The resources that a process holds.
struct Holdings {
  std::size_t descriptors = 0;
  std::size_t kilobytes = 0;  // resident
};
Holdings holdings_of(int pid);

// The names in `folder` that begin so.
std::set<std::string> names_in(const std::filesystem::path& folder, const std::string& beginning);

}  // namespace culprit
