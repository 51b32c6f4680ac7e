// A manager whose work browsers can follow: does what it does, and tells a hub. What it does is
// counted, too.
//
// Events are told as they happen. The graph and the present state are told when they have changed,
// but not more often than kPeriod, and only while somebody reads: a robot that nobody looks at pays
// nothing for being visible.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "manager/manager.h"
#include "web/event_json.h"
#include "web/hub.h"
#include "web/metrics.h"

namespace culprit::web {

class WatchedManager : public ManagingSystem {
 public:
  static constexpr Duration kPeriod = std::chrono::milliseconds(200);
  // After an event the state is told sooner, at most so often.
  static constexpr Duration kSoon = std::chrono::milliseconds(33);

  // All must outlive this. Events count their time from `start`.
  WatchedManager(Manager& manager, Hub& hub, Metrics& metrics, Time start);

  std::vector<Command> step(Time now, std::span<const Observation> observations) override;
  Time next_deadline() const override;
  std::span<const Event> events() const override { return manager_.events(); }

  // What people should know of nodes beyond what the manager knows, by full name: it is shown with
  // their components. May be empty.
  using Remarks = std::map<std::string, std::string>;
  std::function<Remarks()> remarks;

 private:
  void tell_events();
  void tell_state(Time now);
  void add_remarks(Json& state) const;

  Manager& manager_;
  Hub& hub_;
  Metrics& metrics_;
  const Time start_;
  Time told_ = kLongAgo;       // when the state was told last
  Time next_tell_ = kLongAgo;  // when it may be told again
  bool is_graph_new_ = true;
  std::string told_control_;
};

}  // namespace culprit::web
