// Sorts, and keeps one of each.
#pragma once

#include <algorithm>
#include <vector>

namespace culprit {

template <class T>
void sort_unique(std::vector<T>& items) {
  std::sort(items.begin(), items.end());
  items.erase(std::unique(items.begin(), items.end()), items.end());
}

}  // namespace culprit
