// Reports a manager's findings and actions in messages of culprit_msgs. It knows no middleware:
// its creator publishes the messages (ros_api.h).
//
// - Status: the present state. When it has changed, at most every kPeriod.
// - Incident: incident_watch.h.
// - Decision: as they happen; beyond kMostDecisions in a second they are counted and left out.
//
// So it costs little however much happens on the robot, and nothing while nothing happens.
#pragma once

#include <functional>
#include <string>

#include "live/observer.h"
#include "ros_api/incident_watch.h"

namespace culprit::ros_api {

enum class Topic : std::uint8_t { kStatus, kIncidents, kDecisions };

class Teller : public live::Observer {
 public:
  static constexpr Duration kPeriod = std::chrono::milliseconds(250);
  static constexpr std::uint32_t kMostDecisions = 50;  // a second

  // A message, as message_codec.h takes it. Called on the thread that manages; must not block.
  using Tell = std::function<void(Topic topic, const Json& message)>;
  using WallClock = std::function<WallTime()>;

  // `types` outlive it. `version`: of culprit.
  Teller(
      const CulpritTypes& types, std::string version, Tell tell,
      WallClock wall = [] { return std::chrono::system_clock::now(); })
      : types_(types),
        version_(std::move(version)),
        tell_(std::move(tell)),
        wall_(std::move(wall)),
        incidents_(types) {}

  void begins(const Manager& manager, std::function<Remarks()> remarks, Time start) override;
  void stepped(const Runtime::Step& step) override;
  Time next_look() const override;
  void announced(Time, const EventWords&, const std::string&) override {}

 private:
  void tell_decisions(std::span<const Event> events, Time now);
  void tell_incidents(Time now);
  void tell_status(Time now);
  Json status() const;
  Json component(ComponentId id, std::size_t health, const Remarks& remarks) const;

  const CulpritTypes& types_;
  const std::string version_;
  const Tell tell_;
  const WallClock wall_;
  const Manager* manager_ = nullptr;  // null: none has begun
  std::function<Remarks()> remarks_;
  IncidentWatch incidents_;

  bool is_new_manager_ = false;
  bool may_have_changed_ = false;  // the status
  Time looked_ = kLongAgo;         // at the status, last
  Json told_;                      // of it, last, without its time
  Time second_ = kLongAgo;         // since when decisions are counted
  std::uint32_t decisions_ = 0;
  std::uint32_t left_out_ = 0;
};

}  // namespace culprit::ros_api
