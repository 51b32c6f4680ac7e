#include "owners/systemd_bus.h"

#include <cerrno>
#include <climits>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <set>

#include <systemd/sd-bus.h>

#include "base/live_clock.h"

namespace culprit::owners {

struct BusError {
  sd_bus_error it{};
  BusError() = default;
  BusError(const BusError&) = delete;
  BusError& operator=(const BusError&) = delete;
  ~BusError() { sd_bus_error_free(&it); }
};

namespace {

constexpr const char* kService = "org.freedesktop.systemd1";
constexpr const char* kManagerPath = "/org/freedesktop/systemd1";
constexpr const char* kManager = "org.freedesktop.systemd1.Manager";
constexpr const char* kUnit = "org.freedesktop.systemd1.Unit";
constexpr const char* kServiceUnit = "org.freedesktop.systemd1.Service";

// Text that others wrote is untrusted: it is cut to one line of a readable length.
std::string shown(const char* text) {
  constexpr std::size_t kLongest = 200;
  std::string line(text == nullptr ? "" : text, 0, kLongest);
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < ' ' || c == 0x7f) c = '?';
  }
  return line;
}

std::uint64_t microseconds(Duration duration) {
  const auto whole = std::chrono::duration_cast<std::chrono::microseconds>(duration).count();
  return whole < 0 ? 0 : static_cast<std::uint64_t>(whole);
}

bool is_denied(const BusError& error) {
  return sd_bus_error_has_name(&error.it, SD_BUS_ERROR_ACCESS_DENIED) > 0 ||
         sd_bus_error_has_name(&error.it, SD_BUS_ERROR_INTERACTIVE_AUTHORIZATION_REQUIRED) > 0;
}

// Not of the bus, or of the way to it.
bool is_of_systemd(const BusError& error) {
  if (error.it.name == nullptr || error.it.message == nullptr) return false;
  const std::string_view name = error.it.name;
  return !name.starts_with("System.Error.") && name != SD_BUS_ERROR_NO_REPLY &&
         name != SD_BUS_ERROR_TIMEOUT && name != SD_BUS_ERROR_DISCONNECTED &&
         name != SD_BUS_ERROR_SERVICE_UNKNOWN && name != SD_BUS_ERROR_NAME_HAS_NO_OWNER;
}

std::optional<UnitState::Activity> activity_of(const std::string& text) {
  using enum UnitState::Activity;
  if (text == "active" || text == "reloading" || text == "refreshing" || text == "maintenance")
    return kActive;
  if (text == "activating") return kActivating;
  if (text == "deactivating") return kDeactivating;
  if (text == "inactive") return kInactive;
  if (text == "failed") return kFailed;
  return std::nullopt;
}

// systemd stops a unit by itself, too: for its watchdog, or where memory ran out.
bool may_answer_a_stop(const std::string& result) {
  return result == "exit-code" || result == "signal" || result == "core-dump" ||
         result == "timeout";
}

constexpr const char* kMayNot = "culprit may not: ";

}  // namespace

std::string SystemdBus::name() const {
  return std::string(whose_ == Whose::kUser ? "the user's systemd" : "systemd") +
         (host_.empty() ? "" : " on " + host_);
}

std::string SystemdBus::where_to_look(const std::string& unit) const {
  return (host_.empty() ? "" : "ssh " + host_ + " ") + "journalctl " +
         (whose_ == Whose::kUser ? "--user -u " : "-u ") + unit;
}

std::string SystemdBus::what_lists_all() const {
  return (host_.empty() ? "" : "ssh " + host_ + " ") + "systemctl list-unit-files";
}

std::string SystemdBus::remedy() const {
  const std::string whom = host_.empty() ? "its user" : "the user of " + host_;
  return "; give " + whom +
         " the right (docs/security.md), or run the unit in that user's own systemd (UNIT ... "
         "USER)";
}

void SystemdBus::Closing::operator()(sd_bus* bus) const { sd_bus_close_unref(bus); }

SystemdBus::Message::~Message() { sd_bus_message_unref(it); }

