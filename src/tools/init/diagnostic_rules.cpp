#include "init/diagnostic_rules.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/name_grammar.h"
#include "base/ros_names.h"
#include "base/tool_names.h"
#include "base/units.h"
#include "init/measures.h"

namespace culprit::init {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kFewestValues = 10;
constexpr std::size_t kMostKeysProposed = 10;  // of one status
constexpr Duration kShortestStale = 5s;
constexpr double kPeriodsUntilStale = 3;
constexpr std::uint8_t kError = 2;

// How rules call a status, as they write it: by what no other status is called. Empty if there is no
// such thing.
std::string called(const link::Survey::StatusKey& status, const RobotProfile& seen) {
  for (const std::string& name : {status.first, status.second}) {
    const auto is_so_called = [&](const auto& other) {
      return other.first.first == name || other.first.second == name;
    };
    if (!name.empty() && std::ranges::count_if(seen.statuses, is_so_called) == 1)
      return as_written(name);
  }
  return "";
}

// A number that goes up and down. A number that only rises is a counter; one that never changes gives no range.
bool has_range(const link::ValueCourse& value) {
  return value.numbers >= kFewestValues && value.others == 0 && value.rose && value.fell;
}

std::string stale(const link::StatusCourse& course, Duration looked) {
  const double period = seconds(looked) / static_cast<double>(course.messages);
  return to_string(rounded_up(std::max(kShortestStale, from_seconds(kPeriodsUntilStale * period))));
}

class Limits {
 public:
  Limits(const RobotProfile& seen, Names& names, std::vector<std::string>& left_out)
      : seen_(seen), names_(names), left_out_(left_out) {}

  std::vector<Part> parts() {
    for (const auto& each : seen_.statuses) {
      if (!is_culprits_status(each.first.first, each.first.second)) status(each.first, each.second);
    }
    return std::move(parts_);
  }

 private:
  void status(const link::Survey::StatusKey& key, const link::StatusCourse& course) {
    const std::string name = printable(key.first.empty() ? key.second : key.first);
    const std::string written = called(key, seen_);
    if (written.empty())
      return left_out_.push_back(fmt::format(
          "the diagnostic '{}': others are called so, too, or rules cannot name it", name));
    const std::string base = names_.take(key.first.empty() ? key.second : key.first);
    if (course.worst >= kError)
      return left_out_.push_back(fmt::format("level({}): it was {} meanwhile. What is wrong there?",
                                             written,
                                             course.worst == kError ? "an error" : "stale"));
    add(Part::Kind::kLevel, written,
        fmt::format(
            "# guess: {0} was {1} in {2} messages. If it is an error, a person is notified.\n"
            "RULE {3}\n  POLICIES WARNING FOR 1s REPORT\n  TRIGGER level({0}) >= {4}\n",
            written, course.worst == 0 ? "OK" : "a warning at worst", course.messages,
            names_.take(base, "_error"), kError));
    propose_keys(written, base, course);
  }

  void propose_keys(const std::string& status, const std::string& base,
                    const link::StatusCourse& course) {
    std::size_t proposed = 0;
    for (const auto& each : course.keys) {
      const std::string key = as_written(each.first);
      if (key.empty() || !has_range(each.second)) continue;
      if (++proposed > kMostKeysProposed) {
        return add(Part::Kind::kComment, "",
                   fmt::format("# And more keys of {} that vary.\n", status));
      }
      propose(status, base, key, each.second, stale(course, seen_.looked));
    }
  }

  // As far again as what was seen spans, on both sides.
  void propose(const std::string& status, const std::string& base, const std::string& key,
               const link::ValueCourse& value, const std::string& stale_after) {
    const std::string name = names_.take(base + "_" + key);
    const double span = value.most - value.least;
    add(Part::Kind::kLimit, status + " " + key,
        fmt::format("# proposal: {0} of {1} was {2} to {3}, {4} times. Less than {5:.2g} % of its "
                    "values are "
                    "outside (95 % certain).\n"
                    "#   SIGNAL {6} DIAGNOSTIC {1} KEY {0} STALE {7}\n"
                    "#   RULE {8}\n"
                    "#     POLICIES WARNING FOR 1s REPORT\n"
                    "#     TRIGGER {6} < {9} || {6} > {10}\n",
                    key, status, as_number(value.least), as_number(value.most), value.numbers,
                    100 * share_outside(value.numbers), name, stale_after,
                    names_.take(name, "_unusual"), as_number(value.least - span),
                    as_number(value.most + span)));
  }

  void add(Part::Kind kind, std::string subject, std::string text) {
    parts_.push_back({.kind = kind, .subject = std::move(subject), .text = std::move(text)});
  }

  const RobotProfile& seen_;
  Names& names_;
  std::vector<std::string>& left_out_;
  std::vector<Part> parts_;
};

}  // namespace

std::vector<Part> limits(const RobotProfile& seen, Names& names,
                         std::vector<std::string>& left_out) {
  return Limits(seen, names, left_out).parts();
}

}  // namespace culprit::init
