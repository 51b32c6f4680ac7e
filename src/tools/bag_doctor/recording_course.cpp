#include "bag_doctor/recording_course.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <tuple>
#include <unordered_map>

#include "bag/bag_file.h"
#include "bag/number_fields.h"
#include "doctor/wording.h"
#include "ros2/field_reader.h"
#include "ros2/messages.h"

namespace culprit::bag_doctor {
namespace {

constexpr std::size_t kMostNames = 10'000;  // statuses, nodes, frames: the file decides how many
constexpr std::size_t kMostChanges = 1'000;
constexpr std::size_t kMostLines = 3;
constexpr std::string_view kTransitionTopic = "/transition_event";

constexpr std::array<std::string_view, 5> kMeasuredWhole = {
    "sensor_msgs/msg/CompressedImage", "sensor_msgs/msg/Image", "sensor_msgs/msg/LaserScan",
    "sensor_msgs/msg/PointCloud2", "sensor_msgs/msg/MultiEchoLaserScan"};

struct StampedTransform {
  ros2::msg::Header header;
  std::string child_frame_id;
  std::array<double, 7> transform{};
  static void visit(auto& self, auto& each) {
    each(self.header, self.child_frame_id, self.transform);
  }
};
struct Transforms {
  std::vector<StampedTransform> transforms;
  static void visit(auto& self, auto& each) { each(self.transforms); }
};

rtps::ByteView view(std::string_view bytes) {
  return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

Nanoseconds stamp_of(const ros2::msg::Time& time) {
  return Nanoseconds{time.sec} * 1'000'000'000 + time.nanosec;
}

// "/base" was "base" in ROS 1, and some still write it.
std::string frame(const std::string& name) { return name.starts_with('/') ? name.substr(1) : name; }

void note(FieldCourse& field, Run& row, bool is_same, Nanoseconds at) {
  if (is_same && row.messages > 0) {
    ++row.messages;
    row.to = at;
  } else {
    if (row.messages > 0) ++field.changes;
    row = {at, at, 1};
  }
  if (row.from == field.longest.from) {
    field.longest = row;
  } else if (row.messages > field.longest.messages) {
    field.second = std::exchange(field.longest, row);
  } else if (row.from == field.second.from || row.messages > field.second.messages) {
    field.second = row;
  }
}

// Reads one number of each message.
class FieldLook {
 public:
  FieldLook(ros2::FieldReader reader, std::size_t place)
      : reader_(std::move(reader)), place_(place) {}

  // False if the message does not fit its type.
  bool look(rtps::ByteView payload, Nanoseconds at, std::vector<FieldCourse>& fields) {
    Value value;
    const ros2::FieldStatus status = reader_.read(payload, value);
    if (status != ros2::FieldStatus::kRead) return status != ros2::FieldStatus::kMalformed;
    FieldCourse& field = fields[place_];
    const auto number = number_in(value);
    if (!number) return true;
    if (!std::isfinite(*number)) {
      look_at_not_finite(field, at);
      return true;
    }
    bad_ = {};
    note(field, row_, field.count > 0 && *number == last_, at);
    if (field.count++ == 0) field.least = field.most = *number;
    field.least = std::min(field.least, *number);
    field.most = std::max(field.most, *number);
    last_ = *number;
    return true;
  }

 private:
  static std::optional<double> number_in(const Value& value) {
    if (const auto* number = std::get_if<double>(&value)) return *number;
    if (const auto* number = std::get_if<std::int64_t>(&value)) return static_cast<double>(*number);
    if (const auto* truth = std::get_if<bool>(&value)) return *truth ? 1 : 0;
    return std::nullopt;
  }
  void look_at_not_finite(FieldCourse& field, Nanoseconds at) {
    if (field.not_finite++ == 0) field.finite_before = field.count;
    if (bad_.messages == 0) bad_.from = at;
    bad_.to = at;
    ++bad_.messages;
    if (bad_.messages > field.longest_not_finite.messages) field.longest_not_finite = bad_;
    row_ = {};
  }

  ros2::FieldReader reader_;
  std::size_t place_;
  double last_ = 0;
  Run row_{}, bad_{};
};

enum class Use : std::uint8_t {
  kNone,
  kDiagnostics,
  kLog,
  kTransition,
  kParameters,
  kTransforms,
  kGraph,
  kOwnGraph
};

class TopicLook {
 public:
  TopicLook() = default;
  TopicLook(const bag::BagTopic& topic, const bag::BagContents& contents,
            ros2::MessageLibrary& library, const CourseLimits& limits, TopicCourse& course)
      : type_(topic.type) {
    if (topic.encoding != "cdr") return;
    use_ = use_of(topic);
    if (use_ == Use::kTransition)
      node_ = topic.name.substr(0, topic.name.size() - kTransitionTopic.size());
    if (const std::string* definition = contents.definition_of(topic.type);
        definition != nullptr && !definition->empty())
      library.learn(topic.type, *definition);
    seconds_ = reader_of(library, "header.stamp.sec");
    nanoseconds_ = reader_of(library, "header.stamp.nanosec");
    is_measured_whole_ = std::ranges::find(kMeasuredWhole, topic.type) != kMeasuredWhole.end();
    if (use_ != Use::kNone) return;
    for (std::string& path : bag::number_fields(library, topic.type, limits.most_fields)) {
      auto reader = ros2::FieldReader::compile(library, topic.type, path);
      if (!reader) continue;
      looks_.emplace_back(std::move(*reader), course.fields.size());
      course.fields.push_back({.path = std::move(path)});
    }
  }

  Use use() const { return use_; }
  const std::string& node() const { return node_; }

  void look(const bag::BagMessage& message, Nanoseconds at, TopicCourse& course) {
    const rtps::ByteView payload = view(message.bytes);
    if (seconds_) course.stamps.push_back(stamp_in(payload));
    bool fits = true;
    for (FieldLook& each : looks_) fits = each.look(payload, at, course.fields) && fits;
    if (!fits) {
      if (course.undecoded++ == 0) course.undecoded_from = at;
      course.undecoded_to = at;
    }
    if (!is_measured_whole_) return;
    // Behind the encapsulation and the stamp; the name of the frame does not change.
    constexpr std::size_t kHead = 12;
    const std::size_t content =
        std::hash<std::string_view>{}(message.bytes.substr(std::min(kHead, message.bytes.size())));
    note(course.content, row_, course.content.count > 0 && content == last_, at);
    ++course.content.count;
    last_ = content;
  }

 private:
  static Use use_of(const bag::BagTopic& topic) {
    if (topic.type == ros2::msg::DiagnosticArray::kType) return Use::kDiagnostics;
    if (topic.type == ros2::msg::Log::kType) return Use::kLog;
    if (topic.type == ros2::msg::ParameterEvent::kType) return Use::kParameters;
    if (topic.type == "tf2_msgs/msg/TFMessage") return Use::kTransforms;
    if (topic.type == "rosgraph_msgs/msg/Graph") return Use::kGraph;
    if (topic.type == ros2::msg::String::kType && topic.name == "/culprit/graph")
      return Use::kOwnGraph;
    if (topic.type == ros2::msg::TransitionEvent::kType && topic.name.ends_with(kTransitionTopic))
      return Use::kTransition;
    return Use::kNone;
  }
  std::optional<ros2::FieldReader> reader_of(ros2::MessageLibrary& library,
                                             const char* path) const {
    auto reader = ros2::FieldReader::compile(library, type_, path);
    return reader ? std::optional(std::move(*reader)) : std::nullopt;
  }
  Nanoseconds stamp_in(rtps::ByteView payload) const {
    Value seconds, rest;
    if (!nanoseconds_ || seconds_->read(payload, seconds) != ros2::FieldStatus::kRead ||
        nanoseconds_->read(payload, rest) != ros2::FieldStatus::kRead)
      return 0;
    const auto* whole = std::get_if<std::int64_t>(&seconds);
    const auto* part = std::get_if<std::int64_t>(&rest);
    return whole != nullptr && part != nullptr ? *whole * 1'000'000'000 + *part : 0;
  }

  std::string type_;
  Use use_ = Use::kNone;
  std::string node_;
  std::optional<ros2::FieldReader> seconds_, nanoseconds_;
  std::vector<FieldLook> looks_;
  bool is_measured_whole_ = false;
  std::size_t last_ = 0;
  Run row_{};
};

class Reading {
 public:
  Reading(const bag::BagContents& contents, ros2::MessageLibrary& library,
          const CourseLimits& limits)
      : contents_(contents), library_(library), limits_(limits) {}

  void read(const bag::BagMessage& message) {
    notice_topics();
    if (course_.messages++ == 0) {
      course_.begin = message.at;
      course_.begin_clock = message.recorded_at;
    }
    if (message.is_after_hole) course_.holes.push_back({course_.end, message.at});
    course_.end = message.at;
    if (course_.messages > limits_.most_times) return;
    TopicCourse& topic = course_.topics[places_[message.topic]];
    topic.times.push_back(message.at);
    if (topic.other_type_from == 0 && contents_.topics()[message.topic].type != topic.type)
      topic.other_type_from = message.at;
    TopicLook& look = looks_[message.topic];
    look.look(message, message.at, topic);
    switch (look.use()) {
      case Use::kNone:
        break;
      case Use::kDiagnostics:
        read_diagnostics(message);
        break;
      case Use::kLog:
        read_log(message);
        break;
      case Use::kParameters:
        if (const auto event = rtps::decode<ros2::msg::ParameterEvent>(view(message.bytes)))
          notice_node(event->node);
        break;
      case Use::kTransition:
        read_transition(look.node(), message);
        break;
      case Use::kTransforms:
        read_transforms(topic.name.ends_with("tf_static"), message);
        break;
      case Use::kGraph:
        read_graph(message);
        break;
      case Use::kOwnGraph:
        if (const auto text = rtps::decode<ros2::msg::String>(view(message.bytes))) {
          if (const auto graph = parse_graph(text->data)) course_.graph.add(*graph);
        }
        break;
    }
  }

  BagCourse take() {
    notice_topics();
    if (course_.messages > limits_.most_times)
      course_.left_out.push_back("only the first " + std::to_string(limits_.most_times) +
                                 " messages were examined");
    name_unread();
    return std::move(course_);
  }

 private:
  void name_unread() {
    std::vector<std::string> unread;
    for (std::size_t t = 0; t < looks_.size(); ++t) {
      const bag::BagTopic& topic = contents_.topics()[t];
      if (course_.topics[places_[t]].times.empty()) continue;
      if (topic.encoding != "cdr" || !library_.with_parts(topic.type)) unread.push_back(topic.name);
    }
    if (!unread.empty())
      course_.left_out.push_back(
          "the values of " + doctor::listed(unread, 8) +
          ": their types are not known (--message-path FOLDER), or they are not in CDR");
  }
  void notice_topics() {
    while (looks_.size() < contents_.topics().size()) {
      const bag::BagTopic& topic = contents_.topics()[looks_.size()];
      const auto [place, is_new] = by_name_.try_emplace(topic.name, course_.topics.size());
      places_.push_back(place->second);
      if (is_new) {
        course_.topics.push_back({.name = topic.name, .type = topic.type});
        course_.offers[topic.name] = parse_offered_qos(topic.offered_qos);
        looks_.emplace_back(topic, contents_, library_, limits_, course_.topics.back());
      } else {
        course_.topics[place->second].other_types.push_back(topic.type);
        looks_.emplace_back();  // the numbers of one type say nothing of those of another
      }
    }
  }
  void notice_node(const std::string& node) {
    if (node.starts_with('/') && course_.nodes.size() < kMostNames) course_.nodes.insert(node);
  }

  void read_diagnostics(const bag::BagMessage& message) {
    const auto array = rtps::decode<ros2::msg::DiagnosticArray>(view(message.bytes));
    if (!array) return;
    for (const ros2::msg::DiagnosticStatus& each : array->status) {
      if (course_.statuses.size() >= kMostNames && !course_.statuses.contains(each.name)) continue;
      StatusCourse& status = course_.statuses[each.name];
      status.name = each.name;
      const bool is_new = status.changes.empty() || status.changes.back().level != each.level;
      if (is_new && status.changes.size() < kMostChanges)
        status.changes.push_back({message.at, each.level, each.message});
      status.last = message.at;
      ++status.count;
    }
  }

  void read_log(const bag::BagMessage& message) {
    constexpr std::uint8_t kError = 40, kFatal = 50;
    const auto log = rtps::decode<ros2::msg::Log>(view(message.bytes));
    if (!log || log->name.empty()) return;
    std::string node = "/" + log->name;
    std::replace(node.begin(), node.end(), '.', '/');
    notice_node(node);
    if (log->level < kError) return;
    if (course_.logs.size() >= kMostNames && !course_.logs.contains(node)) return;
    LogCourse& course = course_.logs[node];
    ++(log->level >= kFatal ? course.fatals : course.errors);
    course.last = message.at;
    if (course.first.size() < kMostLines)
      course.first.push_back({message.at, log->level, log->msg});
  }

  void read_transition(const std::string& node, const bag::BagMessage& message) {
    const auto event = rtps::decode<ros2::msg::TransitionEvent>(view(message.bytes));
    if (!event || course_.transitions[node].size() >= kMostChanges) return;
    notice_node(node);
    course_.transitions[node].push_back(
        {message.at, event->start_state.label, event->goal_state.label});
  }

  void read_transforms(bool is_static, const bag::BagMessage& message) {
    const auto all = rtps::decode<Transforms>(view(message.bytes));
    if (!all) return;
    for (const StampedTransform& each : all->transforms) {
      const std::tuple key(frame(each.header.frame_id), frame(each.child_frame_id), is_static);
      auto found = transforms_.find(key);
      if (found == transforms_.end()) {
        if (transforms_.size() >= kMostNames) continue;
        found = transforms_.emplace(key, course_.transforms.size()).first;
        course_.transforms.push_back({std::get<0>(key), std::get<1>(key), is_static});
      }
      TransformCourse& course = course_.transforms[found->second];
      course.times.push_back(message.at);
      course.stamps.push_back(stamp_of(each.header.stamp));
    }
  }

  // Field by field, since the type has more than is of use here (rosgraph_msgs/msg/Graph of rcl_interfaces).
  void read_graph(const bag::BagMessage& message) {
    constexpr const char* kType = "rosgraph_msgs/msg/Graph";
    constexpr int kMost = 1'000;
    const rtps::ByteView payload = view(message.bytes);
    const auto text_at = [&](const std::string& path) -> std::optional<std::string> {
      const auto reader = ros2::FieldReader::compile(library_, kType, path);
      Value value;
      if (!reader || reader->read(payload, value) != ros2::FieldStatus::kRead) return std::nullopt;
      const auto* text = std::get_if<std::string>(&value);
      return text == nullptr ? std::nullopt : std::optional(*text);
    };
    for (int n = 0; n < kMost; ++n) {
      const std::string node = "nodes[" + std::to_string(n) + "].";
      const auto name = text_at(node + "name");
      if (!name) return;
      course_.graph.nodes.insert(*name);
      for (const auto& [member, ends] : {std::pair("publishers[", &course_.graph.publishers),
                                         {"subscriptions[", &course_.graph.subscribers}}) {
        for (int t = 0; t < kMost; ++t) {
          const auto topic = text_at(node + member + std::to_string(t) + "].name");
          if (!topic) break;
          (*ends)[*topic].insert(*name);
        }
      }
    }
  }

  const bag::BagContents& contents_;
  ros2::MessageLibrary& library_;
  const CourseLimits limits_;
  BagCourse course_;
  // By topic of the bag: one name may have several types.
  std::vector<TopicLook> looks_;
  std::vector<std::size_t> places_;  // in course_.topics
  std::unordered_map<std::string, std::size_t> by_name_;
  std::map<std::tuple<std::string, std::string, bool>, std::size_t> transforms_;
};

}  // namespace

Expected<BagCourse> read_course(const std::filesystem::path& path, ros2::MessageLibrary& library,
                                const CourseLimits& limits) {
  auto bag = bag::BagFile::open(path);
  if (!bag) return Error{bag.error()};
  Reading reading(bag->contents(), library, limits);
  for (bag::BagMessage message; bag->next(message);) reading.read(message);
  BagCourse course = reading.take();
  if (course.messages == 0) return Error{"the bag '" + path.string() + "' has no message"};
  course.path = path.string();
  course.losses = bag->contents().losses();
  course.remarks = bag->contents().remarks();
  for (const bag::ClockJump& jump : bag->contents().jumps())
    course.jumps.push_back({jump.at, jump.by});
  for (TopicCourse& topic : course.topics) {
    const auto offers = course.offers.find(topic.name);
    topic.is_latched = topic.name.ends_with("tf_static") ||
                       (offers != course.offers.end() && !offers->second.empty() &&
                        std::ranges::all_of(offers->second, [](const OfferedQos& each) {
                          return each.durability == "transient_local";
                        }));
  }
  return course;
}

}  // namespace culprit::bag_doctor
