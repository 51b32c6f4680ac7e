#include "incident_reports/recorded_curves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "bag/bag_file.h"
#include "bag/bag_reading.h"
#include "bag/number_fields.h"
#include "journal/json.h"
#include "knowledge/describe.h"
#include "recorder/incident_recorder.h"
#include "robot/component_binding.h"
#include "ros2/messages.h"

namespace culprit::incident_reports {
namespace {

namespace fs = std::filesystem;

// A message without a named field is read if it is no picture, no map and no cloud.
constexpr std::size_t kSmallMessage = std::size_t{16} << 10;  // bytes
constexpr std::size_t kMostFields = 32;                       // of a type, of which some may change
constexpr std::size_t kMostTracked = 256;                     // curves, of which some are chosen
constexpr std::size_t kMostLimits = 4;
constexpr std::size_t kMessageItself = 64;  // bytes: reading an empty one costs something, too
constexpr double kSecondsOf = 1e-9;         // a nanosecond

std::optional<double> number_in(const Value& value) {
  if (const auto* is = std::get_if<bool>(&value)) return *is ? 1 : 0;
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  if (const auto* real = std::get_if<double>(&value)) return *real;
  const Value read = value_from_text(std::get<std::string>(value));
  return std::holds_alternative<std::string>(read) ? std::nullopt : number_in(read);
}

rtps::ByteView bytes_of(const bag::BagMessage& message) {
  return {reinterpret_cast<const std::uint8_t*>(message.bytes.data()), message.bytes.size()};
}

// Messages of a recording, until it is enough.
class BoundedBag {
 public:
  static Expected<BoundedBag> open(const fs::path& path, const CurveLimits& limits) {
    auto file = bag::BagFile::open(path, {limits.most_memory});
    if (!file) return Error{file.error()};
    return BoundedBag(std::move(*file), limits.most_messages);
  }
  bool next(bag::BagMessage& message) {
    if (read_ > most_ || !file_.next(message)) return false;
    read_ += message.bytes.size() + kMessageItself;
    return true;
  }
  bool is_cut() const { return read_ > most_; }
  const bag::BagContents& contents() const { return file_.contents(); }

 private:
  BoundedBag(bag::BagFile file, std::uint64_t most) : file_(std::move(file)), most_(most) {}
  bag::BagFile file_;
  std::uint64_t most_;
  std::uint64_t read_ = 0;
};

// The robot's graph as the recording begins with it; null: it has none.
Json first_graph(const fs::path& path, const CurveLimits& limits) {
  constexpr std::size_t kMostGraph = std::size_t{4} << 20;  // bytes; robots have some 100,000
  auto file = BoundedBag::open(path, limits);
  if (!file) return nullptr;
  for (bag::BagMessage message; file->next(message);) {
    const bag::BagTopic& topic = file->contents().topics()[message.topic];
    if (topic.name != recorder::IncidentRecorder::kGraphTopic || message.bytes.size() > kMostGraph)
      continue;
    const auto text = rtps::decode<ros2::msg::String>(bytes_of(message));
    if (text) return parse_json(text->data);
  }
  return nullptr;
}

// Topics on which culprit or every node reports on itself: the page shows these elsewhere, or they
// have no numbers.
bool is_of_everybody(const std::string& topic) {
  constexpr std::array<std::string_view, 6> kOfEverybody = {
      "/rosout", "/parameter_events", "/diagnostics", "/clock", "/tf", "/tf_static"};
  return std::ranges::find(kOfEverybody, topic) != kOfEverybody.end() ||
         topic.starts_with("/culprit/") || topic.ends_with("/transition_event");
}

// A topic whose numbers are looked at, and why.
struct WantedTopic {
  std::string name;
  std::string about;
  bool is_published = false;  // by a component: when its messages came tells how that was
};

// Of the components: what they publish, then what they hear.
std::vector<WantedTopic> topics_of(const CurveWish& wish, const Json& graph) {
  std::map<std::string, const Json*> nodes;
  ComponentBinding binding(wish.rules);
  const auto list = graph.is_object() ? graph.find("nodes") : graph.end();
  if (!graph.is_object() || list == graph.end() || !list->is_array()) return {};
  for (const Json& node : *list) {
    const std::string name = journal::text_of(node, "name");
    if (name.empty()) continue;
    nodes.try_emplace(name, &node);
    (void)binding.bind(name);
  }
  const auto node_of = [&](const std::string& component) -> const Json* {
    for (std::size_t c = 0; c < wish.rules.components.size(); ++c) {
      if (wish.rules.components[c].name != component) continue;
      const auto found = nodes.find(binding.node_of(ComponentId(c)));
      return found == nodes.end() ? nullptr : found->second;
    }
    return nullptr;
  };
  std::vector<WantedTopic> topics;
  const auto add = [&](const char* how, const char* verb, bool is_published) {
    for (const std::string& component : wish.components) {
      const Json* node = node_of(component);
      const auto names = node == nullptr ? graph.end() : node->find(how);
      if (node == nullptr || names == node->end() || !names->is_object()) continue;
      for (const auto& item : names->items()) {
        const auto is_it = [&](const WantedTopic& each) { return each.name == item.key(); };
        if (!is_of_everybody(item.key()) && std::ranges::none_of(topics, is_it))
          topics.push_back({item.key(), component + verb, is_published});
      }
    }
  };
  add("publishes", " publishes it", true);
  add("subscribes", " subscribes to it", false);
  return topics;
}

class CurveReader {
 public:
  CurveReader(const CurveWish& wish, const bag::BagContents& contents,
              std::vector<WantedTopic> wanted, const CurveLimits& limits)
      : wish_(wish),
        contents_(contents),
        wanted_(std::move(wanted)),
        limits_(limits),
        reading_(wish.rules, contents, library_) {
    for (const std::string& name : wish.failed) {
      for (const Rule& rule : wish.rules.rules) {
        if (rule.name == name) follow(rule);
      }
    }
  }
  CurveReader(const CurveReader&) = delete;

