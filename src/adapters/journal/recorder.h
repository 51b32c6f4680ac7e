// Writes down what the manager is stepped with and what it does, while it runs.
//
// The manager's thread keeps the steps that decide nothing, hands them over several at a time and
// goes on; a thread of the recorder's own turns them into rows. Steps that decide nothing wait for
// others, because each write costs whole pages of the disk, however little it is about; events and
// requests are written soon. The manager waits only for a step that learned from an outcome, took an
// order or requests changes that cannot be read back later: its rows are on the disk before any
// request or message goes out. Counts of failures that began together, which change with each
// detection, are written soon: a killed process may lose the last of them. A request that can be settled by reading back (settled_here.h) waits
// for one write to the intent file only, and is on the disk soon.
//
// If the file cannot be written, the manager does not wait: the robot is managed all the same. Rows
// are kept and written as soon as it is possible again. If they become too many, the oldest `steps`
// go first, then the oldest others, and a `gap` row holds their number.
#pragma once

#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <thread>
#include <unordered_map>

#include "base/mutex.h"
#include "journal/intent_file.h"
#include "journal/knowledge_changes.h"
#include "journal/recent_rows.h"
#include "journal/session.h"
#include "journal/step_codec.h"
#include "journal/writer.h"
#include "knowledge/knowledge.h"
#include "robot/command.h"

namespace culprit::journal {

// The digest of a step's decisions (StepReader gives it back). Nothing: it decided nothing. Blind
// rules and incidents are left out.
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
  static constexpr std::size_t kMany = 1 << 13;  // observations that are not kept waiting
  // How long, and how many, steps that decide nothing are kept before they are handed over.
  static constexpr Duration kKept = std::chrono::milliseconds(100);
  static constexpr std::size_t kMaxKept = 16;
  static constexpr Duration kRetry = std::chrono::seconds(1);
  // How long an action waits for a disk that does not answer.
  static constexpr Duration kPatience = std::chrono::seconds(2);
  static constexpr std::size_t kMaxUnsaved = 16u << 20;  // bytes of rows, and of steps not yet rows
  // A disk that has not answered for so long may block every writer: then an action waits for the
  // journal, and no longer than kPatience.
  static constexpr Duration kStalled = std::chrono::milliseconds(100);

  struct Options {
    std::filesystem::path path;
    Writer::Options writer;
    std::function<std::int64_t()> wall_clock;  // nanoseconds since 1970
    // The rows that the last run could not write (unwritten.h); they come before the first row.
    std::vector<Entry> unwritten{};
    // Called when writing begins to fail, and when it goes on; from the recorder's thread.
    std::function<void(const std::string&)> on_trouble;
  };

