#include "bag_doctor/policy.h"

#include <algorithm>
#include <charconv>
#include <sstream>

#include <fmt/core.h>

#include "bag_doctor/habit.h"
#include "doctor/wording.h"

namespace culprit::bag_doctor {
namespace {

using doctor::duration;
using doctor::Finding;
using doctor::Gravity;

std::optional<double> number_in(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value >= 0))
    return std::nullopt;
  return value;
}

class PolicyReader {
 public:
  Expected<Policy> read(std::string_view text) {
    std::istringstream lines{std::string(text)};
    for (std::string line; std::getline(lines, line);) {
      ++line_;
      std::istringstream words(line.substr(0, line.find('#')));
      words_.assign(std::istream_iterator<std::string>(words), {});
      if (words_.empty()) continue;
      const Expected<void> done =
          words_[0] == "TOPIC" ? topic()
          : words_[0] == "PAIR"
              ? pair()
              : wrong("a line begins with TOPIC or PAIR, not with '" + words_[0] + "'");
      if (!done) return Error{done.error()};
    }
    return std::move(policy_);
  }

 private:
  Error wrong(const std::string& why) const { return {fmt::format("line {}: {}", line_, why)}; }

  Expected<void> topic() {
    if (words_.size() < 2 || !words_[1].starts_with('/'))
      return wrong("TOPIC needs the full name of a topic: TOPIC /scan");
    Policy::Wish wish{words_[1]};
    for (std::size_t i = 2; i < words_.size(); i += 2) {
      const std::string& word = words_[i];
      if (i + 1 == words_.size()) return wrong(word + " needs a value");
      const std::string& value = words_[i + 1];
      if (word == "RATE") {
        if (const auto done = rate(value, wish); !done) return done;
      } else if (word == "GAP") {
        const auto gap = parse_duration(value);
        if (!gap) return wrong("GAP needs a duration, as 500ms: " + gap.error());
        wish.gap = *gap;
      } else if (word == "COVERAGE") {
        const auto share = number_in(std::string_view(value).substr(0, value.find('%')));
        if (!share || *share > 100 || !value.ends_with('%'))
          return wrong("COVERAGE needs a share, as 95%");
        wish.coverage = *share / 100;
      } else {
        return wrong("'" + word + "' is none of RATE, GAP and COVERAGE");
      }
    }
    policy_.topics.push_back(std::move(wish));
    return {};
  }

  Expected<void> rate(const std::string& text, Policy::Wish& wish) {
    const std::size_t dots = text.find("..");
    const std::string least = text.substr(0, dots);
    const std::string most = dots == std::string::npos ? "" : text.substr(dots + 2);
    if (dots != std::string::npos && least.empty() && most.empty())
      return wrong("RATE needs a limit: RATE 9..11");
    if (!least.empty() && !(wish.least_rate = number_in(least)))
      return wrong("RATE needs numbers in Hz: RATE 9..11");
    if (!most.empty() && !(wish.most_rate = number_in(most)))
      return wrong("RATE needs numbers in Hz: RATE 9..11");
    return {};
  }

  Expected<void> pair() {
    if (words_.size() != 5 || words_[3] != "OFFSET")
      return wrong("PAIR needs two topics and an offset: PAIR /left /right OFFSET 20ms");
    const auto offset = parse_duration(words_[4]);
    if (!offset) return wrong("OFFSET needs a duration, as 20ms: " + offset.error());
    policy_.pairs.push_back({words_[1], words_[2], *offset});
    return {};
  }

  Policy policy_;
  int line_ = 0;
  std::vector<std::string> words_;
};

class PolicyCheck {
 public:
  explicit PolicyCheck(const BagCourse& course) : course_(course) {}

  void check(const Policy::Wish& wish) {
    const TopicCourse* topic = find(wish.topic);
    if (topic == nullptr)
      return breach(wish.topic, "it has no message in this recording", course_.begin, course_.end);
    check_rate(*topic, wish);
    check_gap(*topic, wish);
    check_coverage(*topic, wish);
  }

