#include "knowledge/rivals.h"

namespace culprit {

void Rivals::changed(const Subject& subject, Value before, Value value, Time began, Time now) {
  const int set_back = times_set_back(subject, before, value, began);
  changes_[subject] = {std::move(before), std::move(value), now, set_back};
}

bool Rivals::is_left_alone(const Subject& subject, Time began) const {
  const auto since = left_alone_.find(subject);
  return since != left_alone_.end() && since->second >= began;
}

const Value* Rivals::ours(const Subject& subject) const {
  const auto change = changes_.find(subject);
  return change == changes_.end() ? nullptr : &change->second.value;
}

int Rivals::times_set_back(const Subject& subject, const Value& present, const Value& value,
                           Time began) const {
  const auto found = changes_.find(subject);
  if (found == changes_.end() || found->second.at < began) return 0;
  const Change& last = found->second;
  const bool is_set_back = last.value == value && present == last.before && present != value;
  return is_set_back ? last.set_back + 1 : 0;
}

}  // namespace culprit
