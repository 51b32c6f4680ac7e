#include "recorder/mcap_writer.h"

#include <algorithm>
#include <zlib.h>
#include <zstd.h>

#include "base/invariant.h"

namespace culprit::recorder {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kMostIds = 65'535;
constexpr int kZstdLevel = 1;  // its fastest: the robot's processor is not there for more

enum Code : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0b,
  kMetadata = 0x0c,
  kMetadataIndex = 0x0d,
  kSummaryOffset = 0x0e,
  kDataEnd = 0x0f
};

std::uint32_t checksum_of(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

// Numbers have their lowest byte first.
void put_number(std::string& out, std::uint64_t number, int size) {
  for (int i = 0; i < size; ++i, number >>= 8) out += static_cast<char>(number & 0xff);
}
void put_u16(std::string& out, std::uint16_t number) { put_number(out, number, 2); }
void put_u32(std::string& out, std::uint32_t number) { put_number(out, number, 4); }
void put_u64(std::string& out, std::uint64_t number) { put_number(out, number, 8); }
void put_text(std::string& out, std::string_view text) {
  put_u32(out, static_cast<std::uint32_t>(text.size()));
  out += text;
}
void put_texts(std::string& out, const McapWriter::Texts& texts) {
  std::string all;
  for (const auto& [key, value] : texts) {
    put_text(all, key);
    put_text(all, value);
  }
  put_text(out, all);
}

std::string record_of(Code code, std::string_view body) {
  std::string out(1, static_cast<char>(code));
  put_u64(out, body.size());
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
  put_text(header, profile);
  put_text(header, library);
  put(std::string(kMagic) + record_of(kHeader, header));
}

void McapWriter::put(const std::string& bytes) {
  is_good_ = is_good_ && sink_(bytes);
  if (!is_good_) return;
  written_ += bytes.size();
  checksum_ = checksum_of(bytes, checksum_);
}

std::uint16_t McapWriter::add_schema(Schema schema) {
  if (schemas_.size() >= kMostIds) return 0;
  const auto id = static_cast<std::uint16_t>(schemas_.size() + 1);
  std::string body;
  put_u16(body, id);
  put_text(body, schema.name);
  put_text(body, schema.encoding);
  put_text(body, schema.text);
  schemas_.push_back(record_of(kSchema, body));
  is_schema_in_chunk_.push_back(false);
  return id;
}

std::uint16_t McapWriter::add_channel(Channel channel) {
  CULPRIT_ASSERT(channel.schema >= 1 && channel.schema <= schemas_.size());
  if (channels_.size() >= kMostIds) return 0;
  const auto id = static_cast<std::uint16_t>(channels_.size() + 1);
  std::string body;
  put_u16(body, id);
  put_u16(body, channel.schema);
  put_text(body, channel.topic);
  put_text(body, channel.encoding);
  put_texts(body, channel.metadata);
  channels_.push_back(record_of(kChannel, body));
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
  constexpr std::size_t kHeadSize = 2 + 4 + 8 + 8;
  chunk_ += static_cast<char>(kMessage);
  put_u64(chunk_, kHeadSize + payload.size());
  put_u16(chunk_, head.channel);
  put_u32(chunk_, head.sequence);
  put_u64(chunk_, logged);
  put_u64(chunk_, published);
  chunk_ += payload;
  chunk_span_.include({logged, logged});
  ++counts_[head.channel - 1u];
  ++messages_;
  if (chunk_.size() >= kChunkSize) flush();
}

void McapWriter::add_metadata(const std::string& name, const Texts& metadata) {
  CULPRIT_ASSERT(chunk_entries_.empty());
  std::string body;
  put_text(body, name);
  put_texts(body, metadata);
  const std::string record = record_of(kMetadata, body);
  std::string index;
  put_u64(index, written_);
  put_u64(index, record.size());
  put_text(index, name);
  metadata_indexes_.push_back(record_of(kMetadataIndex, index));
  put(record);
}

void McapWriter::flush() {
  if (!is_good_ || chunk_entries_.empty()) return;
  const std::string packed = compressed(chunk_);
  const std::string_view name = packed.empty() ? "" : "zstd";
  const std::string_view records = packed.empty() ? std::string_view(chunk_) : packed;
  std::string body;
  put_u64(body, chunk_span_.begin());
  put_u64(body, chunk_span_.last);
  put_u64(body, chunk_.size());
  put_u32(body, checksum_of(chunk_));
  put_text(body, name);
  put_u64(body, records.size());
  body += records;
  std::string piece = record_of(kChunk, body);
  const std::size_t chunk_length = piece.size();
  std::string places;
  for (auto& [channel, entries] : chunk_entries_) {
    std::stable_sort(entries.begin(), entries.end(),
                     [](const Entry& a, const Entry& b) { return a.logged < b.logged; });
    put_u16(places, channel);
    put_u64(places, written_ + piece.size());
    std::string list;
    for (const Entry& entry : entries) {
      put_u64(list, entry.logged);
      put_u64(list, entry.offset);
    }
    std::string index;
    put_u16(index, channel);
    put_text(index, list);
    piece += record_of(kMessageIndex, index);
  }
  std::string index;
  put_u64(index, chunk_span_.begin());
  put_u64(index, chunk_span_.last);
  put_u64(index, written_);
  put_u64(index, chunk_length);
  put_text(index, places);
  put_u64(index, piece.size() - chunk_length);
  put_text(index, name);
  put_u64(index, records.size());
  put_u64(index, chunk_.size());
  chunk_indexes_.push_back(record_of(kChunkIndex, index));
  put(piece);
  span_.include(chunk_span_);
  chunk_.clear();
  chunk_span_ = {};
  chunk_entries_.clear();
  std::fill(is_schema_in_chunk_.begin(), is_schema_in_chunk_.end(), false);
}

std::string McapWriter::statistics() const {
  std::string body;
  put_u64(body, messages_);
  put_u16(body, static_cast<std::uint16_t>(schemas_.size()));
  put_u32(body, static_cast<std::uint32_t>(channels_.size()));
  put_u32(body, 0);  // attachments
  put_u32(body, static_cast<std::uint32_t>(metadata_indexes_.size()));
  put_u32(body, static_cast<std::uint32_t>(chunk_indexes_.size()));
  put_u64(body, span_.begin());
  put_u64(body, span_.last);
  std::string counts;
  for (std::size_t c = 0; c < counts_.size(); ++c) {
    put_u16(counts, static_cast<std::uint16_t>(c + 1));
    put_u64(counts, counts_[c]);
  }
  put_text(body, counts);
  return record_of(kStatistics, body);
}

// Everything from `at`, where it is to be, to the end of the file.
std::string McapWriter::summary(std::uint64_t at) const {
  std::string out;
  std::string offsets;
  const auto group = [&](Code code, const std::vector<std::string>& records) {
    const std::size_t begin = out.size();
    for (const std::string& record : records) out += record;
    if (out.size() == begin) return;
    std::string body(1, static_cast<char>(code));
    put_u64(body, at + begin);
    put_u64(body, out.size() - begin);
    offsets += record_of(kSummaryOffset, body);
  };
  group(kSchema, schemas_);
  group(kChannel, channels_);
  group(kStatistics, {statistics()});
  group(kChunkIndex, chunk_indexes_);
  group(kMetadataIndex, metadata_indexes_);
  const std::uint64_t offsets_at = at + out.size();
  out += offsets;
  // The checksum covers the footer up to itself.
  constexpr std::uint64_t kFooterSize = 8 + 8 + 4;
  out += static_cast<char>(kFooter);
  put_u64(out, kFooterSize);
  put_u64(out, at);
  put_u64(out, offsets_at);
  put_u32(out, checksum_of(out));
  out += kMagic;
  return out;
}

void McapWriter::end() {
  flush();
  std::string checksum;
  put_u32(checksum, checksum_);
  put(record_of(kDataEnd, checksum));
  put(summary(written_));
}

}  // namespace culprit::recorder
