#include "journal/verify.h"

#include <map>

#include "journal/json.h"

namespace culprit::journal {
namespace {

// The newest beliefs in the rows, to compare with the table of beliefs.
class Replayed {
 public:
  void follow(const Entry& entry) {
    if (entry.kind != kind::kBelief) return;
    const Json body = parse_json(entry.body);
    if (!body.is_object()) return;
    if (body.contains("forgotten")) {
      const std::string rule = text_of(body, "forgotten");
      std::erase_if(beliefs_,
                    [&](const auto& each) { return rule.empty() || each.first.first == rule; });
      return;
    }
    beliefs_[{text_of(body, "rule"), text_of(body, "strategy")}] = {number_of(body, "alpha"),
                                                                    number_of(body, "beta")};
  }

  void compare(const Learned& learned, std::vector<std::string>& findings) const {
    for (const LearnedBelief& each : learned.beliefs) {
      const auto row = beliefs_.find({each.rule, each.strategy});
      if (row == beliefs_.end() || row->second == each.belief) continue;
      findings.push_back("the belief in " + each.strategy + " of " + each.rule +
                         " differs from its last row");
    }
  }

 private:
  std::map<std::pair<std::string, std::string>, Belief> beliefs_;
};

}  // namespace

Expected<Verification> verify(const Reader& journal, const std::optional<Link>& noted) {
  Verification result;
  const auto anchor = journal.anchor();
  if (!anchor) return Error{anchor.error()};
  Link last = *anchor;
  bool is_noted_seen = !noted || (last.id == noted->id && last.hash == noted->hash);
  if (noted && noted->id < last.id) is_noted_seen = true;  // dropped for size or age since
  auto rows = journal.entries(Which::kAll, INT64_MIN);
  if (!rows) return Error{rows.error()};
  Hasher hasher;
  Replayed replayed;
  Entry entry;
  auto more = rows->next(entry);
  for (; more && *more; more = rows->next(entry)) {
    if (result.rows++ == 0) result.first = entry.id;
    if (entry.id != last.id + 1)
      result.findings.push_back("rows are missing between " + std::to_string(last.id) + " and " +
                                std::to_string(entry.id));
    const auto stored = hash_from(rows->hash());
    if (entry.id == last.id + 1 && (!stored || hasher.link(last.hash, entry) != *stored))
      result.findings.push_back("row " + std::to_string(entry.id) + " (" + entry.kind +
                                ") is not what was written");
    last = {entry.id, stored.value_or(Hash{})};
    if (noted && last.id == noted->id && last.hash == noted->hash) is_noted_seen = true;
    replayed.follow(entry);
  }
  if (!more) return Error{more.error()};
  if (!is_noted_seen)
    result.findings.push_back("row " + std::to_string(noted->id) +
                              " is not there with the hash that was noted");
  result.newest = last;
  const auto learned = journal.learned();
  if (!learned) return Error{learned.error()};
  replayed.compare(*learned, result.findings);
  return result;
}

}  // namespace culprit::journal
