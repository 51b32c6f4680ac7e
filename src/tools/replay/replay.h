// A recorded run once more: through the same manager, which has to decide the same; or with other
// rules or another planner, to see what they would have decided.
#pragma once

#include <functional>

#include "manager/manager.h"
#include "replay/recording.h"

namespace culprit::replay {

// How free the manager is to act.
struct Freedom {
  Autonomy autonomy = Autonomy::kAdvise;
  Governor::Options governor{};
};

// A manager as it was, or would have been, at the beginning of a recorded run: what was learned
// before, and what the run before had left in the middle.
std::unique_ptr<Manager> manager_for(const journal::Session& session, const RuleSet& rules,
                                     std::unique_ptr<const Planner> planner,
                                     const Freedom& freedom);
// Beliefs grow from the priors of `rules`, or from the recorded ones.
enum class Priors : std::uint8_t { kOfRules, kAsLearned };
void restore(Manager& manager, const journal::Learned& learned, const RuleSet& rules,
             Priors priors = Priors::kOfRules);

using EventSink = std::function<void(const Event&, const RuleSet&)>;

struct Repetition {
  std::uint64_t steps = 0;
  std::uint64_t observations = 0;
  std::uint64_t decisions = 0;  // steps that decided anything
  std::string digest;           // of all decisions
  struct Difference {
    std::int64_t row = 0;
    Time at{};
    std::vector<std::string> recorded;  // what was said then
    std::vector<std::string> repeated;
  };
  std::optional<Difference> difference;  // the first one; nothing: all is the same
  bool has_gap = false;
};

// Repeats the run exactly, under the governor that it had. Stops at the first difference. Errors:
// the file cannot be read.
Expected<Repetition> repeat(Recording& recording, const journal::Reader& journal,
                            std::unique_ptr<const Planner> planner,
                            const Governor::Options& governor, const EventSink& sink = {});

// The examined part of a run.
struct Stretch {
  Time from = kLongAgo;    // what was before is known, but for the messages of topics
  Time* newest = nullptr;  // is told when the last step was
  Time until = kNever;     // later steps are left out
  // Called after each step; returns when it wants to look again at the latest.
  std::function<Time(const Manager&)> look{};
};

// The advice of `rules` and `planner` about the observations of the run. A recording cannot change,
// so they only advise: a failure lasts as long as it did then. `rules` must outlive the call;
// returns the inputs that they read and the recording lacks.
Expected<std::vector<std::string>> advise(Recording& recording, const RuleSet& rules,
                                          std::unique_ptr<const Planner> planner,
                                          const EventSink& sink, Stretch stretch = {});

}  // namespace culprit::replay