  void read(const bag::BagMessage& message) {
    if (!has_begun_) begin_ = message.at;
    has_begun_ = true;
    end_ = message.at;
    observations_.clear();
    reading_.read(message, observations_);
    for (const Observation& each : observations_) take(each.what, message.at);
    while (plans_.size() <= message.topic) plans_.push_back(plan_for(plans_.size()));
    const TopicPlan& plan = plans_[message.topic];
    if (plan.rhythm != nullptr) beat(*plan.rhythm, message.at);
    if (message.bytes.size() > kSmallMessage) return;
    for (const Field& field : plan.fields) {
      Value value;
      if (field.reader.read(bytes_of(message), value) != ros2::FieldStatus::kRead) continue;
      if (const auto number = number_in(value))
        tracked_[field.curve].samples.add(message.at, *number);
    }
  }

  RecordedCurves finish() {
    RecordedCurves shown{begin_, end_, {}, {}};
    end_rhythms();
    std::vector<std::string> missing;
    for (Tracked& each : tracked_) {
      if (each.readers.empty()) continue;
      each.curve.about = "read by " + listed(each.readers);
      if (each.samples.samples() == 0) {
        missing.push_back(each.curve.name);
      } else {
        add(each, shown);
      }
    }
    for (const WantedTopic& topic : wanted_) add_of_topic(topic.name, shown);
    if (!missing.empty())
      shown.remarks.push_back(
          "The recording has nothing of what these rules read: " + listed(missing) + ".");
    if (left_out_ > 0)
      shown.remarks.push_back(std::to_string(left_out_) +
                              (left_out_ == 1 ? " more curve is" : " more curves are") +
                              " left out here; the recording has all.");
    return shown;
  }

 private:
  struct Tracked {
    Curve curve{};
    std::vector<std::string> readers{};  // rules; empty: it is of a component's topic
    std::string topic{};                 // then
    bag::ThinnedCurve samples{};
    bool is_rhythm = false;
  };
  struct Field {
    std::size_t curve;  // in tracked_
    ros2::FieldReader reader;
  };
  // When messages of a topic came.
  struct Rhythm {
    std::size_t curve;
    std::int64_t first = 0;
    std::int64_t last = 0;
    std::int64_t count = 0;
  };
  struct TopicPlan {
    std::vector<Field> fields{};
    Rhythm* rhythm = nullptr;
  };
  using Place = std::map<std::uint32_t, std::size_t>;  // ids to tracked_

  void follow(const Rule& rule) {
    for (const InputId id : rule.inputs) {
      const Input& input = wish_.rules[id];
      switch (input.subject()) {
        case Input::Subject::kSignal: {
          const std::size_t place = follow_signal(rule, input.signal);
          if (input.kind == Input::Kind::kSignal) limit(place, input);
          break;
        }
        case Input::Subject::kTopic: {
          if (input.kind == Input::Kind::kGoals || input.kind == Input::Kind::kGoalAge) break;
          const std::size_t place = follow_rhythm(rule, input.topic);
          if (input.kind == Input::Kind::kAge) limit(place, input);
          break;
        }
        case Input::Subject::kParameter:
          limit(place_of(rule, parameters_, input.parameter.index, describe(input, wish_.rules)),
                input);
          break;
        case Input::Subject::kDiagnostic:
          limit(place_of(rule, levels_, input.diagnostic.index, describe(input, wish_.rules)),
                input);
          break;
        case Input::Subject::kComponent:
          break;  // no numbers; the marks tell
      }
    }
  }

