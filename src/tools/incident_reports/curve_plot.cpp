#include "incident_reports/curve_plot.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

#include "base/xml.h"

namespace culprit::incident_reports {
namespace {

// In units of the picture.
constexpr double kPlotWide = 900;
constexpr double kPlotHigh = 118;
constexpr double kLeft = 78;  // for the values
constexpr double kRight = kPlotWide - 14;
constexpr double kTop = 22;  // below the signs of the marks
constexpr double kBottom = 96;
constexpr double kSignWide = 9;  // of the same kind, closer ones are one

constexpr int kMostTicks = 10;
constexpr double kMostAway = 10;  // of a limit that is drawn, in sizes of what the curve shows

std::string_view class_of(Mark::Kind kind) {
  switch (kind) {
    case Mark::Kind::kDetected:
      return "detected";
    case Mark::Kind::kDecided:
      return "decided";
    case Mark::Kind::kNoHelp:
      return "no-help";
    case Mark::Kind::kResolved:
      return "resolved";
    case Mark::Kind::kGivenUp:
      return "given-up";
  }
  return "";
}

// With the minus that is as wide as a plus.
std::string with_minus(std::string number) {
  if (number.starts_with('-')) number.replace(0, 1, "−");
  return number;
}
std::string value_text(double value) { return with_minus(fmt::format("{:.3g}", value)); }
// "−20 s", "0 s", "+2.5 s"
std::string time_text(double seconds) {
  const double rounded = std::round(seconds * 1e6) / 1e6;
  if (rounded == 0) return "0 s";
  return (rounded > 0 ? "+" : "") + with_minus(fmt::format("{:.6g} s", rounded));
}

// The least of 1, 2 and 5 times a power of ten of which no more than kMostTicks fit in.
double step_for(double length) {
  double step = std::pow(10, std::floor(std::log10(length / kMostTicks)));
  for (const double factor : {1.0, 2.0, 5.0, 10.0}) {
    if (length / (factor * step) <= kMostTicks) return factor * step;
  }
  return 10 * step;
}

class Plot {
 public:
  Plot(const Curve& curve, const PlotFrame& frame)
      : curve_(curve), frame_(frame), length_(std::max(1e-3, frame.end - frame.begin)) {
    bool has_any = false;
    const auto include = [&](double value) {
      low_ = has_any ? std::min(low_, value) : value;
      high_ = has_any ? std::max(high_, value) : value;
      has_any = true;
    };
    for (const auto& point : curve.points) include(point.value);
    lowest_ = low_;
    highest_ = high_;
    // One that is far away would make the curve a line without a shape.
    const double size = std::max({highest_ - lowest_, std::abs(lowest_), std::abs(highest_)});
    for (const double limit : curve.limits) {
      const double away = std::max({0.0, limit - highest_, lowest_ - limit});
      if (away > kMostAway * size) {
        far_limits_.push_back(limit);
      } else {
        include(limit);
        limits_.push_back(limit);
      }
    }
    if (low_ == high_) {
      const double room = low_ == 0 ? 1 : 0.1 * std::abs(low_);
      low_ -= room;
      high_ += room;
    }
  }

  std::string drawn(std::size_t number) const {
    const std::string name = xml_escaped(curve_.name);
    const std::string unit = curve_.unit.empty() ? "" : " " + xml_escaped(curve_.unit);
    std::string description = fmt::format(
        "From {} to {}: lowest {}{}, highest {}{}.", time_text(frame_.begin - frame_.zero),
        time_text(frame_.end - frame_.zero), value_text(lowest_), unit, value_text(highest_), unit);
    for (const double limit : curve_.limits)
      description += fmt::format(" A rule's limit is {}{}.", value_text(limit), unit);
    std::string why = curve_.about;
    for (const double limit : far_limits_)
      why += fmt::format("; its limit of {}{} is far away", value_text(limit),
                         curve_.unit.empty() ? "" : " " + curve_.unit);
    return fmt::format(
               "<figure><figcaption><b>{}</b>{} <span class=\"why\">{}</span></figcaption>"
               "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-labelledby=\"plot{}-name\" "
               "aria-describedby=\"plot{}-text\"><title id=\"plot{}-name\">{}</title><desc "
               "id=\"plot{}-text\">{}</desc>",
               name, unit.empty() ? "" : "," + unit, xml_escaped(why), kPlotWide, kPlotHigh, number,
               number, number, name, number, description) +
           axes() + limits() + marks() +
           fmt::format("<path class=\"curve\" d=\"{}\"/></svg></figure>\n", line());
  }

