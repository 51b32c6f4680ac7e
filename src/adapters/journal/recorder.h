// Writes down what the manager is stepped with and what it does, while it runs.
//
// The manager's thread keeps the steps that decide nothing, hands them over several at a time and
// goes on; a thread of the recorder's own turns them into rows. Steps that decide nothing wait for
// others, because each write costs whole pages of the disk, however little it is about; what was
// said or asked is written soon. Only a step that asks for changes on the robot, that learned
// something or took an order is waited for: its rows are on the disk before anything is asked for
// or said.
//
// If the file cannot be written, nothing waits for it: the robot is managed all the same. Rows are
// kept and written as soon as it is possible again. If they become too many, the oldest `steps` go
// first, then the oldest others, and a `gap` row says how many.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <thread>
#include <unordered_map>

#include "base/mutex.h"
#include "journal/known_robot.h"
#include "journal/session.h"
#include "journal/step_codec.h"
#include "journal/writer.h"
#include "knowledge/knowledge.h"
#include "robot/command.h"

namespace culprit::journal {

// What identifies the decisions of a step (StepReader gives it back).
std::optional<Digest> digest_of(std::span<const Command> commands, std::span<const Event> events,
                                const RuleSet& rules, Hasher& hasher);

enum class Ending : std::uint8_t {
  kStopped,     // culprit was asked to stop
  kSteppedBack  // another culprit manages the robot: what is under way is no longer this one's
};

class Recorder {
 public:
  // How long steps that decide nothing wait to be written, by the robot's clock.
  static constexpr Duration kPeriod = std::chrono::seconds(20);
  static constexpr Duration kSoon = std::chrono::milliseconds(200);  // between two writes
  static constexpr std::size_t kMany = 1 << 13;  // observations that do not wait for so long
  // How long, and how many, steps that decide nothing are kept before they are handed over.
  static constexpr Duration kKept = std::chrono::milliseconds(100);
  static constexpr std::size_t kMaxKept = 16;
  // What is known of the robot is written once it changed, and at the latest after so long: old
  // rows are dropped.
  static constexpr Duration kRobotPeriod = std::chrono::seconds(1);
  static constexpr Duration kRobotAtLatest = std::chrono::hours(1);
  static constexpr Duration kRetry = std::chrono::seconds(1);
  // How long an action waits for a disk that does not answer.
  static constexpr Duration kPatience = std::chrono::seconds(2);
  static constexpr std::size_t kMaxUnsaved = 16u << 20;  // bytes of rows, and of steps not yet rows

  struct Options {
    std::filesystem::path path;
    Writer::Options writer;
    std::function<std::int64_t()> wall_clock;  // nanoseconds since 1970
    // Called when writing begins to fail, and when it goes on; from the recorder's thread.
    std::function<void(const std::string&)> on_trouble;
  };

  // `writer`: nothing if the file cannot be opened now; that is tried again and again. `knowledge`
  // and its rules must outlive the recorder, which looks at it in stepped() only. `session` becomes
  // the first row.
  Recorder(std::optional<Writer> writer, Options options, const Session& session,
           const Knowledge& knowledge);
  // As end(), but without a word: as if the process had ended by itself.
  ~Recorder();
  Recorder(const Recorder&) = delete;

  // After each step and before its commands go out, by one thread. Takes the observations.
  void stepped(Time now, std::vector<Observation>& observations, std::span<const Command> commands,
               std::span<const Event> events) {
    // Here for what a step that decides nothing costs: between two steps others use the cache.
    Pending& place = places_[kept_++];
    place.now = now;
    place.observations.swap(observations);
    const bool decides = !commands.empty() || !events.empty();
    if (decides || kept_ == kMaxKept || now - places_.front().now >= kKept)
      hand_over(place, commands, events);
  }

  // Writes what is waiting. An error says what is lost. No step after it.
  Expected<void> end(Ending ending = Ending::kStopped);

