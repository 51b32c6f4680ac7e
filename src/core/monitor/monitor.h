// Observations -> knowledge (paper, "Monitoring"): K_system, the dependency graph, and what is
// known of each component.
//
// Values that depend on time alone (ages, rates, suspicion, staleness) change without an
// observation. For each of them the monitor knows when it will next matter to a trigger, from the
// constants that triggers compare it with, and asks to be stepped then. A sample on a healthy topic
// therefore costs no evaluation at all.
#pragma once

#include <algorithm>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "knowledge/deadlines.h"
#include "knowledge/history.h"
#include "knowledge/knowledge.h"
#include "knowledge/known_robot.h"
#include "monitor/loss_meter.h"
#include "monitor/phi_accrual.h"
#include "monitor/sliding_count.h"
#include "monitor/value_window.h"
#include "robot/observation.h"

namespace culprit {

class Monitor {
 public:
  // A component is lost after this many unanswered ones; one whose process is known only if it is
  // silent too (is_silent).
  static constexpr int kMissedProbes = 2;
  // A later lifecycle transition does not belong to the node's start.
  static constexpr Duration kStart = std::chrono::seconds(60);
  // The usual value of a signal is taken from its last readings, once there are enough.
  static constexpr std::size_t kReadings = 32;
  static constexpr std::size_t kLeastReadings = 4;
  // A node that began anew may take so long to make the publishers and subscribers it had.
  static constexpr Duration kEndsAwaited = std::chrono::seconds(10);
  // Or so long, if its earlier processes answered requests and this one has answered none yet: it is
  // at its start still.
  static constexpr Duration kStartAwaited = std::chrono::minutes(1);
  static constexpr Duration kSpeaksAgain = std::chrono::seconds(2);
  static constexpr Duration kUnsure = std::chrono::seconds(10);
  // A node whose lifecycle changed has so long before it is found to hang.
  static constexpr Duration kSettles = std::chrono::seconds(2);
  // Participants announce themselves every 3 s.
  static constexpr Duration kGrace = std::chrono::seconds(5);
  // How often it is looked whether all is there that an earlier run saw.
  static constexpr Duration kLook = std::chrono::milliseconds(50);
  // A node that shuts down cleanly leaves the graph first. The middleware announces it, and
  // the operating system's report may be faster.
  static constexpr Duration kFarewell = std::chrono::milliseconds(10);

  // When a computer is reachable again, the grace period for each of its nodes: it may have to be
  // discovered anew.
  static constexpr Duration kReturn = std::chrono::seconds(10);
  // And so long for what such a node says, from when it answers.
  static constexpr Duration kSpeaks = std::chrono::milliseconds(3500);

  // A value that becomes NaN again is reported again if it was a number for at least this long.
  static constexpr Duration kTellAgain = std::chrono::seconds(60);

  // What it writes; all else it only reads.
  struct Writes {
    SignalStore& signals;
    DependencyGraph& graph;
    ComponentStates& components;
    Departures& departures;
    Discovered& discovered;
    ReportedNames& reported_names;
    std::optional<Knowledge::ClockStep>& clock_step;
    EventLog& events;
  };

  // `knowledge` must outlive the monitor. Watching begins at `start`. A part that was never seen
  // (knowledge/discovered.h) is unknown, and reported when `discovered`. A part that an earlier run
  // saw may still be discovered until `discovered`. From then on it is absent: a component that is
  // not there is not alive, a topic is silent. A topic that is seen later gets as long for its first
  // message, from the discovery of its publisher. If all parts that an earlier run saw are there,
  // that is known before `discovered` (monitor_start.cpp).
  Monitor(const Knowledge& knowledge, Writes writes, Time start, Time discovered);

  // The lifecycles that earlier processes of culprit knew. Before the first observation.
  void remember(const History& past);
  // The parts of the robot that they saw. Before the first observation.
  void remember(const KnownRobot& known);

  // Takes in an observation as of `at`, which never goes back.
  void observe(const Observation& observation, Time at);

  // culprit received nothing from `since` until `now`, as when it was suspended. A topic has its usual gap and kSpeaksAgain
  // to be received again. Until then its silence is as long as it was at `since`, and then it goes on, so that no recovery
  // is concluded from the pause. For kGrace, a node that leaves the graph is not taken for down unless the operating system
  // says so: it may only have to be discovered anew. For kUnsure, no component is found to hang.
  void restart(Time since, Time now);

