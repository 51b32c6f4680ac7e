// Notes when troubles of components end (ComponentState::past_trouble): what depends on them needs a
// moment to work again. Only while there are failures, whose plans it is called before.
//
// A topic that becomes slow is not silent, and recovers from nothing. So a silence is over only
// under two conditions. It was longer than kSilentGaps of the gap that is usual once it ended, and no other
// silence begins with the very message that ended it.
#pragma once

#include <vector>

#include "knowledge/knowledge.h"

namespace culprit {

class TroubleWatch {
 public:
  // Both must outlive it.
  TroubleWatch(const Knowledge& knowledge, ComponentStates& components)
      : knowledge_(knowledge), components_(components) {}

  // To be called before each plan. `is_any_failing`: there is a failure to plan for.
  void look(Time now, bool is_any_failing);

 private:
  struct Open {
    ComponentId component;
    Time since{};
    std::optional<TopicId> topic;  // of a silence
    Time last{};  // its last message before, or once it is over: the one that ended it
  };

  void open(Open found);
  void close(Open trouble, Time now);

  const Knowledge& knowledge_;
  ComponentStates& components_;
  std::vector<Open> open_;
  std::vector<Open> over_;  // silences that count as over, until a second message comes
};

}  // namespace culprit
