#include "bag_doctor/bag_incident.h"

#include <algorithm>
#include <map>
#include <memory>
#include <tuple>

#include <fmt/core.h>

#include "base/tool_names.h"
#include "diagnose/examination.h"
#include "language/checker.h"

namespace culprit::bag_doctor {
namespace {

using namespace std::chrono_literals;
using Kind = Symptom::Kind;

constexpr std::size_t kMostSymptoms = 400;  // of which a cause is sought

// For each node the nodes that it depends on directly.
std::map<std::string, std::set<std::string>> suppliers_in(const RobotGraph& graph) {
  std::map<std::string, std::set<std::string>> suppliers;
  for (const RobotGraph::Edge& edge : graph.edges) suppliers[edge.consumer].insert(edge.producer);
  for (const auto& [topic, readers] : graph.subscribers) {
    const auto writers = graph.publishers.find(topic);
    if (writers == graph.publishers.end() || is_topic_of_ros(topic)) continue;
    for (const std::string& reader : readers) {
      for (const std::string& writer : writers->second) {
        if (writer != reader) suppliers[reader].insert(writer);
      }
    }
  }
  return suppliers;
}

bool began_together(const Onset& a, const Onset& b) {
  constexpr Duration kTogether = 500ms;
  return a.earliest <= later(b.latest, kTogether) && b.earliest <= later(a.latest, kTogether);
}

// The rules by which core/diagnose sees the recording: components n0, n1, …; a rule s0, s1, … for each symptom; and for
// each component that is well a quiet rule of each kind for which there is evidence.
class Diagnosing {
 public:
  Diagnosing(const std::vector<Symptom>& symptoms, const std::vector<Owner>& owners,
             const std::vector<Health>& health, const RobotGraph& graph)
      : symptoms_(symptoms), graph_(graph) {
    for (const std::string& node : graph.nodes) place_of(node);
    std::string text;
    for (std::size_t i = 0; i < symptoms.size(); ++i)
      text += rule_text(fmt::format("s{}", i), place_of(owners[i].name),
                        symptoms[i].kind == Kind::kOutage || symptoms[i].kind == Kind::kState);
    std::set<std::size_t> ill, sends, measures;
    for (const Owner& owner : owners) ill.insert(place_of(owner.name));
    for (const Health& each : health) {
      const std::string node = publisher_of(each.topic, graph);
      if (node.empty() || ill.contains(place_of(node))) continue;
      sends.insert(place_of(node));
      if (each.has_values) measures.insert(place_of(node));
    }
    for (const std::size_t place : sends) text += rule_text(fmt::format("w{}", place), place, true);
    for (const std::size_t place : measures)
      text += rule_text(fmt::format("v{}", place), place, false);
    std::string head = "SIGNAL measured TOPIC /measured FIELD data\n";
    for (std::size_t n = 0; n < places_.size(); ++n)
      head += fmt::format("COMPONENT n{0} NODE /n{0} LAUNCH \"n\"\n", n);
    Checked checked = check(Source("recording", head + text));
    if (checked.rules) rules_ = std::make_unique<RuleSet>(std::move(*checked.rules));
    if (rules_ == nullptr) return;
    for (std::size_t r = 0; r < rules_->rules.size(); ++r)
      rule_ids_.emplace(rules_->rules[r].name, r);
  }

  struct Verdict {
    double own = 1;
    std::optional<std::size_t> because;  // the symptom that explains it most
  };

  // The verdict on symptom i, beside `others`.
  Verdict verdict(std::size_t i, const std::vector<std::size_t>& others) const {
    if (rules_ == nullptr) return {};
    Knowledge knowledge(*rules_);
    know_robot(knowledge);
    Time now = symptoms_[i].onset.latest;
    fail(i, knowledge);
    for (const std::size_t other : others) {
      fail(other, knowledge);
      now = std::max(now, symptoms_[other].onset.latest);
    }
    knowledge.now = now + 60s;  // no evidence is waited for
    const diagnose::Examination found(knowledge, knowledge.states.active());
    const auto& causes = found.causes();
    const std::size_t node = causes.index_of(rule(i));
    Verdict verdict{found.diagnosis().of(node), std::nullopt};
    double most = 0;
    const auto weigh = [&](std::size_t cause, double share) {
      if (share <= most || !causes[cause].is_rule()) return;
      if (const auto symptom = symptom_of(causes[cause].rule)) {
        most = share;
        verdict.because = symptom;
      }
    };
    found.diagnosis().for_each_share(node,
                                     [&](std::size_t cause, double share) { weigh(cause, share); });
    const auto& loop = causes.loops()[causes.loop_of(node)];
    for (const std::size_t member : loop) {
      if (member != node && found.diagnosis().of(member) > verdict.own)
        weigh(member, found.diagnosis().of(member));
    }
    return verdict;
  }

