#include "owners/engine.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <optional>
#include <poll.h>
#include <sstream>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/environment.h"
#include "base/live_clock.h"
#include "json/json.h"
#include "owners/file_descriptor.h"
#include "owners/proc.h"
#include "owners/remote_program.h"

namespace culprit::owners {
namespace {

using Activity = UnitState::Activity;

constexpr const char* kNoAnswer = ": it does not answer";
constexpr std::size_t kLongestAnswer = 4 << 20;  // bytes: a list of a thousand containers

// Where the engine listens: from the same place as its own tools, or where its packages put it.
// Errors: the engine is set to be on another machine.
Expected<std::string> socket_of(EngineContainer::Engine engine) {
  const bool is_docker = engine == EngineContainer::Engine::kDocker;
  const char* name = is_docker ? "DOCKER_HOST" : "CONTAINER_HOST";
  constexpr std::string_view kUnix = "unix://";
  const std::string told = environment(name);
  if (told.starts_with(kUnix)) return told.substr(kUnix.size());
  if (!told.empty())
    return Error{std::string(name) + " is " + told + ", and culprit uses a socket of this machine"};
  if (is_docker) return std::string("/var/run/docker.sock");
  const std::string own = environment("XDG_RUNTIME_DIR");
  if (geteuid() == 0 || own.empty()) return std::string("/run/podman/podman.sock");
  return own + "/podman/podman.sock";
}

bool wait_for(int descriptor, short what, Time end) {
  pollfd file{descriptor, what, 0};
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - live_now()).count();
    if (left <= 0) return false;
    const int ready = poll(&file, 1, static_cast<int>(left));
    if (ready > 0) return true;
    if (ready == 0 || errno != EINTR) return false;
  }
}

// Text that others wrote is untrusted: it is cut to one line of a readable length.
std::string one_line(std::string text) {
  constexpr std::size_t kLongest = 200;
  text.resize(std::min(text.size(), kLongest));
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < ' ' || c == 0x7f) c = '?';
  }
  return text;
}

std::string message_of(const std::string& body) {
  const Json document = parse_json(body);
  if (document.is_object() && document.contains("message") && document["message"].is_string())
    return one_line(document["message"].get<std::string>());
  return one_line(body);
}

template <class T>
std::optional<T> member(const Json& object, const char* name) {
  if (!object.is_object() || !object.contains(name)) return std::nullopt;
  const Json& value = object[name];
  if constexpr (std::is_same_v<T, bool>) {
    if (!value.is_boolean()) return std::nullopt;
  } else if constexpr (std::is_same_v<T, std::string>) {
    if (!value.is_string()) return std::nullopt;
  } else {
    if (!value.is_number_integer()) return std::nullopt;
  }
  return value.get<T>();
}

// RFC 3339, with fractions or without: in whole seconds since 1970.
std::optional<std::int64_t> seconds_of(const std::string& text) {
  std::tm day{};
  const char* rest = strptime(text.c_str(), "%Y-%m-%dT%H:%M:%S", &day);
  if (rest == nullptr) return std::nullopt;
  if (*rest == '.') rest += 1 + std::strspn(rest + 1, "0123456789");
  std::tm zone{};
  const char* end = strptime(rest, "%z", &zone);
  if (end == nullptr || *end != '\0') return std::nullopt;
  return timegm(&day) - zone.tm_gmtoff;
}

// Whether the event is about such a signal. A stop sends that of the image (STOPSIGNAL) before it kills.
bool asks_to_end(const Json& event) {
  const Json& actor = event.contains("Actor") ? event["Actor"] : event;
  if (!actor.is_object() || !actor.contains("Attributes")) return false;
  const auto signal = member<std::string>(actor["Attributes"], "signal");
  return signal == std::to_string(SIGTERM) || signal == std::to_string(SIGINT) ||
         signal == std::to_string(SIGQUIT);
}

}  // namespace

class Engine::Connection {
 public:
  explicit Connection(const Engine& engine) : engine_(engine) {}

  Expected<void> open() { return engine_.host_.empty() ? open_here() : open_there(); }
  // The additional time that an engine on another computer may take.
  Duration extra() const { return remote_ ? RemoteProgram::kPatience : Duration::zero(); }

