#include "bag/mcap_file.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "mcap/record.h"
#include "mcap/record_fields.h"

namespace culprit::bag {
namespace {

constexpr std::uint64_t kBareBlock = std::uint64_t{1} << 20;  // bytes of messages outside of chunks
constexpr int kOrdinalBits = 32;  // of a message in its block; the block's number is above them

std::int64_t ordinal_of(std::size_t block, std::size_t message = 0) {
  return static_cast<std::int64_t>((std::uint64_t{block} << kOrdinalBits) + message);
}

}  // namespace

McapFile::McapFile(ByteSource source, std::filesystem::path path, BagContents& contents,
                   std::size_t most)
    : source_(std::move(source)),
      path_(std::move(path)),
      name_(path_.filename()),
      contents_(contents),
      most_(most) {}

Expected<std::unique_ptr<Storage>> McapFile::open(const std::filesystem::path& path,
                                                  BagContents& contents, std::size_t most) {
  auto source = ByteSource::open(path);
  if (!source) return Error{source.error()};
  std::unique_ptr<McapFile> file(new McapFile(std::move(*source), path, contents, most));
  if (!file->begin()) {
    const std::string& trouble = file->source_.trouble();
    return Error{trouble.empty() ? "it is not MCAP, or its beginning is damaged" : trouble};
  }
  return std::unique_ptr<Storage>(std::move(file));
}

bool McapFile::begin() {
  std::array<char, mcap::kMagic.size()> magic{};
  return source_.read(magic.data(), magic.size()) == magic.size() &&
         std::string_view(magic.data(), magic.size()) == mcap::kMagic;
}

void McapFile::survey(PieceFinder& finder) {
  find_blocks();
  if (has_plausible_times()) {
    for (std::size_t b = 0; b < blocks_.size(); ++b)
      finder.add_stretch(ordinal_of(b), blocks_[b].first, blocks_[b].last, blocks_[b].messages);
    return;
  }
  was_looked_into_ = true;
  for (std::size_t b = 0; b < blocks_.size(); ++b) look_into(b, finder);
}

void McapFile::find_blocks() {
  while (true) {
    RecordHead head;
    head.place = source_.position();
    std::array<char, mcap::kHeadSize> bytes{};
    if (source_.read(bytes.data(), bytes.size()) < bytes.size()) {
      if (!has_data_end_)
        lose_rest(head, source_.trouble().empty() ? "the file ends there, before it was finished"
                                                  : source_.trouble());
      return;
    }
    head.code = static_cast<std::uint8_t>(bytes[0]);
    head.size = mcap::Fields(std::string_view(bytes.data() + 1, 8)).u64();
    if (head.code == mcap::kFooter) return;
    if (head.code == 0) return lose_rest(head, "no record begins there");
    // A compressed file of some megabytes may hold a billion chunks of nothing.
    if (blocks_.size() >= most_ / sizeof(Block))
      return lose_rest(head, "the list of its chunks takes too much memory");
    if (take_in_record(head)) continue;
    if (!has_data_end_)
      lose_rest(head, source_.trouble().empty() ? "a record there is longer than the file"
                                                : source_.trouble());
    return;
  }
}

// False: the file ends within it.
bool McapFile::take_in_record(const RecordHead& head) {
  const std::uint64_t end = head.place + mcap::kHeadSize + head.size;
  if (end < head.place) return false;
  // Behind the end of the data are copies, for those that read by the index.
  if (!has_data_end_ && head.code == mcap::kChunk) return take_in_chunk(head);
  if (!has_data_end_ && head.code == mcap::kMessage) return take_in_bare(head);
  if (head.code == mcap::kMessageIndex && !blocks_.empty() && blocks_.back().is_chunk) {
    constexpr std::uint64_t kBefore = 6;  // bytes: a channel, and how many bytes follow
    constexpr std::uint64_t kEntry = 16;
    if (head.size > kBefore) blocks_.back().messages += (head.size - kBefore) / kEntry;
    return source_.move_to(end);
  }
  if (head.code != mcap::kSchema && head.code != mcap::kChannel && head.code != mcap::kStatistics &&
      head.code != mcap::kDataEnd)
    return source_.move_to(end);
  if (head.size > most_) return source_.move_to(end);
  if (!take(body_, head.size)) return false;
  if (head.code == mcap::kSchema) read_schema(body_);
  if (head.code == mcap::kChannel) read_channel(body_);
  if (head.code == mcap::kStatistics) expected_count_ = mcap::Fields(body_).u64();
  if (head.code == mcap::kDataEnd) check_bytes(head);
  return source_.move_to(end);
}

bool McapFile::take_in_chunk(const RecordHead& head) {
  is_bare_open_ = false;
  Block block{head.place + mcap::kHeadSize, head.size, head.place, true};
  std::array<char, 16> times{};
  if (head.size >= times.size()) {
    if (source_.read(times.data(), times.size()) < times.size()) return false;
    mcap::Fields fields(std::string_view(times.data(), times.size()));
    block.first = static_cast<std::int64_t>(fields.u64());
    block.last = static_cast<std::int64_t>(fields.u64());
  }
  block.is_whole = source_.move_to(block.place + block.size);
  blocks_.push_back(block);
  return block.is_whole;
}

bool McapFile::take_in_bare(const RecordHead& head) {
  const std::uint64_t end = head.place + mcap::kHeadSize + head.size;
  if (!source_.move_to(end)) return false;
  const std::uint64_t most = std::min<std::uint64_t>(kBareBlock, most_);
  if (is_bare_open_ && end - blocks_.back().place <= most) {
    blocks_.back().size = end - blocks_.back().place;
  } else {
    blocks_.push_back({head.place, end - head.place, head.place, false});
  }
  is_bare_open_ = true;
  return true;
}

// Compares the bytes before this record with the recorder's checksum.
void McapFile::check_bytes(const RecordHead& head) {
  has_data_end_ = true;
  const std::uint32_t expected = mcap::Fields(body_).u32();
  if (expected == 0) return;
  auto bytes = ByteSource::open(path_);
  if (!bytes) return;
  std::uint32_t checksum = 0;
  std::string part(std::size_t{1} << 20, '\0');
  for (std::uint64_t left = head.place; left > 0;) {
    const std::size_t got = bytes->read(part.data(), std::min<std::uint64_t>(left, part.size()));
    if (got == 0) return;
    checksum = mcap::checksum_of({part.data(), got}, checksum);
    left -= got;
  }
  if (checksum != expected)
    contents_.lose(name_ + ": its bytes are not those that were written (checksum of the file)");
}

// Whether the times that chunks say of themselves show no jump, so that nobody has to look into them.
bool McapFile::has_plausible_times() const {
  std::int64_t newest = -1;
  for (const Block& each : blocks_) {
    const bool is_known = each.is_chunk && each.is_whole && is_time(each.first) && each.first > 0 &&
                          is_time(each.last) && each.first <= each.last;
    if (!is_known || each.last - each.first > kLongestHole) return false;
    const bool follows = newest < 0 || (each.first >= newest - PieceFinder::kSlack &&
                                        each.first <= newest + kLongestHole);
    if (!follows) return false;
    newest = std::max(newest, each.last);
  }
  return true;
}

void McapFile::look_into(std::size_t block, PieceFinder& finder) {
  OpenBlock opened;
  if (!load(block, opened, Telling::kNothing)) return;
  bool is_first = true;
  for (const Located& each : opened.messages) {
    if (!is_time(each.recorded_at)) continue;
    finder.add(each.ordinal, each.topic, each.recorded_at);
    Block& about = blocks_[block];
    about.first = is_first ? each.recorded_at : std::min(about.first, each.recorded_at);
    is_first = false;
  }
}

void McapFile::follow(TimeLine line) {
  line_ = std::move(line);
  order_.resize(blocks_.size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  if (line_.is_in_file_order) return;
  std::stable_sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
    return blocks_[a].first < blocks_[b].first;
  });
}

