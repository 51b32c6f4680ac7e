// One drill on a live robot: faults one after the other, while a culprit of its own heals.
//
// Safety, in this order for each fault: the fault can be undone, and is on the disk (drill/injected.h); the robot is well for
// kCalm; interlocks hold, each ABORT condition is false, and culprit acts; only then it is injected. Afterwards it is undone
// if culprit did not heal it, and the robot has to be well again before the next one.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>

#include "cli/drill_injector.h"
#include "cli/drill_manager.h"
#include "drill/drill_plan.h"
#include "drill/trial.h"
#include "journal/file_lock.h"

namespace culprit::cli {

class DrillSession {
 public:
  // A condition that the drill watches, and the rule that it added for that.
  struct Condition {
    std::string rule;
    std::string text;
  };
  struct Options {
    std::vector<std::string> manager;   // arguments of the culprit that heals
    std::filesystem::path log;          // of it
    std::filesystem::path injected;     // the record of faults that are not undone
    std::vector<Condition> interlocks;  // each rule is false while its condition holds
    std::vector<Condition> aborts;      // each rule is true with its condition
    Duration hang = std::chrono::seconds(3);
    Duration patience = std::chrono::seconds(60);  // for the robot to be well
    bool heals = true;                             // false: the culprit is on a dry run
  };
  using Say = std::function<void(const std::string& line)>;

  // Undoes the faults that an earlier drill has left behind, starts the culprit, and waits until the robot is well. Errors:
  // another drill or culprit manages the robot, the record is damaged, a fault that was left cannot be undone, or the robot
  // does not get well; each says what to do.
  static Expected<std::unique_ptr<DrillSession>> begin(Options options, Say say,
                                                       const std::atomic<bool>& stop);

  // Ends the culprit; one that heals, once the robot is well. If the robot does not get well, that culprit goes on. If it
  // exited or hangs, another one heals first. The record stays if a fault is not undone.
  ~DrillSession();

  // One step. Errors end the drill: the robot is not well before or after it, an interlock does not hold, the disk is
  // full, an ABORT condition is true or unknown, culprit is paused, or `stop`. The faults are undone then.
  Expected<drill::Trial> run(const drill::Step& step);

  // Why no further fault may be injected; empty: go on. An ABORT condition that was true once ends the drill, though it is
  // false again when the fault is undone, or was between two looks.
  std::string why_to_end();

  // As it was before the first fault.
  const drill::HealthyRobot& healthy() const { return usual_; }
  // Watches for so long and injects nothing. False: stopped.
  bool watch(Duration time);

 private:
  DrillSession(Options options, Say say, const std::atomic<bool>& stop)
      : options_(std::move(options)), say_(std::move(say)), stop_(stop) {}

  Expected<void> lock();
  Expected<void> undo_what_is_left();
  // Once the robot is well: a node may have been late before. Errors: a fault is still there.
  Expected<void> undo_what_is_left_now();
  // Waits until the robot is well. False: the culprit goes on, or no other one can be started.
  bool heal();
  // Errors: what is wrong; with kWellOrTold also why the drill is to end.
  enum class Until : std::uint8_t { kWell, kWellOrTold };
  Expected<void> wait_until_well(Until until);
  // On the disk, with the culprit that runs and the faults that are left.
  Expected<void> note(std::vector<drill::Injected> injected) const;
  Expected<void> may_inject() const;
  // "ABORT speed > 0.5 is unknown: ..."; empty: all are known.
  std::string blind_abort() const;
  // It exited, or hangs.
  bool is_culprit_lost() const;
  // Sleeps until the next look. Notes if the drill itself stood still meanwhile.
  void next_look();
  Expected<std::vector<drill::Injected>> prepare(const std::vector<drill::Fault>& faults);
  void inject(const std::vector<drill::Injected>& injected, drill::Trial& trial);
  void watch_reaction(drill::Trial& trial, std::vector<drill::Injected>& injected, Time announced);
  bool undo(std::vector<drill::Injected>& injected);
  // Until each is undone, `patience` at most: a node that was just started again may not answer at once.
  bool undo_all(std::vector<drill::Injected>& injected);

  const Options options_;
  const Say say_;
  const std::atomic<bool>& stop_;
  std::optional<journal::FileLock>
      lock_;  // two drills of one robot would undo the faults of each other
  std::unique_ptr<DrillNode> node_;
  std::unique_ptr<DrillManager> manager_;
  drill::ProcessId healer_;  // the process of manager_, from its start on
  std::unique_ptr<DrillInjector> injector_;
  std::optional<drill::RobotView> healthy_;
  drill::HealthyRobot usual_;
  std::vector<drill::Injected>
      left_;                     // injected, and not undone yet, by this drill or an earlier one
  std::string aborted_;          // why: an ABORT condition or a pause; empty: it was not
  std::optional<Time> calm_;     // since when the robot is well
  Time stood_still_ = kLongAgo;  // when the drill itself had not run for a second
};

}  // namespace culprit::cli
