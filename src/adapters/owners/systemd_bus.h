// systemd, over D-Bus: reads the state of its services, and starts and ends them
// (org.freedesktop.systemd1(5)). The systemd of another computer is asked through its own
// systemd-stdio-bridge(1), over ssh.
//
// Every call has a time limit, and blocks its thread for so long at most. Its answers are not
// trusted: one that is not of the type that systemd documents is an error. The connection is made
// by the first call, and again by the next one after it was lost.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/expected.h"
#include "base/time.h"
#include "language/rule_set.h"
#include "owners/remote_program.h"
#include "owners/service_owner.h"

struct sd_bus;
struct sd_bus_message;

namespace culprit::owners {

struct BusError;

class SystemdBus : public ServiceOwner {
 public:
  enum class Whose : std::uint8_t { kSystem, kUser };
  static constexpr Duration kPatience = std::chrono::seconds(2);

  // `host`: the computer, as ssh takes it; empty: this one.
  explicit SystemdBus(Whose whose, std::string host = {}) : whose_(whose), host_(std::move(host)) {}

  // Errors give the fault and the remedy. Where systemd refused, nothing was done.
  Expected<UnitState> state_of(const std::string& unit) override;
  Expected<void> start(const std::string& unit) override { return ask("StartUnit", unit); }
  Expected<void> stop(const std::string& unit, Duration) override { return ask("StopUnit", unit); }
  Expected<void> restart(const std::string& unit, Duration) override {
    return ask("RestartUnit", unit);
  }
  // SIGKILL to all processes of the unit.
  Expected<void> kill(const std::string& unit) override;

  // Whether the process is of that unit.
  Expected<bool> runs(const std::string& unit, int pid) override;
  // The services that systemd has loaded, or could load.
  Expected<std::vector<std::string>> services() override;
  // Whether culprit has the right to start and to end it. Errors: it has not.
  Expected<void> may_manage(const std::string& unit) override;

  bool was_reached() const override { return bus_ != nullptr; }

  std::string name() const override;
  std::string where_to_look(const std::string& unit) const override;
  std::string what_lists_all() const override;

 private:
  struct Closing {
    void operator()(sd_bus* bus) const;
  };
  struct Message {
    Message() = default;
    Message(const Message&) = delete;
    Message& operator=(const Message&) = delete;
    ~Message();
    sd_bus_message* it = nullptr;
  };

  Expected<void> connect();
  Expected<void> open();
  Expected<void> ask(const char* method, const std::string& unit);
  Error failed(const std::string& what, int error, const BusError& why);
  template <class... Values>
  Expected<void> call(const std::string& what, Message& reply, const char* method,
                      const char* types, Values... values);
  Expected<std::string> path_of(const std::string& unit);
  Expected<std::string> text(const std::string& path, const char* interface, const char* name);
  Expected<int> process(const std::string& path, const char* name);
  // In microseconds: a duration, or when it happened last by the monotonic clock; 0: never. An older systemd may not know
  // the property.
  enum class Unknown : std::uint8_t { kIsError, kIsNever };
  Expected<std::uint64_t> time_of(const std::string& path, const char* interface, const char* name,
                                  Unknown unknown = Unknown::kIsError);
  Expected<bool> has_job(const std::string& path);
  Expected<bool> was_told_to_stop(const std::string& path, const std::string& result);
  Expected<bool> was_kept_from_a_restart(const std::string& path);
  Expected<bool> has_run_out(const std::string& path, std::uint64_t left);

  std::string remedy() const;

  Whose whose_;
  std::string host_;
  std::optional<RemoteProgram> remote_;  // that the bus is reached through; nothing: it is here
  std::unique_ptr<sd_bus, Closing> bus_;
};

}  // namespace culprit::owners
