#include "init/draft.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "base/name_grammar.h"
#include "base/ros_names.h"
#include "base/units.h"
#include "init/launch_text.h"
#include "init/names.h"
#include "language/line_reader.h"

namespace culprit::init {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kFewestMessages = 10;
constexpr double kMargin = 3;          // silence is so many times the longest pause that was seen
constexpr Duration kShortest = 300ms;  // less than this any busy machine is silent
constexpr Duration kLongest = 30s;     // what comes more rarely is no rhythm
constexpr double kMostIrregular = 5;   // longest pause to mean pause; more: it comes when it comes
constexpr double kRuleOfThree = 3;     // none in n: with 95 % certainty at most 3/n

// Up to the next number that people would write: 1, 1.5, 2, 3, 5 or 7.5 times a power of ten.
Duration rounded_up(Duration time) {
  const double power = std::pow(10, std::floor(std::log10(seconds(time))));
  for (const double step : {1.0, 1.5, 2.0, 3.0, 5.0, 7.5}) {
    if (step * power >= seconds(time)) return from_seconds(step * power);
  }
  return from_seconds(10 * power);
}

std::string in_milliseconds(Duration time) {
  return fmt::format("{:.0f}ms", std::ceil(seconds(time) * 1000));
}

std::string joined(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

// Node names are unique by their path only: "/left/wheel" and "/right/wheel".
std::map<std::string, std::string> component_names(const std::vector<std::string>& nodes) {
  std::map<std::string, int> uses;
  for (const std::string& node : nodes) ++uses[own_name(node)];
  std::map<std::string, std::string> names;
  std::set<std::string> taken(reserved_words().begin(), reserved_words().end());
  for (const std::string& node : nodes) {
    std::string name = uses[own_name(node)] > 1 ? node.substr(1) : own_name(node);
    std::replace(name.begin(), name.end(), '/', '_');
    while (!taken.insert(name).second) name += "_node";
    names[node] = name;
  }
  return names;
}

class Draft {
 public:
  explicit Draft(const Sighting& seen) : seen_(seen) {
    for (const auto& [name, node] : seen_.robot.nodes) {
      if (is_tool(name) || !is_valid_topic_name(name)) continue;
      if (const auto why = why_not(name, node)) {
        left_out_.push_back(name + ": " + *why);
      } else {
        nodes_.push_back(name);
      }
    }
    names_ = component_names(nodes_);
  }

  std::string text() {
    header();
    notes_on_starts();
    for (const std::string& node : nodes_) component(node);
    for (const std::string& node : nodes_) rule(node);
    topics_without_rule();
    statuses();
    if (!left_out_.empty()) {
      text_ += "\n# Left out, since it could not be found out:\n";
      for (const std::string& each : left_out_) text_ += "# " + each + "\n";
    }
    return text_;
  }

 private:
  // Why it cannot be started again; nothing if it can.
  std::optional<std::string> why_not(const std::string& name,
                                     const LiveInventory::Node& node) const {
    if (node.pid == 0)
      return "its process is not on this machine, or of another user. Write who starts it: "
             "LAUNCH, UNIT or CONTAINER";
    const auto start = seen_.starts.find(name);
    if (start == seen_.starts.end())
      return fmt::format("it could not be read how process {} was started", node.pid);
    for (const auto& [other, its] : seen_.robot.nodes) {
      if (other != name && its.pid == node.pid && !is_tool(other))
        return fmt::format("it lives in process {} with {}. Write what loads it: IN {} PLUGIN ...",
                           node.pid, other, other);
    }
    if (start->second.declare.starts_with("CONTAINER"))
      return start->second.owner + " runs it. Write CONTAINER with the engine and its name there";
    return std::nullopt;
  }

  void header() {
    text_ += fmt::format(
        "# Drafted by `culprit init` from what domain {} showed in {}, while it was taken to be "
        "well.\n# What culprit guessed is marked \"guess\". Read it, then try it: culprit run "
        "--dry-run FILE\n\nCYCLE 200ms\n\n",
        seen_.domain, to_string(seen_.looked));
  }

  // Who started them, and what of their environment is not repeated.
  void notes_on_starts() {
    std::map<std::string, std::vector<std::string>> launchers;
    std::set<std::string> withheld;
    for (const std::string& node : nodes_) {
      const Start& start = seen_.starts.at(node);
      if (!start.declare.empty()) continue;
      if (!start.owner.empty()) launchers[start.owner].push_back(names_.at(node));
      withheld.insert(start.withheld.begin(), start.withheld.end());
    }
    for (const auto& [owner, components] : launchers)
      text_ +=
          fmt::format("# guess: {} started {}. If it starts again what ends, write RESPAWNED.\n",
                      owner, fmt::join(components, ", "));
    if (!withheld.empty())
      text_ +=
          fmt::format("# Variables of theirs that are not copied, for they may be secrets: {}\n",
                      fmt::join(withheld, ", "));
  }

  void component(const std::string& node) {
    const Start& start = seen_.starts.at(node);
    text_ += "COMPONENT " + names_.at(node) + " NODE " + node + " " +
             (start.declare.empty() ? launch_text(start) : start.declare) + "\n";
  }

  void rule(const std::string& node) {
    const std::string& name = names_.at(node);
    const bool is_managed = seen_.robot.nodes.at(node).lifecycle == "active";
    std::string trigger = "!alive(" + name + ")";
    text_ += "\n";
    for (const auto& [topic, what] : seen_.robot.topics) {
      if (is_of_ros(topic) || !is_valid_topic_name(topic) || what.publishers != std::set{node})
        continue;
      const auto limit = silence_of(topic);
      if (!limit) continue;
      text_ += evidence(topic);
      trigger += " || age(" + topic + ") > " + to_string(*limit);
    }
    text_ += "RULE " + name + "_failed\n  POLICIES ERROR\n  TRIGGER " + trigger + "\n";
    text_ +=
        "    # guess: how often it helps, in percent; culprit learns that from every attempt\n";
    if (is_managed) strategy(name, "restart", 50, 10);
    strategy(name, "redeploy", 90, 25);
  }

  // The impact is in cycles: until the failure is gone.
  void strategy(const std::string& name, const std::string& what, int percent, int impact) {
    text_ += fmt::format("    STRATEGY {0}_{1} {2} 10\n      ADAPTATION {0} {1} {3}\n", name, what,
                         percent, impact);
  }

  // Silence is what is longer. Errors: why no rhythm can be told.
  Expected<Duration> silence_of(const std::string& topic) const {
    const auto found = seen_.rhythms.find(topic);
    const ros2::Rhythm rhythm = found == seen_.rhythms.end() ? ros2::Rhythm{} : found->second;
    if (rhythm.messages < kFewestMessages)
      return Error{fmt::format("{} messages came, too few for a rhythm", rhythm.messages)};
    const double mean = seconds(rhythm.first_to_last) / static_cast<double>(rhythm.messages - 1);
    const Duration limit =
        rounded_up(std::max(kShortest, from_seconds(kMargin * seconds(rhythm.longest_pause))));
    if (seconds(rhythm.longest_pause) > kMostIrregular * mean || limit > kLongest)
      return Error{fmt::format("it has no rhythm: {} messages, {} apart on average and {} at most",
                               rhythm.messages, in_milliseconds(from_seconds(mean)),
                               in_milliseconds(rhythm.longest_pause))};
    return limit;
  }

  std::string evidence(const std::string& topic) const {
    const ros2::Rhythm& rhythm = seen_.rhythms.at(topic);
    const auto pauses = static_cast<double>(rhythm.messages - 1);
    return fmt::format(
        "# guess: {} came {:.3g} times a second, {} messages, at most {} apart.\n"
        "# Less than {:.2g} % of its pauses are longer (95 % certain); silence is {:.0f} times "
        "that, {} "
        "at least.\n",
        topic, pauses / seconds(rhythm.first_to_last), rhythm.messages,
        in_milliseconds(rhythm.longest_pause), 100 * std::min(1.0, kRuleOfThree / pauses), kMargin,
        to_string(kShortest));
  }

  void topics_without_rule() {
    for (const auto& [topic, what] : seen_.robot.topics) {
      if (is_of_ros(topic) || !what.is_published()) continue;
      if (what.publishers.size() > 1) {
        left_out_.push_back(topic +
                            ": several nodes publish it, so its silence has no one to blame");
      } else if (const auto limit = silence_of(topic);
                 !limit && names_.contains(*what.publishers.begin())) {
        left_out_.push_back(topic + ": " + limit.error());
      }
    }
  }

  void statuses() {
    if (seen_.robot.diagnostics.empty()) return;
    text_ += "\n# Diagnostics that a rule may read. What would help?\n";
    for (const LiveInventory::Status& status : seen_.robot.diagnostics) {
      text_ += fmt::format("#   TRIGGER level(\"{}\") == 2", printable(status.name));
      if (!status.values.empty()) text_ += "   # keys: " + keys_of(status);
      text_ += "\n";
    }
  }

  static std::string keys_of(const LiveInventory::Status& status) {
    std::vector<std::string> keys;
    for (const auto& [key, value] : status.values) keys.push_back(printable(key));
    return joined(keys);
  }

  const Sighting& seen_;
  std::vector<std::string> nodes_;
  std::map<std::string, std::string> names_;
  std::vector<std::string> left_out_;
  std::string text_;
};

}  // namespace

std::string draft(const Sighting& seen) { return Draft(seen).text(); }

}  // namespace culprit::init
