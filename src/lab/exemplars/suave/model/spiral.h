// The search for the pipeline: a spiral around a centre, a point at a time.
//
//     r_0 = 0,  r_n = r_(n-1) + w / 2 pi * 0.1,  angle 0.1 n,  w = 2 altitude tan(30 deg)
//
// w is the width of the stripe that the camera sees from that altitude. Driven by a timer once a
// second; a tick takes at most one step, and only from the vehicle's last goal.
#pragma once

#include <cstdint>
#include <optional>

#include "exemplars/suave/model/position.h"

namespace culprit::suave::model {

class Spiral {
 public:
  static constexpr double kTolerance = 0.4;  // on each axis

  // Begins anew, around `centre`, whose z does not matter.
  void restart(const Position& centre);
  bool has_begun() const { return has_begun_; }

  // A tick of the timer. Gives the setpoint to publish, if there is one.
  std::optional<Position> tick(const Position& vehicle, double altitude);

 private:
  Position next(double altitude);
  Position at_altitude(double altitude) const;

  bool has_begun_ = false;
  Position centre_;
  std::int64_t step_ = 0;
  double radius_ = 0;
  std::optional<Position> goal_;
  std::optional<double> altitude_;
  double lowered_ =
      0;  // how far below the altitude it aims, after an autopilot that did not get up
  int misses_ = 0;
};

}  // namespace culprit::suave::model
