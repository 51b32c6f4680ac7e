#include "bag_doctor/offered_qos.h"

#include <yaml-cpp/yaml.h>

#include "journal/database.h"

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

std::string slashed(std::string name) {
  if (!name.starts_with('/')) name.insert(0, "/");
  return name;
}

std::map<std::string, std::vector<OfferedQos>> of_metadata(const std::filesystem::path& file) {
  std::map<std::string, std::vector<OfferedQos>> offers;
  try {
    const YAML::Node root = YAML::LoadFile(file.string());
    for (const YAML::Node& each :
         root["rosbag2_bagfile_information"]["topics_with_message_count"]) {
      const YAML::Node topic = each["topic_metadata"];
      const YAML::Node profiles = topic["offered_qos_profiles"];
      // A text of YAML until Iron, a list since.
      const std::string text = !profiles             ? ""
                               : profiles.IsScalar() ? profiles.Scalar()
                                                     : YAML::Dump(profiles);
      if (auto parsed = parse_offered_qos(text); !parsed.empty())
        offers[slashed(topic["name"].as<std::string>())] = std::move(parsed);
    }
  } catch (const YAML::Exception&) {  // what it says so far counts
  }
  return offers;
}

std::map<std::string, std::vector<OfferedQos>> of_database(const std::filesystem::path& file) {
  std::map<std::string, std::vector<OfferedQos>> offers;
  auto database = journal::Database::open(file, journal::Database::Mode::kRead);
  if (!database) return offers;
  auto rows = database->prepare("SELECT name, offered_qos_profiles FROM topics");
  while (rows) {
    const auto more = rows->step();
    if (!more || !*more) break;
    if (auto parsed = parse_offered_qos(std::string(rows->bytes(1))); !parsed.empty())
      offers[slashed(std::string(rows->bytes(0)))] = std::move(parsed);
  }
  return offers;
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

std::map<std::string, std::vector<OfferedQos>> offered_qos(const std::filesystem::path& bag) {
  std::error_code error;
  const bool is_folder = std::filesystem::is_directory(bag, error);
  const std::filesystem::path folder = is_folder ? bag : bag.parent_path();
  const std::filesystem::path metadata = folder / "metadata.yaml";
  if (std::filesystem::is_regular_file(metadata, error)) return of_metadata(metadata);
  if (!is_folder)
    return bag.extension() == ".db3" ? of_database(bag) : decltype(offered_qos(bag)){};
  for (const auto& each : std::filesystem::directory_iterator(folder, error)) {
    if (each.path().extension() == ".db3") return of_database(each.path());
  }
  return {};
}

}  // namespace culprit::bag_doctor
