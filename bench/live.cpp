#include "live.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>

#include "base/environment.h"
#include "owners/spawn.h"

namespace culprit::bench {
namespace {

template <class T>
T value_of(Expected<T> expected) {
  if (!expected) throw std::runtime_error(expected.error());
  return std::move(*expected);
}

std::string read(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace

Usage usage_of(int pid) {
  const std::string process = "/proc/" + std::to_string(pid);
  const std::string stat = read(process + "/stat");
  const std::size_t name_end = stat.rfind(')');
  if (name_end == std::string::npos) return {};
  // After the name come the state and ten numbers, then user and system time (proc(5)).
  std::istringstream fields(stat.substr(name_end + 2));
  std::string skipped;
  for (int i = 0; i < 11; ++i) fields >> skipped;
  double user = 0;
  double system = 0;
  fields >> user >> system;
  std::istringstream pages(read(process + "/statm"));
  double total = 0;
  double resident = 0;
  pages >> total >> resident;
  return {(user + system) / static_cast<double>(sysconf(_SC_CLK_TCK)),
          resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20)};
}

World::World() : domain_(value_of(ros2::DomainLock::reserve())) {
  std::string name = (std::filesystem::temp_directory_path() / "culprit-bench-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a temporary folder");
  folder_ = name;
  setenv("ROS_DOMAIN_ID", std::to_string(domain_.domain()).c_str(), 1);
  setenv("ROS_LOCALHOST_ONLY", "1", 1);
}

World::~World() { std::filesystem::remove_all(folder_); }

std::filesystem::path World::write(const std::string& name, const std::string& text) const {
  std::ofstream(folder_ / name) << text;
  return folder_ / name;
}

ros2::ParticipantOptions World::participant() const {
  return value_of(ros2::options_from_environment());
}

Child::Child(const World& world, const std::string& name, std::vector<std::string> arguments) {
  static int count = 0;
  log_ = world.folder() / (name + "-" + std::to_string(++count) + ".log");
  arguments.insert(arguments.begin(), name);
  pid_ = value_of(owners::spawn({std::move(arguments), {own_folder()}, log_}));
}

Child::~Child() { terminate(); }

void Child::terminate() {
  if (pid_ == 0) return;
  kill(pid_, SIGTERM);
  waitpid(pid_, nullptr, 0);
  pid_ = 0;
}

Child::Ended Child::wait() {
  int status = 0;
  rusage used{};
  wait4(std::exchange(pid_, 0), &status, 0, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1,
          seconds(used.ru_utime) + seconds(used.ru_stime)};
}

std::string Child::output() const { return read(log_); }

double cpu_percent(int pid, std::chrono::seconds length) {
  const double before = usage_of(pid).cpu_seconds;
  const auto begin = std::chrono::steady_clock::now();
  std::this_thread::sleep_for(length);
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
  if (usage_of(pid).resident_mib == 0) return std::nan("");
  return 100 * (usage_of(pid).cpu_seconds - before) / passed.count();
}

Side::Side(const World& world) {
  context_ = value_of(ros2::Context::create(executor_, world.participant()));
  thread_ = std::thread([this] { executor_.run(); });
}

Side::~Side() {
  executor_.stop();
  thread_.join();
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

}  // namespace culprit::bench
