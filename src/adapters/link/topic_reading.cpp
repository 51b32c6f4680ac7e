#include "link/topic_reading.h"

#include <algorithm>

#include "robot/inbox.h"

namespace culprit::ros2 {

std::unique_ptr<TopicReading> TopicReading::open(NodeEntry& self, const std::string& topic,
                                                 const std::string& type, Keys keys,
                                                 const std::set<std::string>& fields,
                                                 const Expected<MessageLibrary*>& library) {
  std::unique_ptr<TopicReading> reading(new TopicReading);
  for (const std::string& path : fields) {
    auto reader = library ? FieldReader::compile(**library, type, path)
                          : Expected<FieldReader>(Error{library.error()});
    if (reader) {
      reading->readers_.push_back({path, std::move(*reader)});
    } else {
      reading->unreadable_.emplace(path, reader.error());
    }
  }
  reading->since_ = live_now();
  // Not kHeader, which has time: rhythms are measured.
  auto listener = TopicListener::open(
      self, topic, type, keys,
      reading->readers_.empty() ? PayloadUse::kBeginning : PayloadUse::kWhole,
      {.on_arrival = [raw = reading.get()](const Sample&) { raw->on_arrival(); },
       .on_message = [raw = reading.get()](const Sample& sample) { raw->on_message(sample); },
       .on_unheard = {}});
  if (!listener) return nullptr;
  reading->listener_ = std::move(*listener);
  return reading;
}

// If a topic's latched messages cannot be read, the count of messages shows it.
void TopicReading::publisher_offers(const Qos& offered) {
  (void)listener_->publisher_offers(offered);
}

void TopicReading::on_arrival() {
  constexpr std::size_t kMaxArrivals = 100'000;  // a flood must not eat the memory
  const Time now = live_now();
  const MutexLock lock(mutex_);
  arrivals_.push_back(now);
  if (rhythm_.messages++ > 0) {
    rhythm_.first_to_last += now - last_;
    rhythm_.longest_pause = std::max(rhythm_.longest_pause, now - last_);
  }
  last_ = now;
  while (arrivals_.front() < now - kWindow || arrivals_.size() > kMaxArrivals)
    arrivals_.pop_front();
}

void TopicReading::on_message(const Sample& sample) {
  const MutexLock lock(mutex_);
  for (const Field& field : readers_) {
    Value value;
    if (field.reader.read(sample.payload, value) != FieldStatus::kRead) continue;
    courses_[field.path].note(value);
    values_[field.path] = std::move(value);
  }
}

void TopicReading::tell(LiveInventory::Topic& topic) const {
  const Time now = live_now();
  const MutexLock lock(mutex_);
  topic.fields = values_;
  topic.unreadable = unreadable_;
  if (now - since_ < kWindow) return;  // too early for a rate
  const auto recent = std::count_if(arrivals_.begin(), arrivals_.end(),
                                    [&](Time at) { return at >= now - kWindow; });
  topic.rate = static_cast<double>(recent) / seconds(kWindow);
}

Rhythm TopicReading::rhythm() const {
  const MutexLock lock(mutex_);
  return rhythm_;
}

std::map<std::string, ValueCourse> TopicReading::courses() const {
  const MutexLock lock(mutex_);
  return courses_;
}

}  // namespace culprit::ros2
