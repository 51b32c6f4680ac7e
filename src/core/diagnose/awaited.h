// Evidence that can still come: for each failure, how long something upstream may yet prove to be its
// cause.
//
//     W_i = max_u min(b_i + E_u, d_i + M_u)                  quiet rules u upstream of i, of a
//                                                            symptom that can cause i's; M_u is
//                                                            kLongestEvidence, or E_u if longer
//           l_i + one reading, the lateness and a cycle      i is an outage, u of a value of a supplier
//                 of u, at most 3 s                          by DEPENDENCY (a rail, a hub), or of one that i
//                                                            was seen to clear with
//     Z_i = max_u r_u + passing + C_i                        rules that cleared lately, and
//                                                            components upstream (or i's own) that a
//                                                            strategy began anew lately or that
//                                                            were in trouble lately, if
//                                                            e_u <= max(l_i, unclear.h) and
//                                                            e_i <= r_u + passing
//
//   e_i, E_u        onset and evidence time (timing.h); d_i the detection of i
//   b_i             when i presumably began: l_i, less the presumed lateness of a value's rule, but at
//                   most so early that a reading and a cycle of u are waited for after l_i. If i comes
//                   and goes, b_i and d_i are those of the first time, but for rules u that cleared
//                   lately: they may come and go with i
//   r_u             when u recovered: it cleared then, less its presumed lateness; a component was
//                   back then
//   passing         kPassing: how long a bad value usually takes along the graph; 0 at i's own
//   C_i             how long i shows it after its cause is gone (clears_within): at most kLongestEvidence, and its
//                   window more, unless a topic that it watches was received again and has failed anew
//
// Until W_i a cause may still be detected; until Z_i the failure may be the echo of one that is gone.
// After both, nothing more can come, and nothing is waited for. All maxima are found in one pass over
// the condensed graph, producers first.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "diagnose/bit_rows.h"
#include "diagnose/timing.h"

namespace culprit::diagnose {

struct Awaiting {
  Time until = kLongAgo;
  RuleId because;        // the rule that can still fire, or cleared
  bool is_echo = false;  // the latter
  // is_echo: that was down for a strategy of `because`, or in trouble (`because` is the failure itself).
  std::optional<ComponentId> component{};
};

// Z_i of one cause that was `over` then: a rule; empty: the outage of a component.
Time echo_ends(RuleId failure, std::optional<RuleId> cause, Time over, Duration passing,
               const Knowledge& knowledge);

// r_u of a rule whose trigger is false since `gone`.
Time recovered(RuleId rule, Time gone, const Knowledge& knowledge);

class Awaited {
 public:
  // For `failures`, those to be decided about. `knowledge` must outlive it.
  Awaited(const Knowledge& knowledge, std::span<const RuleId> failures);

  // The evidence that can still come for one of them; empty: all of it has come.
  std::optional<Awaiting> of(RuleId failure) const;

 private:
  struct Best {
    Duration within{};
    std::optional<RuleId> rule;  // empty: none
  };
  // The best and the second best of another rule: a failure does not wait for itself.
  struct Two {
    Best first;
    Best second;
    void add(const Best& other);
    void add(const Two& other);
    const Best& without(RuleId rule) const;
  };
  struct Place {
    std::array<Two, 2> own;       // E_u by symptom, of rules at this SCC
    std::array<Two, 2> upstream;  // of those upstream of it
    // The same of rules that cleared lately.
    std::array<Two, 2> own_again;
    std::array<Two, 2> upstream_again;
  };

  void collect(Time latest_onset);
  void find_past(Duration within);
  void place_past();
  void carry();
  void look_at(RuleId failure);
  Awaiting awaiting(RuleId failure) const;
  // For an outage: a value of what its component is declared, or was seen, to depend on. Bad data ends no data,
  // but a rail or a hub that is off does.
  Awaiting of_declared_supplier(RuleId failure, ComponentId consumer) const;
  Awaiting of_learned_supplier(RuleId failure) const;
  // When a bad value of the supplier that ends the failure's data has been shown.
  Time shows_value(RuleId supplier, RuleId failure) const;
  // After the onset, as long as one more reading takes.
  Duration next_reading(const Best& evidence) const;
  // A past event that may still show effects: a failure that cleared, or a component that was down
  // for a strategy, or in trouble.
  struct Past {
    std::optional<RuleId> rule;  // that cleared, or of the strategy
    std::optional<ComponentId> component{};
    Time began{};
    Time over{};
    Symptom symptom{};
  };
  // Until when the failure, to which it takes `passing`, may be the echo of that; kLongAgo: it is none.
  Time fades(RuleId failure, const Past& past, Duration passing) const;
  Time looks_back_until(RuleId failure) const;

  const Knowledge& knowledge_;
  std::vector<Place> places_;  // by SCC; empty: nothing can be awaited
  std::vector<bool> is_circle_;
  std::vector<Past> past_;
  BitRows own_past_{0, 0};  // by SCC: which of them are there, and upstream of it
  BitRows upstream_past_{0, 0};
  std::vector<std::pair<RuleId, Awaiting>> found_;  // ascending
};

}  // namespace culprit::diagnose
