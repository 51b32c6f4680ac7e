// The studentized range: how far apart the largest and the smallest of k equal means come to lie by
// chance, in units of their estimated standard error. Tukey's HSD is judged by it.
//
//     Q = (max Z_i - min Z_i) / S,   Z_1..Z_k ~ N(0, 1),   v S^2 ~ chi^2_v,   all independent
//
//     P(Q > q) = Int f_S(s) R(q s) ds,    R(w) = P(max Z_i - min Z_i > w)
//     R(w) = k Int phi(z) [ Phi(z)^(k-1) - (Phi(z) - Phi(z - w))^(k-1) ] dz
//
// The difference of powers is taken apart as (a - b)(a^(n-1) + ... + b^(n-1)), where a - b is
// Phi(z - w): so a tail down to 1e-15 keeps its digits, where 1 - P(Q <= q) would be left with
// noise. Source: D. E. Lund, J. R. Lund: "Algorithm AS 190", Applied Statistics 32 (1983), for the
// two integrals; the outer one is done by Boost's adaptive Gauss-Kronrod quadrature.
#pragma once

namespace culprit::study {

// P(Q > q) for `groups` >= 2 means and `degrees` > 0 degrees of freedom; R's ptukey(q, groups,
// degrees, lower.tail = FALSE). 1 for q <= 0.
double studentized_range_tail(double q, int groups, double degrees);

// The q that is exceeded with `probability` in (0, 1); R's qtukey(1 - probability, groups,
// degrees).
double studentized_range_quantile(double probability, int groups, double degrees);

}  // namespace culprit::study
