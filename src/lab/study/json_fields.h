// Reads the fields of a JSON object and remembers the first complaint, so that a reader of many
// fields needs one check at its end.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "json/json.h"

namespace culprit::study {

class JsonFields {
 public:
  // `json` lives longer than this.
  explicit JsonFields(const Json& json);

  bool has(std::string_view name) const { return json_.contains(std::string(name)); }
  bool is_object(std::string_view name) const {
    return has(name) && json_.at(std::string(name)).is_object();
  }
  // A value of no meaning where there is a complaint.
  bool truth(std::string_view name);
  double number(std::string_view name);  // finite
  std::vector<double> numbers(std::string_view name);
  std::string text(std::string_view name);
  std::uint64_t natural(std::string_view name, std::uint64_t most);
  std::int32_t integer(std::string_view name,
                       std::int32_t least = std::numeric_limits<std::int32_t>::min());
  // True, and the field counts as read, if it is null.
  bool is_null(std::string_view name);
  // An empty object or array where there is a complaint.
  const Json& object(std::string_view name);
  const Json& array(std::string_view name);

  void complain(std::string_view name, std::string_view what);
  // Takes over the complaint of what was inside `name`.
  void complain_inside(std::string_view name, const std::string& complaint);

  // "ratio is missing"; also if there were fields that were not read. Empty if all is well.
  std::string complaint() const;

 private:
  const Json& at(std::string_view name);

  const Json& json_;
  std::size_t read_ = 0;
  std::string complaint_;
};

}  // namespace culprit::study
