// Shard files: what the runs of a shard yielded, one run a line, as they end.
//
// Each line is a sealed JSON object (sealed_line.h). The first tells what campaign and which shard
// this is; then come the runs in their order; the last tells how many they are. A process that dies
// leaves a file without that last line, and perhaps with half a line at its end. That half is
// dropped, and the shard goes on from there. Anything else that is wrong is an error: nobody
// guesses what a damaged file meant.
//
//     {"format":"culprit-shard","format_version":1,"shard":"2/4","campaign":{...},"check":"..."}
//     {"row":0,"run":1,"metrics":{...},"check":"..."}
//     {"runs":324,"check":"..."}
#pragma once

#include <cstdint>
#include <istream>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "language/expected.h"
#include "study/campaign.h"
#include "study/run_metrics.h"
#include "study/shards/shard.h"

namespace culprit::study {

struct ShardHeader {
  Campaign campaign;
  Shard shard;
};

std::string header_line(const ShardHeader& header);
std::string run_line(RunId id, const RunMetrics& run);  // @pre all numbers of `run` are finite
std::string end_line(std::uint64_t runs);

// Reads a shard file to its end, in memory for one line.
class ShardReader {
 public:
  // Reads the header. `name` is for messages; `in` lives longer than the reader.
  static Expected<ShardReader> open(std::istream& in, std::string name);

  const std::string& name() const { return name_; }
  const ShardHeader& header() const { return header_; }

  // The next run; nothing at the end, be it complete or not. After an error, nothing more can be
  // read.
  Expected<std::optional<RunMetrics>> next();

  // After next() gave nothing:
  bool is_complete() const { return is_complete_; }  // all runs are there, and the last line
  std::uint64_t runs() const { return runs_; }
  std::uint64_t good_bytes() const { return good_bytes_; }  // up to half a line at the end

 private:
  enum class Line { kWhole, kTorn, kNone, kTooLong };

  ShardReader(std::istream& in, std::string name) : in_(&in), name_(std::move(name)) {}

  Line read_line();
  Error error(const std::string& what) const;
  Expected<std::optional<RunMetrics>> run(const nlohmann::ordered_json& json);
  Expected<std::optional<RunMetrics>> end(const nlohmann::ordered_json& json);

  std::istream* in_;
  std::string name_;
  ShardHeader header_;
  std::string line_;
  std::uint64_t line_number_ = 0;
  std::uint64_t runs_ = 0;
  std::uint64_t good_bytes_ = 0;
  bool is_complete_ = false;
};

}  // namespace culprit::study
