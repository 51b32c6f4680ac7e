#include "owners/test_engine.h"

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <poll.h>
#include <sstream>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "json/json.h"
#include "owners/proc.h"

namespace culprit::owners {
namespace {

std::string http(int status, const std::string& body) {
  return "HTTP/1.0 " + std::to_string(status) +
         " X\r\nContent-Type: application/json\r\nApi-Version: 1.41\r\n\r\n" + body;
}

double number_after(const std::string& target, const std::string& name) {
  return std::strtod(target.substr(target.find(name) + name.size()).c_str(), nullptr);
}

std::string events_between(const std::string& events, const std::string& target) {
  std::istringstream lines(events);
  std::string some;
  for (std::string line; std::getline(lines, line);) {
    const Json event = parse_json(line);
    const double at = event.is_object() ? event["time"].get<double>() : 0;
    const bool is_asked_for =
        number_after(target, "since=") <= at && at <= number_after(target, "until=");
    if (at == 0 || is_asked_for) some += line + "\n";
  }
  return some;
}

std::string no_such(const std::string& name) {
  return http(404, R"({"message":"No such container: )" + name + "\"}\n");
}

}  // namespace

std::string event_of(const std::string& action, const std::string& signal, std::int64_t at) {
  Json attributes = {{"name", "slam"}};
  if (!signal.empty()) attributes["signal"] = signal;
  return to_line({{"status", action},
                  {"Type", "container"},
                  {"Action", action},
                  {"time", at},
                  {"Actor", {{"ID", std::string(64, 'c')}, {"Attributes", attributes}}}}) +
         "\n";
}

TestEngine::TestEngine() : listens_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, socket().c_str(), sizeof address.sun_path - 1);
  if (bind(listens_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      listen(listens_.get(), 16) != 0)
    std::abort();
  setenv("DOCKER_HOST", ("unix://" + socket()).c_str(), 1);
  thread_ = std::thread([this] { serve(); });
}

TestEngine::~TestEngine() {
  {
    const MutexLock lock(mutex_);
    is_ending_ = true;
  }
  thread_.join();
  for (auto& [name, container] : containers_) end(container);
  unsetenv("DOCKER_HOST");
}

void TestEngine::add(const std::string& name, TestContainer container) {
  const MutexLock lock(mutex_);
  TestContainer& place = containers_[name];
  end(place);
  place = std::move(container);
}

int TestEngine::start(const std::string& name) {
  const MutexLock lock(mutex_);
  TestContainer& container = containers_[name];
  notice(container);  // its policy may be quicker, and must not start two
  if (container.pid == 0) run(container);
  return container.pid;
}

int TestEngine::pid_of(const std::string& name) {
  const MutexLock lock(mutex_);
  return containers_[name].pid;
}

std::vector<std::string> TestEngine::asked() {
  const MutexLock lock(mutex_);
  return asked_;
}

void TestEngine::say(const std::string& answer) {
  const MutexLock lock(mutex_);
  answer_ = answer;
}

void TestEngine::hang(bool hangs) {
  const MutexLock lock(mutex_);
  hangs_ = hangs;
}

void TestEngine::withhold_events(bool withholds) {
  const MutexLock lock(mutex_);
  withholds_events_ = withholds;
}

void TestEngine::run(TestContainer& container) {
  if (container.is_broken) {
    container.status = "exited";
    container.code = 1;
    return;
  }
  const int pid = fork();
  if (pid == 0) {
    if (!container.heeds_signals) signal(SIGTERM, SIG_IGN);
    std::vector<char*> arguments;
    for (std::string& each : container.command) arguments.push_back(each.data());
    arguments.push_back(nullptr);
    execvp(arguments[0], arguments.data());
    _exit(127);
  }
  container.pid = pid;
  container.status = "running";
}

void TestEngine::end(TestContainer& container) {
  if (container.pid == 0) return;
  kill(container.pid, SIGKILL);
  waitpid(container.pid, nullptr, 0);
  container.pid = 0;
  container.code = 137;
  container.status = "exited";
}

