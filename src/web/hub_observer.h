// Publishes a manager's events and state to browsers, through a hub; and counts them.
//
// Events are published as they happen. The graph and the present state are published when they have
// changed, but not more often than kPeriod, and only while a client reads: without clients, a robot
// pays nothing for being visible.
#pragma once

#include <functional>
#include <string>

#include "http/hub.h"
#include "live/observer.h"
#include "web/event_json.h"
#include "web/metrics.h"

namespace culprit::web {

class HubObserver : public live::Observer {
 public:
  static constexpr Duration kPeriod = std::chrono::milliseconds(200);
  // After an event the state is published sooner, at most this often.
  static constexpr Duration kSoon = std::chrono::milliseconds(33);

  // The learned couplings, latencies and coincidences are published at most this often.
  static constexpr Duration kLearnedPeriod = std::chrono::seconds(1);

  // Seconds since 1970: what people read off a wall, while the robot may count otherwise.
  using WallClock = std::function<double()>;
  static double wall_clock();

  // Hub and metrics must outlive this.
  HubObserver(http::Hub& hub, Metrics& metrics, WallClock wall = wall_clock)
      : hub_(hub), metrics_(metrics), wall_(std::move(wall)) {}

  void joined(ros2::NodeEntry& node) override;
  void leaves() override;
  // Remarks are shown with the components of their nodes.
  void begins(const Manager& manager, std::function<Remarks()> remarks, Time start) override;
  void stepped(const Runtime::Step& step) override;
  Time next_look() const override { return hub_.has_readers() ? next_tell_ : kNever; }
  void announced(Time at, const EventWords& words, const std::string& text) override;

 private:
  void tell_event(Json json);
  void tell_events(std::span<const Event> events);
  void tell_state(Time now);
  void add_remarks(Json& state) const;

  http::Hub& hub_;
  Metrics& metrics_;
  const WallClock wall_;
  const Manager* manager_ = nullptr;  // null: none has begun
  std::function<Remarks()> remarks_;
  Time start_{};
  Time told_ = kLongAgo;  // when the state was told last
  Time told_learned_ = kLongAgo;
  Time next_tell_ = kLongAgo;  // when it may be told again
  bool is_graph_new_ = true;
  std::string told_control_;
};

}  // namespace culprit::web
