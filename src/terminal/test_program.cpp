#include "terminal/test_program.h"

#include <cctype>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <sys/wait.h>
#include <thread>

#include "base/environment.h"
#include "base/test_expected.h"
#include "owners/spawn.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;
using test::value_of;

// Whether `done` came true within a time that only failures need.
template <class Done>
bool eventually(Done done, Duration patience = TestProgram::kPatience) {
  const auto end = std::chrono::steady_clock::now() + patience;
  while (!done()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(20ms);
  }
  return true;
}

}  // namespace

TestWorld::TestWorld() : domain_(value_of(ros2::DomainLock::reserve())) {
  setenv("ROS_DOMAIN_ID", std::to_string(domain_.domain()).c_str(), 1);
  setenv("ROS_LOCALHOST_ONLY", "1", 1);
  setenv("SUNSET_STATE", folder_.c_str(), 1);
  setenv("XDG_RUNTIME_DIR", folder_.c_str(), 1);  // where its culprits are asked
}

std::string TestWorld::write(const std::string& name, const std::string& text) const {
  std::ofstream(folder_ / name) << text;
  return (folder_ / name).string();
}

int pid_in(const std::string& output, const std::string& component) {
  const std::string what = component + " is there (process ";
  const std::size_t at = output.rfind(what);
  return at == std::string::npos ? 0 : std::atoi(output.c_str() + at + what.size());
}

TestProgram::TestProgram(const TestWorld& world, std::vector<std::string> arguments) {
  static int count = 0;
  log_ = world.folder() / (arguments.at(0) + "-" + std::to_string(++count) + ".log");
  pid_ = value_of(owners::spawn({std::move(arguments), {own_folder()}, log_}));
}

TestProgram::~TestProgram() {
  if (exit_) return;
  kill(-pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
}

void TestProgram::signal(int number) const {
  if (!exit_) kill(pid_, number);
}

std::optional<int> TestProgram::wait(Duration patience) {
  const auto is_over = [&] {
    int status = 0;
    if (exit_ || waitpid(pid_, &status, WNOHANG) != pid_) return exit_.has_value();
    exit_ = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    return true;
  };
  eventually(is_over, patience);
  return exit_;
}

std::string TestProgram::output() const {
  std::ifstream file(log_);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

bool TestProgram::prints(const std::string& text, Duration patience) const {
  return eventually([&] { return output().find(text) != std::string::npos; }, patience);
}

std::string replaced_when_gone(const std::string& node, const std::string& policies,
                               const std::string& odds) {
  std::string rule = node + "Gone";
  rule[0] = static_cast<char>(std::toupper(rule[0]));
  return "COMPONENT " + node + " NODE /managed_subsystem/" + node + " LAUNCH \"sunset-node " +
         node + "\"\nRULE " + rule + "\n  POLICIES " + policies + "\n  TRIGGER alive(" + node +
         ") == false\n    STRATEGY " + node + "_redeploy " + odds + "\n      ADAPTATION " + node +
         " redeploy 5\n";
}

Holdings holdings_of(int pid) {
  const std::filesystem::path folder = "/proc/" + std::to_string(pid);
  Holdings holdings;
  std::error_code gone;
  for ([[maybe_unused]] const auto& each : std::filesystem::directory_iterator(folder / "fd", gone))
    ++holdings.descriptors;
  std::ifstream status(folder / "status");
  for (std::string word; status >> word;) {
    if (word == "VmRSS:") status >> holdings.kilobytes;
  }
  return holdings;
}

std::set<std::string> names_in(const std::filesystem::path& folder, const std::string& beginning) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(beginning)) names.insert(name);
  }
  return names;
}

}  // namespace culprit
