// Orders a model's entities so that parts come before their systems; or finds a circle, which has
// no such order.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "modes/model.h"

namespace culprit::modes {

struct PartsFirst {
  std::vector<std::size_t> entities;  // all of them, unless there is a circle
  std::vector<std::size_t> circle;    // each is a part of the one before, the first one of the last
};

// @pre each part is in the model
PartsFirst parts_first(const Model& model);

// For people: "/a is a part of itself: /a -> /b -> /a".
std::string describe_circle(const Model& model, const std::vector<std::size_t>& circle);

}  // namespace culprit::modes
