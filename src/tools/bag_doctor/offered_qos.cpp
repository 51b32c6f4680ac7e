#include "bag_doctor/offered_qos.h"

#include <yaml-cpp/yaml.h>

namespace culprit::bag_doctor {
namespace {

// Humble writes the numbers of rmw/types.h, later recorders their names.
std::string named(const YAML::Node& value, const char* first, const char* second) {
  if (!value || !value.IsScalar()) return "";
  const std::string text = value.Scalar();
  if (text == "1") return first;
  if (text == "2") return second;
  return text == first || text == second ? text : "";
}

}  // namespace

std::vector<OfferedQos> parse_offered_qos(const std::string& yaml) {
  std::vector<OfferedQos> offers;
  constexpr std::size_t kLongest = 1 << 20;
  if (yaml.empty() || yaml.size() > kLongest) return offers;
  try {
    for (const YAML::Node& each : YAML::Load(yaml)) {
      if (!each.IsMap()) continue;
      offers.push_back({named(each["reliability"], "reliable", "best_effort"),
                        named(each["durability"], "transient_local", "volatile")});
    }
  } catch (const YAML::Exception&) {
    offers.clear();
  }
  return offers;
}

}  // namespace culprit::bag_doctor
