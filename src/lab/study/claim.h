// A claim of the paper's evaluation, and the verdict of our runs on it.
//
// A claim has parts and holds only if every part holds. Each part is tested in both directions:
//
//     p          one-sided, that the part holds:          small if our runs support it
//     p_against  one-sided, that the opposite holds:      small if our runs contradict it
//
//     p of the claim          the largest p of its parts (intersection-union test)
//     p against the claim     the smallest p_against times the number of parts (Bonferroni)
//
// judge() corrects both over all claims of a table by Holm's method. A claim whose tests are not
// significant in either direction is open: the absence of a difference is never taken as equality.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "study/statistics/moments.h"

namespace culprit::study {

// A sample with the name that tables print.
struct Group {
  std::string name;
  Moments values;
};

enum class Comparison : std::uint8_t {
  kMore,
  kAlike,
  kAbove,
  kBelow,
  kNear
};  // as the functions below

struct ClaimPart {
  std::string shown;  // "DC– 1.21 > DCS 0.96, g 0.66"
  double p = 1;
  double p_against = 1;
  // For others who compute it again.
  Comparison comparison = Comparison::kMore;
  Group first{};
  Group second{};     // empty if there is one sample: then its mean is compared with `bound`
  double bound = 0;   // of one sample
  double margin = 0;  // of kAlike and kNear
};

// The mean of `larger` is above that of `smaller` (Welch). g is Hedges' effect size.
ClaimPart is_more(const Group& larger, const Group& smaller);
// The means differ by less than `margin` (two one-sided tests). Against it: they differ by more.
ClaimPart is_alike(const Group& ours, const Group& other, double margin);
// The mean is above, below, or within `margin` of `bound` (one sample).
ClaimPart is_above(const Group& group, double bound);
ClaimPart is_below(const Group& group, double bound);
ClaimPart is_near(const Group& group, double bound, double margin);

// (mean_b - mean_a) / pooled sd, with Hedges' correction for small samples; 0 without any spread.
double hedges_g(const Moments& a, const Moments& b);

enum class Verdict : std::uint8_t { kHolds, kOpen, kContradicted };
std::string_view to_string(Verdict verdict);  // "holds", "open", "contradicted"

struct Claim {
  std::string text;
  std::string test;  // how, in a few words
  std::vector<ClaimPart> parts;

  // By judge().
  double p = 1;          // corrected
  double p_against = 1;  // corrected
  Verdict verdict = Verdict::kOpen;

  // The part that decides: the strongest against a contradicted claim, else the weakest for it.
  const ClaimPart& decisive() const;
  // The number of parts that are significant by themselves, without a correction.
  std::size_t supported() const;
};

// Fills in p, p_against and the verdicts. @pre each claim has a part
void judge(std::vector<Claim>& claims);

}  // namespace culprit::study