bool McapFile::next(BagMessage& message) {
  while (true) {
    OpenBlock* earliest = nullptr;
    for (auto each = open_.begin(); each != open_.end();) {
      if (each->given == each->messages.size()) {
        open_bytes_ -= each->bytes.size();
        spare_.push_back(std::move(each->bytes));
        each = open_.erase(each);
        continue;
      }
      if (earliest == nullptr ||
          each->messages[each->given].at < earliest->messages[earliest->given].at)
        earliest = &*each;
      ++each;
    }
    if (wants_next(earliest)) {
      open_next();
      continue;
    }
    if (earliest == nullptr) break;
    const Located& each = earliest->messages[earliest->given++];
    message = {each.at, each.topic,
               std::string_view(earliest->bytes).substr(each.offset, each.size), each.recorded_at,
               earliest->is_after_hole};
    earliest->is_after_hole = false;
    return true;
  }
  if (!is_at_end_ && expected_count_ > message_count_)
    contents_.lose(name_ + ": " + std::to_string(expected_count_ - message_count_) + " of its " +
                   std::to_string(expected_count_) + " messages are missing");
  is_at_end_ = true;
  return false;
}

// Whether a message of the next block may come before all of those that are open.
bool McapFile::wants_next(const OpenBlock* earliest) const {
  if (next_block_ == order_.size()) return false;
  if (earliest == nullptr) return true;
  if (open_bytes_ > most_) return false;
  if (line_.is_in_file_order) return open_.size() < 2;
  const Block& next = blocks_[order_[next_block_]];
  return next.first + line_.offset_of(ordinal_of(order_[next_block_])) <=
         earliest->messages[earliest->given].at;
}

