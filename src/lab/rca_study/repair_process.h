// A small robot of the benchmark as a decision process: the possible actions, their costs, and the
// knowledge of the hidden truth after each outcome. The optimum (optimum.h) is worked out in it,
// and every planner's regret.
//
// Hidden truth: F, the components that have a fault now; the kind of each fault; and E, which
// subscriptions pass failures on in this episode. At the beginning F is any set of as many
// components as the scenario has faults. Each fault is of any of the seven kinds, equally likely,
// and subscription e passes with its probability q_e. F only becomes smaller.
//
// Seen: which components are ill, which F and E determine (rca_scenario.h), and whose process is gone,
// which a crash shows. Detectors make no mistakes, and what is seen has settled.
//
// A round: strategies s in a set A, each at an ill component c, begin together; then all is seen
// again. A fault is gone with the probability
//
//     sigma(c, s) = sum_k p_k prod_t (1 - h_tk)^m_t h_sk / sum_k p_k prod_t (1 - h_tk)^m_t
//
//   k      the kinds that the fault can be of: a crash if the process is gone, else any other
//   p_k    their shares, equal
//   h_tk   how likely treatment t helps against kind k: the scenario's truth
//   m_t    how often t was tried at c in vain
//
// independently of the others; so the counts m are all that is known of kinds. The knowledge of F
// and E is a belief b(F, E). An outcome o (which components are ill, which processes are gone)
// changes it by Bayes' rule:
//
//     b'(F', E) ~ sum_F b(F, E) prod_{c in A, c in F} (sigma if c not in F', 1 - sigma if it is)
//
// over those F' and E that show o. With b and m nothing else of the past matters.
//
// A round may begin what culprit's planners allow: strategies that are valid, were not tried in
// this round of the rule, one for each component. None may be at a component that depends on
// another's of A, unless its process is gone. When all were tried they may be tried again, up to
// kTurns times each; then no strategy is left.
//
// A round costs, in the weights of the objective (plan/bayes/objective.h),
//
//     w_time g(x) max_{s in A} i_s / i_max + sum_{s in A} (w_attempt + w_redeployment [s replaces a
//     process] + w_disruption (share of the robot that s takes down))
//
//     g(x) = max_{c ill in x} W_c / W_ERROR
//
//   W_c    1, 2 or 4 by the criticality of the rule of c (plan/bayes/value.h)
//
// So a second in which an ERROR is there costs as much as two with nothing worse than a WARNING. A
// robot that is left ill, because nothing is left or nothing is begun, costs the scenario's whole
// time, weighted by g(x), ten strategies and ten processes.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "knowledge/knowledge.h"
#include "plan/bayes/objective.h"
#include "rca_study/rca_scenario.h"

namespace culprit::study::rca {

using Members = std::uint32_t;  // a set of components, or of subscriptions: one bit for each

// The state of knowledge after some rounds.
struct Situation {
  struct Tries {
    std::uint8_t tried = 0;  // in this turn: a bit for each treatment
    std::uint8_t turns = 0;  // how often all were tried
    bool operator==(const Tries&) const = default;
  };
  struct Hypothesis {
    Members faulty = 0;
    Members passing = 0;
    double weight = 0;  // the probability; those of a situation sum to one
  };

  Members ill = 0;
  Members gone = 0;
  std::vector<Tries> tries;        // by component; nothing for those that are well
  std::vector<Hypothesis> belief;  // by faulty and passing
};

// A strategy for each of some components.
struct Treated {
  std::size_t component = 0;
  std::size_t treatment = 0;  // place in its treatments
};
using Round = std::vector<Treated>;

class RepairProcess {
 public:
  static constexpr std::size_t kMostComponents = 5;
  static constexpr std::size_t kMostSubscriptions = 9;
  static constexpr std::size_t kMostFaults = 3;
  static constexpr int kTurns = 2;