 private:
  static std::string rule_text(const std::string& name, std::size_t place, bool is_outage) {
    return fmt::format(
        "RULE {}\n  POLICIES ERROR\n  TRIGGER {}\n    STRATEGY again 50 10\n      ADAPTATION n{} "
        "redeploy 10\n",
        name, is_outage ? fmt::format("!alive(n{})", place) : "measured > 1", place);
  }

  std::size_t place_of(const std::string& node) {
    return places_.try_emplace(node, places_.size()).first->second;
  }

  void know_robot(Knowledge& knowledge) const {
    for (std::size_t c = 0; c < rules_->components.size(); ++c) {
      ComponentState& state = knowledge.components[ComponentId(c)];
      state.alive = true;
      state.lifecycle = Lifecycle::kActive;
      knowledge.graph.node_appeared(rules_->components[c].node);
      knowledge.discovered.note(ComponentId(c), Time{});
    }
    const auto appear = [&](const std::string& node, EndpointKind kind,
                            const std::string& channel) {
      if (const auto place = places_.find(node); place != places_.end())
        knowledge.graph.endpoint_appeared(fmt::format("/n{}", place->second), kind, channel);
    };
    for (const auto& [topic, nodes] : graph_.publishers) {
      if (is_topic_of_ros(topic)) continue;
      for (const std::string& node : nodes) appear(node, EndpointKind::kPublisher, topic);
    }
    for (const auto& [topic, nodes] : graph_.subscribers) {
      if (is_topic_of_ros(topic)) continue;
      for (const std::string& node : nodes) appear(node, EndpointKind::kSubscriber, topic);
    }
    for (const RobotGraph::Edge& edge : graph_.edges) {
      // A declared dependency has no channel: it gets one of its own.
      const std::string channel = edge.channel.empty() ? edge.producer + "/declared" : edge.channel;
      appear(edge.producer, EndpointKind::kPublisher, channel);
      appear(edge.consumer, EndpointKind::kSubscriber, channel);
    }
    for (const auto& [name, place] : rule_ids_) {
      if (name.starts_with('s')) continue;
      RuleState& state = knowledge.states.state(RuleId(place));
      state.detection.trigger = Slot::of(false);
      state.detection.last_false = Time{};
    }
  }

  void fail(std::size_t i, Knowledge& knowledge) const {
    const Symptom& symptom = symptoms_[i];
    RuleState& state = knowledge.states.state(rule(i));
    state.onset = symptom.onset;
    state.first_onset = symptom.onset.latest;
    state.failing_since = symptom.onset.latest;
    state.worked_until = symptom.onset.earliest;
    state.detection.trigger = Slot::of(true);
    state.detection.last_false = Time{};
    knowledge.states.enter(rule(i), RulePhase::kFailing);
  }

  RuleId rule(std::size_t i) const { return RuleId(rule_ids_.at(fmt::format("s{}", i))); }
  std::optional<std::size_t> symptom_of(RuleId rule) const {
    const std::string& name = (*rules_)[rule].name;
    if (!name.starts_with('s')) return std::nullopt;
    return std::stoul(name.substr(1));
  }

  const std::vector<Symptom>& symptoms_;
  const RobotGraph& graph_;
  std::map<std::string, std::size_t> places_;  // of components, by node
  std::unique_ptr<RuleSet> rules_;
  std::map<std::string, std::size_t> rule_ids_;
};

bool may_explain(const Symptom& cause, const Symptom& effect) {
  if (cause.onset.earliest > effect.onset.latest || cause.until < effect.onset.earliest)
    return false;
  const Duration reach = cause.kind == Kind::kWords ? kWordsReach : kLongestWay;
  return cause.onset.latest == kLongAgo ||
         later(cause.onset.latest, reach) >= effect.onset.earliest;
}

int rank_of(const BagIncident& incident, const std::vector<Symptom>& symptoms) {
  int worst = 0;
  for (const auto* some : {&incident.own, &incident.effects}) {
    for (const std::size_t i : *some)
      worst = std::max(worst, static_cast<int>(symptoms[i].finding.gravity));
  }
  return worst;
}

// A node of which nothing was recorded, and on which several incidents that began together depend, explains them all.
class UnseenCauses {
 public:
  UnseenCauses(const RobotGraph& graph, const std::vector<Symptom>& symptoms,
               const std::vector<Owner>& owners, const std::vector<Health>& health)
      : suppliers_(suppliers_in(graph)), symptoms_(symptoms) {
    for (const Owner& owner : owners) seen_.insert(owner.name);
    for (const Health& each : health) {
      seen_.insert(publisher_of(each.topic, graph));
      well_.insert(publisher_of(each.topic, graph));
    }
    for (const Owner& owner : owners) well_.erase(owner.name);
  }

