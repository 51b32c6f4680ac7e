// A robot as a member of its fleet: its outcomes go to a PostgreSQL database, and the others'
// outcomes come back as priors of the planner's beliefs.
//
// All of it happens on a thread of its own, which the robot never waits for. The thread reads the
// journal, as any other reader does, and keeps its sums beside it (outbox.h). It visits the
// database when there is news, and now and then. A visit costs the database mostly a connection. So
// a failure and its end half a minute later are sent in one visit; a failure that needs a person is
// sent at once. While the database is away, slow, full or of another version the robot is managed
// as before; that is reported once, and nothing is lost.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "base/time.h"
#include "fleet/postgres.h"
#include "language/rule_set.h"
#include "robot/observation.h"

namespace culprit::fleet {

class Member {
 public:
  // How long it takes until ...
  struct Pace {
    Duration read = std::chrono::seconds(1);        // the journal is read after something happened
    Duration gather = std::chrono::seconds(25);     // news is sent after this time, with later news
    Duration visit = std::chrono::seconds(10);      // the database is visited again
    Duration beat = std::chrono::minutes(40);       // it is visited though there is no news
    Duration ask = std::chrono::minutes(40);        // it is asked for the fleet's priors again
    Duration retry = std::chrono::seconds(10);      // it is tried again, at first
    Duration retry_most = std::chrono::minutes(5);  // and later
  };
  struct Options {
    Address address;
    std::filesystem::path journal;
    std::string name;     // of the robot, for people
    std::string context;  // that it works in
    std::string machine;  // its computer's id; empty: it has none
    Pace pace{};
  };
  // Both are called on the thread of the member.
  struct Ears {
    std::function<void(PriorsTold)> priors;
    std::function<void(const std::string&)> trouble;  // what a person should know
  };

  explicit Member(Options options);
  // Returns at once, whatever the database does.
  ~Member();
  Member(const Member&) = delete;

  // A session with these rules: its priors are reported, those known from before first.
  void begin(const RuleSet& rules, Ears ears);
  // Reports no more priors.
  void end();
  // The journal has news, or will have soon.
  void happened();

  const std::string& context() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace culprit::fleet
