// States that nodes report about themselves: diagnostics, logs, lifecycle states, and the quality of service that they offer.
#include <algorithm>

#include <fmt/core.h>

#include "bag_doctor/examined.h"
#include "base/name_grammar.h"
#include "base/tool_names.h"
#include "doctor/wording.h"

namespace culprit::bag_doctor {
namespace {

using namespace std::chrono_literals;
using doctor::duration;
using doctor::Gravity;
using Kind = Symptom::Kind;

constexpr Duration kStartingUp = 5s;  // errors until then are over as a rule
constexpr std::uint8_t kError = 2, kStale = 3;

void look_at_level(const StatusCourse& status, const Examined& bag, Symptoms& all) {
  const BagCourse& course = bag.course;
  const auto& changes = status.changes;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const StatusCourse::Change& change = changes[i];
    if (change.level != kError && change.level != kStale) continue;
    const bool lasts = i + 1 == changes.size();
    const Nanoseconds until = lasts ? status.last : changes[i + 1].at;
    const bool is_sudden =
        i > 0 && change.at > course.begin + Nanoseconds(Duration(kStartingUp).count());
    const bool is_failure = change.level == kError && is_sudden &&
                            (lasts || until - change.at >= Nanoseconds(Duration(1s).count()));
    // A report comes late: once a second, as a rule.
    const Time before = i > 0 ? time_of(change.at) - 1s : kLongAgo;
    all.push_back(
        {.kind = Kind::kWords,
         .finding = {"D020",
                     is_failure ? Gravity::kError : Gravity::kWarning,
                     "diagnostics: " + printable(status.name),
                     fmt::format("it was {} for {}{}: \"{}\"",
                                 change.level == kError ? "at ERROR" : "STALE",
                                 duration(Duration(until - change.at)),
                                 lasts ? ", until the recording ended" : "",
                                 printable(change.message)),
                     "a node, or an aggregator of others, says itself that something does not work",
                     "look at its values in the recording",
                     {},
                     ""},
         .node = node_of_status(status.name, course.nodes),
         .status = status.name,
         .onset = {before, time_of(change.at)},
         .until = lasts ? kNever : time_of(until),
         .words = "reported \"" + printable(change.message) + "\""});
    return;  // the first one shows it
  }
}

void look_at_missing_reports(const StatusCourse& status, const Examined& bag, Symptoms& all) {
  if (status.count < 5 || status.changes.empty()) return;
  const Nanoseconds first = status.changes.front().at;
  const Duration usual = Duration(status.last - first) / static_cast<int>(status.count - 1);
  const Duration silent(bag.end - status.last);
  if (silent <= std::max<Duration>(5s, 5 * usual)) return;
  all.push_back(
      {.kind = Kind::kOutage,
       .finding =
           {"D021",
            Gravity::kWarning,
            "diagnostics: " + printable(status.name),
            fmt::format(
                "its last report came {} before the recording ended; until then one came every {}",
                duration(Duration(bag.course.end - status.last)), duration(usual)),
            "the node that reports it hung or ended; screens still show its last report",
            "see the log of that node at that time",
            {},
            ""},
       .node = node_of_status(status.name, bag.course.nodes),
       .status = status.name,
       .onset = {time_of(status.last), time_of(status.last) + usual},
       .words = "did not report \"" + printable(status.name) + "\" any more"});
}

// The node of a logger: itself, or the one that it is a part of.
std::string node_of_logger(const std::string& logger, const BagCourse& course) {
  for (std::string name = logger; !name.empty(); name.resize(name.rfind('/'))) {
    if (course.graph.nodes.contains(name) || course.transitions.contains(name)) return name;
  }
  return logger;
}

void look_at_log(const std::string& logger, const LogCourse& log, const BagCourse& course,
                 Symptoms& all) {
  const LogCourse::Line& first = log.first.front();
  all.push_back(
      {.kind = Kind::kWords,
       .finding = {"D212",
                   log.fatals > 0 ? Gravity::kError : Gravity::kWarning,
                   "log of " + printable(logger),
                   fmt::format("it has {} at ERROR{}; the first: \"{}\"",
                               doctor::count_of(log.errors, "message"),
                               log.fatals > 0 ? fmt::format(" and {} at FATAL", log.fatals) : "",
                               printable(first.text)),
                   "the node says itself that something does not work",
                   "read its log around that time",
                   {logger},
                   "/rosout"},
       .node = node_of_logger(logger, course),
       .onset = {time_of(first.at), time_of(first.at)},
       .until = time_of(log.last),
       .words = "logged \"" + printable(first.text) + "\""});
}

void look_at_transitions(const std::string& node, const std::vector<Transition>& some,
                         const Examined& bag, Symptoms& all) {
  for (std::size_t i = 0; i < some.size(); ++i) {
    const Transition& each = some[i];
    const bool has_failed = each.to == "errorprocessing" ||
                            (each.from == "activating" && each.to == "inactive") ||
                            (each.from == "configuring" && each.to == "unconfigured");
    const bool was_left =
        each.from == "active" || each.from == "deactivating" || each.to == "finalized";
    const bool is_away =
        each.to == "inactive" || each.to == "finalized" || each.to == "unconfigured";
    const bool is_shutdown = each.at > bag.end - Nanoseconds(Duration(kStartingUp).count());
    if (!has_failed && (!was_left || !is_away || is_shutdown)) continue;
    const auto back = std::find_if(some.begin() + static_cast<std::ptrdiff_t>(i), some.end(),
                                   [](const Transition& t) { return t.to == "active"; });
    all.push_back(
        {.kind = Kind::kState,
         .finding = {"D211",
                     has_failed ? Gravity::kError : Gravity::kWarning,
                     node,
                     fmt::format("it went from {} to {}{}", printable(each.from),
                                 printable(each.to),
                                 back == some.end() ? " and was not active again" : ""),
                     "a node that is not active publishes nothing, and its consumers wait",
                     has_failed ? "read its log around that time"
                                : "see which manager or person deactivated it",
                     {node},
                     ""},
         .node = node,
         .onset = {time_of(each.at), time_of(each.at)},
         .until = back == some.end() ? kNever : time_of(back->at),
         .words = "left its active state"});
    return;
  }
}

void look_at_offers(const std::string& topic, const std::vector<OfferedQos>& offers,
                    const BagCourse& course, Symptoms& all) {
  const auto differ = [&](const std::string OfferedQos::*member) {
    return std::ranges::any_of(offers, [&](const OfferedQos& each) {
      return !(each.*member).empty() && !(offers.front().*member).empty() &&
             each.*member != offers.front().*member;
    });
  };
  std::string seen;
  if (differ(&OfferedQos::reliability)) seen = "its publishers offer reliable and best effort";
  if (differ(&OfferedQos::durability)) seen = "its publishers offer transient local and volatile";
  if (topic == "/tf_static" || topic.ends_with("/tf_static")) {
    if (std::ranges::any_of(offers,
                            [](const OfferedQos& each) { return each.durability == "volatile"; }))
      seen = "a publisher offers it as volatile";
  }
  if (seen.empty() || topic == "/rosout" || topic == "/parameter_events") return;
  all.push_back(
      {.kind = Kind::kValue,
       .finding = {"D213",
                   Gravity::kWarning,
                   topic,
                   seen,
                   "a subscription that requests more gets the messages of some publishers only",
                   "let all of its publishers offer the same",
                   {},
                   topic},
       .topic = topic,
       .onset = {kLongAgo, time_of(course.begin)},
       .words = "offered less on " + topic});
}

}  // namespace

std::string node_of_status(const std::string& status, const std::set<std::string>& nodes) {
  const std::string name = status.substr(0, status.find(':'));
  std::string found;
  for (const std::string& node : nodes) {
    if (node == name || node == "/" + name) return node;
    if (!node.ends_with("/" + name)) continue;
    if (!found.empty()) return "";  // several are called so
    found = node;
  }
  return found;
}

void look_at_states(const Examined& bag, Symptoms& all) {
  for (const auto& [name, status] : bag.course.statuses) {
    look_at_level(status, bag, all);
    look_at_missing_reports(status, bag, all);
  }
  for (const auto& [logger, log] : bag.course.logs) {
    if (!log.first.empty() && !is_culprits_node(logger)) look_at_log(logger, log, bag.course, all);
  }
  for (const auto& [node, transitions] : bag.course.transitions)
    look_at_transitions(node, transitions, bag, all);
  for (const auto& [topic, offers] : bag.course.offers)
    look_at_offers(topic, offers, bag.course, all);
}

}  // namespace culprit::bag_doctor
