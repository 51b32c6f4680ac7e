#include "bag_doctor/bag_report.h"

#include <algorithm>

#include <fmt/core.h>

#include "bag_doctor/examined.h"
#include "doctor/doctor_report.h"
#include "doctor/wording.h"

namespace culprit::bag_doctor {
namespace {

using doctor::Finding;
using doctor::Gravity;

class Writer {
 public:
  Writer(const BagCourse& course, const RobotGraph& graph)
      : course_(course),
        graph_(graph),
        symptoms_(symptoms_of(course)),
        owners_(owners_of(symptoms_, graph)) {}

  BagReport write() {
    BagReport report{course_.path, course_.begin_clock, Duration(course_.end - course_.begin),
                     course_.messages, course_.topics.size()};
    for (const BagIncident& each :
         incidents_of(symptoms_, healthy_topics(course_, symptoms_), graph_))
      add(each, report);
    for (const std::string& each : course_.left_out) report.left_out.push_back(each);
    for (const std::string& each : course_.losses)
      report.left_out.push_back("the bag is not whole: " + each);
    report.left_out.insert(report.left_out.end(), course_.remarks.begin(), course_.remarks.end());
    say_missing_evidence(report);
    return report;
  }

 private:
  doctor::When when_of(const Onset& onset, Time until) const {
    const Time begin = time_of(course_.begin), end = time_of(course_.end);
    const Time from = std::clamp(onset.earliest == kLongAgo ? begin : onset.earliest, begin, end);
    const Time to = std::clamp(until, from, end);
    return {seconds(from - begin), seconds(to - begin), clock_at(from)};
  }

  // As the recorder's clock showed it.
  std::int64_t clock_at(Time time) const {
    std::int64_t clock = time.time_since_epoch().count() + course_.begin_clock - course_.begin;
    for (const BagCourse::Jump& jump : course_.jumps)
      clock += time_of(jump.at) <= time ? jump.by : 0;
    return clock;
  }

  // "/scan" is known to be of /lidar: "/scan: /lidar".
  Finding finding_of(std::size_t i) const {
    Finding finding = symptoms_[i].finding;
    finding.when = when_of(symptoms_[i].onset, symptoms_[i].until);
    if (!owners_[i].is_node) return finding;
    if (finding.subject != owners_[i].name) finding.subject += ": " + owners_[i].name;
    finding.nodes = {owners_[i].name};
    return finding;
  }

  std::string in_words(std::size_t i, Time since) const {
    const Time at = symptoms_[i].onset.earliest;
    const std::string after = at > since ? fmt::format(" (+{:.2f} s)", seconds(at - since)) : "";
    return owners_[i].name + " " + symptoms_[i].words + after;
  }

  Finding cause_of(const BagIncident& incident) const {
    const Time since = std::max(incident.onset.earliest, time_of(course_.begin));
    std::vector<std::string> own, others, nodes = {incident.cause};
    Gravity gravity = Gravity::kWarning;
    for (const std::size_t i : incident.own) {
      own.push_back(symptoms_[i].words);
      gravity = std::max(gravity, symptoms_[i].finding.gravity);
    }
    for (const std::size_t i : incident.effects) {
      others.push_back(in_words(i, since));
      if (std::ranges::find(nodes, owners_[i].name) == nodes.end())
        nodes.push_back(owners_[i].name);
      gravity = std::max(gravity, symptoms_[i].finding.gravity);
    }
    std::string seen =
        incident.is_unseen
            ? "nothing of it was recorded, and components that depend on it failed at once"
            : "it " + doctor::listed(own);
    if (!others.empty()) seen += "; then " + doctor::listed(others, 5);
    return {
        "D200",
        gravity,
        incident.cause,
        std::move(seen),
        others.empty()
            ? "it is the most likely cause"
            : fmt::format("it is the most likely cause; {} of other components {} explained by it",
                          doctor::count_of(others.size(), "finding"),
                          others.size() == 1 ? "is" : "are"),
        incident.is_unseen ? "see its log and its process at that time, and record its topics, too"
                           : "repair it first: see its log and its process at that time",
        std::move(nodes),
        "",
        when_of(incident.onset, incident.until)};
  }

