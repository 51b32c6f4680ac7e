// What publishers of recorded topics offered, as the recorder wrote it down: metadata.yaml, or the table of a .db3.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace culprit::bag_doctor {

// Empty: not known.
struct OfferedQos {
  std::string reliability{};  // "reliable", "best_effort"
  std::string durability{};   // "transient_local", "volatile"
  bool operator==(const OfferedQos&) const = default;
};

// By topic; one for each publisher that the recorder saw. Empty where the recorder did not write it down.
std::map<std::string, std::vector<OfferedQos>> offered_qos(const std::filesystem::path& bag);

// The text of one topic's `offered_qos_profiles`.
std::vector<OfferedQos> parse_offered_qos(const std::string& yaml);

}  // namespace culprit::bag_doctor