  Expected<void> send(const std::string& request, Time end) {
    for (std::size_t sent = 0; sent < request.size();) {
      const ssize_t part =
          ::send(way(), request.data() + sent, request.size() - sent, MSG_NOSIGNAL);
      if (part > 0) {
        sent += static_cast<std::size_t>(part);
      } else if (errno != EAGAIN && errno != EINTR) {
        return failed(errno);
      } else if (!wait_for(way(), POLLOUT, end)) {
        return failed(ETIMEDOUT);
      }
    }
    return {};
  }

  // All that comes until the other side ends it; nothing if that is not in time.
  Expected<std::optional<std::string>> receive(Time end) {
    std::string text;
    while (true) {
      if (!wait_for(way(), POLLIN, end)) return std::optional<std::string>();
      char part[1 << 14];
      const ssize_t size = recv(way(), part, sizeof part, 0);
      if (size < 0 && (errno == EAGAIN || errno == EINTR)) continue;
      if (size < 0 || (size == 0 && text.empty() && remote_)) return failed(errno);
      if (size == 0 || text.size() > kLongestAnswer) return std::optional(std::move(text));
      text.append(part, static_cast<std::size_t>(size));
    }
  }

  Error failed(int error) {
    if (remote_) return Error{remote_->trouble()};
    if (error == EACCES || error == EPERM)
      return Error{engine_.name() + ": culprit may not use " + path_ +
                   "; give its user the right (docs/security.md)"};
    return Error{engine_.name() + ": it cannot be reached at " + path_ + ": " +
                 std::strerror(error) + "; is it running?"};
  }

 private:
  int way() const { return remote_ ? remote_->socket() : socket_.get(); }