  // culprit stands still from `since` until `until`, a moment: it does not count for silences. Each silence loses
  // kSpeaksAgain at most, so that a starved culprit notices it all the same.
  void stand_still(Time since, Time until);

  // Lets time pass: updates every value whose deadline has come.
  void advance(Time now);
  Time next_deadline() const {
    return std::min(deadlines_.next(), knowledge_.departures.next_settling());
  }

  // Brings the values up to date that `program` reads. Triggers need no such thing (see above); a
  // WHEN condition or a parameter's new value does.
  void refresh(const Program& program, Time now);

 private:
  struct Goal {
    Time began;
    GoalStatus status = GoalStatus::kUnknown;
  };
  struct Goals {
    std::unordered_map<std::uint64_t, Goal> all;  // that the server remembers
    bool is_heard = false;                        // it reported them
  };
  struct Topic {
    Goals goals;  // of the status of an action
    std::optional<Time> first;
    std::optional<Time> last;
    std::optional<Time> regained;  // the first sample since `awake_`
    monitor::PhiAccrual phi;
    monitor::LossMeter loss;
    std::vector<InputId> inputs;
    Duration looked_back{};  // at most, by a rule that reads it, until it fires
    bool needs_phi = false;
    // There was a gap in reception since the last sample: until then its silence is as long as it
    // was.
    struct Resumes {
      Time at;
      Duration silence{};
    };
    std::optional<Resumes> resumes;
    // Since when the simulated time of its publisher, or of a component upstream of that, stands still.
    std::optional<Time> held;
    bool is_known_silent = false;  // no sample came since its publisher was known down
    std::optional<Time> listened;  // since when its publisher knows its subscriber
    // It is certain that no sample came since then, though `discovered` is still ahead; and the
    // component that would have published one.
    std::optional<Time> silent_since;
    ComponentId silent_one;
  };
  struct Signal {
    std::optional<Time> last;
    Duration interval{};
    std::vector<InputId> inputs;
    std::optional<WhyUnknown> unusable;  // why its last reading is no number
    std::optional<Time> nan;             // when it was NaN last
  };
  // The state of an input of a topic or of a signal window, by InputId.
  struct Derived {
    monitor::SlidingCount count{Duration(1)};
    std::optional<monitor::ValueWindow> values;  // kMean, kMin, kMax, kStddev
    // When the window held too much, or the publisher's simulated time stood still, the last time.
    std::optional<Time> overflowed;
    bool is_overflow_told = false;
    std::vector<double> deviations;  // kPhi: for each threshold
    // kChanged, kFrozen: the first reading since the last gap, the last one that was another, and its
    // value.
    std::optional<Time> known_since;
    std::optional<Time> changed;
    Value last_value;
    monitor::LongQueue<double> usual{kReadings};  // kSignal: the last readings
  };

  void on(Time at, const NodeAppeared& seen);
  void on(Time at, const NodeVanished& seen);
  void on(Time at, const NamesakesSeen& seen);
  void on(Time at, const EndpointAppeared& seen);
  void on(Time at, const EndpointVanished& seen);
  void on(Time at, const SampleArrived& seen);
  void on(Time at, const SignalRead& seen);
  void on(Time at, const DiagnosticRead& seen);
  void on(Time at, const ParameterRead& seen);
  void on(Time at, const LifecycleRead& seen);
  void on(Time at, const ProcessSeen& seen);
  void on(Time at, const Probed& seen);
  void on(Time at, const ProcessWorked& seen);
  void on(Time at, const UsageSeen& seen);
  void on(Time at, const GoalsSeen& seen);
  void on(Time at, const LogSeen& seen);
  void on(Time at, const StatusHeard& seen);
  void on(Time at, const ParametersListed& seen);
  void on(Time at, const HostReached& seen);
  void on(Time at, const TimeHeld& seen);
  void on(Time at, const ClockStepped& seen);
  void on(Time at, const StartBarred& seen);
  void on(Time at, const LivesOn& seen);
  void on(Time at, const HostHeard& seen);
  void on(Time at, const EndsWith& seen);
  void on(Time at, const LauncherSeen& seen);
  void on(Time at, const StartedHere& seen);
  void on(Time at, const Unloaded& seen);
  void settle_departures(Time now);
  void on(Time, const Reply&) {}  // the executor's
  void on(Time, const Order&) {}  // the governor's
  void on(Time at, const LinkTrouble& seen);
  void on(Time, const HearingRegained&) {}  // the manager's: restart()
  void on(Time, const Overslept&) {}        // likewise
  void on(Time, const PriorsTold&) {}       // likewise: adopt()
  void on(Time at, const ListenerKnown& seen);
  void on(Time, const PublisherKnown& seen) {
    write_.discovered.note_publisher(seen.status, seen.node);
  }
  void on(Time, const HearingLost&) { is_deaf_ = true; }

