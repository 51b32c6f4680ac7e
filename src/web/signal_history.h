// The inputs of the rules over the last quarter of an hour: rate and age of each topic, and each input that is a number. Sampled every second once a page is served, with or without a viewer:
// so a plot also shows the time before the page was opened, and a link to a plot shows the same to everybody.
#pragma once

#include <atomic>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "base/mutex.h"
#include "live/observer.h"
#include "web/hub_observer.h"

namespace culprit::web {

// A curve: as many values as clocks, the oldest first. NaN: it was unknown then.
struct Series {
  std::vector<double> clocks;  // seconds since 1970
  std::vector<double> values;
};

class SignalHistory : public live::Observer {
 public:
  static constexpr Duration kPeriod = std::chrono::seconds(1);
  static constexpr std::size_t kMost = 900;  // samples

  explicit SignalHistory(HubObserver::WallClock wall = HubObserver::wall_clock)
      : wall_(std::move(wall)) {}

  // By a name of plotted_names(). Empty: there is no such signal. From any thread.
  Series of(const std::string& name) const;

  // Samples from now on. Without it, nothing is sampled: a robot without a page pays nothing. From any thread.
  void start() { is_sampling_ = true; }

  // Signals that the new rules still read keep their past.
  void begins(const Manager& manager, std::function<Remarks()> remarks, Time start) override;
  void stepped(const Runtime::Step& step) override;
  Time next_look() const override { return is_sampling_ ? next_ : kNever; }
  void announced(Time, const EventWords&, const std::string&) override {}

 private:
  void sample();

  const HubObserver::WallClock wall_;
  const Manager* manager_ = nullptr;  // null: none has begun
  Time next_ = kLongAgo;
  std::atomic<bool> is_sampling_ = false;
  mutable Mutex mutex_;
  std::deque<double> clocks_ CULPRIT_GUARDED_BY(mutex_);
  // Each has one value a clock.
  std::map<std::string, std::deque<float>> values_ CULPRIT_GUARDED_BY(mutex_);
  std::vector<std::deque<float>*> in_order_ CULPRIT_GUARDED_BY(mutex_);  // as sample() goes
};

}  // namespace culprit::web
