#include "study/paper_claims.h"

#include <algorithm>
#include <array>

#include <fmt/core.h>

#include "study/statistics/rank_correlation.h"

namespace culprit::study {
namespace {

constexpr double kMarginInSd = 0.5;
constexpr double kRateMargin = 0.1;
constexpr double kFewOutcomes = 50;

// In the paper's order of rows.
enum Place : std::size_t { kNone, kS, kC, kCS, kD, kDS, kDC, kDCS };
Place place_of(const PaperSwitches& on) {
  return static_cast<Place>((on.dependencies ? kD : kNone) + (on.criticality ? kC : kNone) +
                            (on.impact ? kS : kNone));
}
constexpr std::array<std::string_view, 8> kNames = {"–––", "––S", "–C–", "–CS",
                                                    "D––", "D–S", "DC–", "DCS"};

class Claimed {
 public:
  Claimed(const Findings& findings, const Ablation& ablation)
      : findings_(findings), ablation_(ablation) {}

  std::vector<Claim> all() &&;

 private:
  static std::size_t column(Metric metric) {
    return static_cast<std::size_t>(
        std::find(kPublishedMetrics.begin(), kPublishedMetrics.end(), metric) -
        kPublishedMetrics.begin());
  }
  const MeanComparison& mean(Place place, Metric metric) const {
    return ablation_.means[place * kPublishedMetrics.size() + column(metric)];
  }
  Group ours(Place place, Metric metric) const {
    return {std::string(kNames[place]), (*mean(place, metric).row)[metric].independent()};
  }
  double margin(Place place, Metric metric) const {
    return kMarginInSd * mean(place, metric).theirs.sd;
  }
  ClaimPart more(Metric metric, Place larger, Place smaller) const {
    return is_more(ours(larger, metric), ours(smaller, metric));
  }
  ClaimPart alike(Metric metric, Place with, Place without) const {
    return is_alike(ours(with, metric), ours(without, metric), margin(without, metric));
  }

  void add(std::string text, std::string test, std::vector<ClaimPart> parts) {
    claims_.push_back({std::move(text), std::move(test), std::move(parts)});
  }
  void add_means(Metric metric);
  void add_order();
  void add_effects();
  void add_no_effect(const char* text, published::Factor factor);
  void add_robustness();
  void add_learning();

