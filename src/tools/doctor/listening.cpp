#include "doctor/listening.h"

#include <algorithm>

#include "base/live_clock.h"
#include "ros2/messages.h"
#include "ros2/sample_gaps.h"

namespace culprit::doctor {
namespace {

constexpr std::size_t kMostPauses = 4096;
constexpr std::size_t kMostLags = 256;
constexpr std::size_t kMostFrames = 16;
constexpr std::size_t kMostWriters = 64;

rtps::SystemTime time_of(const ros2::msg::Time& stamp) {
  return rtps::SystemTime(std::chrono::seconds(stamp.sec) +
                          std::chrono::nanoseconds(stamp.nanosec));
}

Duration middle(std::vector<Duration> values) {
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, nth);
  return *nth;
}

}  // namespace

// Of one topic. on_sample() is called on receive threads.
class Listening::Ear {
 public:
  static std::unique_ptr<Ear> open(ros2::NodeEntry& self, const WantedTopic& topic,
                                   const std::function<std::optional<Duration>()>& simulated_now,
                                   Time now) {
    std::unique_ptr<Ear> ear(new Ear(self, topic, simulated_now, now));
    // Only a reliable reader is sent what was published before (DDS 1.4 §2.2.3.4).
    const rtps::Qos qos =
        topic.is_latched
            ? rtps::Qos{.durability = rtps::Durability::kTransientLocal,
                        .depth = 1,
                        .keys = topic.keys}
            : rtps::Qos{
                  .reliability = rtps::Reliability::kBestEffort, .depth = 1, .keys = topic.keys};
    // Pauses are compared with deadlines. All else may wait a moment, which costs less.
    const auto use =
        topic.has_deadline ? ros2::PayloadUse::kBeginning : ros2::PayloadUse::kBeginningLater;
    auto subscription = ros2::RawSubscription::create(
        self, topic.name, topic.type, qos, use,
        [raw = ear.get()](const ros2::Sample& sample) { raw->on_sample(sample); });
    if (!subscription) return nullptr;
    ear->subscription_ = std::move(*subscription);
    return ear;
  }

  bool has_much() const {
    const MutexLock lock(mutex_);
    return messages_ >= kEnoughMessages && data_ > kMuchData;
  }
  bool had_its_turn(Time now) const {
    const MutexLock lock(mutex_);
    return now - opened_ >= kTurn;
  }
  bool is_closed() const { return subscription_ == nullptr; }
  void close(Time now) {
    subscription_.reset();
    closed_ = now;
  }

  void begin_anew(Time now) {
    const MutexLock lock(mutex_);
    opened_ = now;
    messages_ = 0;
    lost_ = 0;
    gaps_ = {};
    pauses_.clear();
    lags_.clear();
    simulated_lags_.clear();
    jumps_back_ = 0;
    furthest_back_ = {};
    data_ = 0;
  }

  Flow flow(Time now) const {
    const MutexLock lock(mutex_);
    Flow flow;
    flow.listened = closed_.value_or(now) - opened_;
    flow.messages = messages_;
    flow.lost = lost_;
    flow.first_to_last = messages_ == 0 ? Duration() : last_ - first_;
    flow.pauses = pauses_;
    flow.frames = frames_;
    flow.last_sent = last_sent_;
    if (lags_.empty()) return flow;
    Flow::Stamps& stamps = flow.stamps.emplace(Flow::Stamps{});
    stamps.count = lags_.size();
    stamps.lag = middle(lags_);
    if (simulated_lags_.size() == lags_.size()) stamps.simulated_lag = middle(simulated_lags_);
    stamps.jumps_back = jumps_back_;
    stamps.furthest_back = furthest_back_;
    return flow;
  }

 private:
  Ear(ros2::NodeEntry& self, const WantedTopic& topic,
      const std::function<std::optional<Duration>()>& simulated_now, Time now)
      : self_(self), is_stamped_(topic.is_stamped), simulated_now_(simulated_now), opened_(now) {}

  void on_sample(const ros2::Sample& sample) {
    const Time now = live_now();
    const MutexLock lock(mutex_);
    last_sent_ = std::max(last_sent_.value_or(sample.sent), sample.sent);
    if (messages_ == 0) {
      first_ = now;
    } else if (pauses_.size() < kMostPauses) {
      pauses_.push_back(now - last_);
    }
    ++messages_;
    const auto step = gaps_.next(sample.identity.writer, sample.identity.sequence,
                                 self_.context().participant().dropped_here());
    if (!step.lost_here) lost_ += step.published - 1;
    data_ += sample.size;
    last_ = now;
    if (is_stamped_) read_header(sample);
  }

