#include "study/plot/distribution_plot.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/core.h>

#include "base/invariant.h"
#include "study/plot/histogram.h"
#include "study/plot/scale.h"
#include "study/published.h"

namespace culprit::study {
namespace {

// Pixels.
constexpr double kAxisWidth = 420;
constexpr double kMargin = 56;        // behind the axis
constexpr double kLetterWidth = 6.7;  // at most, on average
constexpr double kTop = 40;
constexpr double kRowHeight = 58;
constexpr double kBarHeight = 30;
constexpr double kBottom = 34;
constexpr double kWidestBar = 28;

constexpr int kContinuousBins = 60;
constexpr int kMostIntegerBins = 200;
constexpr double kShownShare = 0.995;  // of a row; what lies beyond is told in numbers

std::optional<published::MeanSd> theirs(const Row& row, Metric metric) {
  const auto values = published::values_of(row.configuration);
  const auto i = static_cast<std::size_t>(metric);
  if (!values || i >= values->size()) return std::nullopt;
  return (*values)[i];
}

struct Range {
  double low = 0;  // zero is always shown
  double high = 0;

  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

Range shown_range(const CampaignResult& result, Metric metric) {
  Range range;
  for (const Row& row : result.rows) {
    const Summary& summary = row[metric];
    if (summary.count() > 0) range.include(summary.mean());
    if (summary.distribution().count() > 0) {
      range.include(summary.distribution().counts().begin()->first);
      range.include(summary.distribution().quantile(kShownShare));
    }
    if (const auto value = theirs(row, metric)) {
      range.include(value->mean - value->sd);
      range.include(value->mean + value->sd);
    }
  }
  if (range.high == range.low) range.high = range.low + 1;
  return range;
}

Bins bins_of(const Range& range, Metric metric) {
  if (traits(metric).is_integer && range.high - range.low < kMostIntegerBins) {
    const double low = std::floor(range.low);
    return {low - 0.5, 1, static_cast<int>(std::ceil(range.high) - low) + 1};
  }
  // A last bin more, so that the highest value is in one.
  return {range.low, (range.high - range.low) / kContinuousBins, kContinuousBins + 1};
}

// Of the axis: the labels of the rows are before it.
double left_of(const CampaignResult& result) {
  std::size_t longest = 0;
  for (const Row& row : result.rows) longest = std::max(longest, label(row.configuration).size());
  return 24 + kLetterWidth * static_cast<double>(longest);
}

class Plot {
 public:
  Plot(const CampaignResult& result, Metric metric)
      : result_(result),
        metric_(metric),
        bins_(bins_of(shown_range(result, metric), metric)),
        left_(left_of(result)),
        right_(left_ + kAxisWidth),
        x_{bins_.low, bins_.high(), left_, right_},
        bottom_(kTop + kRowHeight * static_cast<double>(result.rows.size())),
        svg_(right_ + kMargin, bottom_ + kBottom, traits(metric).title,
             std::string("Histogram for each configuration. ") +
                 std::string(traits(metric).explanation)) {}

  Svg draw() && {
    legend();
    axis();
    for (std::size_t i = 0; i < result_.rows.size(); ++i)
      row(result_.rows[i], kTop + kRowHeight * static_cast<double>(i));
    return std::move(svg_);
  }

 private:
  void legend() {
    constexpr double kY = 16;
    svg_.circle({left_ + 8, kY}, 4, "ours");
    svg_.line({left_, kY}, {left_ + 16, kY}, "ours");
    svg_.text({left_ + 24, kY + 4}, Anchor::kStart, "small", "our mean, 95 % interval");
    const bool has_theirs =
        std::any_of(result_.rows.begin(), result_.rows.end(),
                    [&](const Row& r) { return theirs(r, metric_).has_value(); });
    if (!has_theirs) return;
    whisker(left_ + 190, left_ + 206, kY, "theirs");
    diamond({left_ + 198, kY});
    svg_.text({left_ + 214, kY + 4}, Anchor::kStart, "small", "the paper's mean ± 1 sd");
  }

