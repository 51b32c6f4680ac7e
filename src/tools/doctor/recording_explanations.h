// What findings of recordings mean (D200 to D216), for explanations().
#pragma once

#include <vector>

#include "doctor/explanations.h"

namespace culprit::doctor {

std::vector<Explanation> recording_explanations();

}  // namespace culprit::doctor
