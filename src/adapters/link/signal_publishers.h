// The publisher of each diagnostic status that the rules read: one node.
//
// Anybody on the network can publish a status of any name. So a status counts only from the node
// that was the first to publish it, in this run or in an earlier one (KnownRobot::publishers).
// Another publisher of the same status is not used, and reported once.
//
//   - The node is known by its name: its successor after a restart is the same publisher.
//   - Once it was proven to be a process of this machine, only a proven process is it; and a proven
//     one replaces one that is not.
//   - A proven process replaces a node that left more than kForgets ago, whatever its name: a
//     driver may have another name each time.
//   - A component of the rule file that is proven counts besides: in SUAVE the vehicle and a controller publish one status.
//   - If the rules declare the publisher (SIGNAL … FROM), only that component counts, and nothing is
//     learned. Two signals may declare two components for one status.
//   - Many nodes publish statuses of others (drivers, aggregators), so the subject of a status
//     proves nothing.
//
// Pure: each question brings the time, and the known facts about a publisher.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "base/ids.h"
#include "base/time.h"

namespace culprit::link {

class SignalPublishers {
 public:
  static constexpr Duration kForgets = std::chrono::seconds(30);
  // Time in which only a proven process is learned: it may come a moment later than others, and a node may claim a writer
  // later than its first message.
  static constexpr Duration kClaimed = std::chrono::seconds(3);

  struct Publisher {
    std::string node{};      // full name; empty: no node claims the writer
    bool is_proven = false;  // to be a process of this machine
    bool counts = true;      // it is the one that holds the name, if others claim it, too
    std::optional<ComponentId> component{};  // of the rule file
    bool is_new =
        false;  // no node claims the writer, which was unknown kClaimed ago: no conflict yet
  };
  // Whether a node of this name is in the graph.
  using IsThere = std::function<bool(const std::string& node)>;

  // The rules read `status` FROM `component`, which is called `name`. Before the first question.
  void declare(const std::string& status, ComponentId component, const std::string& name);

  // An earlier run learned that. Before the first question.
  void remember(const std::string& status, const std::string& node);

  struct Answer {
    bool is_used = false;
    bool is_learned = false;  // from now on it is the publisher
    std::string conflict{};   // for people; empty: none, or it was reported
  };
  // May `by` report `status`?
  Answer judge(const std::string& status, const Publisher& by, Time now, const IsThere& is_there);

  // The conflicts that were reported, by status.
  const std::map<std::string, std::string>& conflicts() const { return conflicts_; }

 private:
  static constexpr std::size_t kMostConflicts = 1000;

  struct Bound {
    std::string node;
    bool is_proven = false;
    std::optional<Time> missed;  // since when there is no node of that name
  };
  struct Declared {
    std::set<ComponentId> components;
    std::string names;  // "left and right"
  };
  // A status, and the node that was declared for it; empty: none was.
  using Claim = std::pair<std::string, std::string>;
  Answer judge(const Claim& claim, const Publisher& by, Time now, const IsThere& is_there);
  Answer learn(const Claim& claim, const Publisher& by);
  Answer refuse(const std::string& status, const Publisher& by, const std::string& bound);
  Answer report(const std::string& status, const Publisher& by, const std::string& publishers);

  std::map<std::string, Declared> declared_;  // by status
  std::map<Claim, Bound> bound_;
  std::map<Claim, Time> first_;  // of those without a publisher: when the status first came
  std::set<std::pair<std::string, std::string>> told_;  // status, node
  std::map<std::string, std::string> conflicts_;
};

}  // namespace culprit::link