Expected<void> SystemdBus::open() {
  const bool is_of_user = whose_ == Whose::kUser;
  sd_bus* bus = nullptr;
  int opened = 0;
  if (host_.empty()) {
    opened = is_of_user ? sd_bus_open_user(&bus) : sd_bus_open_system(&bus);
    bus_.reset(bus);
  } else {
    std::vector<std::string> bridge{"systemd-stdio-bridge"};
    // Its --user is not heeded everywhere (systemd 252), and the shell there knows the folder.
    if (is_of_user) bridge.push_back("-punix:path=$XDG_RUNTIME_DIR/bus");
    auto remote = RemoteProgram::begin(host_, std::move(bridge));
    if (!remote) return Error{remote.error()};
    remote_ = std::move(*remote);
    opened = sd_bus_new(&bus);
    bus_.reset(bus);
    const int way = fcntl(remote_->socket(), F_DUPFD_CLOEXEC, 0);  // the bus closes it
    if (opened >= 0) opened = way < 0 ? -errno : sd_bus_set_fd(bus, way, way);
    if (opened >= 0) opened = sd_bus_set_bus_client(bus, 1);
    if (opened >= 0) opened = sd_bus_start(bus);
  }
  return opened < 0 ? Expected<void>(failed("it cannot be reached", opened, BusError()))
                    : Expected<void>();
}

Expected<void> SystemdBus::connect() {
  if (bus_ && sd_bus_is_open(bus_.get()) > 0) return {};
  bus_.reset();
  remote_.reset();
  if (auto opened = open(); !opened) return opened;
  sd_bus* bus = bus_.get();
  sd_bus_set_method_call_timeout(bus, microseconds(kPatience));
  // A call would wait for the connection without its limit.
  const Time end = later(live_now(), remote_ ? RemoteProgram::kPatience : kPatience);
  while (sd_bus_is_ready(bus) <= 0) {
    const int progress = sd_bus_process(bus, nullptr);
    if (progress < 0) return failed("it cannot be reached", progress, BusError());
    if (live_now() >= end) return failed("it cannot be reached", -ETIMEDOUT, BusError());
    if (progress == 0) sd_bus_wait(bus, microseconds(end - live_now()));
  }
  return {};
}

Error SystemdBus::failed(const std::string& what, int error, const BusError& why) {
  const std::string text = name() + ": " + what + ": ";
  if (is_denied(why)) return Error{text + kMayNot + shown(why.it.message) + remedy()};
  if (is_of_systemd(why)) return Error{text + shown(why.it.message)};
  // The connection may be at fault, or what comes over it: the next call makes another one.
  bus_.reset();
  if (remote_) {
    const std::string trouble = remote_->trouble();
    remote_.reset();
    return Error{trouble};
  }
  const std::string address = whose_ == Whose::kUser
                                  ? "DBUS_SESSION_BUS_ADDRESS or XDG_RUNTIME_DIR of culprit"
                                  : "/run/dbus/system_bus_socket";
  return Error{text + std::strerror(-error) + "; is it running, and is " + address + " its bus?"};
}

template <class... Values>
Expected<void> SystemdBus::call(const std::string& what, Message& reply, const char* method,
                                const char* types, Values... values) {
  if (auto connected = connect(); !connected) return connected;
  BusError error;
  const int called = sd_bus_call_method(bus_.get(), kService, kManagerPath, kManager, method,
                                        &error.it, &reply.it, types, values...);
  if (called < 0) return failed(what, called, error);
  return {};
}

Expected<void> SystemdBus::ask(const char* method, const std::string& unit) {
  Message job;
  return call(std::string(method) + " " + unit, job, method, "ss", unit.c_str(), "replace");
}

Expected<void> SystemdBus::kill(const std::string& unit) {
  Message nothing;
  return call("KillUnit " + unit, nothing, "KillUnit", "ssi", unit.c_str(), "all", SIGKILL);
}

Expected<std::string> SystemdBus::path_of(const std::string& unit) {
  Message reply;
  if (auto loaded = call("LoadUnit " + unit, reply, "LoadUnit", "s", unit.c_str()); !loaded)
    return Error{loaded.error()};
  const char* path = nullptr;
  if (const int read = sd_bus_message_read(reply.it, "o", &path); read < 0)
    return failed("LoadUnit " + unit, read, BusError());
  return std::string(path);
}

Expected<std::string> SystemdBus::text(const std::string& path, const char* interface,
                                       const char* name) {
  if (auto connected = connect(); !connected) return Error{connected.error()};
  BusError error;
  char* value = nullptr;
  const int got = sd_bus_get_property_string(bus_.get(), kService, path.c_str(), interface, name,
                                             &error.it, &value);
  if (got < 0) return failed(name, got, error);
  const std::unique_ptr<char, decltype(&std::free)> owned(value, std::free);
  return shown(value);
}

