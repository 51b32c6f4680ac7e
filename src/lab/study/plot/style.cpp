#include "study/plot/style.h"

#include <array>
#include <string_view>

#include <fmt/core.h>

namespace culprit::study {
namespace {

struct Palette {
  std::string_view ink;
  std::string_view faint_ink;
  std::string_view grid;
  std::string_view ours;
  std::string_view theirs;
  std::array<std::string_view, kCurveColours> curves;
};

constexpr Palette kLight = {"#1c2128", "#57606a",
                            "#e2e6ea", "#2f6db5",
                            "#b8500f", {"#0072b2", "#b8500f", "#00805e", "#a94f86", "#8a6100"}};
constexpr Palette kDark = {"#e6e9ed", "#9ba4af",
                           "#343b44", "#6ea8ec",
                           "#f2955c", {"#5fb4ea", "#f2955c", "#3cc79f", "#e29bc6", "#e0b04c"}};

}  // namespace

std::string plot_style(ColorScheme scheme) {
  const Palette& palette = scheme == ColorScheme::kLight ? kLight : kDark;
  std::string style = fmt::format(
      ".plot text{{font:12px system-ui,sans-serif;fill:{0}}}\n"
      ".plot .small{{font-size:11px;fill:{1}}}\n"
      ".plot .grid{{stroke:{2};stroke-width:1}}\n"
      ".plot .axis{{stroke:{1};stroke-width:1}}\n"
      ".plot .bar{{fill:{3};fill-opacity:.45}}\n"
      ".plot .ours{{stroke:{3};stroke-width:2;fill:{3}}}\n"
      ".plot .theirs{{stroke:{4};stroke-width:2;fill:none}}\n"
      ".plot .pipeline{{stroke:{1};stroke-opacity:.45;stroke-width:9;stroke-linecap:round;"
      "stroke-linejoin:round;fill:none}}\n"
      ".plot .mark{{stroke:{4};stroke-width:1.5;fill:{2}}}\n"
      ".plot .vehicle{{fill:{4}}}\n"
      "@media (prefers-reduced-motion:reduce){{.plot .vehicle{{display:none}}}}\n",
      palette.ink, palette.faint_ink, palette.grid, palette.ours, palette.theirs);
  for (int i = 0; i < kCurveColours; ++i) {
    style += fmt::format(
        ".plot .curve{0}{{stroke:{1};stroke-width:2;fill:none}}\n"
        ".plot .truth{0}{{stroke:{1};stroke-width:1.5;stroke-dasharray:2 4;fill:none}}\n"
        ".plot .band{0}{{fill:{1};fill-opacity:.15}}\n.plot .name{0}{{fill:{1}}}\n",
        i, palette.curves[static_cast<std::size_t>(i)]);
  }
  return style;
}

}  // namespace culprit::study
