#include "exemplars/sunset/pictures.h"

#include <cstring>
#include <string>
#include <string_view>

namespace culprit::sunset {
namespace {

namespace msg = ros2::msg;

constexpr std::string_view kRgb = "bgr8";
constexpr std::string_view kDepth = "16UC1";
constexpr std::string_view kLabels = "8UC1";

msg::Image frame_of(Size size, std::size_t pixel_bytes, std::string_view encoding,
                    const msg::Header& header) {
  const auto step = static_cast<std::uint32_t>(static_cast<std::size_t>(size.width) * pixel_bytes);
  return {.header = header,
          .height = static_cast<std::uint32_t>(size.height),
          .width = static_cast<std::uint32_t>(size.width),
          .encoding = std::string(encoding),
          .is_bigendian = 0,
          .step = step,
          .data = std::vector<std::uint8_t>(static_cast<std::size_t>(step) *
                                            static_cast<std::size_t>(size.height))};
}

// An image for the pixels of `message`, if it has as many of them as it says.
template <class Pixel>
std::optional<Image<Pixel>> canvas_for(const msg::Image& message, std::string_view encoding) {
  if (message.width == 0 && message.height == 0 && message.data.empty()) return Image<Pixel>();
  constexpr std::uint32_t kLongestSide = 1 << 14;  // so that the products below cannot overflow
  if (message.encoding != encoding || message.is_bigendian != 0) return std::nullopt;
  if (message.width > kLongestSide || message.height > kLongestSide) return std::nullopt;
  if (message.step != message.width * sizeof(Pixel)) return std::nullopt;
  if (message.data.size() != std::size_t{message.step} * message.height) return std::nullopt;
  return Image<Pixel>(Size{static_cast<int>(message.width), static_cast<int>(message.height)});
}

// For pixels that lie in memory as on the wire.
template <class Pixel>
msg::Image copied(const Image<Pixel>& picture, std::string_view encoding,
                  const msg::Header& header) {
  msg::Image message = frame_of(picture.size, sizeof(Pixel), encoding, header);
  if (!picture.empty()) {
    std::memcpy(message.data.data(), picture.pixels.data(), message.data.size());
  }
  return message;
}
template <class Pixel>
std::optional<Image<Pixel>> copied(const msg::Image& message, std::string_view encoding) {
  auto picture = canvas_for<Pixel>(message, encoding);
  if (picture && !picture->empty()) {
    std::memcpy(picture->pixels.data(), message.data.data(), message.data.size());
  }
  return picture;
}

}  // namespace

msg::Image to_message(const RgbImage& picture, const msg::Header& header) {
  msg::Image message = frame_of(picture.size, sizeof(Rgb), kRgb, header);
  auto byte = message.data.begin();
  for (const Rgb& pixel : picture.pixels) {
    *byte++ = pixel.b;
    *byte++ = pixel.g;
    *byte++ = pixel.r;
  }
  return message;
}

msg::Image to_message(const DepthImage& picture, const msg::Header& header) {
  return copied(picture, kDepth, header);
}

msg::Image to_message(const LabelImage& picture, const msg::Header& header) {
  return copied(picture, kLabels, header);
}

std::optional<RgbImage> rgb_of(const msg::Image& message) {
  auto picture = canvas_for<Rgb>(message, kRgb);
  if (!picture) return picture;
  auto byte = message.data.begin();
  for (Rgb& pixel : picture->pixels) {
    pixel.b = *byte++;
    pixel.g = *byte++;
    pixel.r = *byte++;
  }
  return picture;
}

std::optional<DepthImage> depth_of(const msg::Image& message) {
  return copied<std::uint16_t>(message, kDepth);
}

std::optional<LabelImage> labels_of(const msg::Image& message) {
  return copied<Label>(message, kLabels);
}

}  // namespace culprit::sunset
