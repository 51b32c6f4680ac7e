#include "journal/unwritten.h"

#include <algorithm>
#include <deque>
#include <iterator>
#include <unordered_map>

#include "journal/json.h"

namespace culprit::journal {
namespace {

// The rows of the file by their content, each as often as it occurs there.
class RowsToFind {
 public:
  explicit RowsToFind(const std::vector<Entry>& rows) {
    for (std::size_t i = 0; i < rows.size(); ++i) places_[key_of(rows[i])].push_back(i);
  }

  // One more row of the journal.
  void see(const Entry& row) {
    const auto found = places_.find(key_of(row));
    if (found == places_.end() || found->second.empty()) return;
    found_ = std::max(found_, found->second.front() + 1);
    found->second.pop_front();
  }
  // The journal is written in the order of the file: the rows up to here are in it, also those that
  // are no longer what was written.
  std::size_t found() const { return found_; }

 private:
  static std::string key_of(const Entry& row) {
    return row.kind + "\n" + std::to_string(row.at) + "\n" + row.body;
  }

  std::unordered_map<std::string, std::deque<std::size_t>> places_;
  std::size_t found_ = 0;
};

// Whether this row of the journal means that all rows before it were written, or were lost and are
// over.
bool is_the_last_word(const Entry& row) {
  if (row.kind == kind::kEnd) return true;
  if (row.kind == kind::kSession) return !flag_of(parse_json(row.body), "continued");
  // Some waiting rows were dropped, and the rows about their results follow.
  if (row.kind == kind::kGap) return integer_of(parse_json(row.body), "rows") > 0;
  return false;
}

enum class Place : std::uint8_t { kThere, kDropped, kNotThere };

Expected<Place> place_of(const Link& row, const Reader& journal) {
  const auto anchor = journal.anchor();
  if (!anchor) return Error{anchor.error()};
  if (row.id < anchor->id) return Place::kDropped;
  if (row.id == anchor->id) return row.hash == anchor->hash ? Place::kThere : Place::kNotThere;
  auto rows = journal.entries(Which::kAll, row.id);
  if (!rows) return Error{rows.error()};
  Entry entry;
  const auto next = rows->next(entry);
  if (!next) return Error{next.error()};
  const bool is_it = *next && entry.id == row.id && hash_from(rows->hash()) == row.hash;
  return is_it ? Place::kThere : Place::kNotThere;
}

Expected<std::size_t> count_written(const SavedIntents& saved, const Reader& journal) {
  auto rows = journal.entries(Which::kReadable, saved.after.id + 1);
  if (!rows) return Error{rows.error()};
  RowsToFind sought(saved.rows);
  Entry entry;
  auto row = rows->next(entry);
  for (; row && *row; row = rows->next(entry)) {
    if (is_the_last_word(entry)) return saved.rows.size();
    sought.see(entry);
  }
  if (!row) return Error{row.error()};
  return sought.found();
}

}  // namespace

Unwritten unwritten_rows(const std::filesystem::path& intents, const Reader& journal) {
  Unwritten unwritten;
  const std::string name = "'" + intents.string() + "', the first record of requests, ";
  auto saved = read_intents(intents);
  if (!saved) {
    unwritten.remark = saved.error() + "; the last requests may be unknown";
    return unwritten;
  }
  if (!saved->damage.empty())
    unwritten.remark = name + "is not whole: " + saved->damage + "; what is before that counts";
  if (saved->rows.empty()) return unwritten;
  const auto place = place_of(saved->after, journal);
  if (!place) {
    unwritten.remark = name + "cannot be compared with the journal: " + place.error();
    return unwritten;
  }
  if (*place == Place::kDropped) return unwritten;  // long ago
  if (*place == Place::kNotThere) {
    unwritten.remark = name + "goes on from row " + std::to_string(saved->after.id) +
                       ", which the journal no longer has; nothing is done because of it";
    return unwritten;
  }
  const auto written = count_written(*saved, journal);
  if (!written) {
    unwritten.remark = name + "cannot be compared with the journal: " + written.error();
    return unwritten;
  }
  const auto first = saved->rows.begin() + static_cast<std::ptrdiff_t>(*written);
  unwritten.rows.assign(std::make_move_iterator(first), std::make_move_iterator(saved->rows.end()));
  if (!unwritten.rows.empty()) unwritten.latest = saved->latest;
  return unwritten;
}

}  // namespace culprit::journal
