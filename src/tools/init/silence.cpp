#include "init/silence.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"
#include "init/measures.h"

namespace culprit::init {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kFewestMessages = 10;
constexpr double kMargin = 3;          // silence is so many times the longest pause that was seen
constexpr Duration kShortest = 300ms;  // less than this any busy machine is silent
constexpr Duration kLongest = 30s;     // what comes more rarely is no rhythm
constexpr double kMostIrregular = 5;   // longest pause to mean pause; more: it comes when it comes

std::string in_milliseconds(Duration time) {
  return fmt::format("{:.0f}ms", std::ceil(seconds(time) * 1000));
}

link::Rhythm rhythm_of(const RobotProfile& seen, const std::string& topic,
                       const std::string& node) {
  if (!node.empty()) {
    const auto publishers = seen.rhythms_of_publishers.find(topic);
    if (publishers == seen.rhythms_of_publishers.end()) return {};
    const auto own = publishers->second.find(node);
    return own == publishers->second.end() ? link::Rhythm{} : own->second;
  }
  const auto found = seen.rhythms.find(topic);
  return found == seen.rhythms.end() ? link::Rhythm{} : found->second;
}

}  // namespace

Expected<Duration> silence_of(const RobotProfile& seen, const std::string& topic,
                              const std::string& node) {
  const link::Rhythm rhythm = rhythm_of(seen, topic, node);
  if (rhythm.messages < kFewestMessages)
    return Error{fmt::format("{} messages came, too few for a rhythm", rhythm.messages)};
  const double mean = 1 / rate_of(seen, topic, node);
  const Duration limit =
      rounded_up(std::max(kShortest, from_seconds(kMargin * seconds(rhythm.longest_pause))));
  if (seconds(rhythm.longest_pause) > kMostIrregular * mean || limit > kLongest)
    return Error{fmt::format("it has no rhythm: {} messages, {} apart on average and {} at most",
                             rhythm.messages, in_milliseconds(from_seconds(mean)),
                             in_milliseconds(rhythm.longest_pause))};
  return limit;
}

double rate_of(const RobotProfile& seen, const std::string& topic, const std::string& node) {
  const link::Rhythm rhythm = rhythm_of(seen, topic, node);
  return static_cast<double>(rhythm.messages - 1) / seconds(rhythm.first_to_last);
}

std::string evidence_of_silence(const RobotProfile& seen, const std::string& topic,
                                const std::string& node) {
  const link::Rhythm rhythm = rhythm_of(seen, topic, node);
  return fmt::format(
      "# guess: {} had {:.3g} Hz: {} messages, at most {} apart.\n"
      "# With 95 % certainty, less than {:.2g} % of its gaps are longer. The timeout is {:.0f} "
      "times "
      "the longest gap, rounded up, and at least {}.\n",
      node.empty() ? topic : topic + " from " + node, rate_of(seen, topic, node), rhythm.messages,
      in_milliseconds(rhythm.longest_pause), 100 * share_above(rhythm.messages - 1), kMargin,
      to_string(kShortest));
}

}  // namespace culprit::init
