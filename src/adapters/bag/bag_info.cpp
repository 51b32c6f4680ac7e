#include "bag/bag_info.h"

#include <algorithm>
#include <utility>

namespace culprit::bag {

double TopicInfo::rate() const {
  constexpr double kPerSecond = 1e9;
  constexpr std::int64_t kSecond = 1'000'000'000;
  constexpr std::uint64_t kFewest = 3;
  constexpr std::uint64_t kFewestOfLessThanASecond = 20;  // else they are one burst
  const std::int64_t time = last - first - time_with_hole;
  if (time <= 0 || messages < kFewest || (time < kSecond && messages < kFewestOfLessThanASecond))
    return 0;
  return static_cast<double>(messages - 1 - pauses_with_hole) * kPerSecond /
         static_cast<double>(time);
}

void BagInfo::plan(Topic& topic, const BagTopic& about) {
  topic.is_planned = true;
  if (about.encoding != "cdr") {
    topic.info.why_undecoded = "its messages are in '" + about.encoding + "', not in CDR";
    return;
  }
  if (const std::string* definition = contents_.definition_of(about.type))
    library_.learn(about.type, *definition);
  auto whole = ros2::FieldReader::compile_whole(library_, about.type);
  if (whole) {
    topic.whole = std::move(*whole);
  } else {
    topic.info.why_undecoded = whole.error();
  }
}

void BagInfo::note_gap(Topic& topic, std::int64_t until) {
  const std::int64_t gap = until - topic.heard_since;
  if (gap <= topic.info.longest_gap) return;
  topic.info.longest_gap = gap;
  topic.info.gap_at = topic.heard_since;
  topic.info.gap_clock = topic.heard_clock;
}

void BagInfo::add(const BagMessage& message) {
  if (messages_++ == 0) {
    first_ = message.at;
    first_clock_ = message.recorded_at;
  }
  if (message.is_after_hole) {
    // The gaps end and begin at the hole, in which messages may have come.
    for (Topic& each : topics_) {
      if (each.info.messages > 0) note_gap(each, last_);
      each.heard_since = message.at;
      each.heard_clock = message.recorded_at;
      each.is_after_hole = each.info.messages > 0;
    }
  }
  last_ = message.at;
  last_clock_ = message.recorded_at;
  if (topics_.size() <= message.topic) topics_.resize(message.topic + 1);
  Topic& topic = topics_[message.topic];
  TopicInfo& info = topic.info;
  if (!topic.is_planned) plan(topic, contents_.topics()[message.topic]);
  if (info.messages == 0) {
    info.first = message.at;
    topic.heard_since = info.gap_at = first_;
    topic.heard_clock = info.gap_clock = first_clock_;
  }
  if (std::exchange(topic.is_after_hole, false)) {
    ++info.pauses_with_hole;
    info.time_with_hole += message.at - info.last;
  }
  note_gap(topic, message.at);
  topic.heard_since = info.last = message.at;
  topic.heard_clock = message.recorded_at;
  ++info.messages;
  info.bytes += message.bytes.size();
  if (!topic.whole) return;
  const rtps::ByteView payload{reinterpret_cast<const std::uint8_t*>(message.bytes.data()),
                               message.bytes.size()};
  const ros2::PayloadFit fit = topic.whole->fit(payload);
  if (fit == ros2::PayloadFit::kFits) return;
  if (++info.undecoded == 1)
    info.why_undecoded = fit == ros2::PayloadFit::kTooLong
                             ? "messages are longer than their definition"
                             : "messages are cut short, or of another type";
}

std::vector<TopicInfo> BagInfo::topics() {
  topics_.resize(contents_.topics().size());
  std::vector<TopicInfo> all;
  for (std::size_t t = 0; t < topics_.size(); ++t) {
    const BagTopic& about = contents_.topics()[t];
    if (!topics_[t].is_planned) plan(topics_[t], about);
    if (topics_[t].info.messages > 0) note_gap(topics_[t], last_);
    TopicInfo info = topics_[t].info;
    info.name = about.name;
    info.type = about.type;
    info.encoding = about.encoding;
    all.push_back(std::move(info));
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const TopicInfo& a, const TopicInfo& b) { return a.name < b.name; });
  return all;
}

}  // namespace culprit::bag