 private:
  double x(double at) const { return kLeft + (at - frame_.begin) / length_ * (kRight - kLeft); }
  double y(double value) const {
    return kBottom - (value - low_) / (high_ - low_) * (kBottom - kTop);
  }

  std::string axes() const {
    std::string out;
    const double step = step_for(length_);
    const auto first = std::ceil((frame_.begin - frame_.zero) / step);
    for (int i = 0; i <= kMostTicks; ++i) {
      const double at = (first + i) * step;
      if (frame_.zero + at > frame_.end) break;
      const double where = x(frame_.zero + at);
      out += fmt::format(
          "<line class=\"tick\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\"/><text "
          "x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\">{4}</text>",
          where, kTop, kBottom, kPlotHigh - 6, time_text(at));
    }
    for (const double value : {low_, high_}) {
      const double where = y(value);
      out += fmt::format(
          "<line class=\"tick\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/><text "
          "x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>",
          kLeft, kRight, where, kLeft - 6, where + 4, value_text(value));
    }
    return out;
  }

  std::string limits() const {
    std::string out;
    for (const double limit : limits_)
      out += fmt::format(
          "<line class=\"limit\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"><title>a "
          "rule's limit: {3}</title></line>",
          kLeft, kRight, y(limit), value_text(limit));
    return out;
  }

  // Detections and ends in one row of signs, what was done in the other: they often come at the same time.
  std::string marks() const {
    std::string out;
    std::array<double, 5> last{};
    last.fill(-kPlotWide);
    for (const Mark& mark : frame_.marks) {
      if (mark.at < frame_.begin || mark.at > frame_.end) continue;
      const double where = x(mark.at);
      double& before = last[static_cast<std::size_t>(mark.kind)];
      if (where - before < kSignWide) continue;
      before = where;
      const bool is_done = mark.kind == Mark::Kind::kDecided || mark.kind == Mark::Kind::kNoHelp;
      out += fmt::format(
          "<g class=\"mark {0}\"><title>{1}: {2}</title><line x1=\"{3:.1f}\" x2=\"{3:.1f}\" "
          "y1=\"{4}\" y2=\"{5}\"/><text x=\"{3:.1f}\" y=\"{6}\" "
          "text-anchor=\"middle\">{7}</text></g>",
          class_of(mark.kind), time_text(mark.at - frame_.zero), xml_escaped(mark.text), where,
          kTop, kBottom, is_done ? 20 : 10, sign_of(mark.kind));
    }
    return out;
  }

  // A point that stands alone is a line of no length, which round ends make a dot.
  std::string line() const {
    constexpr double kSecondsEach = 1e-9;
    std::string out;
    const auto& points = curve_.points;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool is_new = i == 0 || points[i].at - points[i - 1].at > curve_.longest_gap;
      const double at = static_cast<double>(points[i].at) * kSecondsEach;
      out += fmt::format("{}{:.1f} {:.1f}", is_new ? "M" : "L", x(at), y(points[i].value));
      if (is_new) out += "h0";
    }
    return out;
  }

  const Curve& curve_;
  const PlotFrame& frame_;
  const double length_;
  std::vector<double> limits_;  // that are drawn
  std::vector<double> far_limits_;
  double low_ = 0;
  double high_ = 0;
  double lowest_ = 0;
  double highest_ = 0;
};

}  // namespace

std::string_view sign_of(Mark::Kind kind) {
  switch (kind) {
    case Mark::Kind::kDetected:
      return "◆";
    case Mark::Kind::kDecided:
      return "▼";
    case Mark::Kind::kNoHelp:
      return "✕";
    case Mark::Kind::kResolved:
      return "✓";
    case Mark::Kind::kGivenUp:
      return "✖";
  }
  return "";
}

std::string plot_of(const Curve& curve, const PlotFrame& frame, std::size_t number) {
  return Plot(curve, frame).drawn(number);
}

}  // namespace culprit::incident_reports
