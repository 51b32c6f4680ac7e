#include "owners/bounded_log.h"

#include <fstream>
#include <string>

namespace culprit::owners {

void bound_log(const std::filesystem::path& log) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(log, error);
  if (error || size <= kMostOfLog) return;
  std::ifstream from(log, std::ios::binary);
  from.seekg(static_cast<std::streamoff>(size - kMostOfLog));
  std::string end(kMostOfLog, '\0');
  from.read(end.data(), static_cast<std::streamsize>(end.size()));
  std::ofstream(log.string() + ".1", std::ios::binary | std::ios::trunc)
      .write(end.data(), from.gcount());
  // Also if the disk is too full for a copy: then most of all.
  std::filesystem::resize_file(log, 0, error);
}

}  // namespace culprit::owners
