#include "recorder/incident_recorder.h"

#include <algorithm>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "base/live_clock.h"
#include "ros2/messages.h"

namespace culprit::recorder {
namespace {

constexpr std::size_t kMostAtOnce = std::size_t{4} << 20;  // bytes, from the ring
// Messages are held so much longer, for a disk that is slow.
constexpr Duration kSlack = std::chrono::seconds(5);
constexpr int kNice = 10;

// Only this thread is less urgent: Linux has a priority for each.
void be_less_urgent() { setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), kNice); }

RecordedTopic text_topic(const char* name) {
  return {name, std::string(ros2::msg::String::kType), "", "string data\n", {rtps::Qos{}}};
}

void stamp(RingMessage& message) {
  message.at = live_now();
  if (message.received == 0) message.received = wall_now();
}

MessageRing::Limits limits_of(const IncidentRecorder::Options& options) {
  const std::size_t large = IncidentRecorder::large_share(options.memory);
  const std::size_t latched = IncidentRecorder::latched_share(options.memory);
  return {options.memory - large - latched, large, latched, options.before + kSlack};
}

}  // namespace

IncidentRecorder::IncidentRecorder(Options options)
    : options_(std::move(options)),
      folder_(options_.folder, options_.disk, options_.space),
      ring_(limits_of(options_)) {
  events_ = add_topic(text_topic(kEventsTopic));
  graph_ = add_topic(text_topic(kGraphTopic));
  thread_ = std::thread([this] { work(); });
}

IncidentRecorder::~IncidentRecorder() {
  {
    const MutexLock lock(mutex_);
    is_ending_ = true;
    changed_.notify_all();
  }
  thread_.join();
}

std::size_t IncidentRecorder::add_topic(RecordedTopic topic) {
  const std::string key = topic.name + ' ' + topic.type + ' ' + topic.type_hash;
  const MutexLock lock(topics_mutex_);
  const auto known = numbers_.find(key);
  if (known != numbers_.end()) {
    topics_[known->second] = std::make_shared<const RecordedTopic>(std::move(topic));
    return known->second;
  }
  if (topics_.size() >= kMostTopics) return kNoTopic;
  numbers_.emplace(key, topics_.size());
  topics_.push_back(std::make_shared<const RecordedTopic>(std::move(topic)));
  return topics_.size() - 1;
}

IncidentRecorder::SharedTopic IncidentRecorder::topic_of(const RingMessage& message) {
  const MutexLock lock(topics_mutex_);
  return topics_[message.topic];
}

void IncidentRecorder::take(RingMessage message, Share share) {
  if (message.topic == kNoTopic) return;
  stamp(message);
  ring_.push(std::move(message), share);
}

void IncidentRecorder::take_latched(RingMessage message, const rtps::Guid& publisher, Share share) {
  if (message.topic == kNoTopic) return;
  stamp(message);
  ring_.latch(message, publisher);
  ring_.push(std::move(message), share);
}

RingMessage IncidentRecorder::told(std::size_t topic, const std::string& json) const {
  return {.topic = topic, .sent = wall_now(), .payload = rtps::encode(ros2::msg::String{json})};
}

void IncidentRecorder::note_event(const std::string& json) { take(told(events_, json)); }

void IncidentRecorder::note_graph(const std::string& json) {
  take_latched(told(graph_, json), {}, Share::kSmall);
}

void IncidentRecorder::want(const std::string& why) {
  until_ = std::max(until_, later(live_now(), options_.after));
  ++wishes_;
  // The first of several requests gives the name.
  if (wish_.why.empty()) wish_ = {why, wall_now(), live_now(), wishes_};
  wish_.number = wishes_;
  changed_.notify_all();
}

void IncidentRecorder::begin(const std::string& why) {
  const MutexLock lock(mutex_);
  is_ill_ = true;
  want(why);
}

