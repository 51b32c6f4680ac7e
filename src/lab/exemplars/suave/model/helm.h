// The interface of the functions to the rest of the robot, wherever it runs: in the same model, or
// in another process.
#pragma once

#include <cstddef>
#include <optional>

#include "exemplars/suave/model/position.h"

namespace culprit::suave::model {

class Helm {
 public:
  virtual ~Helm() = default;

  // The vehicle's estimate of its position.
  virtual Position seen() const = 0;
  virtual void go_to(const Position& goal) = 0;
  // Where the spiral is centred; nothing while that is not known yet.
  virtual std::optional<Position> centre() const = 0;
  // The pipeline's point that was seen first; nothing while none was.
  virtual std::optional<std::size_t> found() const = 0;
  // `thruster` counts from 1.
  virtual void recover(int thruster) = 0;
  // Fills the battery; at the charging station.
  virtual void recharge() = 0;
};

}  // namespace culprit::suave::model
