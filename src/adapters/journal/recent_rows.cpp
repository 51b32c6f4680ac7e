#include "journal/recent_rows.h"

#include "base/invariant.h"
#include "journal/intent_file.h"

namespace culprit::journal {

const std::size_t RecentRows::kMaxBytes = IntentFile::kMaxBytes / 2;

void RecentRows::replace(std::uint64_t decision, std::span<const Entry> rows) {
  CULPRIT_ASSERT(recent_.empty() || recent_.back().decision <= decision);  // forget() goes in order
  if (recent_.empty() || recent_.back().decision != decision) recent_.push_back({decision, {}});
  std::string& text = recent_.back().rows;
  bytes_ -= text.size();
  text.clear();
  constexpr std::size_t kMostBeside = 30;  // of each row, beside its kind and its body
  std::size_t size = 0;
  for (const Entry& row : rows) size += kMostBeside + row.kind.size() + row.body.size();
  text.reserve(size);
  for (const Entry& row : rows) append_row(row, text);
  bytes_ += text.size();
}

void RecentRows::forget(std::uint64_t upto) {
  while (!recent_.empty() && recent_.front().decision <= upto) {
    bytes_ -= recent_.front().rows.size();
    recent_.pop_front();
  }
}

void RecentRows::append_to(std::string& all) const {
  for (const Recent& each : recent_) all += each.rows;
}

}  // namespace culprit::journal
