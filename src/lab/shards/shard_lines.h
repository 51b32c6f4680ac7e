// The lines of a shard file, one at a time: how far they are whole, and the first one's data that
// all kinds of campaign share.
#pragma once

#include <cstdint>
#include <istream>
#include <string>

#include "base/expected.h"
#include "json/json.h"
#include "shards/shard.h"

namespace culprit::study {

class ShardLines {
 public:
  enum class Line { kWhole, kTorn, kNone, kTooLong };

  // `name` is for messages; `in` lives longer.
  ShardLines(std::istream& in, std::string name) : in_(&in), name_(std::move(name)) {}

  Line read();
  const std::string& text() const { return text_; }  // of the line, without its end

  const std::string& name() const { return name_; }
  std::uint64_t good_bytes() const { return good_bytes_; }  // of the whole lines
  // With the file's name, the line's number and what can be done.
  Error error(const std::string& what) const;

 private:
  std::istream* in_;
  std::string name_;
  std::string text_;
  std::uint64_t number_ = 0;
  std::uint64_t good_bytes_ = 0;
};

struct ShardBeginning {
  std::string study;  // the campaign's kStudy
  Shard shard;
  Json campaign;
};

std::string beginning_line(const ShardBeginning& beginning);

// Reads the first line.
Expected<ShardBeginning> read_beginning(ShardLines& lines);

}  // namespace culprit::study
