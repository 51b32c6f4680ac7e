// Turns what a manager finds into alerts for people: one fault, one alert, and one more when it is over.
//
// - An incident (incidents/incidents.h) is a fault, and the alert has its id. If it returns within kStaysAway, it is the
//   same fault, under the id of its first incident.
// - It is reported after `wait`. If it has cleared by then, one message reports both. It is reported at once if a person is needed, also if it was reported
//   before.
// - The end is reported once the fault has been absent for kStaysAway.
// - Problems of the whole robot are reported in the same way: a storm, a deaf culprit, a missing REQUIRED component, one
//   that was never seen and that a rule of level ERROR needs.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "alerts/alert.h"
#include "live/observer.h"

namespace culprit::live {

class Alerting : public Observer {
 public:
  static constexpr Duration kStaysAway = std::chrono::seconds(30);

  struct Options {
    Duration wait = std::chrono::seconds(5);
    std::string host;
    std::function<std::string()> link{};  // of the page
  };
  // Called on the thread that manages; must not block.
  using Post = std::function<void(const alerts::Alert&)>;
  // Seconds since 1970.
  using WallClock = std::function<double()>;

  Alerting(Options options, Post post, WallClock wall)
      : options_(std::move(options)), post_(std::move(post)), wall_(std::move(wall)) {}

  void begins(const Manager& manager, std::function<Remarks()> remarks, Time start) override;
  void stepped(const Runtime::Step& step) override;
  Time next_look() const override { return due_; }
  void announced(Time, const EventWords&, const std::string&) override {}

 private:
  // A problem at one moment.
  struct Problem {
    std::set<std::string> keys{};           // by which it is known again: its rules, its components
    alerts::Alert alert{};                  // but for what is the same all the time
    bool tells_condition = false;           // its headline does: that a component is down
    bool needs_person_if_it_lasts = false;  // for the time of Options::wait
  };
  // A fault, from its beginning to its end.
  struct Fault {
    std::map<std::string, Time> keys;  // that it has, or had until then
    alerts::Alert alert;               // as it is now, or was last
    std::string condition{};  // the last headline that told one; what follows it lasts longer
    Time began;
    Time gone = kNever;  // since when it is not there; kNever: it is
    bool is_told = false;
    bool is_person_needed = false;   // and was told so
    bool was_person_needed = false;  // at any time
    Time looked_at = kLongAgo;       // when it was last seen to be there
  };

  void note(std::span<const Event> events);
  void look(Time now);
  void forget_what_is_seen_again();
  std::vector<Problem> problems() const;
  std::vector<Problem> problems_of_the_whole() const;
  std::vector<Problem> problems_of_sight() const;
  Fault& fault_of(const Problem& problem, Time now);
  void close_part(Fault& part, const std::string& whole);
  void take(Problem problem, Time now);
  void tell(Fault& fault, Time now);
  bool is_over(Fault& fault, Time now);
  Time next_due(const Fault& fault) const;

  const Options options_;
  const Post post_;
  const WallClock wall_;
  const Manager* manager_ = nullptr;             // null: none has begun
  std::set<std::string> lost_sight_;             // rules that failed and cannot be judged now
  std::set<std::string> flapping_;               // rules
  std::map<std::string, std::string> resolved_;  // rules, and how their failure went away last
  std::vector<Fault> faults_;
  bool is_one_of_two_ = false;  // at the last look, a fault had two causes
  Time due_ = kNever;
};

}  // namespace culprit::live
