// Observations of a culprit that only advises, so that it knows the robot if it becomes the
// manager: of each thing the latest one, with its time.
//
// A manager that begins with these stands where one would that had begun to watch at since(), and
// has heard of each topic once: nothing that was seen has to be discovered anew, and silences and
// ages go on where they are. Rates, rhythms and windows begin anew; until they are known, what reads
// them is unknown. Orders, replies and troubles are not kept.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "base/time.h"
#include "robot/component_binding.h"
#include "robot/observation.h"

namespace culprit::live {

class SeenSoFar {
 public:
  // More things than that are not kept track of.
  static constexpr std::size_t kMost = 1 << 16;

  // `rules` must outlive it. Watching begins at `start`.
  SeenSoFar(const RuleSet& rules, Time start) : binding_(rules), since_(start) {}

  // In the order in which they were made.
  void note(std::span<const Observation> observations);

  // Before that culprit did not listen: messages that were missing until then need not have been
  // missing on the robot.
  Time since() const { return since_; }
  // False: there were too many things, so that a manager has to discover the robot by itself.
  bool is_whole() const { return is_whole_; }
  // In the order in which they were made.
  std::vector<Observation> observations() const;

 private:
  struct Entry {
    std::uint64_t place;  // in the order of all
    Observation observation;
    int count;  // how often: ends of one node that have one name, probes
  };
  struct Node {
    Entry appeared;              // first, since it vanished last
    std::optional<Entry> again;  // told once more since: its process is known now, or is another
    std::optional<Entry> namesakes;
    std::optional<Entry> vanished;  // of components only
    std::map<std::pair<EndpointKind, std::string>, Entry> ends;
  };

  void note(const Observation& observation);
  void listens_from(Time at);
  void probed(const Probed& probed, Entry entry);
  void appeared(const std::string& node, Entry entry);
  void vanished(const std::string& node, Entry entry);
  std::size_t size() const { return named_.size() + numbered_.size() + ends_; }

  ComponentBinding binding_;
  Time since_;
  bool is_whole_ = true;
  std::uint64_t place_ = 0;
  std::optional<Entry> deaf_;
  std::map<std::string, Node> named_;  // by name
  std::size_t ends_ = 0;               // of all nodes
  // By the kind of observation, and what it is about.
  std::map<std::tuple<std::size_t, std::size_t>, Entry> numbered_;
  std::map<ComponentId, Entry> unanswered_;  // probes in a row, the last of them
  std::map<std::string, Entry> statuses_;    // by name
  std::map<std::string, Entry> hosts_;       // HostHeard, by name
};

}  // namespace culprit::live