  void add(const BagIncident& incident, BagReport& report) const {
    BagReport::Incident told{incident.cause, incident.is_node, incident.certainty,
                             when_of(incident.onset, incident.until)};
    told.first = report.findings.size();
    if (incident.is_node &&
        (incident.own.size() + incident.effects.size() > 1 || incident.is_unseen))
      report.findings.push_back(cause_of(incident));
    for (const auto* some : {&incident.own, &incident.effects}) {
      for (const std::size_t i : *some) report.findings.push_back(finding_of(i));
    }
    for (const std::size_t i : incident.effects) {
      if (std::ranges::find(told.effects, owners_[i].name) == told.effects.end())
        told.effects.push_back(owners_[i].name);
    }
    told.count = report.findings.size() - told.first;
    report.incidents.push_back(std::move(told));
  }

  void say_missing_evidence(BagReport& report) const {
    std::vector<std::string> silent;
    for (const TopicCourse& topic : course_.topics) {
      const bool is_told = std::ranges::any_of(
          symptoms_, [&](const Symptom& symptom) { return symptom.topic == topic.name; });
      if (topic.times.empty() && !is_told) silent.push_back(topic.name);
    }
    if (!silent.empty())
      report.left_out.push_back(fmt::format(
          "announced without a message, which may be by design: {}", doctor::listed(silent, 8)));
    if (symptoms_.empty()) return;
    const std::vector<std::string> unknown = without_publisher(symptoms_, graph_);
    const char* remedy =
        "add --graph FILE (culprit graph --json > FILE), or --rules FILE with DEPENDENCY";
    if (!unknown.empty())
      report.left_out.push_back(
          fmt::format("the recording does not say which node publishes {}: {}",
                      doctor::listed(unknown), remedy));
    if (!graph_.has_edges() && symptoms_.size() > 1)
      report.left_out.push_back(fmt::format(
          "the recording does not say which nodes depend on which, so no cause is named: {}",
          remedy));
  }

  const BagCourse& course_;
  const RobotGraph& graph_;
  const std::vector<Symptom> symptoms_;
  const std::vector<Owner> owners_;
};

}  // namespace

BagReport report_of(const BagCourse& course, const RobotGraph& given) {
  RobotGraph graph = course.graph;
  graph.add(given);
  graph.nodes.insert(course.nodes.begin(), course.nodes.end());
  return Writer(course, graph).write();
}

Json to_json(const BagReport& report) {
  Json incidents = Json::array(), findings = Json::array();
  for (const BagReport::Incident& each : report.incidents) {
    Json places = Json::array();
    for (std::size_t i = 0; i < each.count; ++i) places.push_back(each.first + i);
    incidents.push_back({{"cause", each.cause},
                         {"is_node", each.is_node},
                         {"certainty", each.certainty},
                         {"from_s", each.when.from},
                         {"until_s", each.when.until},
                         {"clock", static_cast<double>(each.when.clock) / 1e9},
                         {"effects", each.effects},
                         {"findings", std::move(places)}});
  }
  for (const Finding& each : report.findings) findings.push_back(doctor::to_json(each));
  return {{"bag", report.path},
          {"begin", static_cast<double>(report.begin) / 1e9},
          {"length_s", seconds(report.length)},
          {"messages", report.messages},
          {"topics", report.topics},
          {"incidents", std::move(incidents)},
          {"findings", std::move(findings)},
          {"left_out", report.left_out}};
}

std::string summary(const BagReport& report) {
  const auto count = [&](Gravity gravity) {
    return static_cast<std::size_t>(
        std::ranges::count(report.findings, gravity, &Finding::gravity));
  };
  return fmt::format(
      "{}, {:.1f} s, {} of {}: {}", report.path, seconds(report.length),
      doctor::count_of(report.messages, "message"), doctor::count_of(report.topics, "topic"),
      report.findings.empty() ? "nothing is wrong that the recording shows"
                              : doctor::count_of(count(Gravity::kError), "error") + ", " +
                                    doctor::count_of(count(Gravity::kWarning), "warning"));
}

}  // namespace culprit::bag_doctor
