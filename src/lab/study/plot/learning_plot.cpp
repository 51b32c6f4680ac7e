#include "study/plot/learning_plot.h"

#include <algorithm>

#include <fmt/core.h>

#include "base/invariant.h"
#include "study/plot/scale.h"
#include "study/plot/style.h"

namespace culprit::study {
namespace {

// Pixels.
constexpr double kHeight = 300;
constexpr double kLeft = 50;
constexpr double kRight = 400;
constexpr double kLetterWidth = 6.7;  // at most, on average
constexpr double kTop = 16;
constexpr double kBottom = kHeight - 44;
constexpr double kLeastDistance = 15;  // of two names

// Moves places apart that are too near, in their order, within kTop..kBottom as far as they fit.
std::vector<double> apart(const std::vector<double>& wanted) {
  std::vector<std::size_t> order(wanted.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return wanted[a] < wanted[b]; });
  std::vector<double> places = wanted;
  for (std::size_t i = 1; i < order.size(); ++i)
    places[order[i]] = std::max(places[order[i]], places[order[i - 1]] + kLeastDistance);
  const double too_low = order.empty() ? 0 : std::max(0.0, places[order.back()] - kBottom);
  for (double& place : places) place -= too_low;
  return places;
}

std::string label(const LearningCurve& curve) {
  return fmt::format("{} {:.2f} (true {:.2f})", curve.strategy, curve.believed(), curve.truth);
}

// The labels are behind the axis.
double width(const std::vector<LearningCurve>& curves) {
  std::size_t longest = 0;
  for (const LearningCurve& curve : curves) longest = std::max(longest, label(curve).size());
  return kRight + 20 + kLetterWidth * static_cast<double>(longest);
}

class Plot {
 public:
  explicit Plot(const std::vector<LearningCurve>& curves)
      : curves_(curves),
        x_{0, std::max(1.0, static_cast<double>(curves.front().learned.size())), kLeft, kRight},
        svg_(width(curves), kHeight, "Learned success probabilities of " + curves.front().failure,
             "Probability over experiments for each strategy, with the true rate as a dotted "
             "line.") {}

  Svg draw() && {
    axes();
    std::vector<double> ends;
    for (std::size_t i = 0; i < curves_.size(); ++i) {
      curve(curves_[i], static_cast<int>(i) % kCurveColours);
      ends.push_back(y_(curves_[i].believed()));
    }
    names(apart(ends));
    return std::move(svg_);
  }

 private:
  void axes() {
    for (const double tick : ticks(0, 1, 5)) {
      svg_.line({kLeft, y_(tick)}, {kRight, y_(tick)}, "grid");
      svg_.text({kLeft - 8, y_(tick) + 4}, Anchor::kEnd, "small", tick_label(tick));
    }
    for (const double tick : ticks(x_.low, x_.high, 8))
      svg_.text({x_(tick), kBottom + 18}, Anchor::kMiddle, "small", tick_label(tick));
    svg_.line({kLeft, kBottom}, {kRight, kBottom}, "axis");
    svg_.text({kRight, kBottom + 36}, Anchor::kEnd, "small", "experiments");
    svg_.text({kLeft, kBottom + 36}, Anchor::kStart, "small",
              "success probability; dotted: true rate");
  }

  void curve(const LearningCurve& curve, int colour) {
    std::vector<Point> line = {{x_(0), y_(curve.initial)}};
    std::vector<Point> band = line;
    std::vector<Point> lower_edge;
    for (std::size_t i = 0; i < curve.learned.size(); ++i) {
      const double x = x_(static_cast<double>(i + 1));
      const double mean = curve.learned[i].mean();
      const double sd = curve.learned[i].population_sd();
      line.push_back({x, y_(mean)});
      band.push_back({x, y_(std::min(1.0, mean + sd))});
      lower_edge.push_back({x, y_(std::max(0.0, mean - sd))});
    }
    band.insert(band.end(), lower_edge.rbegin(), lower_edge.rend());
    const bool is_repeated = !curve.learned.empty() && curve.learned.back().count() > 1;
    if (is_repeated) svg_.polygon(band, fmt::format("band{}", colour));
    svg_.line({kLeft, y_(curve.truth)}, {kRight, y_(curve.truth)}, fmt::format("truth{}", colour));
    svg_.polyline(line, fmt::format("curve{}", colour));
  }

  void names(const std::vector<double>& places) {
    for (std::size_t i = 0; i < curves_.size(); ++i) {
      const int colour = static_cast<int>(i) % kCurveColours;
      svg_.line({kRight + 2, y_(curves_[i].believed())}, {kRight + 12, places[i]},
                fmt::format("truth{}", colour));
      svg_.text({kRight + 16, places[i] + 4}, Anchor::kStart, fmt::format("name{}", colour),
                label(curves_[i]));
    }
  }

  const std::vector<LearningCurve>& curves_;
  Scale x_;
  Scale y_{0, 1, kBottom, kTop};
  Svg svg_;
};

}  // namespace

Svg learning_plot(const std::vector<LearningCurve>& curves) {
  CULPRIT_ASSERT(!curves.empty());
  return Plot(curves).draw();
}

}  // namespace culprit::study
