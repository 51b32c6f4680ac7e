#include "language/type_classes.h"

#include <utility>

namespace culprit {

TypeClasses::Variable TypeClasses::add(std::optional<Type> type) {
  const auto v = static_cast<Variable>(nodes_.size());
  nodes_.push_back({v, 1, type});
  return v;
}

void TypeClasses::learn(Variable v, Type type) {
  auto& known = nodes_[root(v)].type;
  if (known || type == Type::kDuration) return;
  known = type == Type::kInt ? Type::kDouble : type;
}

void TypeClasses::unify(Variable a, Variable b) {
  if (const auto type = type_of(a)) return learn(b, *type);
  if (const auto type = type_of(b)) return learn(a, *type);
  Variable large = root(a);
  Variable small = root(b);
  if (large == small) return;
  if (nodes_[large].size < nodes_[small].size) std::swap(large, small);
  nodes_[small].parent = large;
  nodes_[large].size += nodes_[small].size;
}

TypeClasses::Variable TypeClasses::root(Variable v) const {
  while (nodes_[v].parent != v) v = nodes_[v].parent;
  return v;
}

}  // namespace culprit
