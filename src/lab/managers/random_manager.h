// SUAVE's Random: a mode of chance for the function of the task, at its begin and every 15 s
// (version 1.5: 30 s).
#pragma once

#include "managers/suave_manager.h"

namespace culprit::study {

class RandomManager : public SuaveManager {
 public:
  explicit RandomManager(const Setting& setting);

 private:
  Routine follow_tasks();
  Routine adapt_periodically();
  Routine adapt();

  Duration period_;
};

}  // namespace culprit::study