// Starts a container again that ended by itself, if its policy says so.
void TestEngine::notice(TestContainer& container) {
  if (container.pid == 0 || state_letter(container.pid).value_or('Z') != 'Z') return;
  end(container);
  if (container.policy != "no") run(container);
}

void TestEngine::serve() {
  while (true) {
    pollfd file{listens_.get(), POLLIN, 0};
    const bool has_come = poll(&file, 1, 20) > 0;
    const MutexLock lock(mutex_);
    if (is_ending_) return;
    for (auto& [name, container] : containers_) notice(container);
    if (!has_come || hangs_) continue;
    // Not for what it starts to hold open: the answer ends with the connection.
    FileDescriptor peer(accept4(listens_.get(), nullptr, nullptr, SOCK_CLOEXEC));
    std::string request;
    char part[4096];
    while (request.find("\r\n\r\n") == std::string::npos) {
      const ssize_t size = recv(peer.get(), part, sizeof part, 0);
      if (size <= 0) break;
      request.append(part, static_cast<std::size_t>(size));
    }
    const std::size_t first = request.find(' ');
    const std::size_t second = request.find(' ', first + 1);
    if (second == std::string::npos) continue;
    const std::string answer =
        answer_to(request.substr(0, first), request.substr(first + 1, second - first - 1));
    if (answer.empty()) {
      unanswered_.push_back(std::move(peer));
      continue;
    }
    (void)!::send(peer.get(), answer.data(), answer.size(), MSG_NOSIGNAL);
  }
}

std::string TestEngine::look_at(const std::string& name) {
  const TestContainer& container = containers_.at(name);
  const Json document = {
      {"Id", std::string(64, 'c')},
      {"Name", "/" + name},
      {"RestartCount", 0},
      {"State",
       {{"Status", container.status},
        {"Running", container.status == "running"},
        {"Paused", container.status == "paused"},
        {"Restarting", false},
        {"OOMKilled", false},
        {"Dead", false},
        {"Pid", container.pid},
        {"ExitCode", container.code},
        {"FinishedAt", container.finished_at},
        {"Error", ""}}},
      {"HostConfig", {{"RestartPolicy", {{"Name", container.policy}, {"MaximumRetryCount", 0}}}}}};
  return http(200, to_line(document));
}

std::string TestEngine::answer_to(const std::string& method, const std::string& target) {
  if (!answer_.empty()) return answer_;
  if (withholds_events_ && target.starts_with("/events?")) return "";
  if (target.starts_with("/events?") &&
      target.find("%22event%22:%5B%22kill%22,%22start%22,%22stop%22%5D") != target.npos) {
    for (const auto& [name, container] : containers_) {
      const bool is_asked_for =
          target.find("%22container%22:%5B%22" + name + "%22%5D") != target.npos;
      if (is_asked_for) return http(200, events_between(container.events, target));
    }
    return http(200, "");
  }
  constexpr std::string_view kContainers = "/containers/";
  if (!target.starts_with(kContainers)) return http(404, R"({"message":"page not found"})");
  if (target == "/containers/json?all=1") {
    Json all = Json::array();
    for (const auto& [name, container] : containers_)
      all.push_back({{"Id", std::string(64, 'c')}, {"Names", {"/" + name}}});
    return http(200, to_line(all));
  }
  const std::size_t slash = target.find('/', kContainers.size());
  const std::string name = target.substr(kContainers.size(), slash - kContainers.size());
  if (!containers_.contains(name)) return no_such(name);
  TestContainer& container = containers_[name];
  std::string what = slash == std::string::npos ? "" : target.substr(slash + 1);
  if (method == "GET" && what == "json") {
    ++looks_;
    return look_at(name);
  }
  what = what.substr(0, what.find('?'));
  asked_.push_back(what + " " + name);
  if (what == "start" && container.pid != 0) return http(304, "");
  if (what == "stop" && container.pid == 0) return http(304, "");
  if (what == "kill" && container.pid == 0)
    return http(409, R"({"message":"Container is not running"})");
  if (what != "start") end(container);
  if (what == "start" || what == "restart") run(container);
  return http(204, "");
}

}  // namespace culprit::owners