  void join(std::vector<BagIncident>& incidents) const {
    for (std::size_t i = 0; i < incidents.size(); ++i) {
      std::vector<std::size_t> together = {i};
      if (!is_outage(incidents[i])) continue;
      std::set<std::string> common = unseen_above(incidents[i].cause);
      for (std::size_t k = i + 1; k < incidents.size(); ++k) {
        if (!is_outage(incidents[k]) || !began_together(incidents[i].onset, incidents[k].onset))
          continue;
        std::set<std::string> both;
        const std::set<std::string> others = unseen_above(incidents[k].cause);
        std::ranges::set_intersection(common, others, std::inserter(both, both.end()));
        if (both.empty()) continue;
        common = std::move(both);
        together.push_back(k);
      }
      if (together.size() < 2 || common.empty()) continue;
      merge(incidents, together, nearest(common, incidents[i].cause));
    }
  }

 private:
  bool is_outage(const BagIncident& incident) const {
    return incident.is_node && !incident.is_unseen && !incident.own.empty() &&
           symptoms_[incident.own.front()].kind == Kind::kOutage;
  }
  std::set<std::string> unseen_above(const std::string& node) const {
    std::set<std::string> above;
    std::vector<std::string> open = {node};
    while (!open.empty()) {
      const auto found = suppliers_.find(open.back());
      open.pop_back();
      if (found == suppliers_.end()) continue;
      for (const std::string& each : found->second) {
        if (!seen_.contains(each) && has_no_healthy_reader(each) && above.insert(each).second)
          open.push_back(each);
      }
    }
    return above;
  }
  bool has_no_healthy_reader(const std::string& node) const {
    return std::ranges::none_of(suppliers_, [&](const auto& each) {
      return each.second.contains(node) && well_.contains(each.first);
    });
  }
  // One that `node` reads itself, else the first by name.
  std::string nearest(const std::set<std::string>& common, const std::string& node) const {
    const auto direct = suppliers_.find(node);
    for (const std::string& each : common) {
      if (direct != suppliers_.end() && direct->second.contains(each)) return each;
    }
    return *common.begin();
  }
  static void merge(std::vector<BagIncident>& incidents, const std::vector<std::size_t>& some,
                    const std::string& cause) {
    BagIncident joined = incidents[some.front()];
    joined.cause = cause;
    joined.is_unseen = true;
    joined.effects.insert(joined.effects.begin(), joined.own.begin(), joined.own.end());
    joined.own.clear();
    for (auto it = some.rbegin(); it + 1 != some.rend(); ++it) {
      const BagIncident& other = incidents[*it];
      joined.effects.insert(joined.effects.end(), other.own.begin(), other.own.end());
      joined.effects.insert(joined.effects.end(), other.effects.begin(), other.effects.end());
      joined.until = std::max(joined.until, other.until);
      joined.onset.earliest = std::min(joined.onset.earliest, other.onset.earliest);
      joined.onset.latest = std::min(joined.onset.latest, other.onset.latest);
      incidents.erase(incidents.begin() + static_cast<std::ptrdiff_t>(*it));
    }
    std::ranges::sort(joined.effects);
    incidents[some.front()] = std::move(joined);
  }