  std::size_t place_of(const Rule& rule, Place& places, std::uint32_t id, const std::string& name) {
    const auto [found, is_new] = places.try_emplace(id, tracked_.size());
    if (is_new) tracked_.push_back({.curve = {.name = name}});
    std::vector<std::string>& readers = tracked_[found->second].readers;
    if (std::ranges::find(readers, rule.name) == readers.end()) readers.push_back(rule.name);
    return found->second;
  }
  std::size_t follow_signal(const Rule& rule, SignalId id) {
    const Signal& signal = wish_.rules[id];
    std::string name = signal.name;
    if (const auto* field = std::get_if<TopicField>(&signal.source)) {
      const std::string& topic = wish_.rules[field->topic].name;
      named_.emplace(topic, field->field);
      name += " (" + topic + " " + field->field + ")";
    }
    return place_of(rule, signals_, id.index, name);
  }
  std::size_t follow_rhythm(const Rule& rule, TopicId id) {
    const std::string& topic = wish_.rules[id].name;
    const std::size_t place = place_of(rule, topics_, id.index, "");
    follow_rhythm(place, topic);
    return place;
  }
  Rhythm& follow_rhythm(std::size_t place, const std::string& topic) {
    tracked_[place].curve.name = "time between messages of " + topic;
    tracked_[place].curve.unit = "s";
    tracked_[place].is_rhythm = true;
    return rhythms_.try_emplace(topic, Rhythm{place}).first->second;
  }
  void limit(std::size_t place, const Input& input) {
    std::vector<double>& limits = tracked_[place].curve.limits;
    for (const double each : input.thresholds) {
      const bool is_known = std::ranges::find(limits, each) != limits.end();
      if (limits.size() < kMostLimits && !is_known && std::isfinite(each)) limits.push_back(each);
    }
  }

  void take(const ObservationWhat& what, std::int64_t at) {
    const auto put = [&](const Place& places, std::uint32_t id, std::optional<double> number) {
      const auto found = places.find(id);
      if (found != places.end() && number) tracked_[found->second].samples.add(at, *number);
    };
    if (const auto* signal = std::get_if<SignalRead>(&what)) {
      put(signals_, signal->signal.index, number_in(signal->value));
    } else if (const auto* parameter = std::get_if<ParameterRead>(&what)) {
      put(parameters_, parameter->parameter.index, number_in(parameter->value));
    } else if (const auto* level = std::get_if<DiagnosticRead>(&what)) {
      put(levels_, level->diagnostic.index, static_cast<double>(level->level));
    }
  }
  void beat(Rhythm& rhythm, std::int64_t at) {
    if (rhythm.count == 0) rhythm.first = at;
    if (rhythm.count > 0)
      tracked_[rhythm.curve].samples.add(at, static_cast<double>(at - rhythm.last) * kSecondsOf);
    rhythm.last = at;
    ++rhythm.count;
  }
  // A topic that fell silent, and still was at the end, is shown as silent.
  void end_rhythms() {
    for (auto& [topic, rhythm] : rhythms_) {
      if (rhythm.count == 0) continue;
      const std::int64_t silence = end_ - rhythm.last;
      const std::int64_t usual =
          rhythm.count == 1 ? 0 : (rhythm.last - rhythm.first) / (rhythm.count - 1);
      if (silence / 2 > usual)
        tracked_[rhythm.curve].samples.add(end_, static_cast<double>(silence) * kSecondsOf);
    }
  }

