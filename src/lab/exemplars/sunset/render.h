// Intersects a camera's rays with the terrain, then with the vehicles on it.
#pragma once

#include "exemplars/sunset/camera.h"
#include "exemplars/sunset/image.h"
#include "exemplars/sunset/terrain.h"
#include "exemplars/sunset/traffic.h"

namespace culprit::sunset {

// An ideal picture: no lens, no noise.
struct View {
  RgbImage rgb;
  LabelImage truth;
  Image<float> height;  // metres above the ground
};

View render_terrain(const Terrain& terrain, const Camera& camera, Size size);

// Draws body, windows, roof and shadow where nothing higher hides them.
void render_vehicle(View& view, const Terrain& terrain, const Camera& camera,
                    const Vehicle& vehicle);

}  // namespace culprit::sunset
