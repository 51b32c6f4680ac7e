// Where recordings are kept, and how much of the disk they may have: the oldest goes first.
//
// A recording is called "<robot>_<when>_<why>.mcap": "submarine_20261125T190317.042Z_CameraDead.mcap", by the wall clock in
// UTC. Other files in the folder are neither counted nor touched.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/expected.h"

namespace culprit::recorder {

struct StoredRecording {
  std::filesystem::path path;
  std::int64_t when = 0;   // what it is about happened, nanoseconds since 1970, to the millisecond
  std::int64_t ended = 0;  // when it was written last, likewise
  std::uint64_t bytes = 0;
};

// The name of a recording. In `robot` and `why`, each character that is not allowed in a file name
// becomes '-'.
std::string recording_name(const std::string& robot, std::int64_t when, const std::string& why);
// When it began; nothing: that is no name of a recording.
std::optional<std::int64_t> when_recorded(const std::string& name);
// The oldest first; none if there is no such folder.
std::vector<StoredRecording> recordings_in(const std::filesystem::path& folder);

class RecordingFolder {
 public:
  struct Space {
    std::uint64_t total = 0;  // bytes of the file system
    std::uint64_t free = 0;   // that an ordinary user may have
  };
  using SpaceOf = std::function<Expected<Space>(const std::filesystem::path&)>;
  // statvfs(2).
  static Expected<Space> space_of(const std::filesystem::path& folder);

  // The part of a file system that stays free: a gigabyte, or a tenth of it where that is less.
  static constexpr std::uint64_t kLeftFree = 1'000'000'000;
  static std::uint64_t left_free(const Space& space);

  // `most_bytes`: of all recordings together.
  RecordingFolder(std::filesystem::path path, std::uint64_t most_bytes, SpaceOf space = space_of)
      : path_(std::move(path)), most_bytes_(most_bytes), space_(std::move(space)) {}

  const std::filesystem::path& path() const { return path_; }

  // Makes the folder if it is not there.
  Expected<void> open() const;
  // Makes room for so many more bytes of `own`, which stays itself: removes other recordings until the budget and the
  // disk have them. Errors: even then there is no room, or the disk cannot be asked.
  Expected<void> make_room(std::uint64_t bytes, const std::filesystem::path& own) const;

 private:
  const std::filesystem::path path_;
  const std::uint64_t most_bytes_;
  const SpaceOf space_;
};

}  // namespace culprit::recorder