  // Can it be worked out for this robot? Not with common causes, false alarms that last, or
  // components without a rule.
  static bool is_small(const RcaScenario& scenario);

  // Both must outlive it. `rules` are those of the scenario. @pre is_small(scenario)
  RepairProcess(const RcaScenario& scenario, const RuleSet& rules, Objective objective);

  struct Outcome {
    double probability = 0;
    Situation situation;
  };
  // The possible first observations, before any action.
  std::vector<Outcome> beginnings() const;
  std::vector<Outcome> outcomes(const Situation& situation, const Round& round) const;

  // All that may begin: never empty while is_open().
  std::vector<Round> rounds(const Situation& situation) const;
  double cost(const Situation& situation, const Round& round) const;
  double cost_of_leaving_it_ill(const Situation& situation) const;

  // The situation if it were revealed for good which components have a fault: only those are ill,
  // as if no subscription passed anything on. No way on costs less than on average over the
  // possible revelations: fewer are ill, so time weighs no more. `faulty` is one of its
  // hypotheses'.
  Situation told(const Situation& situation, Members faulty) const;
  // The same without a revelation: the observations show it for good, and no effect is more
  // critical than every fault. Returns nothing otherwise, or if this is such a situation already.
  std::optional<Situation> told_by_itself(const Situation& situation) const;
  // Is it such a situation?
  bool is_told(const Situation& situation) const;

  // Is any component ill for which a strategy is left to try?
  bool is_open(const Situation& situation) const;
  // Is nothing left to try at this component?
  bool is_exhausted(const Situation& situation, std::size_t component) const;

  // Adds the edges of the graph, as a manager sees it.
  void connect(DependencyGraph& graph) const;
  // A manager's knowledge in a situation. `knowledge` is of the same rules.
  void show(const Situation& situation, Knowledge& knowledge) const;
  // The inverse: the observations and tries by now, with the belief that follows from them alone.
  // Empty while the observations have not settled, so that no hypothesis explains them.
  std::optional<Situation> situation_of(const Knowledge& knowledge) const;

  std::size_t size() const { return scenario_.components.size(); }

 private:
  struct Way {
    Members from = 0;
    std::size_t to = 0;
    double passes = 0;
    bool is_redundant = false;
  };
  using Seen = std::pair<Members, Members>;  // ill, gone
  using Sorted = std::map<Seen, std::vector<Situation::Hypothesis>>;

  double gravity(Members ill) const { return gravity_[ill]; }
  Members spread(Members faulty, Members passing) const;
  std::size_t place(Members faulty, Members passing) const {
    return faulty << paths_.size() | passing;
  }
  Members ill(Members faulty, Members passing) const { return ill_[place(faulty, passing)]; }
  // The first set of subscriptions that can never be distinguished from `passing` as long as there
  // are no other faults than these.
  Members alike(Members faulty, Members passing) const { return alike_[place(faulty, passing)]; }
  void tell_apart();
  double probability_of(Members passing) const;
  double likelihood(const Situation& situation, std::size_t component) const;
  double success(const Situation& situation, const Treated& treated) const;
  std::uint8_t valid(const Situation& situation, std::size_t component) const;
  std::vector<int> vain(const Situation& situation, std::size_t component) const;
  Situation settled(Seen seen, std::vector<Situation::Hypothesis> belief,
                    std::vector<Situation::Tries> tries) const;
  bool interferes(const Situation& situation, std::size_t a, std::size_t b) const;

  const RcaScenario& scenario_;
  const RuleSet& rules_;
  CostWeights weights_;
  std::vector<double> gravity_;  // g, by ill
  std::vector<Way> paths_;
  std::vector<Members> upstream_;  // by component, by the graph
  std::vector<std::size_t> dependents_;
  std::vector<Members> ill_;            // by faulty and passing
  std::vector<Members> alike_;          // as well
  std::vector<std::size_t> redundant_;  // by component: how many sources have to be ill together
};

}  // namespace culprit::study::rca
