#include "init/bag_draft.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "bag_doctor/habit.h"
#include "base/name_grammar.h"
#include "base/ros_names.h"
#include "base/tool_names.h"
#include "base/units.h"
#include "init/draft_names.h"
#include "init/measures.h"

namespace culprit::init {
namespace {

using namespace std::chrono_literals;
using bag_doctor::BagCourse;
using bag_doctor::FieldCourse;
using bag_doctor::TopicCourse;

constexpr std::size_t kFewestChanges = 30;
constexpr std::size_t kMostFields = 3;  // of a topic, in rules
constexpr Duration kPace = 5s;          // the window of rates

// One topic as each of the recordings has it.
using OverBags = std::vector<const TopicCourse*>;

const FieldCourse* field_of(const TopicCourse& topic, const std::string& path) {
  const auto found = std::ranges::find(topic.fields, path, &FieldCourse::path);
  return found == topic.fields.end() ? nullptr : &*found;
}

class BagDraft {
 public:
  explicit BagDraft(std::span<const BagCourse> bags) : bags_(bags) {}

  std::string text() {
    head();
    for (const TopicCourse& topic : bags_.front().topics) {
      if (is_topic_of_ros(topic.name) || topic.is_latched || !is_valid_topic_name(topic.name))
        continue;
      if (const OverBags all = over_bags(topic.name); !all.empty()) rules_of(topic.name, all);
    }
    for (const auto& [name, status] : bags_.front().statuses) rule_of_status(name);
    if (!left_out_.empty()) {
      text_ += "\n# Left out, since the recordings do not say enough:\n";
      for (const std::string& each : left_out_) text_ += "# " + each + "\n";
    }
    return std::move(text_);
  }

 private:
  void head() {
    double length = 0;
    for (const BagCourse& bag : bags_) length += seconds(Duration(bag.end - bag.begin));
    text_ = fmt::format(
        "# Drafted by culprit init --bag from {} recording{} of {:.0f} s. All rules only report.\n"
        "# Guesses are marked; more recordings make them better.\n"
        "# Say whether a recording can judge them: culprit check --bag BAG this.rules\n",
        bags_.size(), bags_.size() == 1 ? "" : "s", length);
    std::set<std::string> nodes;
    for (const BagCourse& bag : bags_) {
      for (const auto* some : {&bag.nodes, &bag.graph.nodes})
        nodes.insert(some->begin(), some->end());
    }
    std::erase_if(nodes, [](const std::string& node) {
      return is_tool_node(node) || !is_valid_topic_name(node);
    });
    if (nodes.empty()) return;
    text_ +=
        "#\n# proposal: components, once it is known how each is started. On the live robot, "
        "culprit init drafts that.\n";
    for (const std::string& node : nodes)
      text_ += fmt::format("#   COMPONENT {} NODE {}\n", names_.take(own_name(node)), node);
  }

  // Empty unless all recordings have messages of it.
  OverBags over_bags(const std::string& name) const {
    OverBags all;
    for (const BagCourse& bag : bags_) {
      const auto found = std::ranges::find(bag.topics, name, &TopicCourse::name);
      if (found == bag.topics.end() || found->times.empty()) return {};
      all.push_back(&*found);
    }
    return all;
  }

  void rules_of(const std::string& name, const OverBags& all) {
    const std::string base = name.substr(1);
    const bool is_steady = std::ranges::all_of(
        all, [](const TopicCourse* each) { return bag_doctor::habit_of(each->times).is_steady; });
    if (is_steady) {
      rule_of_silence(name, base, all);
      rule_of_rate(name, base, all);
    } else {
      left_out_.push_back(name + ": it has no steady rhythm in each of them");
    }
    rules_of_values(name, base, all);
  }

  // From the first message to the end of the recording: a topic that ends with its launch is not silent.
  std::vector<Duration> pauses(const OverBags& all) const {
    std::vector<Duration> pauses;
    for (std::size_t b = 0; b < all.size(); ++b) {
      const auto& times = all[b]->times;
      for (std::size_t i = 1; i < times.size(); ++i) pauses.emplace_back(times[i] - times[i - 1]);
      pauses.emplace_back(bags_[b].end - times.back());
    }
    return pauses;
  }

  void rule_of_silence(const std::string& name, const std::string& base, const OverBags& all) {
    const std::vector<Duration> some = pauses(all);
    const Duration longest = std::ranges::max(some);
    const Duration limit = rounded_up(std::max<Duration>(300ms, 3 * longest));
    text_ += fmt::format(
        "\n# guess: of {} pauses of {} none was longer than {:.3g} s. Fewer than one in {} is (95 "
        "% certain),\n"
        "# and an alarm needs one that is three times as long.\n"
        "RULE {}\n  POLICIES ERROR REPORT\n  TRIGGER age({}) > {}\n",
        some.size(), name, seconds(longest), static_cast<std::size_t>(1 / share_above(some.size())),
        names_.take(base, "_silent"), name, to_string(limit));
  }

  // Messages in the emptiest window, over all of them; nothing if none has a whole window.
  std::optional<std::size_t> fewest_in_window(const OverBags& all) const {
    std::optional<std::size_t> fewest;
    for (std::size_t b = 0; b < all.size(); ++b) {
      const auto& times = all[b]->times;
      std::size_t first = 0;
      const auto note = [&](std::int64_t end, std::size_t behind) {
        while (first < behind && times[first] <= end - kPace.count()) ++first;
        if (end - times.front() >= 2 * kPace.count())
          fewest = std::min(fewest.value_or(behind), behind - first);
      };
      for (std::size_t i = 0; i < times.size(); ++i) note(times[i] - 1, i);
      note(bags_[b].end, times.size());
    }
    return fewest;
  }