  // The plan for a topic of the recording, if it concerns a component, or a rule its rhythm.
  TopicPlan plan_for(std::size_t place) {
    const bag::BagTopic& topic = contents_.topics()[place];
    TopicPlan plan;
    const auto rhythm = rhythms_.find(topic.name);
    if (rhythm != rhythms_.end()) plan.rhythm = &rhythm->second;
    const auto wanted = std::ranges::find(wanted_, topic.name, &WantedTopic::name);
    if (wanted == wanted_.end()) return plan;
    const auto named = named_.lower_bound({topic.name, ""});
    const bool is_drawn =
        plan.rhythm != nullptr || (named != named_.end() && named->first == topic.name);
    if (wanted->is_published && !is_drawn && tracked_.size() < kMostTracked) {
      tracked_.push_back({.curve = {.about = wanted->about}, .topic = topic.name});
      plan.rhythm = &follow_rhythm(tracked_.size() - 1, topic.name);
    }
    if (topic.encoding == "cdr") plan.fields = fields_in(topic, wanted->about);
    return plan;
  }
  std::vector<Field> fields_in(const bag::BagTopic& topic, const std::string& about) {
    if (const std::string* definition = contents_.definition_of(topic.type))
      library_.learn(topic.type, *definition);
    std::vector<Field> fields;
    for (const std::string& path : bag::number_fields(library_, topic.type, kMostFields)) {
      if (tracked_.size() >= kMostTracked) break;
      if (named_.contains({topic.name, path})) continue;
      auto reader = ros2::FieldReader::compile(library_, topic.type, path);
      if (!reader) continue;
      fields.push_back({tracked_.size(), std::move(*reader)});
      tracked_.push_back(
          {.curve = {.name = topic.name + " " + path, .about = about}, .topic = topic.name});
    }
    return fields;
  }

  // The numbers that change: a constant is not worth its place. If there are none (a camera's pictures), and no rule reads one, when the messages came.
  void add_of_topic(const std::string& topic, RecordedCurves& shown) {
    std::size_t count = 0;
    const Tracked* rhythm = nullptr;
    for (const Tracked& each : tracked_) {
      if (!each.readers.empty() || each.topic != topic || each.samples.samples() == 0) continue;
      if (each.is_rhythm) rhythm = &each;
      if (each.is_rhythm || each.samples.lowest() == each.samples.highest()) continue;
      if (count++ < limits_.most_of_topic) {
        add(each, shown);
      } else {
        ++left_out_;
      }
    }
    // One message, latched say, has no rhythm.
    if (count == 0 && rhythm != nullptr && rhythm->samples.samples() > 1) add(*rhythm, shown);
  }
  void add(const Tracked& each, RecordedCurves& shown) {
    if (shown.curves.size() < limits_.most_curves) {
      shown.curves.push_back(finished(each));
    } else {
      ++left_out_;
    }
  }
  static Curve finished(const Tracked& each) {
    Curve curve = each.curve;
    curve.points = each.samples.points();
    // A silence is what the line of a rhythm shows.
    curve.longest_gap = each.is_rhythm ? INT64_MAX : each.samples.longest_gap();
    return curve;
  }

  const CurveWish& wish_;
  const bag::BagContents& contents_;
  const std::vector<WantedTopic> wanted_;
  const CurveLimits& limits_;
  ros2::MessageLibrary library_;  // of what is in the recording, and the standard types
  bag::BagReading reading_;
  std::vector<Tracked> tracked_;
  Place signals_, parameters_, levels_, topics_;
  std::map<std::string, Rhythm> rhythms_;                // by topic; their places stay
  std::set<std::pair<std::string, std::string>> named_;  // topics and fields that the rules read
  std::vector<TopicPlan> plans_;                         // by topic of the recording
  std::vector<Observation> observations_;
  std::int64_t begin_ = 0;
  std::int64_t end_ = 0;
  bool has_begun_ = false;
  std::size_t left_out_ = 0;
};

}  // namespace

Expected<RecordedCurves> recorded_curves(const fs::path& recording, const CurveWish& wish,
                                         const CurveLimits& limits) {
  std::error_code error;
  const std::uint64_t size = fs::file_size(recording, error);
  if (!error && size > limits.most_file)
    return Error{recording.string() + " is too large to be drawn (" +
                 std::to_string(size / 1'000'000) + " MB); open it in Foxglove"};
  auto file = BoundedBag::open(recording, limits);
  if (!file) return Error{file.error()};
  CurveReader reader(wish, file->contents(), topics_of(wish, first_graph(recording, limits)),
                     limits);
  for (bag::BagMessage message; file->next(message);) reader.read(message);
  RecordedCurves shown = reader.finish();
  constexpr std::size_t kMostLossesTold = 5;  // of what is lost
  std::size_t told = 0;
  for (const std::string& each : file->contents().losses()) {
    if (told++ < kMostLossesTold)
      shown.remarks.push_back("The recording is not whole: " + each + ".");
  }
  if (file->is_cut())
    shown.remarks.push_back("The recording is very large, and only its beginning is drawn.");
  return shown;
}

}  // namespace culprit::incident_reports