  Expected<void> open_here() {
    auto path = socket_of(engine_.which_);
    if (!path) return Error{engine_.name() + ": " + path.error()};
    path_ = std::move(*path);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path_.size() >= sizeof address.sun_path) return failed(ENAMETOOLONG);
    std::memcpy(address.sun_path, path_.c_str(), path_.size());
    socket_ = FileDescriptor(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    if (!socket_) return failed(errno);
    if (connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
      return failed(errno);
    return {};
  }

  Expected<void> open_there() {
    auto remote = RemoteProgram::begin(engine_.host_, {engine_.program(), "system", "dial-stdio"});
    if (!remote) return Error{remote.error()};
    remote_ = std::move(*remote);
    return {};
  }

  const Engine& engine_;
  std::string path_;
  FileDescriptor socket_;
  std::optional<RemoteProgram> remote_;
};

std::string Engine::program() const {
  return which_ == EngineContainer::Engine::kDocker ? "docker" : "podman";
}

std::string Engine::name() const { return program() + (host_.empty() ? "" : " on " + host_); }

std::string Engine::where_to_look(const std::string& container) const {
  return (host_.empty() ? "" : "ssh " + host_ + " ") + program() + " logs " + container;
}

std::string Engine::what_lists_all() const {
  return (host_.empty() ? "" : "ssh " + host_ + " ") + program() + " ps -a";
}

Error Engine::no_form(const std::string& what) const {
  return Error{name() + ": what it answers to " + what + " is not of the engine's API"};
}

// HTTP/1.0: one request on a connection, and the answer ends with it.
Expected<Engine::Answer> Engine::ask(const std::string& method, const std::string& target,
                                     Duration patience) {
  was_reached_ = false;
  Connection connection(*this);
  if (auto opened = connection.open(); !opened) return Error{opened.error()};
  const Time end = later(live_now(), patience + connection.extra());
  const std::string request =
      method + " " + target + " HTTP/1.0\r\nHost: engine\r\nContent-Length: 0\r\n\r\n";
  if (auto sent = connection.send(request, end); !sent) return Error{sent.error()};
  const auto received = connection.receive(end);
  if (!received) return Error{received.error()};
  if (!*received) return Answer{};
  const std::string& text = **received;
  was_reached_ = true;
  // "HTTP/1.0 200 OK"
  constexpr std::size_t kStatus = 9;
  const std::size_t body = text.find("\r\n\r\n");
  if (!text.starts_with("HTTP/1.") || text.size() < kStatus + 3 || body == std::string::npos ||
      text.size() > kLongestAnswer)
    return no_form(method + " " + target);
  return Answer{std::atoi(text.substr(kStatus, 3).c_str()), text.substr(body + 4)};
}

Expected<UnitState> Engine::state_of(const std::string& container) {
  const auto answer = ask("GET", "/containers/" + container + "/json", kPatience);
  if (!answer) return Error{answer.error()};
  UnitState state;
  if (answer->status == 0) return Error{name() + kNoAnswer};
  if (answer->status == 404) {
    state.load_state = "not-found";
    return state;
  }
  if (answer->status != 200) return Error{name() + ": " + message_of(answer->body)};
  const Json document = parse_json(answer->body);
  const std::string what = "a look at " + container;
  if (!document.is_object() || !document.contains("State")) return no_form(what);
  const Json& said = document["State"];
  const auto status = member<std::string>(said, "Status");
  const auto pid = member<std::int64_t>(said, "Pid");
  const auto code = member<std::int64_t>(said, "ExitCode");
  if (!status || !pid || !code || *pid < 0 || *pid > INT32_MAX) return no_form(what);
  state.is_loaded = true;
  state.load_state = "loaded";
  state.main_pid = static_cast<int>(*pid);
  if (*status == "paused")
    return Error{container + " is paused, and culprit does not resume it: " + program() +
                 " unpause " + container};
  if (*status == "running") {
    if (state.main_pid == 0) return no_form(what);
    state.activity = Activity::kActive;
    last_pids_[container] = state.main_pid;
    ends_.erase(container);
  } else if (*status == "restarting" || *status == "initialized") {
    state.activity = Activity::kActivating;
  } else if (*status == "removing" || *status == "stopping") {
    state.activity = Activity::kDeactivating;
  } else if (*status == "created" || *status == "configured" || *status == "exited" ||
             *status == "stopped" || *status == "dead") {
    constexpr std::int64_t kKilled = 137;
    constexpr std::array<std::int64_t, 3> kWanted = {0, 130, 143};
    const bool is_out_of_memory = member<bool>(said, "OOMKilled").value_or(false);
    const bool is_wanted = std::ranges::find(kWanted, *code) != kWanted.end();
    // A process may answer a stop with an error, and is killed after its grace.
    Expected<bool> was_told = is_wanted;
    if (!is_wanted && !is_out_of_memory)
      was_told = was_told_to_stop(container, member<std::string>(said, "FinishedAt").value_or(""));
    if (!was_told) return Error{was_told.error()};
    state.is_orderly = !is_out_of_memory && *was_told;
    const bool is_failed = !is_wanted && *code != kKilled;
    state.main_pid = 0;
    state.activity = is_out_of_memory || is_failed ? Activity::kFailed : Activity::kInactive;
    state.result = is_out_of_memory ? "out of memory" : "exit code " + std::to_string(*code);
  } else {
    return Error{name() + " says that " + container + " is '" + one_line(*status) +
                 "', which culprit does not know"};
  }
  const auto last = last_pids_.find(container);
  state.last_main_pid = last == last_pids_.end() ? 0 : last->second;
  return state;
}

// The engine keeps its last events: one for each signal that it sent, and one for a stop, once the container has ended. A
// start after them, as in a restart by culprit, begins anew. An `until` that is to come would have to be waited for. Where
// the clock was set back since it ended, or the date is none, the moment before now counts. An engine that answers all
// but this must not hide a crash for ever: then it counts as not told, until it says otherwise.
Expected<bool> Engine::was_told_to_stop(const std::string& container,
                                        const std::string& finished_at) {
  constexpr std::int64_t kMomentBefore = 30;  // seconds
  constexpr std::int64_t kMomentAfter = 5;
  constexpr std::int64_t kNanoseconds = 1'000'000'000;
  constexpr int kEnough = 3;
  End& known = ends_[container];
  if (known.finished_at != finished_at) known = {finished_at};
  if (known.was_told) return *known.was_told;
  const std::int64_t now = wall_now();
  const std::int64_t end = seconds_of(finished_at).value_or(0);
  const bool is_known = end >= kMomentBefore && end <= now / kNanoseconds;
  const std::int64_t since = (is_known ? end : now / kNanoseconds) - kMomentBefore;
  const std::int64_t until = is_known ? std::min(now, (end + kMomentAfter) * kNanoseconds) : now;
  std::string part = std::to_string(until % kNanoseconds);
  part.insert(0, 9 - part.size(), '0');
  const auto answer = ask("GET",
                          "/events?since=" + std::to_string(since) +
                              "&until=" + std::to_string(until / kNanoseconds) + "." + part +
                              "&filters=%7B%22container%22:%5B%22" + container +
                              "%22%5D,%22event%22:%5B%22kill%22,%22start%22,%22stop%22%5D%7D",
                          kPatience);
  if (!was_reached_ && ++known.unanswered >= kEnough) return false;
  if (!was_reached_) return Error{answer ? name() + kNoAnswer : answer.error()};
  known.unanswered = 0;
  std::istringstream events(answer && answer->status == 200 ? answer->body : "");
  bool is_told = false;
  for (std::string line; std::getline(events, line);) {
    const Json event = parse_json(line);
    const auto action = member<std::string>(event, "Action");
    is_told = action == "stop" || (action == "kill" && asks_to_end(event)) ||
              (is_told && action != "start");
  }
  // The event of its stop may still come.
  const bool is_complete = is_known && now / kNanoseconds >= end + kMomentAfter;
  if (is_told || is_complete) known.was_told = is_told;
  return is_told;
}

Expected<void> Engine::change(const std::string& container, const std::string& what,
                              Duration patience) {
  const auto answer = ask("POST", "/containers/" + container + "/" + what, patience);
  if (!answer) return Error{answer.error()};
  constexpr int kNotModified = 304;  // it is so already
  if (answer->status == 0 || answer->status / 100 == 2 || answer->status == kNotModified) return {};
  return Error{name() + ": " + message_of(answer->body)};
}

namespace {

std::string whole_seconds(Duration duration) {
  return std::to_string(std::chrono::floor<std::chrono::seconds>(duration).count());
}

}  // namespace

Expected<void> Engine::start(const std::string& container) {
  return change(container, "start", kPatience);
}

Expected<void> Engine::stop(const std::string& container, Duration polite) {
  return change(container, "stop?t=" + whole_seconds(polite), polite + kPatience);
}

Expected<void> Engine::restart(const std::string& container, Duration polite) {
  return change(container, "restart?t=" + whole_seconds(polite), polite + kPatience);
}

Expected<void> Engine::kill(const std::string& container) {
  return change(container, "kill?signal=SIGKILL", kPatience);
}

Expected<bool> Engine::runs(const std::string& container, int pid) {
  const auto answer = ask("GET", "/containers/" + container + "/json", kPatience);
  if (!answer) return Error{answer.error()};
  const Json document = parse_json(answer->body);
  const auto id = member<std::string>(document, "Id");
  if (!id || id->empty() || !document.contains("State")) return no_form("a look at " + container);
  if (container_of(pid) == *id) return true;
  const auto first = member<std::int64_t>(document["State"], "Pid").value_or(0);
  for (int each = pid; first > 1 && each > 1; each = parent_of(each).value_or(0)) {
    if (each == first) return true;
  }
  return false;
}

Expected<std::vector<std::string>> Engine::services() {
  const auto answer = ask("GET", "/containers/json?all=1", kPatience);
  if (!answer) return Error{answer.error()};
  const Json document = parse_json(answer->body);
  if (!document.is_array()) return no_form("the list of its containers");
  std::vector<std::string> names;
  for (const Json& each : document) {
    if (!each.is_object() || !each.contains("Names") || !each["Names"].is_array()) continue;
    for (const Json& name : each["Names"]) {
      if (!name.is_string()) continue;
      const std::string text = name.get<std::string>();
      names.push_back(text.starts_with('/') ? text.substr(1) : text);
    }
  }
  return names;
}

// A user who may use the socket may do everything.
Expected<void> Engine::may_manage(const std::string& container) {
  const auto state = state_of(container);
  return state ? Expected<void>() : Expected<void>(Error{state.error()});
}

}  // namespace culprit::owners
