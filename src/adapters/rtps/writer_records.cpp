#include "rtps/writer_records.h"

#include <algorithm>
#include <utility>

#include "base/invariant.h"

namespace culprit::rtps {

std::optional<std::int64_t> WriterRecords::furthest(const Guid& writer,
                                                    Clock::time_point now) const {
  const auto known = writers_.find(writer);
  if (known == writers_.end() || known->second.last == 0) return std::nullopt;
  const auto silence = std::chrono::duration<double>(now - known->second.heard).count();
  const auto ahead = static_cast<std::int64_t>(std::clamp(silence, 0.0, 1e6) * kPerSecond);
  return known->second.last + kAhead + ahead;
}

void WriterRecords::wrote(const Guid& guid, std::int64_t sequence, Clock::time_point now) {
  Writer& writer = writers_[guid];
  writer.last = std::max(writer.last, sequence);
  writer.heard = now;
}

// Memory that a reliable reader keeps for it: a sample of one byte needs a description, too.
std::size_t WriterRecords::kept_for(const Assembly& sample) {
  constexpr std::size_t kDescription = 512;  // bytes
  return sample.size + kDescription;
}

const char* WriterRecords::reserve(const Guid& guid, Reading how, const Fragments& fragments) {
  constexpr const char* kTooMuch = "fragments of more than fits the memory";
  const bool keeps_all = how == Reading::kReliable;
  Writer& writer = writers_[guid];
  auto found = writer.assemblies.find(fragments.sequence);
  if (found == writer.assemblies.end()) {
    const std::size_t of_one = keeps_all ? kReliableOfOne : kLargest;
    const std::size_t of_all = keeps_all ? kReliableOfAll : kLargestOfAll;
    if (!keeps_all && !writer.assemblies.empty() &&
        writer.assemblies.begin()->first > fragments.sequence)
      return nullptr;  // of an older sample, which the reader passes over
    Assembly wanted{fragments.size, fragments.fragment_size, {}, fragments.all};
    const std::size_t reserved =
        keeps_all ? writer.reserved + kept_for(wanted) : std::max(writer.reserved, wanted.size);
    if (reserved > of_one || total(how) - writer.reserved + reserved > of_all) return kTooMuch;
    total(how) += reserved - writer.reserved;
    writer.reserved = reserved;
    writer.how = how;
    if (keeps_all) wanted.seen.resize(wanted.missing);
    if (!keeps_all) writer.assemblies.clear();
    found = writer.assemblies.emplace(fragments.sequence, std::move(wanted)).first;
  }
  Assembly& assembly = found->second;
  if (assembly.size != fragments.size || assembly.fragment_size != fragments.fragment_size)
    return "fragments that contradict one another";
  if (!keeps_all || assembly.seen.empty()) return nullptr;
  const std::size_t before = std::size_t{fragments.first} - 1;
  for (std::size_t i = before; i < before + fragments.count; ++i) {
    if (assembly.seen[i]) continue;
    assembly.seen[i] = true;
    CULPRIT_ASSERT(assembly.missing > 0);  // its memory would never be given back
    --assembly.missing;
  }
  if (assembly.missing == 0) release(writer, found);
  return nullptr;
}

void WriterRecords::has_none_before(const Guid& writer, std::int64_t sequence) {
  const auto known = writers_.find(writer);
  if (known == writers_.end()) return;
  auto& assemblies = known->second.assemblies;
  while (!assemblies.empty() && assemblies.begin()->first < sequence)
    release(known->second, assemblies.begin());
}

// Below zero, the limits would be those of no memory.
void WriterRecords::give_back(const Writer& writer, std::size_t bytes) {
  std::size_t& all = total(writer.how);
  CULPRIT_ASSERT(bytes <= all);
  all -= bytes;
}

void WriterRecords::release(Writer& writer, std::map<std::int64_t, Assembly>::iterator which) {
  const std::size_t kept = kept_for(which->second);
  CULPRIT_ASSERT(kept <= writer.reserved);
  give_back(writer, kept);
  writer.reserved -= kept;
  writer.assemblies.erase(which);
}

void WriterRecords::forget(const Guid& guid) {
  const auto known = writers_.find(guid);
  if (known == writers_.end()) return;
  give_back(known->second, known->second.reserved);
  writers_.erase(known);
}

void WriterRecords::forget(const GuidPrefix& participant) {
  std::erase_if(writers_, [&](const auto& each) {
    if (each.first.prefix() != participant) return false;
    give_back(each.second, each.second.reserved);
    return true;
  });
}

}  // namespace culprit::rtps
