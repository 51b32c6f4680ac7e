// The fleet that a robot shares its outcomes with, as its sessions see it: they report outcomes and
// receive what others learned. No call here blocks.
#pragma once

#include <functional>
#include <string>

#include "language/rule_set.h"
#include "robot/observation.h"

namespace culprit::live {

class Fleet {
 public:
  virtual ~Fleet() = default;

  // The context in which outcomes count, as the journal has it.
  virtual std::string context() const = 0;
  // A session begins, which writes the journal. Both functions may be called on another thread,
  // until ends().
  virtual void begins(const RuleSet& rules, std::function<void(PriorsTold)> priors,
                      std::function<void(const std::string&)> trouble) = 0;
  // It is over: when this returns, nothing more is called.
  virtual void ends() = 0;
  // Events are in the journal, or will be soon.
  virtual void happened() = 0;
};

}  // namespace culprit::live
