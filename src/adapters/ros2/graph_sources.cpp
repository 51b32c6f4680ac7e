#include "ros2/graph_sources.h"

#include <algorithm>

namespace culprit::ros2 {

bool GraphSources::has_room(const std::string& source, std::size_t Entries::*what,
                            std::size_t limit, std::size_t more) const {
  std::size_t all = more;
  std::size_t of_strangers = more;
  std::size_t of_this = more;
  bool is_stranger = !source.empty();
  for (const auto& [name, each] : sources_) {
    all += each.*what;
    const bool is_known = name.empty() || each.components > 0;
    if (!is_known) of_strangers += each.*what;
    if (name != source) continue;
    of_this += each.*what;
    is_stranger = !is_known;
  }
  if (all >= limit) return false;
  return !is_stranger || (of_strangers < std::max<std::size_t>(limit / 2, 1) &&
                          of_this < std::max<std::size_t>(limit / 4, 1));
}

}  // namespace culprit::ros2
