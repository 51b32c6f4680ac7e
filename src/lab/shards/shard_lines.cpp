#include "shards/shard_lines.h"

#include <limits>

#include "study/json_fields.h"
#include "study/sealed_line.h"

namespace culprit::study {
namespace {

constexpr std::string_view kFormat = "culprit-shard";
constexpr std::uint64_t kFormatVersion = 2;
constexpr std::size_t kLongestLine = 1 << 20;  // bytes; a run with 100 reaction times has 2,500
constexpr const char* kRemedy = "; remove the file and run its shard again";

Expected<ShardBeginning> beginning(const Json& json) {
  JsonFields fields(json);
  if (fields.text("format") != kFormat) return Error{"is no shard file of culprit"};
  const std::uint64_t version =
      fields.natural("format_version", std::numeric_limits<std::uint32_t>::max());
  if (version != kFormatVersion && fields.complaint().empty()) {
    return Error{"has format version " + std::to_string(version) + ", but this culprit reads " +
                 std::to_string(kFormatVersion) + "; use the culprit that wrote it"};
  }
  ShardBeginning beginning;
  beginning.study = fields.text("study");
  const Expected<Shard> shard = parse_shard(fields.text("shard"));
  if (shard) beginning.shard = *shard;
  if (!shard) fields.complain_inside("shard", shard.error());
  beginning.campaign = fields.object("campaign");
  const std::string complaint = fields.complaint();
  if (!complaint.empty()) return Error{"has a wrong header: " + complaint};
  return beginning;
}

}  // namespace

ShardLines::Line ShardLines::read() {
  text_.clear();
  ++number_;
  std::streambuf& buffer = *in_->rdbuf();
  for (int c = buffer.sbumpc(); c != std::char_traits<char>::eof(); c = buffer.sbumpc()) {
    if (c == '\n') {
      good_bytes_ += text_.size() + 1;
      return Line::kWhole;
    }
    if (text_.size() == kLongestLine) return Line::kTooLong;
    text_ += static_cast<char>(c);
  }
  return text_.empty() ? Line::kNone : Line::kTorn;
}

Error ShardLines::error(const std::string& what) const {
  return {name_ + ":" + std::to_string(number_) + ": " + what + kRemedy};
}

std::string beginning_line(const ShardBeginning& beginning) {
  return sealed_line({{"format", kFormat},
                      {"format_version", kFormatVersion},
                      {"study", beginning.study},
                      {"shard", label(beginning.shard)},
                      {"campaign", beginning.campaign}});
}

Expected<ShardBeginning> read_beginning(ShardLines& lines) {
  const auto line = lines.read();
  const std::optional<Json> json =
      line == ShardLines::Line::kWhole ? unsealed(lines.text()) : std::optional<Json>();
  if (!json) {
    return Error{lines.name() + ": is no shard file of culprit, or its first line is damaged" +
                 kRemedy};
  }
  Expected<ShardBeginning> found = beginning(*json);
  if (!found) return Error{lines.name() + ": " + found.error()};
  return found;
}

}  // namespace culprit::study
