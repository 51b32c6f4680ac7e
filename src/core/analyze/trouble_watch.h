// Notes when troubles of components end (ComponentState::past_trouble): what depends on them needs a
// moment to work again. Only while there are failures: the end of a trouble is noted when it is seen,
// and without plans nobody looks.
//
// A topic that becomes slow is not silent, and recovers from nothing: its silence ends only as
// SignalStore::Rhythm::silence says.
#pragma once

#include <optional>
#include <vector>

#include "knowledge/knowledge.h"

namespace culprit {

class TroubleWatch {
 public:
  // Both must outlive it.
  TroubleWatch(const Knowledge& knowledge, ComponentStates& components)
      : knowledge_(knowledge), components_(components) {}

  // To be called before each plan, and in each step that has nothing to plan. `is_any_failing`: there is
  // a failure to plan for.
  void look(Time now, bool is_any_failing);

 private:
  struct Open {
    ComponentId component;
    Time since{};
    std::optional<TopicId> topic;  // of a silence
    bool is_of_values = false;     // TroubleSeen::is_of_values() ever since
  };

  void note_silences_before(Time now);
  void close(const Open& trouble, Time now);
  bool is_over(const Open& silence) const;
  void withdraw();

  const Knowledge& knowledge_;
  ComponentStates& components_;
  std::vector<Open> open_;
  std::vector<Open> over_;  // silences that may yet turn out to be slow messages
  bool is_watching_ = false;
};

}  // namespace culprit