Expected<int> SystemdBus::process(const std::string& path, const char* name) {
  if (auto connected = connect(); !connected) return Error{connected.error()};
  BusError error;
  std::uint32_t pid = 0;
  const int got = sd_bus_get_property_trivial(bus_.get(), kService, path.c_str(), kServiceUnit,
                                              name, &error.it, 'u', &pid);
  if (got < 0) return failed(name, got, error);
  if (pid > INT_MAX) return failed(name, -ERANGE, BusError());
  return static_cast<int>(pid);
}

Expected<std::uint64_t> SystemdBus::time_of(const std::string& path, const char* interface,
                                            const char* name, Unknown unknown) {
  if (auto connected = connect(); !connected) return Error{connected.error()};
  BusError error;
  std::uint64_t at = 0;
  const int got = sd_bus_get_property_trivial(bus_.get(), kService, path.c_str(), interface, name,
                                              &error.it, 't', &at);
  if (unknown == Unknown::kIsNever &&
      sd_bus_error_has_name(&error.it, SD_BUS_ERROR_UNKNOWN_PROPERTY) > 0)
    return std::uint64_t{0};
  if (got < 0) return failed(name, got, error);
  return at;
}

// A unit that is told to stop is not active any more when its main process ends. By itself, that ends first.
Expected<bool> SystemdBus::was_told_to_stop(const std::string& path, const std::string& result) {
  const auto began = time_of(path, kServiceUnit, "ExecMainStartTimestampMonotonic");
  if (!began) return Error{began.error()};
  const auto left = time_of(path, kUnit, "ActiveExitTimestampMonotonic");
  if (!left) return Error{left.error()};
  const auto ended = time_of(path, kServiceUnit, "ExecMainExitTimestampMonotonic");
  if (!ended) return Error{ended.error()};
  const bool was_stopped = *began <= *left && *left < *ended;
  if (!was_stopped || result != "timeout") return was_stopped;
  const auto is_own = has_run_out(path, *left);
  if (!is_own) return Error{is_own.error()};
  return !*is_own;
}

// Whether it left once it had been active for RuntimeMaxSec=: systemd stops it then, nobody told it to.
Expected<bool> SystemdBus::has_run_out(const std::string& path, std::uint64_t left) {
  const auto limit = time_of(path, kServiceUnit, "RuntimeMaxUSec");
  if (!limit) return Error{limit.error()};
  const auto entered = time_of(path, kUnit, "ActiveEnterTimestampMonotonic");
  if (!entered) return Error{entered.error()};
  return *entered <= left && left - *entered >= *limit;
}

// A unit that has failed is to be started again after RestartSec= (Restart=). Told to stop before, it is inactive, and its
// Result stays. Later it may be inactive because that start could not happen (ConditionPathExists=).
// RestartSteps= (systemd 254) lengthens the delay with each start. A start that could not happen is counted: the next
// delay may not be over then, but systemd has checked the conditions.
Expected<bool> SystemdBus::was_kept_from_a_restart(const std::string& path) {
  const auto ended = time_of(path, kServiceUnit, "ExecMainExitTimestampMonotonic");
  if (!ended) return Error{ended.error()};
  const auto rests = time_of(path, kUnit, "InactiveEnterTimestampMonotonic");
  if (!rests) return Error{rests.error()};
  const auto delay = time_of(path, kServiceUnit, "RestartUSec");
  if (!delay) return Error{delay.error()};
  if (*ended > *rests) return false;
  const std::uint64_t waited = *rests - *ended;
  if (waited < *delay) return true;
  const auto next = time_of(path, kServiceUnit, "RestartUSecNext", Unknown::kIsNever);
  if (!next) return Error{next.error()};
  const auto tried = time_of(path, kUnit, "ConditionTimestampMonotonic");
  if (!tried) return Error{tried.error()};
  return waited < *next && *tried <= *ended;
}

