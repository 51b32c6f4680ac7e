#include "modes/model.h"

#include <algorithm>

namespace culprit::modes {
namespace {

template <class T>
const T* find_in(const std::vector<T>& all, std::string_view name) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const T& each) { return each.name == name; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace

std::string to_string(const Target& target) {
  return target.is_active ? "active." + target.mode : "inactive";
}

const Mode* Entity::find(std::string_view mode) const { return find_in(modes, mode); }

const Entity* Model::find(std::string_view name) const { return find_in(entities, name); }

}  // namespace culprit::modes
