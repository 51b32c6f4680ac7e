// Learned success probabilities of one failure's strategies over the experiments, each with the
// true rate (dotted), and with a band of ± 1 sd where the series was repeated.
#pragma once

#include <vector>

#include "study/learning.h"
#include "study/plot/svg.h"

namespace culprit::study {

// @pre curves is not empty; all are of one failure, and of equal length
Svg learning_plot(const std::vector<LearningCurve>& curves);

}  // namespace culprit::study
