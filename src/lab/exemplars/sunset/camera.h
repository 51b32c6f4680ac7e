// The drone's pinhole camera, looking straight down from kAltitudeMetres.
//
// Its focal length is 100 px for 160 px of width (a field of view of 77 degrees). One pixel is 0.5
// m on the ground, and a frame covers 80 m x 60 m.
#pragma once

#include "exemplars/sunset/image.h"

namespace culprit::sunset {

inline constexpr double kAltitudeMetres = 50.0;
inline constexpr double kFocalPerWidth = 100.0 / 160.0;

// Metres on the terrain, or metres for each metre of descent.
struct Point {
  double x = 0;
  double y = 0;
};

// Where the camera is, and which direction on the terrain is up in the picture, as a unit vector.
struct Pose {
  Point position;
  Point up{0, -1};
};

class Camera {
 public:
  Camera(const Pose& pose, Size size)
      : pose_(pose),
        focal_(kFocalPerWidth * size.width),
        middle_{0.5 * size.width, 0.5 * size.height} {}

  const Point& position() const { return pose_.position; }

  // How far the ray through a pixel moves sideways for each metre that it descends.
  Point slope(int column, int row) const {
    const double right = (column + 0.5 - middle_.x) / focal_;
    const double up = (middle_.y - row - 0.5) / focal_;
    return {up * pose_.up.x - right * pose_.up.y, up * pose_.up.y + right * pose_.up.x};
  }

  double pixels_per_metre(double height) const { return focal_ / (kAltitudeMetres - height); }

  // The pixel (with fractions) that shows a point `offset` metres sideways of the camera and
  // `height` above the ground.
  Point project(Point offset, double height) const {
    const double scale = pixels_per_metre(height);
    const double up = offset.x * pose_.up.x + offset.y * pose_.up.y;
    const double right = offset.y * pose_.up.x - offset.x * pose_.up.y;
    return {middle_.x + right * scale - 0.5, middle_.y - up * scale - 0.5};
  }

 private:
  Pose pose_;
  double focal_;
  Point middle_;
};

}  // namespace culprit::sunset
