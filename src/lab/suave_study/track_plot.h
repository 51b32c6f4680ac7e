// A run of the SUAVE study from above: the pipeline, the vehicle's way, numbered marks where
// something happened, and the vehicle under way.
#pragma once

#include "study/plot/svg.h"
#include "suave_study/track.h"

namespace culprit::study {

// The area that all drawings of one page show, so that they can be compared.
struct TrackFrame {
  double left = 0;  // metres, as the simulation's x
  double right = 0;
  double bottom = 0;  // y
  double top = 0;
};
TrackFrame frame_of(const std::vector<Track>& tracks);

// The vehicle moves this much faster than real time.
inline constexpr double kTrackSpeed = 15;

Svg track_plot(const Track& track, const TrackFrame& frame);

}  // namespace culprit::study
