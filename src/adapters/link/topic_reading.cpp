#include "link/topic_reading.h"

#include <algorithm>

#include "inbox/inbox.h"

namespace culprit::link {

std::unique_ptr<TopicReading> TopicReading::open(ros2::NodeEntry& self, const std::string& topic,
                                                 const std::string& type, rtps::Keys keys,
                                                 const std::set<std::string>& fields,
                                                 const Expected<ros2::MessageLibrary*>& library) {
  std::unique_ptr<TopicReading> reading(new TopicReading);
  for (const std::string& path : fields) {
    auto reader = library ? ros2::FieldReader::compile(**library, type, path)
                          : Expected<ros2::FieldReader>(Error{library.error()});
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
      reading->readers_.empty() ? ros2::PayloadUse::kBeginning : ros2::PayloadUse::kWhole,
      {.on_arrival = [raw = reading.get()](const ros2::Sample& sample) { raw->on_arrival(sample); },
       .on_message = [raw = reading.get()](const ros2::Sample& sample) { raw->on_message(sample); },
       .on_unheard = {}});
  if (!listener) return nullptr;
  reading->listener_ = std::move(*listener);
  return reading;
}

// If a topic's latched messages cannot be read, the count of messages shows it.
void TopicReading::publisher_offers(const rtps::Qos& offered) {
  (void)listener_->publisher_offers(offered);
}

void TopicReading::note(Arrivals& arrivals, Time now) {
  Rhythm& rhythm = arrivals.rhythm;
  if (rhythm.messages++ > 0) {
    rhythm.first_to_last += now - arrivals.last;
    rhythm.longest_pause = std::max(rhythm.longest_pause, now - arrivals.last);
  }
  arrivals.last = now;
}

void TopicReading::on_arrival(const ros2::Sample& sample) {
  constexpr std::size_t kMaxArrivals = 100'000;  // a flood must not eat the memory
  constexpr std::size_t kMaxWriters = 64;        // the network decides how many there are
  const Time now = live_now();
  const MutexLock lock(mutex_);
  arrivals_.push_back(now);
  note(all_, now);
  const rtps::Guid& writer = sample.identity.writer;
  if (of_writers_.size() < kMaxWriters || of_writers_.contains(writer))
    note(of_writers_[writer], now);
  while (arrivals_.front() < now - kWindow || arrivals_.size() > kMaxArrivals)
    arrivals_.pop_front();
}

void TopicReading::on_message(const ros2::Sample& sample) {
  const MutexLock lock(mutex_);
  for (const Field& field : readers_) {
    Value value;
    if (field.reader.read(sample.payload, value) != ros2::FieldStatus::kRead) continue;
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
  return all_.rhythm;
}

std::unordered_map<rtps::Guid, Rhythm> TopicReading::rhythms() const {
  std::unordered_map<rtps::Guid, Rhythm> all;
  const MutexLock lock(mutex_);
  for (const auto& [writer, arrivals] : of_writers_) all[writer] = arrivals.rhythm;
  return all;
}

std::map<std::string, ValueCourse> TopicReading::courses() const {
  const MutexLock lock(mutex_);
  return courses_;
}

}  // namespace culprit::link
