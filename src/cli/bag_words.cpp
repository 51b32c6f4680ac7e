#include "cli/bag_words.h"

#include <cmath>

#include <fmt/core.h>

#include "base/name_grammar.h"
#include "cli/journal_file.h"

namespace culprit::cli {
namespace {

constexpr double kPerSecond = 1e9;

}  // namespace

std::string clock_text(std::int64_t at) { return local_time(at); }

std::string clock_document(std::int64_t at) { return utc_time(at); }

std::string describe(const bag::ClockJump& jump, std::int64_t start) {
  const double by = static_cast<double>(jump.by) / kPerSecond;
  return fmt::format(
      "{} by {:.3f} s at {:.3f} s ({}); time goes on from message to message",
      by < 0 ? "the clock was set back" : "the clock was set forward, or nothing was recorded,",
      std::abs(by), static_cast<double>(jump.at - start) / kPerSecond,
      clock_text(jump.recorded_at));
}

void print_bag_troubles(const bag::BagFile& bag, std::int64_t start) {
  for (const bag::ClockJump& each : bag.contents().jumps())
    fmt::print(stderr, "culprit: {}\n", describe(each, start));
  for (const std::string& each : bag.contents().remarks())
    fmt::print(stderr, "culprit: {}\n", escape_controls(each));
  for (const std::string& each : bag.contents().losses())
    fmt::print(stderr, "culprit: the bag is not whole: {}\n", escape_controls(each));
}

void add_bag_troubles(Json& document, const bag::BagFile& bag, std::int64_t start) {
  Json jumps = Json::array();
  for (const bag::ClockJump& each : bag.contents().jumps())
    jumps.push_back({{"at_s", static_cast<double>(each.at - start) / kPerSecond},
                     {"by_s", static_cast<double>(each.by) / kPerSecond},
                     {"clock", clock_document(each.recorded_at)}});
  document["clock_jumps"] = std::move(jumps);
  document["remarks"] = bag.contents().remarks();
  document["lost"] = bag.contents().losses();
}

}  // namespace culprit::cli