void McapFile::open_next() {
  OpenBlock opened;
  if (!spare_.empty()) {
    opened.bytes = std::move(spare_.back());
    spare_.pop_back();
  }
  if (!load(order_[next_block_++], opened, Telling::kLosses)) {
    is_after_hole_ = true;
    return;
  }
  opened.is_after_hole = is_after_hole_;
  is_after_hole_ = false;
  for (const Located& each : opened.messages) {
    if (!was_looked_into_ && each.at < newest_) ++late_;
    newest_ = std::max(newest_, each.at);
  }
  std::stable_sort(opened.messages.begin(), opened.messages.end(),
                   [](const Located& a, const Located& b) { return a.at < b.at; });
  open_bytes_ += opened.bytes.size();
  open_.push_back(std::move(opened));
}

bool McapFile::load(std::size_t block, OpenBlock& opened, Telling telling) {
  const Block& about = blocks_[block];
  if (about.size > most_) {
    if (telling == Telling::kLosses)
      lose(about, "is of " + std::to_string(about.size) + " bytes, more than the " +
                      std::to_string(most_) + " that are read");
    return false;
  }
  if (!source_.move_to(about.place)) return false;
  if (about.is_chunk) {
    if (!decompress_chunk(about, opened.bytes, telling)) return false;
  } else if (!take(opened.bytes, about.size)) {
    return false;
  }
  read_records(block, opened, telling);
  return true;
}

bool McapFile::decompress_chunk(const Block& block, std::string& into, Telling telling) {
  const auto fail = [&](const std::string& why) {
    if (telling == Telling::kLosses) lose(block, why);
    return false;
  };
  const bool is_whole = take(body_, block.size);
  mcap::Fields fields(body_);
  const auto said = fields.read<mcap::Chunk>();
  if (!fields.is_good()) return is_whole && fail("is damaged");
  const std::string_view compressed = fields.rest().substr(0, said.compressed_size);
  Compression compression = Compression::kNone;
  if (said.compression == "zstd") {
    compression = Compression::kZstd;
  } else if (said.compression == "lz4") {
    compression = Compression::kLz4;
  } else if (!said.compression.empty()) {
    return fail("is compressed with something else than zstd or lz4");
  }
  if (said.size > most_)
    return fail("would take " + std::to_string(said.size) + " bytes of memory, more than the " +
                std::to_string(most_) + " that are spent");
  const Decompressed result = decompress_(compression, compressed, said.size, into);
  if (result == Decompressed::kTooLong) return fail("holds more than it says");
  const bool is_all = into.size() == said.size;
  if (said.checksum != 0 && is_all && said.checksum != mcap::checksum_of(into))
    return fail("is damaged: its checksum is wrong");
  // Compressed data may be followed by bytes that mean nothing: if all is there, it is.
  if (result == Decompressed::kDamaged && !(is_all && said.checksum != 0))
    return fail("is damaged: it cannot be decompressed");
  if (is_whole && !is_all) return fail("holds less than it says");
  return true;
}

