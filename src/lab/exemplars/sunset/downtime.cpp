#include "exemplars/sunset/downtime.h"

namespace culprit::sunset {

void Downtime::on_output(Time at) {
  if (first_) {
    between_ += counted(at - last_);
  } else {
    first_ = at;
  }
  last_ = at;
}

Duration Downtime::total(Time now) const {
  if (!first_) return counted(now - begin_);
  return counted(*first_ - begin_) + between_ + counted(now - last_);
}

}  // namespace culprit::sunset
