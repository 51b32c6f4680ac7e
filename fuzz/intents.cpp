// Files of intents (journal/intent_file.h): whatever their bytes, they are read to their end or to the
// first row that culprit did not write. The intents can be written again unchanged; the next run can append to the valid part of the file.
//
// So that the fuzzer comes behind the checksums, input that does not begin as such a file does is one
// payload in an otherwise good one.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

#include "journal/recovery.h"
#include "journal/writer.h"
#include "language/checker.h"

namespace {

using namespace culprit;

const RuleSet& rules() {
  static const RuleSet set = *check(Source("fuzz.rules", R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Silent
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms
    STRATEGY redeploy 50 10
      ADAPTATION camera redeploy 5
    STRATEGY tune 50 10
      ADAPTATION camera increase_parameter gain 0.5 5
)"))
                                  .rules;
  return set;
}

// A folder of this process, gone with it, with a journal of one run.
struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("culprit-fuzz-intents-" + std::to_string(getpid()));
  std::filesystem::path journal = path / "a.journal";
  journal::Link newest;
  Folder() {
    std::filesystem::create_directory(path);
    auto writer = journal::Writer::open(journal, {});
    journal::Session session;
    session.boot = journal::boot_id();
    (void)writer->append({{{0, 1, "session", to_line(journal::to_json(session))}}, {}}, 1,
                         journal::Durability::kProcessEnd);
    newest = writer->newest();
  }
  ~Folder() { std::filesystem::remove_all(path); }
};

std::string as_written(const journal::SavedIntents& saved, const Folder& folder) {
  auto file = journal::IntentFile::open(folder.journal);
  if (!file) __builtin_trap();
  file->begin_after(journal::IntentFile::Head(saved.after));
  std::string rows;
  for (const journal::Entry& row : saved.rows) journal::append_row(row, rows);
  if (!file->append(saved.latest, rows)) return "";
  std::ifstream in(journal::intents_beside(folder.journal), std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

bool is_same(const std::vector<journal::Entry>& a, const std::vector<journal::Entry>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
    return x.at == y.at && x.kind == y.kind && x.body == y.body;
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  std::string bytes(reinterpret_cast<const char*>(data), size);
  if (!bytes.starts_with("culprit-intents")) {
    auto file = journal::IntentFile::open(folder.journal);
    if (!file) __builtin_trap();
    file->begin_after(journal::IntentFile::Head(folder.newest));
    if (!file->append(Time(std::chrono::seconds(1)), bytes)) return 0;
  } else {
    std::ofstream(journal::intents_beside(folder.journal), std::ios::binary) << bytes;
  }
  const auto reader = journal::Reader::open(folder.journal);
  if (!reader) __builtin_trap();
  const auto unwritten = journal::unwritten_rows(journal::intents_beside(folder.journal), *reader);
  (void)journal::recover(*reader, unwritten, rules(), {Time(std::chrono::hours(1)), 1});

  const auto saved = journal::read_intents(journal::intents_beside(folder.journal));
  if (!saved) __builtin_trap();
  const std::string again = as_written(*saved, folder);
  if (again.empty()) return 0;  // it was larger than such a file
  const journal::SavedIntents twice = journal::decode_intents(again);
  if (!twice.damage.empty() || !is_same(saved->rows, twice.rows)) __builtin_trap();
  return 0;
}
