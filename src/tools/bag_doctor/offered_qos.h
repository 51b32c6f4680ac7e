// The QoS that the publishers of a recorded topic offered, as the recorder wrote it down.
#pragma once

#include <string>
#include <vector>

namespace culprit::bag_doctor {

// Empty: not known.
struct OfferedQos {
  std::string reliability{};  // "reliable", "best_effort"
  std::string durability{};   // "transient_local", "volatile"
  bool operator==(const OfferedQos&) const = default;
};

// The text of a topic's `offered_qos_profiles`: one offer for each publisher that the recorder saw. Empty: it says nothing.
std::vector<OfferedQos> parse_offered_qos(const std::string& yaml);

}  // namespace culprit::bag_doctor