  // `writer`: nothing if the file cannot be opened now; that is tried again and again. `knowledge`
  // and its rules must outlive the recorder, which looks at it in stepped() only. `session` becomes
  // the first row.
  Recorder(std::optional<Writer> writer, Options options, const Session& session,
           const Knowledge& knowledge);
  // As end(), but without a report: as if the process had ended by itself.
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
    if (decides || kept_ == kMaxKept || now - places_.front().now >= kKept) {
      hand_over(place, commands, events);
      wake_writer();
    }
  }

  // As stepped(), for a step with commands, in two calls with the commands between them. The first
  // call writes what must be on the disk before; the second one wakes the writer for the rest.
  void before_commands(Time now, std::vector<Observation>& observations,
                       std::span<const Command> commands, std::span<const Event> events);
  void after_commands() { wake_writer(); }

  // Writes what is waiting. An error names the lost rows. No step after it.
  Expected<void> end(Ending ending = Ending::kStopped);

 private:
  // The parts of a step that few steps have.
  struct Decided {
    std::uint64_t number = 0;  // counted from 1; 0: it has no rows
    std::vector<Command> commands;
    std::vector<Event> events;
    std::vector<Entry> rows;  // about outcomes, events and intents
    Learned learned;
    std::optional<KnownRobot> robot;
  };
  // One cache line: between two steps of a robot at rest, others use the cache, and each line that
  // is fetched again lengthens the step.
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

  // Hands over the kept steps, the last of which is `step`.
  void hand_over(Pending& step, std::span<const Command> commands, std::span<const Event> events);
  // kSynced: soon, and on the disk then.
  enum class Urgency : std::uint8_t { kNone, kSoon, kSynced, kNow };
  void hand_over(Urgency urgency);
  void wake_writer();
  void date_kept();
  void take_outcomes(Pending& step);
  void decide(Pending& step, std::span<const Command> commands, std::span<const Event> events);
  Decided& decided(Pending& step);
  void keep_rows(const Decided& decision);
  bool is_with_the_kernel(const Decided& decision, Time now);
  void wait_until_written();
  void run();
  void make_rows(Pending& pending);
  void make_decision(std::int64_t wall, Decided& decision);
  void close_steps();
  void add(Entry row);
  void add(std::string_view kind, std::int64_t at, const Json& body);
  Expected<void> write();
  Expected<void> open_anew();
  void begin_session_anew(const std::filesystem::path& rows);
  void finish();
  Expected<void> failed(Error error);
  void tell_of_copy();
  void open_intents();
  void tell_of_intents();
  void empty_intents();
  void bound_unsaved();

  Options options_;
  const Knowledge& knowledge_;
  const RuleSet& rules_;

  // Used by the manager's thread only.
  KnowledgeChanges changes_;
  std::unordered_map<std::uint64_t, std::string> asked_;  // changes that wait for their outcome
  std::uint64_t decisions_ = 0;
  std::optional<IntentFile> intents_;  // nothing: what is asked for waits for the journal
  std::uint64_t in_file_ = 0;          // the newest decision that it has
  RecentRows recent_;
  std::string rows_;  // memory that is used again

  bool is_writer_needed_ = false;  // and not woken yet

  // All that a step without decisions touches, side by side.
  alignas(64) std::size_t kept_ = 0;
  std::array<Pending, kMaxKept> places_;

  // Shared by both threads, under the mutex.
  alignas(64) Mutex mutex_;
  Urgency urgency_ CULPRIT_GUARDED_BY(mutex_) = Urgency::kNone;
  Time first_queued_ CULPRIT_GUARDED_BY(mutex_){};  // steps that wait, from here
  Time now_of_queue_ CULPRIT_GUARDED_BY(mutex_){};  // to here
  Queue queue_ CULPRIT_GUARDED_BY(mutex_);
  std::size_t queued_observations_ CULPRIT_GUARDED_BY(mutex_) = 0;
  std::uint64_t handed_over_ CULPRIT_GUARDED_BY(mutex_) = 0;
  std::uint64_t lost_steps_ CULPRIT_GUARDED_BY(mutex_) = 0;
  std::uint64_t written_ CULPRIT_GUARDED_BY(mutex_) = 0;
  std::uint64_t saved_ CULPRIT_GUARDED_BY(mutex_) = 0;  // the newest decision in the journal
  IntentFile::Head head_ CULPRIT_GUARDED_BY(mutex_);    // of intents after that
  std::optional<std::chrono::steady_clock::time_point> writing_since_ CULPRIT_GUARDED_BY(mutex_);
  // One for the manager's thread, which has none, and whether it wants one.
  std::optional<IntentFile> new_intents_ CULPRIT_GUARDED_BY(mutex_);
  bool wants_intents_ CULPRIT_GUARDED_BY(mutex_) = true;
  std::string intents_trouble_ CULPRIT_GUARDED_BY(mutex_);
  ConditionVariable work_;
  ConditionVariable done_;
  bool is_failing_ CULPRIT_GUARDED_BY(mutex_) = false;
  bool is_ending_ CULPRIT_GUARDED_BY(mutex_) = false;

  // Used by the recorder's thread only.
  std::optional<Writer> writer_;
  bool is_damaged_ = false;   // the file, which cannot be written any more
  std::string copy_trouble_;  // that was reported
  std::string told_of_intents_;
  Time now_{};                    // of the newest step
  std::uint64_t unsaved_to_ = 0;  // the newest decision in `unsaved_`, or before it
  bool owes_sync_ = false;        // something of it has to be on the disk
  Batch unsaved_;
  std::size_t unsaved_bytes_ = 0;
  std::string steps_;  // of the row that is being made
  std::int64_t steps_at_ = 0;
  std::uint64_t gap_steps_ = 0;
  std::uint64_t gap_rows_ = 0;
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