// A chunk at which the file was cut off gives the records that are whole.
void McapFile::read_records(std::size_t block, OpenBlock& opened, Telling telling) {
  mcap::Fields fields(opened.bytes);
  std::size_t message = 0;
  while (!fields.rest().empty()) {
    const auto code = static_cast<std::uint8_t>(fields.bytes(1)[0]);
    const std::string_view body = fields.bytes(fields.u64());
    if (!fields.is_good()) {
      if (blocks_[block].is_whole && telling == Telling::kLosses)
        lose(blocks_[block], "is damaged: one of its records is longer than the chunk");
      return;
    }
    if (code == mcap::kSchema) read_schema(body);
    if (code == mcap::kChannel) read_channel(body);
    if (code == mcap::kMessage) read_message(body, ordinal_of(block, message++), opened, telling);
  }
}

void McapFile::read_schema(std::string_view body) {
  mcap::Fields fields(body);
  const auto schema = fields.read<mcap::Schema>();
  constexpr std::size_t kLongestName = 1024;
  if (!fields.is_good() || schema.id == 0 || schema.name.size() > kLongestName) return;
  const bool is_new =
      types_.try_emplace(schema.id, schema.name).second;  // Others of this number must be the same.
  if (is_new && schema.encoding == "ros2msg") contents_.define(schema.name, schema.text);
}

void McapFile::read_channel(std::string_view body) {
  mcap::Fields fields(body);
  const auto read = fields.read<mcap::Channel>();
  constexpr std::size_t kLongestName = 1024;
  if (!fields.is_good() || read.topic.size() > kLongestName || read.encoding.size() > kLongestName)
    return;
  const auto [channel, is_new] = channels_.try_emplace(read.id);
  if (!is_new) return;  // Others of this number must be the same.
  const auto type = types_.find(read.schema);
  BagTopic known{std::string(read.topic), type == types_.end() ? std::string() : type->second,
                 std::string(read.encoding)};
  mcap::Fields metadata(fields.text());
  while (!metadata.rest().empty() && metadata.is_good()) {
    const std::string_view key = metadata.text();
    const std::string_view value = metadata.text();
    if (key == "offered_qos_profiles") known.offered_qos = value;
  }
  channel->second = contents_.place_of(std::move(known));
}

void McapFile::read_message(std::string_view body, std::int64_t ordinal, OpenBlock& opened,
                            Telling telling) {
  mcap::Fields fields(body);
  const auto read = fields.read<mcap::Message>();
  const auto channel = channels_.find(read.channel);
  const auto at = static_cast<std::int64_t>(read.logged);
  const bool is_told = telling == Telling::kLosses;
  if (is_told) ++message_count_;
  if (!fields.is_good()) {
    if (is_told) contents_.lose_message("cut short");
    return;
  }
  if (channel == channels_.end()) {
    if (is_told) contents_.lose_message("of a topic that the file does not describe");
    return;
  }
  const auto offset = static_cast<std::size_t>(fields.rest().data() - opened.bytes.data());
  opened.messages.push_back({is_time(at) ? at + line_.offset_of(ordinal) : at, at, ordinal,
                             channel->second, offset, fields.rest().size()});
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
    to.resize(before + got);
    if (got < wanted) return false;
  }
  return true;
}

void McapFile::lose(const Block& block, const std::string& what) {
  contents_.lose(name_ + ": the " + (block.is_chunk ? "chunk" : "record") + " at byte " +
                 std::to_string(block.head) + " " + what + "; it is left out");
}

void McapFile::lose_rest(const RecordHead& head, const std::string& why) {
  contents_.lose(name_ + ": what follows byte " + std::to_string(head.place) + " is lost: " + why +
                 "; try mcap recover " + name_);
}

}  // namespace culprit::bag
