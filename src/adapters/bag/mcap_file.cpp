#include "bag/mcap_file.h"

#include <algorithm>
#include <array>
#include <zlib.h>

#include "bag/mcap_fields.h"

namespace culprit::bag {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kHeadSize = 9;  // of each record: its code, and the size of what follows

enum Code : std::uint8_t {
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kStatistics = 0x0b,
  kDataEnd = 0x0f
};

std::uint32_t checksum_of(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

}  // namespace

McapFile::McapFile(ByteSource source, std::string name, BagContents& contents, std::size_t most)
    : source_(std::move(source)), name_(std::move(name)), contents_(contents), most_(most) {}

Expected<std::unique_ptr<Storage>> McapFile::open(const std::filesystem::path& path,
                                                  BagContents& contents, std::size_t most) {
  auto source = ByteSource::open(path);
  if (!source) return Error{source.error()};
  std::unique_ptr<McapFile> file(new McapFile(std::move(*source), path.filename(), contents, most));
  if (!file->begin()) {
    const std::string& trouble = file->source_.trouble();
    return Error{trouble.empty() ? "it is not MCAP, or its beginning is damaged" : trouble};
  }
  return std::unique_ptr<Storage>(std::move(file));
}

bool McapFile::begin() {
  std::array<char, kMagic.size()> magic{};
  return take(magic.data(), magic.size()) && std::string_view(magic.data(), magic.size()) == kMagic;
}

bool McapFile::next(BagMessage& message) {
  while (given_ == located_.size()) {
    if (is_at_end_) return false;
    located_.clear();
    given_ = 0;
    read_record();
  }
  const Located& each = located_[given_++];
  message = {static_cast<std::int64_t>(each.at), each.topic,
             records_.substr(each.offset, each.size)};
  return true;
}

void McapFile::read_record() {
  RecordHead head;
  head.place = source_.position();
  head.checksum_before = checksum_;
  std::array<char, kHeadSize> bytes{};
  if (!take(bytes.data(), bytes.size())) {
    if (!has_data_end_)
      lose_rest(head, source_.trouble().empty() ? "the file ends there, before it was finished"
                                                : source_.trouble());
    return finish();
  }
  head.code = static_cast<std::uint8_t>(bytes[0]);
  head.size = McapFields(std::string_view(bytes.data() + 1, 8)).u64();
  switch (head.code) {
    case 0:
      lose_rest(head, "no record begins there");
      return finish();
    case kFooter:
      return finish();
    case kSchema:
    case kChannel:
    case kMessage:
    case kChunk:
      // Behind the end of the data are copies, for those that read by the index.
      if (!has_data_end_) return read_wanted(head);
      break;
    case kStatistics:
    case kDataEnd:
      return read_wanted(head);
    default:
      break;
  }
  if (pass(head.size)) return;
  if (!has_data_end_) lose_rest(head, "a record there is longer than the file");
  finish();
}

void McapFile::read_wanted(const RecordHead& head) {
  const bool is_too_long = head.size > most_;
  const bool is_whole = is_too_long ? pass(head.size) : take(body_, head.size);
  if (is_too_long && is_whole)
    return lose(head, "is of " + std::to_string(head.size) + " bytes, more than the " +
                          std::to_string(most_) + " that are read");
  records_ = body_;
  if (!is_too_long && head.code == kChunk) {
    read_chunk(head, body_, is_whole);
  } else if (is_whole && head.code == kDataEnd) {
    read_data_end(head, body_);
  } else if (is_whole && head.code == kStatistics) {
    expected_count_ = McapFields(body_).u64();
  } else if (is_whole) {
    read_content(head.code, body_);
  }
  if (is_whole) return;
  if (!has_data_end_)
    lose_rest(head, source_.trouble().empty() ? "a record there is longer than the file"
                                              : source_.trouble());
  finish();
}

void McapFile::read_data_end(const RecordHead& head, std::string_view body) {
  has_data_end_ = true;
  const std::uint32_t checksum = McapFields(body).u32();
  if (checksum != 0 && checksum != head.checksum_before)
    contents_.lose(name_ + ": its bytes are not those that were written (checksum of the file)");
}

void McapFile::read_chunk(const RecordHead& head, std::string_view body, bool is_whole) {
  McapFields fields(body);
  fields.bytes(16);  // the times of its first and last message
  const std::uint64_t size = fields.u64();
  const std::uint32_t checksum = fields.u32();
  const std::string_view name = fields.text();
  const std::uint64_t compressed_size = fields.u64();
  if (!fields.is_good()) {
    if (is_whole) lose(head, "is damaged");
    return;
  }
  const std::string_view compressed = fields.rest().substr(0, compressed_size);
  Compression compression = Compression::kNone;
  if (name == "zstd") {
    compression = Compression::kZstd;
  } else if (name == "lz4") {
    compression = Compression::kLz4;
  } else if (!name.empty()) {
    return lose(head, "is compressed with something else than zstd or lz4");
  }
  if (size > most_)
    return lose(head, "would take " + std::to_string(size) + " bytes of memory, more than the " +
                          std::to_string(most_) + " that are spent");
  const Decompressed result = decompress_(compression, compressed, size, chunk_);
  if (result == Decompressed::kTooLong) return lose(head, "holds more than it says");
  const bool is_all = chunk_.size() == size;
  if (checksum != 0 && is_all && checksum != checksum_of(chunk_))
    return lose(head, "is damaged: its checksum is wrong");
  // Compressed data may be followed by bytes that mean nothing: if all is there, it is.
  if (result == Decompressed::kDamaged && !(is_all && checksum != 0))
    return lose(head, "is damaged: it cannot be decompressed");
  if (is_whole && !is_all) return lose(head, "holds less than it says");
  records_ = chunk_;
  read_chunk_records(head, is_all);
}

// What is whole in the last chunk of a file that was cut off is whole.
void McapFile::read_chunk_records(const RecordHead& head, bool is_whole) {
  McapFields fields(records_);
  while (!fields.rest().empty()) {
    const auto code = static_cast<std::uint8_t>(fields.bytes(1)[0]);
    const std::string_view body = fields.bytes(fields.u64());
    if (!fields.is_good()) {
      if (is_whole) lose(head, "is damaged: one of its records is longer than the chunk");
      break;
    }
    read_content(code, body);
  }
  std::stable_sort(located_.begin(), located_.end(),
                   [](const Located& a, const Located& b) { return a.at < b.at; });
}

void McapFile::read_content(std::uint8_t code, std::string_view body) {
  if (code == kSchema) read_schema(body);
  if (code == kChannel) read_channel(body);
  if (code == kMessage) read_message(body);
}

void McapFile::read_schema(std::string_view body) {
  McapFields fields(body);
  const std::uint16_t id = fields.u16();
  const std::string_view type = fields.text();
  const std::string_view encoding = fields.text();
  const std::string_view text = fields.text();
  constexpr std::size_t kLongestName = 1024;
  if (!fields.is_good() || id == 0 || type.size() > kLongestName) return;
  types_.try_emplace(id, type);  // Others of this number must be the same.
  if (encoding == "ros2msg") contents_.define(type, text);
}

void McapFile::read_channel(std::string_view body) {
  McapFields fields(body);
  const std::uint16_t id = fields.u16();
  const auto type = types_.find(fields.u16());
  const std::string_view topic = fields.text();
  const std::string_view encoding = fields.text();
  constexpr std::size_t kLongestName = 1024;
  if (!fields.is_good() || topic.size() > kLongestName || encoding.size() > kLongestName) return;
  const auto [channel, is_new] = channels_.try_emplace(id);
  if (!is_new) return;  // Others of this number must be the same.
  channel->second =
      contents_.place_of({std::string(topic), type == types_.end() ? std::string() : type->second,
                          std::string(encoding)});
}

void McapFile::read_message(std::string_view body) {
  McapFields fields(body);
  const auto channel = channels_.find(fields.u16());
  fields.u32();  // its number in the channel
  const std::uint64_t at = fields.u64();
  fields.u64();  // when it was published, by the clock of whoever did
  ++message_count_;
  if (!fields.is_good()) return contents_.lose_message("cut short");
  if (channel == channels_.end())
    return contents_.lose_message("of a topic that the file does not describe");
  const auto offset = static_cast<std::size_t>(fields.rest().data() - records_.data());
  located_.push_back({at, channel->second, offset, fields.rest().size()});
}

void McapFile::finish() {
  is_at_end_ = true;
  if (expected_count_ > message_count_)
    contents_.lose(name_ + ": " + std::to_string(expected_count_ - message_count_) + " of its " +
                   std::to_string(expected_count_) + " messages are missing");
}

bool McapFile::take(char* to, std::size_t size) {
  const std::size_t got = source_.read(to, size);
  checksum_ = checksum_of({to, got}, checksum_);
  return got == size;
}

// By and by: what a record claims to be long may not be there.
bool McapFile::take(std::string& to, std::uint64_t size) {
  constexpr std::size_t kStep = std::size_t{1} << 20;
  to.clear();
  while (to.size() < size) {
    const std::size_t before = to.size();
    to.resize(before + std::min<std::uint64_t>(size - before, kStep));
    const std::size_t wanted = to.size() - before;
    const std::size_t got = source_.read(to.data() + before, wanted);
    checksum_ = checksum_of({to.data() + before, got}, checksum_);
    to.resize(before + got);
    if (got < wanted) return false;
  }
  return true;
}

bool McapFile::pass(std::uint64_t size) {
  std::array<char, std::size_t{64} << 10> block;
  while (size > 0) {
    const std::size_t part = std::min<std::uint64_t>(size, block.size());
    if (!take(block.data(), part)) return false;
    size -= part;
  }
  return true;
}

void McapFile::lose(const RecordHead& head, const std::string& what) {
  contents_.lose(name_ + ": the " + (head.code == kChunk ? "chunk" : "record") + " at byte " +
                 std::to_string(head.place) + " " + what + "; it is left out");
}

void McapFile::lose_rest(const RecordHead& head, const std::string& why) {
  contents_.lose(name_ + ": what follows byte " + std::to_string(head.place) + " is lost: " + why);
}

}  // namespace culprit::bag
