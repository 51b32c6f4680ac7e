// Quality of service, as far as ROS 2 uses it, and the profiles that its built-in endpoints have
// (design.ros2.org/articles/qos.html; rmw/qos_profiles.h).
//
// A reader matches a writer that offers at least what it requests. So a best effort, volatile
// reader matches every writer, and holds none of them back; one that asks for transient local must
// know that it is offered.
#pragma once

#include <cstdint>

#include "base/units.h"

namespace culprit::rtps {

enum class Reliability : std::uint8_t { kBestEffort, kReliable };
enum class Durability : std::uint8_t { kVolatile, kTransientLocal };
// Whether the samples of a topic have keys (`@key` in its type; ROS 2 Kilted and later). A reader
// with keys matches no writer without, nor the reverse.
enum class Keys : std::uint8_t { kNone, kSome };
enum class History : std::uint8_t { kKeepLast, kKeepAll };
// How a publisher's liveliness is asserted: by the middleware for the whole process, or by the
// publisher itself.
enum class Liveliness : std::uint8_t { kAutomatic, kManualByTopic };
// Whether a subscriber receives all publishers of a topic, or the strongest only. ROS 2 has no
// setting for it; XML profiles of the middleware have.
enum class Ownership : std::uint8_t { kShared, kExclusive };

inline constexpr Duration kInfinite = Duration::max();

struct Qos {
  Reliability reliability = Reliability::kReliable;
  Durability durability = Durability::kVolatile;
  History history = History::kKeepLast;
  std::uint32_t depth = 10;  // with kKeepLast, >= 1; of a discovered endpoint it is not known
  Duration deadline = kInfinite;
  Duration lifespan = kInfinite;
  Keys keys = Keys::kNone;
  Liveliness liveliness = Liveliness::kAutomatic;
  Duration liveliness_lease = kInfinite;
  Ownership ownership = Ownership::kShared;
  bool operator==(const Qos&) const = default;
};

namespace qos {

inline constexpr Qos kDefault{};
inline constexpr Qos kServices{};
inline constexpr Qos kParameterServices{.depth = 1000};
inline constexpr Qos kParameterEvents{.depth = 1000};
inline constexpr Qos kSensorData{.reliability = Reliability::kBestEffort, .depth = 5};
inline constexpr Qos kRosout{
    .durability = Durability::kTransientLocal, .depth = 1000, .lifespan = std::chrono::seconds(10)};
inline constexpr Qos kDiscoveryInfoWriter{.durability = Durability::kTransientLocal, .depth = 1};
inline constexpr Qos kDiscoveryInfoReader{.durability = Durability::kTransientLocal,
                                          .history = History::kKeepAll};

}  // namespace qos

}  // namespace culprit::rtps
