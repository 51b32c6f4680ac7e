#include "suave_study/track_plot.h"

#include <algorithm>

#include "exemplars/suave/model/pipeline.h"
#include "study/plot/scale.h"

namespace culprit::study {
namespace {

using suave::model::Position;

constexpr double kWidth = 720;
constexpr double kMargin = 34;  // of the axes' labels
constexpr double kAir = 3;      // metres around everything
constexpr double kMarkRadius = 8;

// Metres to pixels, the same along both axes.
struct Map {
  explicit Map(const TrackFrame& frame)
      : x{frame.left, frame.right, kMargin, kWidth - kMargin / 2},
        height((x.end - x.begin) * (frame.top - frame.bottom) / (frame.right - frame.left)),
        y{frame.bottom, frame.top, kMargin / 2 + height, kMargin / 2} {}

  Point operator()(const Position& p) const { return {x(p.x), y(p.y)}; }
  std::vector<Point> operator()(const std::vector<Position>& all) const {
    std::vector<Point> points;
    for (const Position& p : all) points.push_back((*this)(p));
    return points;
  }

  Scale x;
  double height;
  Scale y;
};

void draw_grid(Svg& svg, const Map& map) {
  for (const double x : ticks(map.x.low, map.x.high, 8)) {
    svg.line({map.x(x), map.y.begin}, {map.x(x), map.y.end}, "grid");
    svg.text({map.x(x), map.y.begin + 16}, Anchor::kMiddle, "small", tick_label(x));
  }
  for (const double y : ticks(map.y.low, map.y.high, 5)) {
    svg.line({map.x.begin, map.y(y)}, {map.x.end, map.y(y)}, "grid");
    svg.text({map.x.begin - 6, map.y(y) + 4}, Anchor::kEnd, "small", tick_label(y));
  }
}

// Marks at one place stand side by side.
void draw_marks(Svg& svg, const Track& track, const Map& map) {
  std::vector<Point> taken;
  for (std::size_t i = 0; i < track.marks.size(); ++i) {
    Point at = map(track.marks[i].at);
    const auto overlaps = [&](const Point& other) {
      return std::abs(other.x - at.x) < 2 * kMarkRadius &&
             std::abs(other.y - at.y) < 2 * kMarkRadius;
    };
    while (std::any_of(taken.begin(), taken.end(), overlaps)) at.x += 2 * kMarkRadius + 1;
    taken.push_back(at);
    svg.circle(at, kMarkRadius, "mark");
    svg.text({at.x, at.y + 4}, Anchor::kMiddle, "small", std::to_string(i + 1));
  }
}

}  // namespace

TrackFrame frame_of(const std::vector<Track>& tracks) {
  const auto& pipeline = suave::model::pipeline();
  TrackFrame frame{pipeline[0].x, pipeline[0].x, pipeline[0].y, pipeline[0].y};
  const auto include = [&](const Position& p) {
    frame = {std::min(frame.left, p.x), std::max(frame.right, p.x), std::min(frame.bottom, p.y),
             std::max(frame.top, p.y)};
  };
  for (const Position& p : pipeline) include(p);
  for (const Track& track : tracks)
    for (const Position& p : track.points) include(p);
  return {frame.left - kAir, frame.right + kAir, frame.bottom - kAir, frame.top + kAir};
}

Svg track_plot(const Track& track, const TrackFrame& frame) {
  const Map map(frame);
  Svg svg(kWidth, map.height + 1.5 * kMargin, "The way of the vehicle with " + track.manager,
          "Seen from above, in metres: the pipeline as a broad line, the way as a thin one, and "
          "numbers where something happened.");
  draw_grid(svg, map);
  const auto& pipeline = suave::model::pipeline();
  svg.polyline(map({pipeline.begin(), pipeline.end()}), "pipeline");
  const std::vector<Point> way = map(track.points);
  svg.polyline(way, "curve0");
  draw_marks(svg, track, map);
  svg.moving_circle(way, static_cast<double>(way.size()) / kTrackSpeed, 6, "vehicle");
  return svg;
}

}  // namespace culprit::study