  void check(const Policy::Pair& pair) {
    const TopicCourse* first = find(pair.first);
    const TopicCourse* second = find(pair.second);
    for (const auto& [topic, name] : {std::pair(first, pair.first), {second, pair.second}}) {
      if (topic == nullptr)
        return breach(name, "it has no message in this recording", course_.begin, course_.end);
    }
    const bool has_stamps = !first->stamps.empty() && !second->stamps.empty();
    std::vector<Nanoseconds> others = has_stamps ? second->stamps : second->times;
    std::ranges::sort(others);
    std::vector<Duration> offsets;
    for (const Nanoseconds at : has_stamps ? first->stamps : first->times) {
      const auto behind = std::ranges::lower_bound(others, at);
      Duration nearest = Duration::max();
      if (behind != others.end()) nearest = Duration(*behind - at);
      if (behind != others.begin()) nearest = std::min(nearest, Duration(at - *std::prev(behind)));
      offsets.push_back(nearest);
    }
    std::ranges::sort(offsets);
    const Duration usual = offsets[(offsets.size() - 1) * 95 / 100];
    if (usual > pair.offset)
      breach(pair.first,
             fmt::format(
                 "the nearest message of {} is up to {} away (95 % of them), and {} is allowed",
                 pair.second, duration(usual), duration(pair.offset)),
             course_.begin, course_.end);
  }

  std::vector<Finding> take() { return std::move(found_); }

 private:
  const TopicCourse* find(const std::string& name) const {
    const auto found = std::ranges::find(course_.topics, name, &TopicCourse::name);
    return found == course_.topics.end() || found->times.empty() ? nullptr : &*found;
  }

  void check_rate(const TopicCourse& topic, const Policy::Wish& wish) {
    if (!wish.least_rate && !wish.most_rate) return;
    const double span = seconds(Duration(topic.times.back() - topic.times.front()));
    const double rate = span > 0 ? static_cast<double>(topic.times.size() - 1) / span : 0;
    const auto limit = [](std::optional<double> value) {
      return value ? fmt::format("{:g}", *value) : "";
    };
    if (rate < wish.least_rate.value_or(0) || rate > wish.most_rate.value_or(rate))
      breach(topic.name,
             fmt::format("its rate is {:.3g} Hz, and {}..{} is required", rate,
                         limit(wish.least_rate), limit(wish.most_rate)),
             topic.times.front(), topic.times.back());
  }

  // All pauses, those at both ends of the recording too.
  std::vector<Stretch> pauses(const TopicCourse& topic) const {
    std::vector<Stretch> all;
    Nanoseconds last = course_.begin;
    for (const Nanoseconds at : topic.times) {
      all.push_back({last, at});
      last = at;
    }
    all.push_back({last, course_.end});
    return all;
  }

  void check_gap(const TopicCourse& topic, const Policy::Wish& wish) {
    if (!wish.gap) return;
    const auto all = pauses(topic);
    const Stretch& longest = *std::ranges::max_element(all, {}, &Stretch::length);
    if (longest.length() > *wish.gap)
      breach(topic.name,
             fmt::format("it paused for {}, and {} is allowed", duration(longest.length()),
                         duration(*wish.gap)),
             longest.from, longest.to);
  }

  void check_coverage(const TopicCourse& topic, const Policy::Wish& wish) {
    const Duration length(course_.end - course_.begin);
    if (!wish.coverage || length <= Duration::zero()) return;
    const auto all = pauses(topic);
    std::vector<Duration> lengths;
    for (const Stretch& each : all) lengths.push_back(each.length());
    std::ranges::sort(lengths);
    const Duration most = 2 * lengths[lengths.size() / 2];
    Duration uncovered{};
    for (const Duration each : lengths) uncovered += std::max(each - most, Duration::zero());
    const double share = 1 - seconds(uncovered) / seconds(length);
    if (share < *wish.coverage)
      breach(topic.name,
             fmt::format("it covers {:.1f} % of the recording, and {:g} % are required",
                         100 * share, 100 * *wish.coverage),
             course_.begin, course_.end);
  }

  void breach(const std::string& topic, std::string seen, Nanoseconds from, Nanoseconds to) {
    found_.push_back({"D214",
                      Gravity::kError,
                      topic,
                      std::move(seen),
                      "a pipeline that relies on it will fail or be wrong",
                      "record again, or change the policy",
                      {},
                      topic,
                      doctor::When{seconds(Duration(from - course_.begin)),
                                   seconds(Duration(to - course_.begin)), from}});
  }

  const BagCourse& course_;
  std::vector<Finding> found_;
};

}  // namespace

Expected<Policy> parse_policy(std::string_view text) { return PolicyReader().read(text); }

std::vector<Finding> breaches(const Policy& policy, const BagCourse& course) {
  PolicyCheck check(course);
  for (const Policy::Wish& each : policy.topics) check.check(each);
  for (const Policy::Pair& each : policy.pairs) check.check(each);
  return check.take();
}

}  // namespace culprit::bag_doctor
