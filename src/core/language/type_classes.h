// Infers the types of signals and parameters from their uses.
//
// A use gives the type of a variable, or shows that two variables have one type, whichever it is.
// Such variables make one class, and a type that is learned for one holds for all (union-find, by
// size). So one walk over the rules finds every type, in whatever order the uses come.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "language/program.h"

namespace culprit {

class TypeClasses {
 public:
  using Variable = std::uint32_t;

  Variable add(std::optional<Type> type);

  std::optional<Type> type_of(Variable v) const { return nodes_[root(v)].type; }

  // A known type stays; the first use counts. Numbers are all doubles, and none are durations.
  void learn(Variable v, Type type);
  // Two that are known to differ stay apart.
  void unify(Variable a, Variable b);

 private:
  struct Node {
    Variable parent;         // itself: it stands for its class
    std::uint32_t size = 1;  // of the class
    std::optional<Type> type;
  };

  Variable root(Variable v) const;

  std::vector<Node> nodes_;
};

}  // namespace culprit
