// A stand-in for a container engine, for tests: it speaks as much of the Docker Engine API as culprit
// asks for, in the form that Docker 20.10 answers, on a unix socket. A container really runs a process.
#pragma once

#include <atomic>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "base/mutex.h"
#include "base/test_folder.h"
#include "owners/file_descriptor.h"

namespace culprit::owners {

struct TestContainer {
  std::string policy = "no";  // "always", "unless-stopped"
  bool heeds_signals = true;  // ends when it is asked politely
  bool is_broken = false;     // it ends at once, with exit code 1
  std::string status = "created";
  int pid = 0;
  int code = 0;
  std::string events{};       // one a line
  std::string finished_at{};  // when it ended last
  std::vector<std::string> command{"sleep", "300"};
};

// As dockerd writes it; `signal` is of "kill". `at`: in seconds since 1970; 0: whenever events are asked for.
std::string event_of(const std::string& action, const std::string& signal = "",
                     std::int64_t at = 0);

class TestEngine {
 public:
  // A program that looks for docker meanwhile finds this one.
  TestEngine();
  ~TestEngine();

  std::string socket() const { return (own_.path() / "engine.sock").string(); }
  void add(const std::string& name, TestContainer container = {});
  // As `docker start`.
  int start(const std::string& name);
  int pid_of(const std::string& name);
  // The changes that were asked for, in order: "restart slam".
  std::vector<std::string> asked();
  // How often it was asked how a container is.
  int looks() const { return looks_; }

  // The answer that it gives in place of the truth; empty: the truth.
  void say(const std::string& answer);
  void hang(bool hangs);
  // It answers how a container is, and not what happened to it.
  void withhold_events(bool withholds);

 private:
  void serve();
  std::string answer_to(const std::string& method, const std::string& target)
      CULPRIT_REQUIRES(mutex_);
  std::string look_at(const std::string& name) CULPRIT_REQUIRES(mutex_);
  void run(TestContainer& container);
  void end(TestContainer& container);
  void notice(TestContainer& container);

  test::TestFolder own_;
  FileDescriptor listens_;
  std::vector<FileDescriptor> unanswered_{};
  Mutex mutex_;
  std::map<std::string, TestContainer> containers_ CULPRIT_GUARDED_BY(mutex_);
  std::vector<std::string> asked_ CULPRIT_GUARDED_BY(mutex_);
  std::atomic<int> looks_ = 0;
  std::string answer_ CULPRIT_GUARDED_BY(mutex_);
  bool hangs_ CULPRIT_GUARDED_BY(mutex_) = false;
  bool withholds_events_ CULPRIT_GUARDED_BY(mutex_) = false;
  bool is_ending_ CULPRIT_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace culprit::owners
