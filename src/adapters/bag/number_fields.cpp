#include "bag/number_fields.h"

#include <algorithm>
#include <array>

namespace culprit::bag {
namespace {

constexpr std::uint32_t kMostElements = 3;  // of an array: a robot has a left and a right wheel
constexpr int kDeepest = 8;
constexpr int kMostVisits = 1000;  // of definitions: one that multiplies ends

constexpr std::array<std::string_view, 3> kStamps = {
    "std_msgs/msg/Header", "builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration"};

bool is_number(ros2::Primitive primitive) {
  return primitive != ros2::Primitive::kString && primitive != ros2::Primitive::kWString;
}

// Pictures and packets, of which no element means anything.
bool is_byte(ros2::Primitive primitive) {
  switch (primitive) {
    case ros2::Primitive::kBool:
    case ros2::Primitive::kByte:
    case ros2::Primitive::kChar:
    case ros2::Primitive::kInt8:
    case ros2::Primitive::kUint8:
      return true;
    default:
      return false;
  }
}

class FieldWalk {
 public:
  FieldWalk(ros2::MessageLibrary& library, std::size_t most) : library_(library), most_(most) {}

  void enter(const std::string& type, const std::string& path, int depth) {
    if (depth > kDeepest || ++visits_ > kMostVisits || paths_.size() >= most_) return;
    if (std::ranges::find(kStamps, type) != kStamps.end()) return;
    const auto definition = library_.find(type);
    if (!definition) return;
    for (const ros2::FieldDefinition& field : (*definition)->fields) {
      const std::string name = path.empty() ? field.name : path + "." + field.name;
      if (const auto* primitive = std::get_if<ros2::Primitive>(&field.element)) {
        take(field, *primitive, name);
      } else if (field.shape == ros2::Shape::kSingle) {
        enter(std::get<std::string>(field.element), name, depth + 1);
      }
    }
  }
  std::vector<std::string> paths() && { return std::move(paths_); }

 private:
  void take(const ros2::FieldDefinition& field, ros2::Primitive primitive,
            const std::string& name) {
    if (!is_number(primitive)) return;
    if (field.shape == ros2::Shape::kSingle) return add(name);
    if (is_byte(primitive)) return;
    const std::uint32_t count = field.count == 0 ? kMostElements : field.count;
    for (std::uint32_t i = 0; i < std::min(count, kMostElements); ++i)
      add(name + "[" + std::to_string(i) + "]");
  }
  void add(std::string name) {
    if (paths_.size() < most_) paths_.push_back(std::move(name));
  }

  ros2::MessageLibrary& library_;
  const std::size_t most_;
  int visits_ = 0;
  std::vector<std::string> paths_;
};

}  // namespace

std::vector<std::string> number_fields(ros2::MessageLibrary& library, const std::string& type,
                                       std::size_t most) {
  FieldWalk walk(library, most);
  walk.enter(type, "", 0);
  return std::move(walk).paths();
}

}  // namespace culprit::bag
