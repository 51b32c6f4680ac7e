// Shard files of studies: whatever the bytes are, they are read to their end or refused. Runs that
// are read can be written again unchanged. To reach what stands behind a checksum, lines are also
// read as if they had been sealed properly.
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>

#include "shards/merge.h"
#include "shards/shard_file.h"
#include "study/sealed_line.h"

namespace {

using namespace culprit::study;

// Gives each line that is a JSON object a seal that fits.
std::string sealed(const std::string& text) {
  std::istringstream in(text);
  std::string out;
  for (std::string line; std::getline(in, line);) {
    const auto json = culprit::parse_json(line);
    out += json.is_object() && !json.empty() ? sealed_line(json) : line + "\n";
  }
  return out;
}

template <class C>
void read_as(const std::string& text) {
  std::istringstream in(text);
  auto reader = ShardReader<C>::open(in, "fuzz");
  if (!reader) return;
  std::string again = header_line(reader->header());
  std::uint64_t runs = 0;
  while (true) {
    const auto run = reader->next();
    if (!run || !run->has_value()) break;
    const ShardHeader<C>& header = reader->header();
    again += run_line(header.campaign[campaign_index(header.shard, runs++)], **run);
  }
  if (runs != reader->runs()) __builtin_trap();
  std::istringstream second(again);
  auto repeated = ShardReader<C>::open(second, "again");
  if (!repeated) __builtin_trap();
  for (std::uint64_t i = 0; i < runs; ++i) {
    const auto run = repeated->next();
    if (!run || !run->has_value()) __builtin_trap();
  }
}

void read(const std::string& text) {
  read_as<Campaign>(text);
  read_as<SuaveCampaign>(text);
  std::istringstream in(text);
  const ShardSource source{"fuzz", &in};
  (void)merge(std::span(&source, 1));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  read(text);
  read(sealed(text));
  return 0;
}