  const std::map<std::string, std::set<std::string>> suppliers_;
  const std::vector<Symptom>& symptoms_;
  std::set<std::string> seen_;  // of which anything was recorded
  std::set<std::string> well_;
};

}  // namespace

std::vector<Owner> owners_of(const std::vector<Symptom>& symptoms, const RobotGraph& graph) {
  std::vector<Owner> owners;
  for (const Symptom& symptom : symptoms) {
    std::string node = symptom.node.empty() ? publisher_of(symptom.topic, graph) : symptom.node;
    if (node.empty() && !symptom.status.empty()) node = node_of_status(symptom.status, graph.nodes);
    const bool is_node = !node.empty();
    owners.push_back({is_node                 ? std::move(node)
                      : symptom.topic.empty() ? symptom.finding.subject
                                              : symptom.topic,
                      is_node});
  }
  // A topic with several publishers belongs to the one that has another symptom at that time.
  for (std::size_t i = 0; i < symptoms.size(); ++i) {
    const auto publishers = graph.publishers.find(symptoms[i].topic);
    if (owners[i].is_node || publishers == graph.publishers.end()) continue;
    for (std::size_t k = 0; k < symptoms.size() && !owners[i].is_node; ++k) {
      if (owners[k].is_node && publishers->second.contains(owners[k].name) &&
          began_together(symptoms[i].onset, symptoms[k].onset))
        owners[i] = owners[k];
    }
  }
  return owners;
}

std::vector<std::string> without_publisher(const std::vector<Symptom>& symptoms,
                                           const RobotGraph& graph) {
  const std::vector<Owner> owners = owners_of(symptoms, graph);
  std::set<std::string> topics;
  for (std::size_t i = 0; i < symptoms.size(); ++i) {
    if (!owners[i].is_node && !symptoms[i].topic.empty()) topics.insert(symptoms[i].topic);
  }
  return {topics.begin(), topics.end()};
}

std::vector<BagIncident> incidents_of(const std::vector<Symptom>& symptoms,
                                      const std::vector<Health>& health, const RobotGraph& graph) {
  const std::vector<Owner> owners = owners_of(symptoms, graph);
  std::vector<double> own(symptoms.size(), 1);
  std::vector<std::optional<std::size_t>> because(symptoms.size());
  if (graph.has_edges() && symptoms.size() <= kMostSymptoms) {
    const Diagnosing diagnosing(symptoms, owners, health, graph);
    for (std::size_t i = 0; i < symptoms.size(); ++i) {
      if (!owners[i].is_node) continue;
      std::vector<std::size_t> others;
      for (std::size_t k = 0; k < symptoms.size(); ++k) {
        if (k != i && owners[k].is_node && may_explain(symptoms[k], symptoms[i]))
          others.push_back(k);
      }
      const auto verdict = diagnosing.verdict(i, others);
      own[i] = verdict.own;
      if (verdict.own <= 0.5) because[i] = verdict.because;
    }
  }
  const auto root_of = [&](std::size_t i) {
    std::set<std::size_t> passed;
    while (because[i] && passed.insert(i).second) i = *because[i];
    return i;
  };
  std::vector<BagIncident> incidents;
  std::vector<std::size_t> place(symptoms.size());
  for (std::size_t i = 0; i < symptoms.size(); ++i) {
    if (root_of(i) != i) continue;
    const Symptom& symptom = symptoms[i];
    const auto same = std::ranges::find_if(incidents, [&](const BagIncident& each) {
      return each.cause == owners[i].name &&
             symptom.onset.earliest <= later(each.until, kWordsReach) &&
             each.onset.earliest <= later(symptom.until, kWordsReach);
    });
    place[i] = static_cast<std::size_t>(same - incidents.begin());
    if (same == incidents.end())
      incidents.push_back({.cause = owners[i].name,
                           .is_node = owners[i].is_node,
                           .certainty = own[i],
                           .onset = symptom.onset,
                           .until = symptom.until});
    BagIncident& incident = incidents[place[i]];
    incident.own.push_back(i);
    incident.until = std::max(incident.until, symptom.until);
  }
  for (std::size_t i = 0; i < symptoms.size(); ++i) {
    const std::size_t root = root_of(i);
    if (root == i) continue;
    BagIncident& incident = incidents[place[root]];
    (owners[i].name == incident.cause ? incident.own : incident.effects).push_back(i);
    incident.until = std::max(incident.until, symptoms[i].until);
  }
  for (BagIncident& each : incidents) std::ranges::sort(each.own);
  if (graph.has_edges()) UnseenCauses(graph, symptoms, owners, health).join(incidents);
  std::ranges::stable_sort(incidents, [&](const BagIncident& a, const BagIncident& b) {
    // A topic of which nobody knows the publisher is no cause that a person can look at.
    return std::tuple(-rank_of(a, symptoms), -std::ssize(a.effects), !a.is_node, a.onset.latest) <
           std::tuple(-rank_of(b, symptoms), -std::ssize(b.effects), !b.is_node, b.onset.latest);
  });
  return incidents;
}

}  // namespace culprit::bag_doctor
