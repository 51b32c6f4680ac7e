// Nodes that are wrong now, and which of them may cause which others.
//
// Nodes are
//   - failures: rules that fired, also exhausted ones whose trigger is true;
//   - imminent rules (imminent.h): what they read looks bad, and they have not fired yet;
//   - troubles (trouble.h) of components that no failure touches, or that began kUsualDelay after the
//     last one that does: a supplier needs no rule, and one that was slow for long may be dead now;
//   - inputs without a supplier: a failing rule that never saw its function work, of a component
//     that reads a topic or calls a service that no node offers; or, while a component was never seen, one
//     upstream of it.
//
// Node j may be the cause of node i if a component of j is upstream of one of i, along a path that
// the effect can have taken (paths.h). Criticality does not matter: the effects decide how bad a
// cause is (plan/bayes/levels.h). Two exceptions: a bad value whose strategies begin nothing anew and call
// nothing is no cause of a more critical failure; and a rule that only reports, or is exhausted, is no cause of one
// that watches the same and adapts the same. Two failures that were seen to clear together count as if they
// were connected, although the graph shows no edge. A cause begins before its effect (timing.h), or,
// if the effect outlasts an earlier cause or its own component's new beginning, before that.
// Nodes that may be the causes of each other, directly or through others, form a feedback loop. It
// needs no loop in the graph, because a rule may touch several components.
//
// Rules are in the order of their names, components in that of theirs, so that nothing depends on the
// order of declarations.
#pragma once

#include <string>
#include <vector>

#include "diagnose/paths.h"

namespace culprit::diagnose {

inline constexpr std::size_t kLevels = 3;  // of criticality

// An effect usually follows its cause within this time. If it was seen to be well for n times as long
// while the cause was there, it is 1/n as likely to be one; an outage 1/n^2, since it follows its cause
// at once or after a timeout, and a bad value may come slowly.
inline constexpr Duration kUsualDelay = std::chrono::seconds(5);
// Learned couplings off the graph count from this mean on.
inline constexpr double kKnownCoupling = 0.3;

struct CauseNode {
  enum class Kind : std::uint8_t { kFailure, kImminent, kTrouble, kUnsupplied };
  Kind kind = Kind::kFailure;
  RuleId rule;              // of a failure, or imminent; kUnsupplied: the failure
  ComponentId component{};  // kTrouble: that is in trouble; kUnsupplied: that lacks its input
  Trouble trouble{};        // kTrouble
  std::string channel{};    // kUnsupplied: the topic or service
  Onset onset;
  Time worked_until = kLongAgo;  // of a rule: when it was seen to be well last
  Time first_onset = kNever;     // of a rule: the latest onset of its first detection
  // The latest onset of the first trouble of its components, which became another one since; kNever: of none.
  Time troubled_since = kNever;
  // Of a failure: when its component began anew, a cause of it cleared, or a strategy for it failed, and it was there still.
  Time unclear_until = kLongAgo;
  bool is_outage = false;  // of a rule: that reads no values

  bool is_rule() const { return kind == Kind::kFailure || kind == Kind::kImminent; }
};

class Causes {
 public:
  // `reach` holds all components that these nodes touch; `paths` are made of it.
  Causes(const Knowledge& knowledge, const Reach& reach, const Paths& paths,
         std::span<const RuleId> imminent, std::span<const std::optional<TroubleSeen>> troubles);

  std::size_t size() const { return nodes_.size(); }
  const CauseNode& operator[](std::size_t i) const { return nodes_[i]; }
  bool holds(RuleId rule) const { return places_[rule.index] != kAbsent; }
  // For a failure or an imminent rule. @pre holds(rule)
  std::size_t index_of(RuleId rule) const;

  // The possible causes of node i outside its own loop.
  std::span<const Word> causes(std::size_t i) const { return causes_[i]; }
  // Is j a possible cause of i only because of what was learned?
  bool is_learned(std::size_t j, std::size_t i) const { return has(learned_[i], j); }
  // How likely i is an effect of j although it stayed well for this long beside j, relative to one
  // that came in the usual time: 0..1.
  double timely(std::size_t j, std::size_t i) const;

  // The nodes of feedback loop c; most consist of one.
  std::size_t loop_of(std::size_t i) const { return loop_of_[i]; }
  const std::vector<std::vector<std::size_t>>& loops() const { return loops_; }

 private:
  static constexpr std::size_t kAbsent = static_cast<std::size_t>(-1);

  void add_rules(const Knowledge& knowledge, std::span<const RuleId> imminent);
  void add_troubles(const Knowledge& knowledge,
                    std::span<const std::optional<TroubleSeen>> troubles);
  void outlast_troubles(const Reach& reach, const Knowledge& knowledge);
  void add_unsupplied(const Knowledge& knowledge);
  void connect(const Knowledge& knowledge, const Reach& reach, const Paths& paths);
  void connect_learned(const Knowledge& knowledge, std::size_t i);
  void leave_out_slight(const Knowledge& knowledge);
  bool can_explain(std::size_t j, std::size_t i, const Knowledge& knowledge) const;
  bool may_be_effect(std::size_t silent, std::size_t i, const Reach& reach,
                     const Knowledge& knowledge) const;
  bool can_precede(std::size_t j, std::size_t i, const Knowledge& knowledge) const;
  bool comes_back(std::size_t j, std::size_t i, const Knowledge& knowledge) const;
  void find_loops(const BitRows& effects);

  std::vector<CauseNode> nodes_;
  std::vector<std::size_t> places_;  // in nodes_, by RuleId
  BitRows causes_{0, 0};
  BitRows learned_{0, 0};
  std::vector<std::size_t> loop_of_;
  std::vector<std::vector<std::size_t>> loops_;
};

}  // namespace culprit::diagnose
