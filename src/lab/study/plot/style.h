// How plots look: one style sheet, with the colours of light or dark scheme.
//
// The colours of curves are Okabe and Ito's, which people with any colour vision can distinguish.
#pragma once

#include <string>

namespace culprit::study {

inline constexpr int kCurveColours = 5;  // classes curve0..., band0..., name0...

enum class ColorScheme { kLight, kDark };

std::string plot_style(ColorScheme scheme);

}  // namespace culprit::study
