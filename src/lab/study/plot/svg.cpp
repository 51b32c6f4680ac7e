#include "study/plot/svg.h"

#include <fmt/core.h>

#include "study/markup.h"

namespace culprit::study {
namespace {

// A hundredth of a pixel is fine enough, and the same everywhere.
std::string place(double value) {
  std::string text = fmt::format("{:.2f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string places(const std::vector<Point>& points) {
  std::string out;
  for (const Point& point : points) {
    if (!out.empty()) out += ' ';
    out += place(point.x) + "," + place(point.y);
  }
  return out;
}

std::string_view name(Anchor anchor) {
  return anchor == Anchor::kStart ? "start" : anchor == Anchor::kMiddle ? "middle" : "end";
}

}  // namespace

Svg::Svg(double width, double height, std::string_view title, std::string_view description)
    : width_(width),
      height_(height),
      title_(markup_escaped(title)),
      description_(markup_escaped(description)) {}

void Svg::rectangle(Point corner, double width, double height, std::string_view css_class) {
  body_ += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" class=\"{}\"/>\n",
                       place(corner.x), place(corner.y), place(width), place(height), css_class);
}

void Svg::line(Point from, Point to, std::string_view css_class) {
  body_ += fmt::format("<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" class=\"{}\"/>\n",
                       place(from.x), place(from.y), place(to.x), place(to.y), css_class);
}

void Svg::polyline(const std::vector<Point>& points, std::string_view css_class) {
  body_ += fmt::format("<polyline points=\"{}\" class=\"{}\"/>\n", places(points), css_class);
}

void Svg::polygon(const std::vector<Point>& points, std::string_view css_class) {
  body_ += fmt::format("<polygon points=\"{}\" class=\"{}\"/>\n", places(points), css_class);
}

void Svg::circle(Point centre, double radius, std::string_view css_class) {
  body_ += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" class=\"{}\"/>\n", place(centre.x),
                       place(centre.y), place(radius), css_class);
}

void Svg::moving_circle(const std::vector<Point>& points, double duration_s, double radius,
                        std::string_view css_class) {
  std::string xs;
  std::string ys;
  for (const Point& point : points) {
    xs += (xs.empty() ? "" : ";") + place(point.x);
    ys += (ys.empty() ? "" : ";") + place(point.y);
  }
  const auto animated = [&](char axis, const std::string& values) {
    return fmt::format(
        "<animate attributeName=\"c{}\" values=\"{}\" dur=\"{}s\" repeatCount=\"indefinite\"/>",
        axis, values, place(duration_s));
  };
  body_ += fmt::format("<circle r=\"{}\" class=\"{}\">{}{}</circle>\n", place(radius), css_class,
                       animated('x', xs), animated('y', ys));
}

void Svg::text(Point at, Anchor anchor, std::string_view css_class, std::string_view text) {
  body_ += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"{}\" class=\"{}\">{}</text>\n",
                       place(at.x), place(at.y), name(anchor), css_class, markup_escaped(text));
}

std::string Svg::begin(std::string_view attributes) const {
  return fmt::format(
      "<svg {} class=\"plot\" viewBox=\"0 0 {} {}\" role=\"img\">\n<title>{}</title>\n"
      "<desc>{}</desc>\n",
      attributes, place(width_), place(height_), title_, description_);
}

std::string Svg::inside_page() const {
  const std::string size = fmt::format("style=\"max-width:{}px\"", place(width_));
  return begin(size) + body_ + "</svg>\n";
}

std::string Svg::file(std::string_view style) const {
  const std::string size = fmt::format(
      "xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" "
      "height=\"{}\"",
      place(width_), place(height_));
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + begin(size) + "<style>\n" +
         std::string(style) + "</style>\n" + body_ + "</svg>\n";
}

}  // namespace culprit::study
