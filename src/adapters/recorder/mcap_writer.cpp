#include "recorder/mcap_writer.h"

#include <algorithm>
#include <zstd.h>

#include "base/invariant.h"
#include "mcap/record.h"
#include "mcap/record_fields.h"

namespace culprit::recorder {
namespace {

constexpr std::size_t kMostIds = 65'535;
static_assert(sizeof(std::size_t) == 8);  // as sizes are in the file
constexpr int kZstdLevel = 1;  // its fastest: the robot's processor is not there for more

void append_pairs(std::string& out, const McapWriter::Texts& texts) {
  std::string all;
  for (const auto& [key, value] : texts) mcap::append(all, key, value);
  mcap::append(out, all);
}

std::string record_of(mcap::Code code, std::string_view body) {
  std::string out(1, static_cast<char>(code));
  mcap::append(out, body.size());
  out += body;
  return out;
}

// Empty if that makes it no shorter.
std::string compressed(std::string_view bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), kZstdLevel);
  out.resize(ZSTD_isError(size) != 0 || size >= bytes.size() ? 0 : size);
  return out;
}

}  // namespace

void McapWriter::Span::include(const Span& other) {
  first = std::min(first, other.first);
  last = std::max(last, other.last);
}

McapWriter::McapWriter(Sink sink, const std::string& profile, const std::string& library)
    : sink_(std::move(sink)) {
  std::string header;
  mcap::append(header, profile, library);
  put(std::string(mcap::kMagic) + record_of(mcap::kHeader, header));
}

void McapWriter::put(const std::string& bytes) {
  is_good_ = is_good_ && sink_(bytes);
  if (!is_good_) return;
  written_ += bytes.size();
  checksum_ = mcap::checksum_of(bytes, checksum_);
}

std::uint16_t McapWriter::add_schema(Schema schema) {
  if (schemas_.size() >= kMostIds) return 0;
  const auto id = static_cast<std::uint16_t>(schemas_.size() + 1);
  std::string body;
  append_fields(body, mcap::Schema{id, schema.name, schema.encoding, schema.text});
  schemas_.push_back(record_of(mcap::kSchema, body));
  is_schema_in_chunk_.push_back(false);
  return id;
}

std::uint16_t McapWriter::add_channel(Channel channel) {
  CULPRIT_ASSERT(channel.schema >= 1 && channel.schema <= schemas_.size());
  if (channels_.size() >= kMostIds) return 0;
  const auto id = static_cast<std::uint16_t>(channels_.size() + 1);
  std::string body;
  append_fields(body, mcap::Channel{id, channel.schema, channel.topic, channel.encoding});
  append_pairs(body, channel.metadata);
  channels_.push_back(record_of(mcap::kChannel, body));
  schema_of_.push_back(channel.schema);
  counts_.push_back(0);
  return id;
}

void McapWriter::add(const Head& head, std::string_view payload) {
  CULPRIT_ASSERT(head.channel >= 1 && head.channel <= channels_.size());
  if (!is_good_) return;
  const auto [entries, is_new] = chunk_entries_.try_emplace(head.channel);
  if (is_new) {
    const std::size_t schema = schema_of_[head.channel - 1u] - 1u;
    if (!is_schema_in_chunk_[schema]) chunk_ += schemas_[schema];
    is_schema_in_chunk_[schema] = true;
    chunk_ += channels_[head.channel - 1u];
  }
  const auto logged = static_cast<std::uint64_t>(std::max<std::int64_t>(0, head.logged));
  const auto published = static_cast<std::uint64_t>(std::max<std::int64_t>(0, head.published));
  entries->second.push_back({logged, chunk_.size()});
  chunk_ += static_cast<char>(mcap::kMessage);
  mcap::append(chunk_, mcap::Message::kSize + payload.size());
  append_fields(chunk_, mcap::Message{head.channel, head.sequence, logged, published});
  chunk_ += payload;
  chunk_span_.include({logged, logged});
  ++counts_[head.channel - 1u];
  ++messages_;
  if (chunk_.size() >= kChunkSize) flush();
}

