// Bags: whatever their bytes say, they are read to their end or refused, the times of their
// messages never go back, rules can be replayed on them, and their numbers drawn.
//
// The first line of the input is what the file's name ends with (`mcap`, `db3`, `mcap.zstd`), the
// rest its bytes. To reach what stands behind checksums, MCAP is also read with each checksum of a
// chunk set to 0, which says that there is none.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>
#include <unistd.h>

#include "bag/bag_file.h"
#include "bag/bag_reading.h"
#include "incident_reports/recorded_curves.h"
#include "language/checker.h"

namespace {

using namespace culprit;

const RuleSet& rules() {
  static const RuleSet set = *check(Source("fuzz.rules", R"(
COMPONENT camera NODE /camera
COMPONENT gripper NODE /arm/gripper
SIGNAL visibility TOPIC /a FIELD data
SIGNAL depth TOPIC /b FIELD depths[0].metres
SIGNAL entropy DIAGNOSTIC segmentation KEY entropy
RULE R
  POLICIES ERROR
  TRIGGER visibility < 1 || depth < 1 || entropy > 1 || lifecycle(camera) != "active" || age(/a) > 1s
    STRATEGY tune 50 10 WHEN parameter(gripper, gain) < 2
      ADAPTATION camera restart 2
)"))
                                  .rules;
  return set;
}

// The curves of it must be bounded, too.
void check_curves(const std::string& path) {
  incident_reports::CurveLimits limits;
  limits.most_memory = std::size_t{1} << 20;
  const auto shown =
      incident_reports::recorded_curves(path, {rules(), {"R"}, {"camera", "gripper"}}, limits);
  if (!shown) return;
  if (shown->curves.size() > limits.most_curves || shown->end < shown->begin) std::abort();
  for (const incident_reports::Curve& each : shown->curves) {
    if (each.points.size() > 2 * bag::ThinnedCurve::kMostBuckets) std::abort();
  }
}

void read(const std::string& path) {
  const bag::BagFile::Limits limits{std::size_t{1} << 20};
  auto file = bag::BagFile::open(path, limits);
  if (!file) return;
  ros2::MessageLibrary library;
  bag::BagReading reading(rules(), file->contents(), library);
  std::vector<Observation> observations;
  std::int64_t last = 0;
  for (bag::BagMessage message; file->next(message);) {
    if (message.at < last || message.topic >= file->contents().topics().size()) std::abort();
    last = message.at;
    observations.clear();
    reading.read(message, observations);
  }
  (void)reading.missing();
  check_curves(path);
  if (file->contents().losses().size() > 30) std::abort();
}

void read_as(const std::string& kind, const std::string& bytes) {
  const std::string path = (std::filesystem::temp_directory_path() / "culprit-fuzz-").string() +
                           std::to_string(getpid()) + "." + kind;
  std::ofstream(path, std::ios::binary) << bytes;
  read(path);
  std::filesystem::remove(path);
}

// Follows the records as far as they go.
std::string without_checksums(std::string bytes) {
  constexpr std::size_t kMagic = 8;
  constexpr std::size_t kHead = 9;
  for (std::size_t at = kMagic; bytes.size() >= kHead && at <= bytes.size() - kHead;) {
    std::uint64_t size = 0;
    for (std::size_t i = 8; i > 0; --i)
      size = size << 8 | static_cast<unsigned char>(bytes[at + i]);
    const std::size_t left = bytes.size() - at - kHead;
    if (bytes[at] == 0x06 && left >= 28) bytes.replace(at + kHead + 24, 4, 4, '\0');
    if (size > left) break;
    at += kHead + size;
  }
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const std::size_t line = text.find('\n');
  if (line == std::string::npos) return 0;
  const std::string kind = text.substr(0, line);
  const std::string bytes = text.substr(line + 1);
  if (kind == "mcap") {
    read_as(kind, bytes);
    read_as(kind, without_checksums(bytes));
  } else if (kind == "db3" || kind == "mcap.zstd" || kind == "db3.zstd") {
    read_as(kind, bytes);
  }
  return 0;
}
