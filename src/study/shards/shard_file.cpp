#include "study/shards/shard_file.h"

#include "study/shards/json_fields.h"
#include "study/shards/run_record.h"
#include "study/shards/sealed_line.h"

namespace culprit::study {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kFormat = "culprit-shard";
constexpr std::uint64_t kFormatVersion = 1;
constexpr std::size_t kLongestLine = 1 << 20;  // bytes; a run with 100 reaction times has 2,500

Expected<ShardHeader> header(const Json& json) {
  JsonFields fields(json);
  if (fields.text("format") != kFormat) return Error{"is no shard file of culprit"};
  const std::uint64_t version =
      fields.natural("format_version", std::numeric_limits<std::uint32_t>::max());
  if (version != kFormatVersion && fields.complaint().empty()) {
    return Error{"has format version " + std::to_string(version) + ", but this culprit reads " +
                 std::to_string(kFormatVersion) + "; use the culprit that wrote it"};
  }
  ShardHeader header;
  const Expected<Shard> shard = parse_shard(fields.text("shard"));
  if (shard) header.shard = *shard;
  if (!shard) fields.complain_inside("shard", shard.error());
  const Expected<Campaign> campaign = campaign_from_json(fields.object("campaign"));
  if (campaign) header.campaign = *campaign;
  if (!campaign) fields.complain_inside("campaign", campaign.error());
  const std::string complaint = fields.complaint();
  if (!complaint.empty()) return Error{"has a wrong header: " + complaint};
  return header;
}

constexpr const char* kRemedy = "; remove the file and run its shard again";

}  // namespace

std::string header_line(const ShardHeader& header) {
  return sealed_line({{"format", kFormat},
                      {"format_version", kFormatVersion},
                      {"shard", label(header.shard)},
                      {"campaign", to_json(header.campaign)}});
}

std::string run_line(RunId id, const RunMetrics& run) {
  return sealed_line({{"row", id.row}, {"run", id.run}, {"metrics", *to_json(run)}});
}

std::string end_line(std::uint64_t runs) { return sealed_line({{"runs", runs}}); }

Expected<ShardReader> ShardReader::open(std::istream& in, std::string name) {
  ShardReader reader(in, std::move(name));
  const Line line = reader.read_line();
  const std::optional<Json> json =
      line == Line::kWhole ? unsealed(reader.line_) : std::optional<Json>();
  if (!json) {
    return Error{reader.name_ + ": is no shard file of culprit, or its first line is damaged" +
                 kRemedy};
  }
  Expected<ShardHeader> found = study::header(*json);
  if (!found) return Error{reader.name_ + ": " + found.error()};
  reader.header_ = std::move(*found);
  return reader;
}

ShardReader::Line ShardReader::read_line() {
  line_.clear();
  ++line_number_;
  std::streambuf& buffer = *in_->rdbuf();
  for (int c = buffer.sbumpc(); c != std::char_traits<char>::eof(); c = buffer.sbumpc()) {
    if (c == '\n') {
      good_bytes_ += line_.size() + 1;
      return Line::kWhole;
    }
    if (line_.size() == kLongestLine) return Line::kTooLong;
    line_ += static_cast<char>(c);
  }
  return line_.empty() ? Line::kNone : Line::kTorn;
}

Error ShardReader::error(const std::string& what) const {
  return {name_ + ":" + std::to_string(line_number_) + ": " + what + kRemedy};
}

Expected<std::optional<RunMetrics>> ShardReader::next() {
  const Line line = read_line();
  if (is_complete_ && line != Line::kNone) return error("there is something after the last line");
  if (line == Line::kTooLong) return error("the line is too long");
  if (line != Line::kWhole) return std::optional<RunMetrics>();
  const std::optional<Json> json = unsealed(line_);
  if (!json) return error("the line is damaged: its checksum does not fit");
  return json->contains("metrics") ? run(*json) : end(*json);
}

Expected<std::optional<RunMetrics>> ShardReader::run(const Json& json) {
  if (runs_ == size(header_.shard, header_.campaign))
    return error("there are more runs than the shard has");
  const RunId expected = header_.campaign[campaign_index(header_.shard, runs_)];
  JsonFields fields(json);
  if (fields.natural("row", std::numeric_limits<std::uint32_t>::max()) != expected.row ||
      fields.natural("run", std::numeric_limits<std::uint32_t>::max()) != expected.run) {
    return error("here should be run " + std::to_string(expected.run) + " of row " +
                 std::to_string(expected.row));
  }
  Expected<RunMetrics> run = run_from_json(fields.object("metrics"));
  if (!run) fields.complain_inside("metrics", run.error());
  const std::string complaint = fields.complaint();
  if (!complaint.empty()) return error(complaint);
  ++runs_;
  return std::optional<RunMetrics>(std::move(*run));
}

Expected<std::optional<RunMetrics>> ShardReader::end(const Json& json) {
  JsonFields fields(json);
  const std::uint64_t runs = fields.natural("runs", std::numeric_limits<std::uint64_t>::max());
  const std::string complaint = fields.complaint();
  if (!complaint.empty()) return error(complaint);
  if (runs != runs_ || runs != size(header_.shard, header_.campaign)) {
    return error("the last line tells of " + std::to_string(runs) + " runs, but there are " +
                 std::to_string(runs_) + " before it");
  }
  is_complete_ = true;
  return next();  // there must be nothing more
}

}  // namespace culprit::study