 private:
  // What few steps have beside observations.
  struct Decided {
    std::vector<Command> commands;
    std::vector<Event> events;
    Learned learned;
    std::optional<KnownRobot> robot;
  };
  // One line of the cache: between two steps of a robot at rest, others use the cache, and each
  // line that has to be fetched anew is felt in what a step takes.
  struct alignas(64) Pending {
    Time now{};
    std::int64_t wall = 0;
    std::vector<Observation> observations;
    std::unique_ptr<Decided> decided;
    std::optional<Ending> end{};
  };
  // Places are used again with the memory that their observations had.
  struct Queue {
    std::vector<Pending> places;
    std::size_t used = 0;
    Pending& next();
    void clear();
  };

  // What is kept, the last of which is `step`.
  void hand_over(Pending& step, std::span<const Command> commands, std::span<const Event> events);
  enum class Urgency : std::uint8_t { kNone, kSoon, kNow };
  void hand_over(Urgency urgency);
  std::unique_ptr<Decided> decision_of(std::span<const Command> commands,
                                       std::span<const Event> events);
  void wait_until_written();
  Learned changes();
  // Nothing if it was written.
  std::optional<KnownRobot> newly_known(Time now);
  void run();
  void make_rows(const Pending& pending);
  void make_decision(std::int64_t wall, const Decided& decision);
  void make_outcome(std::int64_t wall, const Reply& reply);
  void close_steps();
  void add(std::string_view kind, std::int64_t at, const Json& body);
  Expected<void> write(bool is_durable);
  Expected<void> open_anew();
  void begin_session_anew(const std::filesystem::path& rows);
  void finish();
  Expected<void> failed(Error error);
  void tell_of_copy();
  void bound_unsaved();

  Options options_;
  const Knowledge& knowledge_;
  const RuleSet& rules_;

  // Of the manager's thread.
  std::vector<Belief> beliefs_;  // as written last
  std::vector<std::vector<Couplings::Learned>> couplings_;

  KnownRobot known_robot_;  // as written last
  std::uint64_t robot_changes_ = 0;
  std::uint64_t robot_sightings_ = 0;
  Time robot_looked_at_ = kLongAgo;
  Time robot_written_ = kLongAgo;

  // All that a step without decisions touches, side by side.
  alignas(64) std::size_t kept_ = 0;
  std::array<Pending, kMaxKept> places_;

  // Of both threads, under the mutex.
  alignas(64) Mutex mutex_;
  Urgency urgency_ CULPRIT_GUARDED_BY(mutex_) = Urgency::kNone;
  Time first_queued_ CULPRIT_GUARDED_BY(mutex_){};  // steps that wait, from here
  Time now_of_queue_ CULPRIT_GUARDED_BY(mutex_){};  // to here
  Queue queue_ CULPRIT_GUARDED_BY(mutex_);
  std::size_t queued_observations_ CULPRIT_GUARDED_BY(mutex_) = 0;
  std::uint64_t handed_over_ CULPRIT_GUARDED_BY(mutex_) = 0;
  std::uint64_t lost_steps_ CULPRIT_GUARDED_BY(mutex_) = 0;
  std::uint64_t written_ CULPRIT_GUARDED_BY(mutex_) = 0;
  ConditionVariable work_;
  ConditionVariable done_;
  bool is_failing_ CULPRIT_GUARDED_BY(mutex_) = false;
  bool is_ending_ CULPRIT_GUARDED_BY(mutex_) = false;

  // Of the recorder's thread.
  std::optional<Writer> writer_;
  bool is_damaged_ = false;   // the file, which cannot be written any more
  std::string copy_trouble_;  // that was told
  Time now_{};                // of the newest step
  Batch unsaved_;
  std::size_t unsaved_bytes_ = 0;
  std::string steps_;  // of the row that is being made
  std::int64_t steps_at_ = 0;
  std::uint64_t gap_steps_ = 0;
  std::uint64_t gap_rows_ = 0;
  std::unordered_map<std::uint64_t, std::string> asked_;  // changes that wait for their outcome
  Whereabouts where_;
  Json session_;
  Json robot_;             // its row
  Learned known_;          // all, for a file that takes the place of this one
  bool is_begun_ = false;  // the session is in a file
  std::optional<Error> last_error_;
  Hasher hasher_;

  std::thread thread_;
};

}  // namespace culprit::journal
