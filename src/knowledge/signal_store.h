// K_system (paper, "Knowledge base"): the present value of everything that rules read.
//
// One slot for each input of the rule set, in the layout that programs evaluate on. The store also
// collects the rules whose triggers a change can have flipped; the analysis takes them from here
// and looks at no others.
#pragma once

#include <span>
#include <string>
#include <vector>

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
  void forget(InputId id) { set(id, Slot()); }

  // Writes a value that cannot have changed any trigger (see Input::thresholds).
  void set_quietly(InputId id, const Slot& value);

  // Has the rules that read the input evaluated, whether its value changed or not.
  void touch(InputId id);
  void touch(RuleId id);

  // How long after a change in the system this input shows it, as far as the monitor has seen.
  Duration latency(InputId id) const { return latencies_[id.index]; }
  void set_latency(InputId id, Duration latency) { latencies_[id.index] = latency; }

  // Takes the rules that were marked since the last call, each once. Valid until the next mark.
  std::span<const RuleId> take_touched();

 private:
  const RuleSet& rules_;
  std::vector<Slot> slots_;
  std::vector<std::string> texts_;  // what slots of texts refer to
  std::vector<Duration> latencies_;
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