  const Findings& findings_;
  const Ablation& ablation_;
  std::vector<Claim> claims_;
};

void Claimed::add_means(Metric metric) {
  std::vector<ClaimPart> parts;
  for (std::size_t place = 0; place < kNames.size(); ++place) {
    const auto at = static_cast<Place>(place);
    parts.push_back(is_alike(ours(at, metric),
                             {"paper", published::sample(mean(at, metric).theirs)},
                             margin(at, metric)));
  }
  add(fmt::format("means of {}", traits(metric).title), "TOST", std::move(parts));
}

void Claimed::add_order() {
  constexpr Metric kR = Metric::kRatio;
  constexpr Metric kU = Metric::kUnnecessaryRedeployments;
  std::vector<ClaimPart> highest;
  std::vector<ClaimPart> second;
  std::vector<ClaimPart> lowest;
  std::vector<ClaimPart> minimum;
  for (const Place other : {kNone, kS, kC, kCS, kD, kDS}) {
    highest.push_back(more(kR, kDC, other));
    second.push_back(more(kR, kDCS, other));
    lowest.push_back(more(kU, other, kDCS));
    minimum.push_back(is_below(ours(other, kR), 1));
  }
  highest.push_back(more(kR, kDC, kDCS));
  lowest.push_back(more(kU, kDC, kDCS));
  add("D and C: highest ratio", "Welch", std::move(highest));
  add("D, C and S: next highest ratio", "Welch", std::move(second));
  add("both ratios exceed 1", "t", {is_above(ours(kDC, kR), 1), is_above(ours(kDCS, kR), 1)});
  add("no other ratio reaches 1", "t", std::move(minimum));
  add("D, C and S: fewest unnecessary redeployments", "Welch", std::move(lowest));
}

void Claimed::add_effects() {
  constexpr Metric kR = Metric::kRatio;
  constexpr Metric kT = Metric::kReaction;
  constexpr Metric kU = Metric::kUnnecessaryRedeployments;
  add("D raises the ratio where C is on", "Welch", {more(kR, kDC, kC), more(kR, kDCS, kCS)});
  add("D spares redeployments where C or S is on", "Welch",
      {more(kU, kC, kDC), more(kU, kS, kDS), more(kU, kCS, kDCS)});
  add("C raises the ratio where D is on", "Welch", {more(kR, kDC, kD), more(kR, kDCS, kDS)});
  add("C spares redeployments where D is on", "Welch", {more(kU, kD, kDC), more(kU, kDS, kDCS)});
  add("C delays reactions where only D is on", "Welch", {more(kT, kDC, kD)});
  add("S spares redeployments everywhere", "Welch",
      {more(kU, kNone, kS), more(kU, kD, kDS), more(kU, kC, kCS), more(kU, kDC, kDCS)});
  add("S lowers the ratio of D and C", "Welch", {more(kR, kDC, kDCS)});
  add("S shortens reactions where C is on", "Welch", {more(kT, kC, kCS), more(kT, kDC, kDCS)});
  add_no_effect("D has no other effect", published::Factor::kDependencies);
  add_no_effect("C has no other effect", published::Factor::kCriticality);
  add_no_effect("S has no other effect", published::Factor::kImpact);
  std::vector<ClaimPart> downtime;
  for (const auto& [with, without] : {std::pair(kD, kNone),
                                      {kDC, kC},
                                      {kDS, kS},
                                      {kDCS, kCS},
                                      {kC, kNone},
                                      {kDC, kD},
                                      {kCS, kS},
                                      {kDCS, kDS},
                                      {kS, kNone},
                                      {kDS, kD},
                                      {kCS, kC},
                                      {kDCS, kDC}})
    downtime.push_back(alike(Metric::kDowntime, with, without));
  add("no switch changes the downtime", "TOST", std::move(downtime));
}

// The grey cells of the paper's table of effects. The downtime, which nothing changes, is a claim of its own.
void Claimed::add_no_effect(const char* text, published::Factor factor) {
  std::vector<ClaimPart> parts;
  for (const published::Effect& effect : published::effects()) {
    if (effect.factor != factor) continue;
    for (std::size_t column = 0; column < kPublishedMetrics.size(); ++column) {
      const Metric metric = kPublishedMetrics[column];
      const bool is_grey =
          effect.changes[column].significance == published::Significance::kNotSignificant;
      if (is_grey && metric != Metric::kDowntime)
        parts.push_back(alike(metric, place_of(effect.with), place_of(effect.without)));
    }
  }
  add(text, "TOST", std::move(parts));
}

void Claimed::add_robustness() {
  const Configuration& full = mean(kDCS, Metric::kRatio).row->configuration;
  const Row* off = findings_.campaign.find(
      {full.switches, full.planner, full.profile, Probabilities::kMisspecified});
  if (off == nullptr) return;
  const published::Values printed = *published::values_of(off->configuration);
  std::vector<ClaimPart> means;
  std::vector<ClaimPart> parts;
  for (const Metric metric : kPublishedMetrics) {
    const Group group{"20 % off", (*off)[metric].independent()};
    const published::MeanSd& theirs = printed[column(metric)];
    means.push_back(is_alike(group, {"paper", published::sample(theirs)}, kMarginInSd * theirs.sd));
    parts.push_back(is_alike(group, ours(kDCS, metric), margin(kDCS, metric)));
  }
  add("means with P off by 20 %", "TOST", std::move(means));
  add("P off by 20 % changes nothing", "TOST", std::move(parts));
}

void Claimed::add_learning() {
  std::vector<ClaimPart> parts;
  std::vector<ClaimPart> of_all;
  for (const LearningCurve& curve : findings_.learning) {
    const bool is_named = curve.failure == "F1" || curve.failure == "F4";
    if (!is_named || curve.planner != ablation_.planner || curve.counted < kFewOutcomes) continue;
    const Group learned{curve.strategy, curve.learned.back()};
    parts.push_back(is_near(learned, curve.truth, kRateMargin));
    of_all.push_back(is_near(learned, curve.truth_of_all, kRateMargin));
  }
  if (parts.empty()) return;
  add("learned P of F1 and F4 reach the true rates", "TOST", std::move(parts));
  add("learned P reach the rates of all executions", "TOST", std::move(of_all));
}

std::vector<Claim> Claimed::all() && {
  for (const Metric metric : kPublishedMetrics) add_means(metric);
  add_order();
  add_effects();
  add_robustness();
  add_learning();
  judge(claims_);
  return std::move(claims_);
}

}  // namespace

std::vector<Claim> paper_claims(const Findings& findings, const Ablation& ablation) {
  return Claimed(findings, ablation).all();
}

std::vector<OrderAgreement> order_agreement(const Ablation& ablation) {
  std::vector<OrderAgreement> agreements;
  for (std::size_t column = 0; column < kPublishedMetrics.size(); ++column) {
    OrderAgreement agreement;
    agreement.metric = kPublishedMetrics[column];
    std::vector<Moments> published;
    std::vector<double> ours;
    std::vector<double> theirs;
    for (std::size_t place = 0; place < kNames.size(); ++place) {
      const MeanComparison& mean = ablation.means[place * kPublishedMetrics.size() + column];
      published.push_back(published::sample(mean.theirs));
      theirs.push_back(mean.theirs.mean);
      ours.push_back((*mean.row)[agreement.metric].mean());
    }
    const auto tukey = TukeyHsd::of(std::move(published));
    for (std::size_t a = 0; tukey && a < kNames.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        if (tukey->compare(a, b).p >= 0.05) continue;
        ++agreement.pairs;
        agreement.same += (ours[a] - ours[b]) * (theirs[a] - theirs[b]) > 0 ? 1 : 0;
      }
    }
    agreement.spearman_rho = spearman_rho(ours, theirs);
    agreement.p = spearman_p(ours, theirs);
    agreements.push_back(agreement);
  }
  return agreements;
}

}  // namespace culprit::study
