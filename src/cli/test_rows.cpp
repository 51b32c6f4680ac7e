#include "cli/test_rows.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "journal/json.h"
#include "journal/reader.h"

namespace culprit::cli {

Rows::Rows(const std::filesystem::path& journal) {
  const auto reader = journal::Reader::open(journal);
  if (!reader) {
    ADD_FAILURE() << reader.error();
    return;
  }
  auto entries = reader->entries(journal::Which::kReadable);
  journal::Entry entry;
  while (entries) {
    const auto more = entries->next(entry);
    if (!more || !*more) return;
    rows_.push_back({std::chrono::nanoseconds(entry.at), entry.kind,
                     journal::text_of(parse_json(entry.body), "text")});
  }
}

std::optional<Row> Rows::first(const std::string& text, const std::optional<Row>& after) const {
  const auto found = std::find_if(rows_.begin(), rows_.end(), [&](const Row& row) {
    return row.text.find(text) != std::string::npos && (!after || row.at > after->at);
  });
  return found == rows_.end() ? std::nullopt : std::optional(*found);
}

std::size_t Rows::requests(const std::string& text) const {
  return static_cast<std::size_t>(std::count_if(rows_.begin(), rows_.end(), [&](const Row& row) {
    return row.kind == journal::kind::kIntent && row.text == text;
  }));
}

std::string Rows::all() const {
  std::string text;
  for (const Row& row : rows_)
    text += std::to_string(row.at.count() / 1'000'000) + " " + row.kind + " " + row.text + "\n";
  return text;
}

}  // namespace culprit::cli