  void rule_of_rate(const std::string& name, const std::string& base, const OverBags& all) {
    constexpr std::size_t kFewest = 10;
    const auto fewest = fewest_in_window(all);
    if (!fewest || *fewest < kFewest) return;
    const double slowest = static_cast<double>(*fewest) / seconds(kPace);
    text_ += fmt::format(
        "\n# guess: in any 5 s {} came at {:.3g} Hz or more.\n"
        "RULE {}\n  POLICIES WARNING FOR 1s REPORT\n  TRIGGER rate({}, 5s) < {}\n",
        name, slowest, names_.take(base, "_slow"), name, as_number(0.7 * slowest));
  }

  struct Watched {
    std::string path;
    std::size_t count = 0;
    double least = 0, most = 0;
    Duration longest_row{};
  };

  // Numbers that were finite, and changed with nearly every message, in all recordings.
  std::vector<Watched> watched(const OverBags& all) const {
    std::vector<Watched> found;
    for (const FieldCourse& each : all.front()->fields) {
      if (each.path.find("covariance") != std::string::npos) continue;
      Watched field{each.path, 0, each.least, each.most};
      const bool is_fit = std::ranges::all_of(all, [&](const TopicCourse* topic) {
        const FieldCourse* course = field_of(*topic, each.path);
        if (course == nullptr || course->not_finite > 0 || course->changes < kFewestChanges)
          return false;
        field.count += course->count;
        field.least = std::min(field.least, course->least);
        field.most = std::max(field.most, course->most);
        field.longest_row =
            std::max(field.longest_row, Duration(course->longest.to - course->longest.from));
        return 10 * course->changes >= 7 * course->count;
      });
      if (is_fit && found.size() < kMostFields) found.push_back(std::move(field));
    }
    return found;
  }

  void rules_of_values(const std::string& name, const std::string& base, const OverBags& all) {
    const std::vector<Watched> fields = watched(all);
    if (fields.empty()) return;
    text_ += "\n";
    std::vector<std::string> signals;
    for (const Watched& each : fields) {
      signals.push_back(names_.take(base + "_" + each.path));
      text_ += fmt::format("SIGNAL {} TOPIC {} FIELD {}\n", signals.back(), name, each.path);
    }
    std::vector<std::string> nan, frozen;
    Duration longest{};
    for (const Watched& each : fields) longest = std::max(longest, each.longest_row);
    const Duration window = rounded_up(std::max<Duration>(2s, 5 * longest));
    for (const std::string& each : signals) {
      nan.push_back(fmt::format("isnan({})", each));
      frozen.push_back(fmt::format("frozen({}, {})", each, to_string(window)));
    }
    text_ += fmt::format("RULE {}\n  POLICIES ERROR REPORT\n  TRIGGER {}\n",
                         names_.take(base, "_nan"), fmt::join(nan, " || "));
    if (window <= 60s)
      text_ += fmt::format(
          "# guess: no value stayed as it was for longer than {:.3g} s. A robot that stands still "
          "may hold it longer.\n"
          "RULE {}\n  POLICIES WARNING REPORT\n  TRIGGER {}\n",
          seconds(longest), names_.take(base, "_frozen"), fmt::join(frozen, " && "));
    for (std::size_t i = 0; i < fields.size(); ++i) propose_limits(fields[i], signals[i]);
  }

  void propose_limits(const Watched& field, const std::string& signal) {
    const double span = field.most - field.least;
    text_ += fmt::format(
        "# proposal: {0} was {1} to {2}, {3} times. Less than {4:.2g} % of its values are outside "
        "(95 % certain).\n"
        "#   RULE {5}\n#     POLICIES WARNING FOR 1s REPORT\n#     TRIGGER {0} < {6} || {0} > "
        "{7}\n",
        signal, as_number(field.least), as_number(field.most), field.count,
        100 * share_outside(field.count), names_.take(signal, "_unusual"),
        as_number(field.least - span), as_number(field.most + span));
  }

  void rule_of_status(const std::string& name) {
    constexpr std::uint8_t kError = 2;
    const std::string written = as_written(name);
    if (written.empty())
      return left_out_.push_back("the diagnostic '" + printable(name) + "': rules cannot name it");
    std::size_t reports = 0;
    for (const BagCourse& bag : bags_) {
      const auto found = bag.statuses.find(name);
      if (found == bag.statuses.end()) return;
      reports += found->second.count;
      const bool was_bad = std::ranges::any_of(
          found->second.changes, [](const auto& change) { return change.level >= kError; });
      if (was_bad)
        return left_out_.push_back(
            fmt::format("level({}): it was an error, or stale, meanwhile", written));
    }
    text_ += fmt::format(
        "\n# {0} was no error in {1} reports.\nRULE {2}\n  POLICIES WARNING FOR 1s REPORT\n  "
        "TRIGGER level({0}) >= {3}\n",
        written, reports, names_.take(name, "_error"), kError);
  }

  std::span<const BagCourse> bags_;
  Names names_;
  std::string text_;
  std::vector<std::string> left_out_;
};

}  // namespace

std::string draft_of_bags(std::span<const BagCourse> bags) { return BagDraft(bags).text(); }

}  // namespace culprit::init
