// The last values of a node's parameters, kept across its processes (the exemplar's
// ~/parameters.csv, one file for each node).
//
// The file grows by one line "<name> <value>" for each change; the last one counts. Only whole
// lines count: a process that is killed while it writes leaves at most an unfinished line, which
// opening the file cuts off.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "base/expected.h"
#include "base/value.h"

namespace culprit::sunset {

class ParameterFile {
 public:
  // Creates the file, and its folder, if need be.
  static Expected<ParameterFile> open(const std::filesystem::path& path);

  // The value that was last set when the file was opened, with the type of `pattern`. Empty if the
  // parameter was never set, or if its text is no value of this type.
  std::optional<Value> last(std::string_view name, const Value& pattern) const;

  // Is on its way to the disk, and survives a kill, when this returns. Errors: the disk is full, or
  // the value is a text of several lines. After a failed write the file takes nothing more.
  Expected<void> append(std::string_view name, const Value& value);

 private:
  ParameterFile(std::map<std::string, std::string, std::less<>> texts, std::ofstream file)
      : texts_(std::move(texts)), file_(std::move(file)) {}

  std::map<std::string, std::string, std::less<>> texts_;
  std::ofstream file_;
};

}  // namespace culprit::sunset
