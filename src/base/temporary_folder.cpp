#include "base/temporary_folder.h"

#include <cerrno>
#include <cstring>
#include <stdlib.h>
#include <system_error>

namespace culprit {

Expected<TemporaryFolder> TemporaryFolder::make(const std::string& purpose) {
  std::error_code error;
  const std::filesystem::path parent = std::filesystem::temp_directory_path(error);
  if (error) return Error{"cannot make a temporary folder: TMPDIR names none"};
  std::string path = parent / ("culprit-" + purpose + "-XXXXXX");
  if (mkdtemp(path.data()) == nullptr)
    return Error{"cannot make a folder in " + parent.string() + ": " + std::strerror(errno)};
  return TemporaryFolder(std::move(path));
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code error;
  if (!path_.empty()) std::filesystem::remove_all(path_, error);
}

}  // namespace culprit
