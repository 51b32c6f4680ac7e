#include "knowledge/rivals.h"

namespace culprit {

void Rivals::changed(ComponentId system, std::string before, std::string mode, Time began,
                     Time now) {
  const int set_back = times_set_back(system, before, mode, began);
  changes_[system] = {std::move(before), std::move(mode), now, set_back};
}

bool Rivals::is_left_alone(ComponentId system, Time began) const {
  const auto since = left_alone_.find(system);
  return since != left_alone_.end() && since->second >= began;
}

int Rivals::times_set_back(ComponentId system, const std::string& present, const std::string& mode,
                           Time began) const {
  const auto found = changes_.find(system);
  if (found == changes_.end() || found->second.at < began) return 0;
  const Change& last = found->second;
  const bool is_set_back = last.mode == mode && present == last.before && present != mode;
  return is_set_back ? last.set_back + 1 : 0;
}

}  // namespace culprit
