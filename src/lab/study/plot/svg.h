// Writes an SVG drawing, element by element. Looks come from a style sheet by classes (style.h);
// texts are escaped.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace culprit::study {

struct Point {
  double x = 0;
  double y = 0;
};

enum class Anchor { kStart, kMiddle, kEnd };

class Svg {
 public:
  // In pixels. `title` names the drawing to those who hear it, `description` says what it shows.
  Svg(double width, double height, std::string_view title, std::string_view description);

  void rectangle(Point corner, double width, double height, std::string_view css_class);
  void line(Point from, Point to, std::string_view css_class);
  void polyline(const std::vector<Point>& points, std::string_view css_class);
  void polygon(const std::vector<Point>& points, std::string_view css_class);
  void circle(Point centre, double radius, std::string_view css_class);
  // Goes along `points`, at even times, in so many seconds, again and again.
  void moving_circle(const std::vector<Point>& points, double duration_s, double radius,
                     std::string_view css_class);
  void text(Point at, Anchor anchor, std::string_view css_class, std::string_view text);

  // For a page that has the style sheet.
  std::string inside_page() const;
  // A file of its own, with the style sheet in it.
  std::string file(std::string_view style) const;

 private:
  std::string begin(std::string_view attributes) const;

  double width_;
  double height_;
  std::string title_;
  std::string description_;
  std::string body_;
};

}  // namespace culprit::study
