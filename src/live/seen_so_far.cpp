#include "live/seen_so_far.h"

#include <algorithm>

namespace culprit::live {
namespace {

// The number of the thing that an observation is about, if only its latest counts; empty for other
// observations.
struct NumberOf {
  using Number = std::optional<std::size_t>;

  Number operator()(const SampleArrived& o) const { return o.topic.index; }
  Number operator()(const SignalRead& o) const { return o.signal.index; }
  Number operator()(const DiagnosticRead& o) const { return o.diagnostic.index; }
  Number operator()(const ParameterRead& o) const { return o.parameter.index; }
  Number operator()(const LifecycleRead& o) const { return o.component.index; }
  Number operator()(const ProcessSeen& o) const { return o.component.index; }
  Number operator()(const LauncherSeen& o) const { return o.component.index; }
  Number operator()(const StartedHere& o) const { return o.component.index; }
  Number operator()(const ProcessWorked& o) const { return o.component.index; }
  Number operator()(const GoalsSeen& o) const { return o.topic.index; }
  Number operator()(const UsageSeen& o) const { return o.component.index; }
  Number operator()(const HostReached& o) const { return o.component.index; }
  Number operator()(const TimeHeld& o) const { return o.component.index; }
  Number operator()(const StartBarred& o) const { return o.component.index; }
  Number operator()(const Unloaded& o) const { return o.component.index; }
  Number operator()(const LivesOn& o) const { return o.component.index; }
  Number operator()(const EndsWith& o) const { return o.component.index; }
  Number operator()(const ParametersListed& o) const { return o.component.index; }
  Number operator()(const Probed& o) const {
    return o.answered ? Number(o.component.index) : std::nullopt;
  }
  template <class Other>
  Number operator()(const Other&) const {
    return std::nullopt;
  }
};

}  // namespace

void SeenSoFar::note(std::span<const Observation> observations) {
  if (!is_whole_) return;
  for (const Observation& each : observations) note(each);
  if (size() + statuses_.size() + hosts_.size() <= kMost) return;
  is_whole_ = false;
  named_.clear();
  numbered_.clear();
  statuses_.clear();
  hosts_.clear();
}

void SeenSoFar::note(const Observation& observation) {
  const Entry entry{++place_, observation, 1};
  if (const auto* node = std::get_if<NodeAppeared>(&observation.what)) {
    appeared(node->node, entry);
  } else if (const auto* gone = std::get_if<NodeVanished>(&observation.what)) {
    vanished(gone->node, entry);
  } else if (const auto* seen = std::get_if<NamesakesSeen>(&observation.what)) {
    const auto found = named_.find(seen->node);
    if (found != named_.end()) found->second.namesakes = entry;
  } else if (const auto* end = std::get_if<EndpointAppeared>(&observation.what)) {
    const auto found = named_.find(end->node);
    if (found == named_.end()) return;
    const auto [place, is_new] = found->second.ends.emplace(std::pair(end->kind, end->name), entry);
    if (is_new) {
      ++ends_;
    } else {
      ++place->second.count;
    }
  } else if (const auto* left = std::get_if<EndpointVanished>(&observation.what)) {
    const auto owner = named_.find(left->node);
    if (owner == named_.end()) return;
    const auto found = owner->second.ends.find({left->kind, left->name});
    if (found == owner->second.ends.end() || --found->second.count > 0) return;
    owner->second.ends.erase(found);
    --ends_;
  } else if (const auto* status = std::get_if<StatusHeard>(&observation.what)) {
    statuses_.insert_or_assign(status->name, entry);
  } else if (const auto* publisher = std::get_if<PublisherKnown>(&observation.what)) {
    statuses_.insert_or_assign("publisher of " + publisher->status, entry);
  } else if (const auto* host = std::get_if<HostHeard>(&observation.what)) {
    hosts_.insert_or_assign(host->host, entry);
  } else if (std::holds_alternative<HearingLost>(observation.what)) {
    deaf_ = entry;
  } else if (std::holds_alternative<HearingRegained>(observation.what)) {
    deaf_.reset();
    listens_from(observation.at);
  } else if (std::holds_alternative<Overslept>(observation.what)) {
    listens_from(observation.at);
  } else if (const auto* probe = std::get_if<Probed>(&observation.what)) {
    probed(*probe, entry);
  } else if (const auto number = std::visit(NumberOf(), observation.what)) {
    numbered_.insert_or_assign({observation.what.index(), *number}, entry);
  }
}

// Among consecutive probes without an answer, only a few affect a decision.
void SeenSoFar::probed(const Probed& probed, Entry entry) {
  constexpr int kMostCounted = 10;
  if (probed.node > 0) return;  // of its other nodes the next answer tells
  const auto known = unanswered_.find(probed.component);
  if (probed.answered) {
    if (known != unanswered_.end()) unanswered_.erase(known);
    numbered_.insert_or_assign({entry.observation.what.index(), probed.component.index}, entry);
  } else if (!deaf_) {
    if (known != unanswered_.end()) entry.count = std::min(known->second.count + 1, kMostCounted);
    unanswered_.insert_or_assign(probed.component, std::move(entry));
  }
}

// An answer before that may have been missed.
void SeenSoFar::listens_from(Time at) {
  since_ = std::max(since_, at);
  unanswered_.clear();
}

void SeenSoFar::appeared(const std::string& node, Entry entry) {
  if (const auto component = binding_.bind(node)) unanswered_.erase(*component);
  const auto known = named_.find(node);
  if (known != named_.end() && !known->second.vanished) {
    known->second.again = std::move(entry);
    return;
  }
  // Endpoints from before it vanished are announced again.
  if (known != named_.end()) {
    ends_ -= known->second.ends.size();
    named_.erase(known);
  }
  named_.emplace(node, Node{std::move(entry), {}, {}, {}, {}});
}

void SeenSoFar::vanished(const std::string& node, Entry entry) {
  const auto known = named_.find(node);
  if (known == named_.end()) return;
  if (binding_.bind(node)) {
    known->second.vanished = std::move(entry);
    return;
  }
  ends_ -= known->second.ends.size();
  named_.erase(known);
}

std::vector<Observation> SeenSoFar::observations() const {
  std::vector<const Entry*> entries;
  const auto add = [&](const std::optional<Entry>& entry) {
    if (entry) entries.push_back(&*entry);
  };
  add(deaf_);
  for (const auto& [name, node] : named_) {
    entries.push_back(&node.appeared);
    add(node.again);
    add(node.namesakes);
    add(node.vanished);
    for (const auto& [end, entry] : node.ends) {
      for (int i = 0; i < entry.count; ++i) entries.push_back(&entry);
    }
  }
  for (const auto& [what, entry] : numbered_) entries.push_back(&entry);
  for (const auto& [component, entry] : unanswered_) {
    for (int i = 0; i < entry.count; ++i) entries.push_back(&entry);
  }
  for (const auto& [name, entry] : statuses_) entries.push_back(&entry);
  for (const auto& [name, entry] : hosts_) entries.push_back(&entry);
  std::ranges::stable_sort(entries, {}, &Entry::place);
  std::vector<Observation> all;
  for (const Entry* entry : entries) {
    all.push_back(entry->observation);
    // Samples that were lost on the way before it belong to an unknown rhythm.
    if (auto* sample = std::get_if<SampleArrived>(&all.back().what)) *sample = {sample->topic};
  }
  return all;
}

}  // namespace culprit::live