void McapWriter::add_metadata(const std::string& name, const Texts& metadata) {
  CULPRIT_ASSERT(chunk_entries_.empty());
  std::string body;
  mcap::append(body, name);
  append_pairs(body, metadata);
  const std::string record = record_of(mcap::kMetadata, body);
  std::string index;
  mcap::append(index, written_, record.size(), name);
  metadata_indexes_.push_back(record_of(mcap::kMetadataIndex, index));
  put(record);
}

void McapWriter::flush() {
  if (!is_good_ || chunk_entries_.empty()) return;
  const std::string packed = compressed(chunk_);
  const std::string_view name = packed.empty() ? "" : "zstd";
  const std::string_view records = packed.empty() ? std::string_view(chunk_) : packed;
  std::string body;
  append_fields(body, mcap::Chunk{chunk_span_.begin(), chunk_span_.last, chunk_.size(),
                                  mcap::checksum_of(chunk_), name, records.size()});
  body += records;
  std::string piece = record_of(mcap::kChunk, body);
  const std::size_t chunk_length = piece.size();
  std::string places;
  for (auto& [channel, entries] : chunk_entries_) {
    std::stable_sort(entries.begin(), entries.end(),
                     [](const Entry& a, const Entry& b) { return a.logged < b.logged; });
    mcap::append(places, channel, written_ + piece.size());
    std::string list;
    for (const Entry& entry : entries) mcap::append(list, entry.logged, entry.offset);
    std::string index;
    mcap::append(index, channel, list);
    piece += record_of(mcap::kMessageIndex, index);
  }
  std::string index;
  mcap::append(index, chunk_span_.begin(), chunk_span_.last, written_, chunk_length, places,
               piece.size() - chunk_length, name, records.size(), chunk_.size());
  chunk_indexes_.push_back(record_of(mcap::kChunkIndex, index));
  put(piece);
  span_.include(chunk_span_);
  chunk_.clear();
  chunk_span_ = {};
  chunk_entries_.clear();
  std::fill(is_schema_in_chunk_.begin(), is_schema_in_chunk_.end(), false);
}

std::string McapWriter::statistics() const {
  std::string body;
  constexpr std::uint32_t kAttachments = 0;
  mcap::append(body, messages_, static_cast<std::uint16_t>(schemas_.size()),
               static_cast<std::uint32_t>(channels_.size()), kAttachments,
               static_cast<std::uint32_t>(metadata_indexes_.size()),
               static_cast<std::uint32_t>(chunk_indexes_.size()), span_.begin(), span_.last);
  std::string counts;
  for (std::size_t c = 0; c < counts_.size(); ++c)
    mcap::append(counts, static_cast<std::uint16_t>(c + 1), counts_[c]);
  mcap::append(body, counts);
  return record_of(mcap::kStatistics, body);
}

// Everything from `at`, where it is to be, to the end of the file.
std::string McapWriter::summary(std::uint64_t at) const {
  std::string out;
  std::string offsets;
  const auto group = [&](mcap::Code code, const std::vector<std::string>& records) {
    const std::size_t begin = out.size();
    for (const std::string& record : records) out += record;
    if (out.size() == begin) return;
    std::string body(1, static_cast<char>(code));
    mcap::append(body, at + begin, out.size() - begin);
    offsets += record_of(mcap::kSummaryOffset, body);
  };
  group(mcap::kSchema, schemas_);
  group(mcap::kChannel, channels_);
  group(mcap::kStatistics, {statistics()});
  group(mcap::kChunkIndex, chunk_indexes_);
  group(mcap::kMetadataIndex, metadata_indexes_);
  const std::uint64_t offsets_at = at + out.size();
  out += offsets;
  // The checksum covers the footer up to itself.
  constexpr std::uint64_t kFooterSize = 8 + 8 + 4;
  out += static_cast<char>(mcap::kFooter);
  mcap::append(out, kFooterSize, at, offsets_at);
  mcap::append(out, mcap::checksum_of(out));
  out += mcap::kMagic;
  return out;
}

void McapWriter::end() {
  flush();
  std::string checksum;
  mcap::append(checksum, checksum_);
  put(record_of(mcap::kDataEnd, checksum));
  put(summary(written_));
}

}  // namespace culprit::recorder