  Duration silence_of(TopicId topic, Time now) const;
  void resume(TopicId topic, Time since, Time now);
  void hold_silence(TopicId topic, Time since, Time until);

  void read_signal(SignalId signal, const Value& value, Time at);
  void note_arrival(InputId id, Time at);
  void update(InputId id, Time now);
  void put_held(InputId id);
  Duration latency_of(SignalId signal, InputId id) const;
  void note_reading(InputId id, const Slot& slot);
  void note_number(SignalId signal, const Value& value, const Slot& slot, Time at);
  void update_window(InputId id, Time now);
  void note_change(InputId id, const Value& value, Time at, bool is_after_gap);
  void update_changed(InputId id, Time now);
  void update_frozen(InputId id, Time now);
  Duration pause_of(const Input& input) const;
  void put(InputId id, const Slot& value, const Signal& signal);
  bool is_stale(SignalId signal, Time now) const;
  WhyUnknown why_unknown(SignalId signal, Time now) const;
  void note_overflow(InputId id, Time at);
  void begin_windows_anew(Time now);
  Time next_crossing(InputId id, Time now) const;
  Time next_age(const Input& input, Time now) const;
  Time next_phi(InputId id, Time now) const;
  Time next_rate(InputId id) const;
  Slot age(InputId id, Time now) const;
  Slot rate(InputId id, Time now);
  Slot phi(InputId id, Time now) const;
  Slot loss(InputId id, Time now);
  Slot goals(InputId id, Time now);
  Slot goal_age(TopicId topic, Time now) const;
  std::optional<Time> goals_known_since(TopicId topic) const;
  std::optional<Time> oldest_goal(TopicId topic) const;
  Time next_of_goals(InputId id, Time now) const;
  void count_goal(TopicId topic, GoalStatus outcome, Time at);
  void forget_goals(TopicId topic, Time now);
  Slot logs(InputId id, Time now);
  Time logs_known_from(InputId id) const;
  Time next_of_logs(InputId id, Time now) const;

  // Whether a component that publishes the topic joined the graph since then.
  void note_how_far_it_looks_back(const Rule& rule);
  bool has_begun_since(Time before, TopicId topic) const;
  bool has_begun_since(Time before, ComponentId sender) const;
  bool has_sender_begun_since(Time before, InputId id) const;
  // Between two samples, the last of which was before.
  void note_pause(SignalStore::Rhythm& rhythm, Duration interval, TopicId topic) const;
  std::vector<TopicId> topics_of(std::optional<ComponentId> publisher,
                                 const std::string& name) const;
  void see(TopicId topic, Time at);
  void see(ComponentId component, Time at);
  // From when on a topic that has not spoken is silent; kNever while it was not seen.
  Time silent_from(TopicId topic) const;
  bool is_time_held(TopicId topic) const;
  void hold_topic(TopicId topic, bool is_held, Time at);
  Time listened_since(TopicId topic) const;
  Time zero_from(const Input& input) const;
  Time rate_known_from(InputId id) const;
  void tell_never_seen(Time at);

  void expect(const KnownRobot& known);
  void expect_no_more();
  void look_at_expected(Time now);
  bool is_all_there() const;
  bool is_there(ComponentId component) const;
  bool is_there(TopicId topic) const;
  bool is_there(InputId input) const;
  std::optional<ComponentId> certainly_silent(TopicId topic) const;
  void forget_what_was_heard_of(ComponentId component, Time now);