  void read_header(const ros2::Sample& sample) CULPRIT_REQUIRES(mutex_) {
    const auto header = rtps::decode<ros2::msg::Header>(sample.payload);
    if (!header) return;
    if (frames_.size() < kMostFrames || frames_.contains(header->frame_id))
      frames_.insert(header->frame_id);
    if (header->stamp == ros2::msg::Time{}) return;
    const rtps::SystemTime stamp = time_of(header->stamp);
    if (lags_.size() < kMostLags) {
      lags_.push_back(sample.sent - stamp);
      if (const auto simulated = simulated_now_())
        simulated_lags_.push_back(*simulated - stamp.time_since_epoch());
    }
    note_jump({sample.identity.writer, header->frame_id}, stamp);
  }

  using Origin = std::pair<rtps::Guid, std::string>;
  void note_jump(const Origin& origin, rtps::SystemTime stamp) CULPRIT_REQUIRES(mutex_) {
    // Less is two threads that publish, or pictures that are paired out of turn: no clock was set.
    constexpr Duration kJump = std::chrono::milliseconds(500);
    if (stamps_.size() >= kMostWriters && !stamps_.contains(origin)) return;
    const auto [last, is_first] = stamps_.try_emplace(origin, stamp);
    const Duration back = last->second - stamp;
    if (!is_first && back > kJump) {
      ++jumps_back_;
      furthest_back_ = std::max(furthest_back_, back);
    }
    last->second = stamp;
  }

  ros2::NodeEntry& self_;
  const bool is_stamped_;
  const std::function<std::optional<Duration>()> simulated_now_;
  mutable Mutex mutex_;
  Time opened_ CULPRIT_GUARDED_BY(mutex_);
  std::optional<Time> closed_;  // of the executor's thread
  std::size_t messages_ CULPRIT_GUARDED_BY(mutex_) = 0;
  std::size_t lost_ CULPRIT_GUARDED_BY(mutex_) = 0;
  ros2::SampleGaps gaps_ CULPRIT_GUARDED_BY(mutex_);
  std::size_t data_ CULPRIT_GUARDED_BY(mutex_) = 0;  // bytes
  Time first_ CULPRIT_GUARDED_BY(mutex_){};
  Time last_ CULPRIT_GUARDED_BY(mutex_){};
  std::vector<Duration> pauses_ CULPRIT_GUARDED_BY(mutex_);
  std::vector<Duration> lags_ CULPRIT_GUARDED_BY(mutex_);
  std::vector<Duration> simulated_lags_ CULPRIT_GUARDED_BY(mutex_);
  std::size_t jumps_back_ CULPRIT_GUARDED_BY(mutex_) = 0;
  Duration furthest_back_ CULPRIT_GUARDED_BY(mutex_){};
  std::map<Origin, rtps::SystemTime> stamps_ CULPRIT_GUARDED_BY(mutex_);
  std::set<std::string> frames_ CULPRIT_GUARDED_BY(mutex_);
  std::optional<rtps::SystemTime> last_sent_ CULPRIT_GUARDED_BY(mutex_);
  std::unique_ptr<ros2::RawSubscription> subscription_;  // null: enough was heard
};

Listening::Listening(ros2::NodeEntry& self, std::function<std::optional<Duration>()> simulated_now)
    : self_(self), simulated_now_(std::move(simulated_now)) {}
Listening::~Listening() = default;

void Listening::listen_to(const std::vector<WantedTopic>& topics) {
  for (const WantedTopic& topic : topics) {
    if (known_.insert(topic.name).second && !ears_.contains(topic.name)) waiting_.push_back(topic);
  }
}

void Listening::take_turns(Time now, Duration left) {
  const bool is_worth_it = left >= kWorthIt;
  std::size_t open = 0;
  for (const auto& [name, ear] : ears_) {
    if (ear->is_closed()) continue;
    if (ear->has_much() || (is_worth_it && !waiting_.empty() && ear->had_its_turn(now)))
      ear->close(now);
    else
      ++open;
  }
  std::optional<ros2::Participant::Hold> hold(self_.context().participant());
  for (; open < kMostAtOnce && !waiting_.empty(); ++open, waiting_.pop_front()) {
    const bool is_last = open + 1 == kMostAtOnce || waiting_.size() == 1;
    if (is_last) hold.reset();
    const WantedTopic& topic = waiting_.front();
    if (auto ear = Ear::open(self_, topic, simulated_now_, now))
      ears_.insert_or_assign(topic.name, std::move(ear));
  }
}

std::map<std::string, Flow> Listening::flows(Time now) const {
  std::map<std::string, Flow> all;
  for (const auto& [name, ear] : ears_) all[name] = ear->flow(now);
  return all;
}

// A topic that was released is subscribed to again when it is needed again, after those that
// waited.
void Listening::begin_anew(Time now) {
  std::erase_if(ears_, [](const auto& entry) { return entry.second->is_closed(); });
  known_.clear();
  for (const auto& [name, ear] : ears_) {
    ear->begin_anew(now);
    known_.insert(name);
  }
  for (const WantedTopic& topic : waiting_) known_.insert(topic.name);
}

}  // namespace culprit::doctor
