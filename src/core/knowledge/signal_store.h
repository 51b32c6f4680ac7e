// K_system (paper, "Knowledge base"): the present value of everything that rules read.
//
// One slot for each input of the rule set, in the layout that programs evaluate on. The store also
// collects the rules whose triggers a change can have flipped; the analysis takes them from here
// and looks at no others.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/time.h"
#include "knowledge/why_unknown.h"
#include "language/evaluate.h"
#include "language/rule_set.h"

namespace culprit {

class SignalStore {
 public:
  // `rules` must outlive the store. Every input begins unknown.
  explicit SignalStore(const RuleSet& rules);
  // As `other` is, for `rules`: the same rules at another address.
  SignalStore(const RuleSet& rules, const SignalStore& other);

  std::span<const Slot> slots() const { return slots_; }
  const Slot& operator[](InputId id) const { return slots_[id.index]; }

  // Writes a value and marks the rules that read the input if the value is another than before.
  void set(InputId id, const Slot& value);
  void forget(InputId id, WhyUnknown why = WhyUnknown::kNoValue);
  // Empty if the input is known.
  std::optional<WhyUnknown> why_unknown(InputId id) const {
    return slots_[id.index].known ? std::nullopt : std::optional(why_unknown_[id.index]);
  }

  // Writes a value that cannot have changed any trigger (see Input::thresholds).
  void set_quietly(InputId id, const Slot& value);

  // Has the rules that read the input evaluated, whether its value changed or not.
  void touch(InputId id);
  void touch(RuleId id);

  // How long after a change in the system this input shows it, as far as the monitor has seen.
  Duration latency(InputId id) const { return latencies_[id.index]; }
  // Until all that the trigger of a rule reads shows it.
  Duration latency(RuleId id) const;
  void set_latency(InputId id, Duration latency) { latencies_[id.index] = latency; }

  // After a gap of hearing: when the topics of a rule would have had a sample again. Before that its trigger
  // proves nothing about the present.
  Time heard_again_by(RuleId id) const;

  // When a signal was read last, or a goal of an action succeeded; kLongAgo for inputs that neither brings.
  Time read_at(InputId id) const { return read_at_[id.index]; }
  void set_read_at(InputId id, Time at) { read_at_[id.index] = at; }
  // When values of a signal or a diagnostic come. `gap` is the usual pause between two. Counted events (logs,
  // goals) have `last` alone.
  struct Arrivals {
    Time last = kLongAgo;
    Duration gap{};
    int count = 0;       // no more are counted than kRegular
    Duration longest{};  // the longest pause that ended by itself
  };
  // From so many values on, `gap` is known.
  static constexpr int kRegular = 4;
  const Arrivals& arrivals(InputId id) const { return arrivals_[id.index]; }
  void set_arrivals(InputId id, const Arrivals& arrivals) { arrivals_[id.index] = arrivals; }

  // culprit receives again since then, and may have missed values before.
  void hear_again(Time since) { hears_since_ = since; }
  // When a value that came before that would have been followed by another one: until then it may not
  // be what the robot says now. kLongAgo: it came since, or none was missed. kNever: once one comes.
  Time confirmed_by(InputId id) const;

  // Has every signal that the trigger of the rule reads been read after `since`? Not if it reads
  // anything else.
  bool is_read_since(RuleId id, Time since) const;

  // Whether the last reading of a signal was beyond all that it was lately, towards a value that
  // rules compare it with.
  bool is_unusual(InputId id) const { return is_unusual_[id.index]; }
  void set_unusual(InputId id, bool unusual) { is_unusual_[id.index] = unusual; }

  // The time of a topic's last sample, the average interval, and the usual pause in between:
  // longer, if the topic comes in bursts. Zero: not known yet.
  struct Rhythm {
    std::optional<Time> last;
    Duration interval{};
    Duration gap{};
    Duration longest{};  // the longest pause that ended by itself
    // All such pauses that were longer than usual, and all other intervals.
    Duration paused{};
    Duration flowed{};
    // The share of the recently published messages that was lost on the way here, 0 to 1; also 0 while
    // too few were published to measure it.
    double loss = 0;
    double loss_at_most = 0;  // the upper bound of the link's true loss; 0 where nothing was lost
    // Since `last` there was a time in which it could not be received: since when it would be silent, had culprit
    // received all the time until now. May be a little ahead.
    Time resumed = kLongAgo;
    Time heard_again_by = kLongAgo;  // after that time: when a sample would have come at the latest
    // The last pause that was longer than kUsualPause of the gaps that were usual before.
    // Empty once the next pause shows that the topic has only become slow.
    struct Silence {
      Time since{};
      Time over{};
      Duration gap{};  // that was usual before
    };
    std::optional<Silence> silence{};
    // The last messages, each of which came later after the one before than kSlowPace of the gaps that were usual
    // before them. One in between may come in time.
    struct Slowing {
      Time since{};     // the last message that came in time
      Duration gap{};   // that was usual before
      int in_time = 0;  // so many more messages came in time again than late
    };
    std::optional<Slowing>
        slowing{};  // empty: it is not slow, or has been for so long that this is its pace
    bool is_slow_since(Time at) const {
      return slowing && slowing->since <= later(at, slowing->gap);
    }
    static constexpr double kSlowPace = 1.5;
    static constexpr int kBackInPace = 3;  // messages in time: it is not slow any more
    static constexpr Duration kSlowAtMost = std::chrono::seconds(30);

    // Does it come all the time? A topic that is sent on demand pauses often or for long.
    bool is_steady() const { return gap > Duration::zero() && paused <= flowed / kFlowsForPause; }
    static constexpr int kFlowsForPause = 4;
    static constexpr int kUsualPause = 3;  // gaps
    static constexpr int kSilentGaps = 2;  // longer: it is silent

    // Since when its silence counts. @pre last
    Time silent_since() const { return std::max(*last, resumed); }
  };
  const Rhythm& rhythm(TopicId id) const { return rhythms_[id.index]; }
  void set_rhythm(TopicId id, Rhythm rhythm) { rhythms_[id.index] = rhythm; }

  // Takes the rules that were marked since the last call, each once. Valid until the next mark.
  std::span<const RuleId> take_touched();

 private:
  Time age_confirmed_by(const Input& input) const;

  const RuleSet& rules_;
  std::vector<Slot> slots_;
  std::vector<std::string> texts_;       // what slots of texts refer to
  std::vector<WhyUnknown> why_unknown_;  // of those that are
  std::vector<Duration> latencies_;
  std::vector<Time> read_at_;
  std::vector<Arrivals> arrivals_;
  Time hears_since_ = kLongAgo;
  std::vector<bool> is_unusual_;
  std::vector<Rhythm> rhythms_;  // by TopicId
  std::vector<RuleId> touched_;
  std::vector<RuleId> taken_;
  std::vector<bool> is_touched_;
};

// Known or unknown, and the same value.
bool same(const Slot& a, const Slot& b, Type type);

// `value` as a value of `type`: a text is read as a diagnostic's text is, a whole number may become
// a number or a truth (0, 1), everything may become a text. Unknown if that cannot be. A resulting
// text lives in `text`.
Slot as_type(const Value& value, Type type, std::string& text);

}  // namespace culprit