  void await_ends(ComponentId component, Time at);
  void note_ends(ComponentId component, Time at);
  bool is_at_its_start(ComponentId component, Time now) const;
  void await_ends_no_more(ComponentId component, Time at);
  void keep_ends(ComponentId component);
  void forget_process(ComponentId component, Time at);
  void forget_usage(ComponentId component);
  void note_process(const ProcessSeen& seen, Time at);
  void note_begin(const ProcessSeen& seen, Time at);
  void note_end(const ProcessSeen& seen, Time at);
  void note_farewell(ComponentId component, Time at);
  bool is_being_ended(ComponentId component) const;
  void note_known_dead(ComponentId component, Time at);
  void note_no_longer_dead(ComponentId component);
  void touch_topics_of(ComponentId component);
  void note_part_vanished(ComponentId component, const std::string& node, Time at);
  void note_part_probed(const Probed& seen, Time at);
  bool has_hung_part(ComponentId component) const;
  void note_missing_part(ComponentId component, Time at);
  void note_given_back(ComponentId component, Lifecycle now, Time at);
  void note_rise(ComponentId component, Lifecycle state, Time at);
  void note_end_of_start(ComponentId component, Time at);
  bool hangs_in_transition(ComponentId component, Time now) const;
  void update_lifecycle_inputs(ComponentId component, Time now);
  bool does_not_answer(ComponentId component, Time now) const;
  bool is_silent(ComponentId component, Time now) const;
  void note_silent(const std::string& host, Time at);
  void update_alive(ComponentId component, Time at, const std::string& remark);
  void update_alive_inputs(ComponentId component, Time now, const Slot& value);
  void update_groups_of(ComponentId component, Time now);
  void note_pause(const Group& group, Time now);
  void update_group(GroupId group, Time now);

  const Knowledge& knowledge_;
  Writes write_;
  // Since when a window of values counts that began at `since`.
  Time heard_since(Time since) const { return std::max(since, awake_); }

  // The parts that an earlier run saw, until all of them are there or discovery is over.
  struct Expected {
    struct Part {
      ComponentId component;
      int pid = 0;  // as in KnownRobot::Part
    };
    std::vector<Part> parts;
    std::vector<bool> seen;   // by topic
    std::vector<bool> heard;  // likewise
    std::vector<InputId> values;
  };
  std::optional<Expected> expected_;

  Time start_;
  Time discovered_;
  Time awake_ = kLongAgo;   // no gap counts from before
  Time graced_ = kLongAgo;  // until then nodes may have to be discovered anew
  bool is_deaf_ = false;
  std::set<std::string> silent_hosts_;  // that were told of
  std::vector<Topic> topics_;
  std::unordered_map<std::string, std::vector<TopicId>> topic_ids_;  // by name
  std::vector<Signal> signals_;
  std::vector<Derived> derived_;
  std::vector<std::vector<InputId>> component_inputs_;
  // Unanswered questions to the component's other nodes, in their order.
  struct PartMisses {
    int count = 0;
    bool is_reliable = true;  // it has answered from the first question on
    bool has_answered = false;
  };
  std::vector<std::vector<PartMisses>> part_misses_;  // by component
  std::vector<bool> has_answered_;                    // by component: one of its processes did
  std::vector<std::vector<InputId>> parameter_inputs_;
  std::vector<std::vector<SignalId>> parameter_signals_;
  std::vector<std::vector<InputId>> diagnostic_inputs_;
  std::size_t farewell_of(ComponentId component) const {
    return knowledge_.rules.inputs.size() + 2 + knowledge_.rules.components.size() +
           component.index;
  }

  std::size_t return_of(ComponentId component) const {
    return farewell_of(component) + knowledge_.rules.components.size();
  }
  std::size_t look_at_expected_slot() const {
    return knowledge_.rules.inputs.size() + 2 + 3 * knowledge_.rules.components.size();
  }

  // By InputId; then `discovered_`, then `graced_`; then ComponentState::awaits_ends_until by
  // component; then, by component, until when its farewell may still come; then, by component,
  // until when it may have to be discovered again after its computer was unreachable; then when to
  // look at `expected_`; then when the health of a group may change, by GroupId.
  Deadlines deadlines_;
};

}  // namespace culprit
