// A container engine (docker, podman), asked over the REST API of its socket (Docker Engine API;
// podman speaks the same). The engine of another computer is asked through its own `docker system
// dial-stdio` or `podman system dial-stdio`, over ssh.
//
// Every call has a time limit, and blocks its thread for so long at most. Its answers are not
// trusted: one that has not the form of the API's documentation is an error. A user who may use the
// socket may do all that the engine can (docs/security.md).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "language/rule_set.h"
#include "owners/service_owner.h"

namespace culprit::owners {

class Engine : public ServiceOwner {
 public:
  static constexpr Duration kPatience = std::chrono::seconds(2);

  // `host`: the computer, as ssh takes it; empty: this one.
  explicit Engine(EngineContainer::Engine which, std::string host = {})
      : which_(which), host_(std::move(host)) {}

  Expected<UnitState> state_of(const std::string& container) override;
  Expected<void> start(const std::string& container) override;
  // The API has whole seconds: a shorter time becomes 0.
  Expected<void> stop(const std::string& container, Duration polite) override;
  Expected<void> restart(const std::string& container, Duration polite) override;
  Expected<void> kill(const std::string& container) override;
  // By its control group, as the kernel shows it; or it is the first process of the container, or
  // comes from that.
  Expected<bool> runs(const std::string& container, int pid) override;
  Expected<std::vector<std::string>> services() override;
  Expected<void> may_manage(const std::string& container) override;

  bool was_reached() const override { return was_reached_; }

  std::string name() const override;
  std::string where_to_look(const std::string& container) const override;
  std::string what_lists_all() const override;

 private:
  struct Answer {
    int status = 0;  // 0: none came in time
    std::string body;
  };
  // An open connection, and the words for its errors.
  class Connection;
  Expected<Answer> ask(const std::string& method, const std::string& target, Duration patience);
  // Asks for a change. A change that is not answered in time may happen all the same.
  Expected<void> change(const std::string& container, const std::string& what, Duration patience);
  // Whether it was told to stop (docker stop), and not killed, in the moment before it ended at that time (RFC 3339).
  Expected<bool> was_told_to_stop(const std::string& container, const std::string& finished_at);
  Error no_form(const std::string& what) const;

  // Its program: the name that people know.
  std::string program() const;

  const EngineContainer::Engine which_;
  const std::string host_;
  bool was_reached_ = false;
  std::map<std::string, int> last_pids_;  // the engine forgets them
  // When a container ended last with an error, and whether it was told to stop.
  struct End {
    std::string finished_at;
    std::optional<bool> was_told{};  // nothing: not settled
    int unanswered = 0;              // requests for its events, in a row
  };
  std::map<std::string, End> ends_;
};

}  // namespace culprit::owners
