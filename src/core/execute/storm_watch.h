// Have so many components failed at once that acting would do more harm than good?
//
// A storm: many failures, of a component each, that nothing upstream explains (NodeHealthCheck's minHealthy, with the dependency
// graph taken into account). These do not count:
//   - the consumers of a dead camera, also before its own alarm;
//   - exited processes, whose cause is clear;
//   - failures that wait for a rule that can still fire;
//   - failures that began with a trouble that is over.
// Failures that began within `together` count together, although some may have been repaired already.
//
// A graph in doubt: nodes vanished from the graph although their processes run, or those of other computers do not answer
// although these are reachable. Then the network is more likely at fault than all of the nodes.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "diagnose/trouble.h"
#include "knowledge/knowledge.h"

namespace culprit::execute {

class StormWatch {
 public:
  struct Options {
    double share = 0;  // of the components; 0: there are no storms
    int least = 4;     // so few are never a storm
    Duration together = std::chrono::seconds(2);
    Duration calm = std::chrono::seconds(5);  // it is over when it was not seen for so long
  };
  struct Storm {
    Restraint restraint = Restraint::kStorm;
    std::string reason;
  };

  // `knowledge` must outlive the watch.
  StormWatch(const Knowledge& knowledge, EventLog& events, Options options);

  // Tells StormBegan and StormEnded. Looks only when something has happened in this step or since
  // the last look: what makes a storm comes with events.
  void advance(Time now);
  void note(std::span<const Event> events) { has_news_ |= !events.empty(); }
  const std::optional<Storm>& storm() const { return storm_; }

  // Failures that are a storm unless a rule fires that still can: nothing is done for them until then.
  struct Doubt {
    std::vector<RuleId> failures;
    std::string reason;
  };
  const std::optional<Doubt>& doubt() const { return doubt_; }
  Time next_deadline() const { return std::min(storm_ ? over_ : kNever, look_again_); }

 private:
  std::optional<Storm> look(Time now);
  void look_for_dead();
  void look_for_failures(Time now);
  // By component: does it look bad although no rule about it has fired?
  struct Suspects {
    std::vector<bool> rules;  // one may still fire
    std::vector<std::optional<diagnose::TroubleSeen>> troubles;
  };
  Suspects all_suspects() const;
  void add_awaited(Suspects& suspects);
  struct IllRoots {
    std::size_t components = 0;
    std::vector<RuleId> failures{};
  };
  IllRoots ill_roots(const Suspects& suspects) const;
  bool is_explained_by(ComponentId component, RuleId failure, const Suspects& suspects) const;
  bool is_or_was_ill(ComponentId component, RuleId except) const;
  bool is_in_trouble(ComponentId component, RuleId failure, const Suspects& suspects) const;
  bool was_in_trouble(ComponentId component, RuleId failure) const;
  bool has_clear_cause(RuleId failure, ComponentId component) const;
  bool is_much(std::size_t components) const;

  const Knowledge& knowledge_;
  EventLog& events_;
  Options options_;
  std::optional<Storm> storm_;
  std::optional<Doubt> doubt_;
  Time over_ = kNever;
  bool has_news_ = false;
  Time look_again_ = kNever;  // when a failure has waited long enough for a cause upstream
  // By component: the operating system said that its process is gone, and it was not well since.
  std::vector<bool> is_dead_;
  // By rule: of a failure that began within `together`, whether it is there still or not.
  struct Recent {
    Time began = kLongAgo;
    bool has_clear_cause = false;  // its process exited, or its computer was unreachable
  };
  std::vector<Recent> recent_;
  std::vector<RuleId> lately_;  // those rules
};

}  // namespace culprit::execute
