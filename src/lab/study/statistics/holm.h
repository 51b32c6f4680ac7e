// Holm's correction for several tests (Holm: "A Simple Sequentially Rejective Multiple Test
// Procedure", 1979).
//
//     p_(1) <= ... <= p_(m):   adjusted p_(i) = max over j <= i of min(1, (m - j + 1) p_(j))
//
// Rejecting where the adjusted p is below 5 % keeps the chance of any false rejection below 5 %.
#pragma once

#include <span>
#include <vector>

namespace culprit::study {

// In the order of `p`. @pre each is in [0, 1]
std::vector<double> holm(std::span<const double> p);

}  // namespace culprit::study