  void axis() {
    for (const double tick : ticks(x_.low, x_.high, 8)) {
      if (traits(metric_).is_integer && tick != std::round(tick)) continue;
      svg_.line({x_(tick), kTop - 6}, {x_(tick), bottom_}, "grid");
      svg_.text({x_(tick), bottom_ + 16}, Anchor::kMiddle, "small", tick_label(tick));
    }
    svg_.text({right_, bottom_ + 31}, Anchor::kEnd, "small", traits(metric_).title);
  }

  void row(const Row& row, double top) {
    const double base = top + kBarHeight + 4;
    svg_.text({left_ - 12, base - 8}, Anchor::kEnd, "label", label(row.configuration));
    svg_.line({left_, base}, {right_, base}, "axis");
    const Summary& summary = row[metric_];
    if (summary.count() == 0) {
      svg_.text({left_ + 6, base - 8}, Anchor::kStart, "small", "no values");
      return;
    }
    bars(summary, base);
    notes(summary, base);
    ours(summary, base + 7);
    if (const auto value = theirs(row, metric_)) {
      whisker(x_(value->mean - value->sd), x_(value->mean + value->sd), base + 15, "theirs");
      diamond({x_(value->mean), base + 15});
    }
  }

  void bars(const Summary& summary, double base) {
    const Histogram counts = histogram(summary.distribution(), bins_);
    const auto highest = static_cast<double>(std::max<std::int64_t>(counts.highest(), 1));
    for (std::size_t i = 0; i < counts.counts.size(); ++i) {
      if (counts.counts[i] == 0) continue;
      const double begin = x_(bins_.low + bins_.width * static_cast<double>(i));
      const double end = x_(bins_.low + bins_.width * static_cast<double>(i + 1));
      const double gap = std::max(std::min(1.0, (end - begin) / 5), end - begin - kWidestBar);
      const double height =
          std::max(1.0, kBarHeight * static_cast<double>(counts.counts[i]) / highest);
      svg_.rectangle({begin + gap / 2, base - height}, end - begin - gap, height, "bar");
    }
  }

  // Statistics that the histogram does not show.
  void notes(const Summary& summary, double base) {
    const std::int64_t beyond = histogram(summary.distribution(), bins_).beyond;
    if (beyond > 0)
      svg_.text({right_ + 4, base - 14}, Anchor::kStart, "small", fmt::format("+{} ▸", beyond));
    if (summary.censored() > 0)
      svg_.text({right_ + 4, base}, Anchor::kStart, "small",
                fmt::format("{} never", summary.censored()));
  }

  void ours(const Summary& summary, double y) {
    if (const auto interval = summary.interval())
      whisker(x_(interval->low), x_(interval->high), y, "ours");
    svg_.circle({x_(summary.mean()), y}, 3, "ours");
  }

  void whisker(double begin, double end, double y, std::string_view css_class) {
    const double left = std::max(begin, left_);
    const double right = std::min(end, right_);
    svg_.line({left, y}, {right, y}, css_class);
    if (left == begin) svg_.line({left, y - 3}, {left, y + 3}, css_class);
    if (right == end) svg_.line({right, y - 3}, {right, y + 3}, css_class);
  }

  void diamond(Point at) {
    svg_.polygon({{at.x - 4, at.y}, {at.x, at.y - 4}, {at.x + 4, at.y}, {at.x, at.y + 4}},
                 "theirs");
  }

  const CampaignResult& result_;
  Metric metric_;
  Bins bins_;
  double left_;
  double right_;
  Scale x_;
  double bottom_;
  Svg svg_;
};

}  // namespace

bool has_values(const CampaignResult& result, Metric metric) {
  return std::any_of(result.rows.begin(), result.rows.end(),
                     [&](const Row& row) { return row[metric].count() > 0; });
}

Svg distribution_plot(const CampaignResult& result, Metric metric) {
  CULPRIT_ASSERT(has_values(result, metric));
  return Plot(result, metric).draw();
}

}  // namespace culprit::study
