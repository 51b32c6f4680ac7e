// Shared parts of the live benchmarks: a world of its own, and programs in it as processes of their
// own.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "ros2/context.h"
#include "ros2/domain_lock.h"
#include "ros2/executor.h"

namespace culprit::bench {

// The resource usage of a process so far, from /proc.
struct Usage {
  double cpu_seconds = 0;
  double resident_mib = 0;  // now
};
Usage usage_of(int pid);

// A DDS domain on loopback and a folder, both gone with it. One at a time: it sets the environment
// that processes started meanwhile obey.
class World {
 public:
  World();
  ~World();

  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path write(const std::string& name, const std::string& text) const;
  ros2::ParticipantOptions participant() const;

 private:
  ros2::DomainLock domain_;
  std::filesystem::path folder_;
};

// A program that runs until its object ends. Programs are found beside this one.
class Child {
 public:
  Child(const World& world, const std::string& name, std::vector<std::string> arguments);
  ~Child();  // terminates it and waits
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  int pid() const { return pid_; }
  void terminate();
  // Waits until it ends by itself.
  struct Ended {
    int exit_code;       // -1: it was killed
    double cpu_seconds;  // that it used in all
  };
  Ended wait();
  // Its printed output.
  std::string output() const;

 private:
  std::filesystem::path log_;
  int pid_;
};

// Percent of one core, over `length`. Not a number if the process ended meanwhile, so that its claim is missed.
double cpu_percent(int pid, std::chrono::seconds length);

// A ROS 2 context whose executor has a thread.
class Side {
 public:
  explicit Side(const World& world);
  ~Side();

  ros2::Context& context() { return *context_; }
  ros2::Executor& executor() { return executor_; }

 private:
  ros2::Executor executor_;
  std::unique_ptr<ros2::Context> context_;
  std::thread thread_;
};

// The value below which the share `q` of `values` lies.
double quantile(std::vector<double> values, double q);

}  // namespace culprit::bench