void IncidentRecorder::over() {
  const MutexLock lock(mutex_);
  if (!std::exchange(is_ill_, false)) return;
  until_ = std::max(until_, later(live_now(), options_.after));
  changed_.notify_all();
}

Expected<std::filesystem::path> IncidentRecorder::record_now(const std::string& why,
                                                             Duration patience) {
  MutexLock lock(mutex_);
  want(why);
  const std::uint64_t mine = wishes_;
  const bool is_answered = changed_.wait_for(
      lock, patience, [&]() CULPRIT_REQUIRES(mutex_) { return answered_ >= mine; });
  if (!is_answered) return Error{"the disk does not answer"};
  return answer_;
}

void IncidentRecorder::work() {
  be_less_urgent();
  MutexLock lock(mutex_);
  while (true) {
    const auto is_wanted = [&]() CULPRIT_REQUIRES(mutex_) {
      return is_ending_ || !wish_.why.empty();
    };
    if (file_ == nullptr) {
      changed_.wait(lock, is_wanted);
    } else {
      changed_.wait_for(lock, kFlushes, is_wanted);
    }
    const Wish wish = std::exchange(wish_, {});
    const bool is_ending = is_ending_;
    lock.unlock();
    if (!wish.why.empty() && file_ == nullptr) open(wish);
    if (file_ != nullptr) write_new(since_);
    lock.lock();
    if (!wish.why.empty()) {
      answered_ = wish.number;
      answer_ = file_ != nullptr ? Expected<std::filesystem::path>(file_->path()) : Error{trouble_};
      changed_.notify_all();
    }
    const Time now = live_now();
    const bool is_done = (!is_ill_ && now >= until_) || now >= later(opened_, kLongest);
    // A request that comes meanwhile gets this recording.
    const bool is_wanted_on = !wish_.why.empty() && !is_ending;
    const bool ends =
        file_ != nullptr && (is_ending || (is_done && !is_wanted_on) || !file_->trouble().empty());
    if (ends) {
      lock.unlock();
      close();
      lock.lock();
    }
    if (is_ending) return;
  }
}

void IncidentRecorder::open(const Wish& wish) {
  auto file = RecordingFile::create(folder_, recording_name(options_.robot, wish.when, wish.why),
                                    options_.library);
  if (!file) return say_once("nothing is recorded: " + file.error());
  file_ = std::move(*file);
  opened_ = wish.at;
  since_ = wish.at - options_.before;
  written_ = 0;
  ring_.count_lost(since_);
  // An old latched message counts as received at the beginning; otherwise the recording would seem
  // to begin then.
  const std::int64_t beginning = wish.when - options_.before.count();
  for (const SharedMessage& message : ring_.latched(since_)) {
    file_->add(*message, *topic_of(*message), std::max<std::int64_t>(0, beginning));
  }
}

void IncidentRecorder::write_new(Time since) {
  while (file_->trouble().empty()) {
    const std::vector<SharedMessage> messages = ring_.after(written_, since, kMostAtOnce);
    if (messages.empty()) break;
    for (const SharedMessage& message : messages) file_->add(*message, *topic_of(*message));
    written_ = messages.back()->number;
  }
  file_->flush();
}

void IncidentRecorder::close() {
  write_new(since_);  // what came while the disk was busy with the last of it
  const std::uint64_t lost = ring_.stop_counting();
  if (file_->trouble().empty()) file_->end();
  if (!file_->trouble().empty()) {
    say_once("a recording ends early: " + file_->trouble());
  } else {
    trouble_.clear();
    options_.say("recorded " + std::to_string(file_->messages()) +
                 " messages: " + file_->path().string());
  }
  if (lost > 0)
    options_.say(std::to_string(lost) +
                 " messages are missing in it: more came than the memory for them holds while the "
                 "disk was busy (--record-budget)");
  file_.reset();
}

void IncidentRecorder::say_once(const std::string& text) {
  if (text == trouble_) return;
  trouble_ = text;
  options_.say(text);
}

}  // namespace culprit::recorder
