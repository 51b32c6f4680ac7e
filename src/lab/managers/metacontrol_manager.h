// MROS 2, the Metacontrol of SUAVE: an ontology of functions and their designs, reasoned over every
// 1.5 s.
//
// Where its delays come from: the period of the reasoner, whose phase is constant within a run; and
// the inference over the whole ontology, during which nothing is decided. Errors of components take
// effect through the inference, so they wait for one that began after them. The search is always to
// be improved, and its design is chosen after the inference by what was measured last.
#pragma once

#include "managers/suave_manager.h"

namespace culprit::study {

class MetacontrolManager : public SuaveManager {
 public:
  explicit MetacontrolManager(const Setting& setting);

 private:
  Routine follow_tasks();
  Routine reason();
  Routine reason_once();
  // The best design of a function, by the known states of components and the measurements; empty:
  // none.
  std::string best_design(const std::string& function, bool is_thruster_failed) const;

  std::map<std::string, std::string> objectives_;  // by function, its design; empty: ungrounded
};

}  // namespace culprit::study
