// Shard files: what the runs of a shard yielded, one run a line, as they end.
//
// Each line is a sealed JSON object (sealed_line.h). The first names the campaign and the shard;
// then come the runs in their order; the last has their number. A process that dies leaves a file
// without that last line, and perhaps with half a line at its end. The incomplete line is dropped,
// and the shard goes on from there. Any other damage is an error: the content of a damaged file is
// never guessed.
//
//     {"format":"culprit-shard","format_version":2,"study":"sunset","shard":"2/4",
//      "campaign":{...},"check":"..."}                                      (in one line)
//     {"row":0,"run":1,"metrics":{...},"check":"..."}
//     {"runs":324,"check":"..."}
//
// C is a kind of campaign (shard_kind.h).
#pragma once

#include <cstdint>
#include <istream>
#include <optional>
#include <string>
#include <variant>

#include "base/expected.h"
#include "shards/shard_kind.h"
#include "shards/shard_lines.h"

namespace culprit::study {

template <class C>
struct ShardHeader {
  C campaign;
  Shard shard;
};

template <class C>
std::string header_line(const ShardHeader<C>& header);
template <class Run>
std::string run_line(RunId id, const Run& run);  // @pre all numbers of `run` are finite
std::string end_line(std::uint64_t runs);

// Reads a shard file to its end, in memory for one line.
template <class C>
class ShardReader {
 public:
  using Run = typename ShardKind<C>::Run;

  // Reads the header. `name` is for messages; `in` lives longer than the reader.
  static Expected<ShardReader> open(std::istream& in, std::string name);
  // The same of a file whose first line was read already.
  static Expected<ShardReader> open(ShardLines lines, const ShardBeginning& beginning);

  const std::string& name() const { return lines_.name(); }
  const ShardHeader<C>& header() const { return header_; }

  // The next run; nothing at the end, be it complete or not. After an error, nothing more can be
  // read.
  Expected<std::optional<Run>> next();

  // After next() gave nothing:
  bool is_complete() const { return is_complete_; }  // all runs are there, and the last line
  std::uint64_t runs() const { return runs_; }
  std::uint64_t good_bytes() const { return lines_.good_bytes(); }  // up to half a line at the end

 private:
  ShardReader(ShardLines lines, ShardHeader<C> header)
      : lines_(std::move(lines)), header_(std::move(header)) {}

  Expected<std::optional<Run>> run(const Json& json);
  Expected<std::optional<Run>> end(const Json& json);

  ShardLines lines_;
  ShardHeader<C> header_;
  std::uint64_t runs_ = 0;
  bool is_complete_ = false;
};

using AnyShardReader = std::variant<ShardReader<Campaign>, ShardReader<SuaveCampaign>>;

// Reads the header of a file of whatever kind.
Expected<AnyShardReader> open_shard(std::istream& in, std::string name);

}  // namespace culprit::study