Expected<bool> SystemdBus::has_job(const std::string& path) {
  if (auto connected = connect(); !connected) return Error{connected.error()};
  BusError error;
  Message reply;
  std::uint32_t id = 0;
  const int got = sd_bus_get_property(bus_.get(), kService, path.c_str(), kUnit, "Job", &error.it,
                                      &reply.it, "(uo)");
  if (got < 0) return failed("Job", got, error);
  if (const int read = sd_bus_message_read(reply.it, "(uo)", &id, nullptr); read < 0)
    return failed("Job", read, BusError());
  return id != 0;
}

Expected<UnitState> SystemdBus::state_of(const std::string& unit) {
  const auto path = path_of(unit);
  if (!path) return Error{path.error()};
  UnitState state;
  auto load_state = text(*path, kUnit, "LoadState");
  if (!load_state) return Error{load_state.error()};
  state.load_state = std::move(*load_state);
  state.is_loaded = state.load_state == "loaded";
  if (!state.is_loaded) return state;
  const auto active = text(*path, kUnit, "ActiveState");
  if (!active) return Error{active.error()};
  const auto activity = activity_of(*active);
  if (!activity) return Error{"systemd says that " + unit + " is '" + *active + "'"};
  state.activity = *activity;
  const auto job = has_job(*path);
  if (!job) return Error{job.error()};
  state.has_job = *job;
  const auto main = process(*path, "MainPID");
  if (!main) return Error{main.error()};
  state.main_pid = *main;
  const auto last = process(*path, "ExecMainPID");
  if (!last) return Error{last.error()};
  state.last_main_pid = *last;
  auto result = text(*path, kServiceUnit, "Result");
  if (!result) return Error{result.error()};
  state.result = std::move(*result);
  state.is_orderly = state.activity == UnitState::Activity::kInactive && state.result == "success";
  if (state.activity == UnitState::Activity::kFailed && may_answer_a_stop(state.result)) {
    const auto told = was_told_to_stop(*path, state.result);
    if (!told) return Error{told.error()};
    state.is_orderly = *told;
  } else if (state.activity == UnitState::Activity::kInactive && !state.is_orderly) {
    const auto told = was_kept_from_a_restart(*path);
    if (!told) return Error{told.error()};
    state.is_orderly = *told;
  }
  return state;
}

Expected<bool> SystemdBus::runs(const std::string& unit, int pid) {
  const auto path = path_of(unit);
  if (!path) return Error{path.error()};
  if (auto connected = connect(); !connected) return Error{connected.error()};
  BusError error;
  Message reply;
  const int called =
      sd_bus_call_method(bus_.get(), kService, kManagerPath, kManager, "GetUnitByPID", &error.it,
                         &reply.it, "u", static_cast<std::uint32_t>(pid));
  const bool is_of_none =
      sd_bus_error_has_name(&error.it, "org.freedesktop.systemd1.NoUnitForPID") > 0;
  if (is_of_none) return false;
  if (called < 0) return failed("GetUnitByPID", called, error);
  const char* other = nullptr;
  if (const int read = sd_bus_message_read(reply.it, "o", &other); read < 0)
    return failed("GetUnitByPID", read, BusError());
  return *path == other;
}

Expected<std::vector<std::string>> SystemdBus::services() {
  std::set<std::string> names;
  Message files;
  if (auto listed = call("ListUnitFiles", files, "ListUnitFiles", ""); !listed)
    return Error{listed.error()};
  if (const int read = sd_bus_message_enter_container(files.it, 'a', "(ss)"); read < 0)
    return failed("ListUnitFiles", read, BusError());
  const char* path = nullptr;
  int read = 0;
  while ((read = sd_bus_message_read(files.it, "(ss)", &path, nullptr)) > 0) {
    const std::string_view file(path);
    const std::string_view name = file.substr(file.rfind('/') + 1);
    if (name.ends_with(".service")) names.emplace(name);
  }
  if (read < 0) return failed("ListUnitFiles", read, BusError());
  return std::vector<std::string>(names.begin(), names.end());
}

// Setting no property changes nothing, and takes the right that starting and ending take.
Expected<void> SystemdBus::may_manage(const std::string& unit) {
  Message nothing;
  auto may = call("SetUnitProperties " + unit, nothing, "SetUnitProperties", "sba(sv)",
                  unit.c_str(), 1, 0);
  if (may || may.error().find(kMayNot) == std::string::npos) return may;
  return Error{
      may.error() +
      ". A rule of polkit that names verbs has to allow start, stop, restart and kill, and "
      "set-property for this look, which sets nothing"};
}

}  // namespace culprit::owners
