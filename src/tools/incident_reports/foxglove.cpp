#include "incident_reports/foxglove.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <set>

#include "bag/bag_file.h"
#include "bag/bag_reading.h"
#include "json/json.h"
#include "knowledge/describe.h"
#include "knowledge/event_words.h"
#include "recorder/mcap_writer.h"
#include "replay/bag_replay.h"
#include "robot/unreadable.h"

namespace culprit::incident_reports {
namespace {

namespace fs = std::filesystem;
using recorder::McapWriter;

constexpr const char* kLogTopic = "/culprit/log";
constexpr const char* kIncidentTopic = "/culprit/incidents";

// Characters that a path of Foxglove's panels gives a meaning.
std::string topic_of(const std::string& kind, const std::string& name) {
  std::string topic = "/culprit/" + kind + "/";
  for (const char c : name.starts_with('/') ? name.substr(1) : name) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
    topic += is_plain ? c : '_';
  }
  return topic;
}

Json member(const char* type) { return {{"type", type}}; }
Json list_of(const char* type) { return {{"type", "array"}, {"items", member(type)}}; }

// With the time that foxglove.Log has.
std::string schema_of(const std::string& title, Json members) {
  Json time{{"type", "object"},
            {"title", "time"},
            {"properties", {{"sec", member("integer")}, {"nsec", member("integer")}}}};
  Json properties{{"timestamp", std::move(time)}};
  properties.update(members);
  return to_line({{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                  {"title", title},
                  {"type", "object"},
                  {"properties", std::move(properties)}});
}

Json time_of(std::int64_t at) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  return {{"sec", at / kSecond}, {"nsec", at % kSecond}};
}

// As foxglove.Log numbers them. A failure is as severe as its rule says.
int foxglove_level(const Event& event, const RuleSet& rules) {
  constexpr int kInfo = 2, kWarning = 3, kError = 4;
  const auto* detected = std::get_if<FailureDetected>(&event.what);
  if (detected != nullptr && rules[detected->rule].policies.criticality == Criticality::kError)
    return kError;
  const EventSeverity severity = severity_of(event, rules);
  return severity == EventSeverity::kError     ? kError
         : severity == EventSeverity::kWarning ? kWarning
                                               : kInfo;
}

// Topics whose rhythm the rules read.
std::set<std::uint32_t> rhythms_of(const RuleSet& rules) {
  std::set<std::uint32_t> topics;
  for (const Input& input : rules.inputs) {
    using enum Input::Kind;
    const bool is_rhythm =
        input.kind == kAge || input.kind == kRate || input.kind == kPhi || input.kind == kLoss;
    if (is_rhythm && !rules[input.topic].publisher) topics.insert(input.topic.index);
  }
  return topics;
}

class FoxgloveFile {
 public:
  FoxgloveFile(const RuleSet& rules, McapWriter::Sink sink)
      : rules_(rules),
        writer_(std::move(sink), "", "culprit"),
        rhythms_(rhythms_of(rules)),
        states_(rules.rules.size()) {
    log_ = schema("foxglove.Log", {{"level", member("integer")},
                                   {"message", member("string")},
                                   {"name", member("string")},
                                   {"file", member("string")},
                                   {"line", member("integer")}});
    incident_ = schema("culprit.Incident", {{"id", member("string")},
                                            {"state", member("string")},
                                            {"headline", member("string")},
                                            {"criticality", member("string")},
                                            {"is_certain", member("boolean")},
                                            {"components", list_of("string")},
                                            {"rules", list_of("string")}});
    rule_ =
        schema("culprit.Rule", {{"state", member("string")}, {"is_failing", member("integer")}});
    value_ = schema("culprit.Value", {{"value", member("number")}, {"text", member("string")}});
  }

  void begin(std::int64_t clock) {
    for (std::size_t r = 0; r < rules_.rules.size(); ++r) put_state(RuleId(r), clock);
  }

  // The rule's trigger got a value, or lost it.
  void judge(RuleId rule, bool is_known, std::int64_t clock) {
    states_[rule.index].is_known = is_known;
    put_state(rule, clock);
  }

  void add(const Event& event, std::int64_t clock) {
    if (const std::string text = describe(event, rules_); !text.empty())
      put(kLogTopic, log_, clock,
          {{"level", foxglove_level(event, rules_)},
           {"message", text},
           {"name", "culprit"},
           {"file", std::string(words_of(event).name)},
           {"line", 0}});
    if (const auto* detected = std::get_if<FailureDetected>(&event.what))
      set_failing(detected->rule, clock, true);
    if (const auto* resolved = std::get_if<FailureResolved>(&event.what))
      set_failing(resolved->rule, clock, false);
    if (const auto* lost = std::get_if<FailureLost>(&event.what))
      set_failing(lost->rule, clock, false);
    if (const auto* opened = std::get_if<IncidentOpened>(&event.what))
      put_incident(opened->incident, "opened", clock);
    if (const auto* changed = std::get_if<IncidentChanged>(&event.what))
      put_incident(changed->incident, "changed", clock);
    if (const auto* closed = std::get_if<IncidentClosed>(&event.what))
      put(kIncidentTopic, incident_, clock,
          {{"id", closed->id},
           {"state", std::string(to_string(closed->how))},
           {"rules", Json::array({rules_[closed->root].name})}});
  }

  void add(const ObservationWhat& what, std::int64_t clock) {
    if (const auto* signal = std::get_if<SignalRead>(&what)) {
      put_value(topic_of("signals", rules_[signal->signal].name), signal->value, clock);
    } else if (const auto* parameter = std::get_if<ParameterRead>(&what)) {
      const Parameter& of = rules_[parameter->parameter];
      put_value(topic_of("parameters", rules_[of.component].name + "_" + of.name), parameter->value,
                clock);
    } else if (const auto* level = std::get_if<DiagnosticRead>(&what)) {
      put_value(topic_of("levels", rules_.diagnostics[level->diagnostic.index].name),
                Value(std::int64_t{level->level}), clock);
    } else if (const auto* sample = std::get_if<SampleArrived>(&what)) {
      if (!rhythms_.contains(sample->topic.index)) return;
      const auto [last, is_first] = last_.try_emplace(sample->topic.index, clock);
      if (!is_first) put_gap(sample->topic, last->second, clock);
      last->second = clock;
    }
  }

  // `clock`: of the last message. False: it could not be written.
  bool end(std::int64_t clock) {
    // A topic that fell silent for good has no message that ends its gap.
    for (const auto& [topic, last] : last_) put_gap(TopicId(topic), last, clock);
    writer_.end();
    return writer_.is_good();
  }

 private:
  std::uint16_t schema(const std::string& name, Json members) {
    return writer_.add_schema({name, "jsonschema", schema_of(name, std::move(members))});
  }
  void put(const std::string& topic, std::uint16_t schema, std::int64_t clock, Json message) {
    const auto [channel, is_new] = channels_.try_emplace(topic, 0);
    if (is_new) channel->second = writer_.add_channel({schema, topic, "json", {}});
    if (channel->second == 0) return;
    Json whole{{"timestamp", time_of(clock)}};
    whole.update(message);
    writer_.add({channel->second, ++sequence_, clock, clock}, to_line(whole));
  }
  struct RuleState {
    bool is_known = false;
    bool is_failing = false;
  };
  void set_failing(RuleId rule, std::int64_t clock, bool is_failing) {
    states_[rule.index].is_failing = is_failing;
    put_state(rule, clock);
  }
  void put_state(RuleId rule, std::int64_t clock) {
    const RuleState& state = states_[rule.index];
    const char* word = !state.is_known ? "unknown" : state.is_failing ? "failing" : "ok";
    put(topic_of("rules", rules_[rule].name), rule_, clock,
        {{"state", word}, {"is_failing", state.is_failing ? 1 : 0}});
  }
  void put_gap(TopicId topic, std::int64_t last, std::int64_t clock) {
    constexpr double kNanosecond = 1e-9;  // s
    if (clock > last)
      put_value(topic_of("gaps", rules_[topic].name),
                Value(static_cast<double>(clock - last) * kNanosecond), clock);
  }
  void put_incident(const culprit::Incident& incident, const char* state, std::int64_t clock) {
    Json components = Json::array();
    for (const ComponentId each : incident.components) components.push_back(rules_[each].name);
    Json failures = Json::array({rules_[incident.root].name});
    for (const RuleId each : incident.consequences) failures.push_back(rules_[each].name);
    put(kIncidentTopic, incident_, clock,
        {{"id", incident.id},
         {"state", state},
         {"headline", incident.headline},
         {"criticality", std::string(to_string(incident.criticality))},
         {"is_certain", incident.is_certain},
         {"components", std::move(components)},
         {"rules", std::move(failures)}});
  }
  // JSON has no NaN, and an infinite number is none there either.
  void put_value(const std::string& topic, const Value& value, std::int64_t clock) {
    if (is_unreadable(value)) return;
    Json message = Json::object();
    if (const auto* number = std::get_if<double>(&value)) {
      if (std::isfinite(*number)) message["value"] = *number;
      if (!std::isfinite(*number)) message["text"] = to_string(value);
    } else if (const auto* whole = std::get_if<std::int64_t>(&value)) {
      message["value"] = *whole;
    } else if (const auto* truth = std::get_if<bool>(&value)) {
      message["value"] = *truth ? 1 : 0;
    } else if (const auto* text = std::get_if<std::string>(&value)) {
      char* end = nullptr;
      const double parsed = std::strtod(text->c_str(), &end);
      const bool is_number = !text->empty() && *end == '\0' && std::isfinite(parsed);
      if (is_number) message["value"] = parsed;
      if (!is_number) message["text"] = *text;
    }
    put(topic, value_, clock, std::move(message));
  }

  const RuleSet& rules_;
  McapWriter writer_;
  const std::set<std::uint32_t> rhythms_;
  std::vector<RuleState> states_;               // by rule
  std::map<std::uint32_t, std::int64_t> last_;  // message of a topic whose rhythm is read
  std::uint16_t log_ = 0, incident_ = 0, rule_ = 0, value_ = 0;
  std::map<std::string, std::uint16_t> channels_;  // by topic
  std::uint32_t sequence_ = 0;
};

// One under the other, each with its share of the height.
Json stacked(const std::vector<std::string>& panels, std::size_t from = 0) {
  if (from + 1 == panels.size()) return panels[from];
  return {{"first", panels[from]},
          {"second", stacked(panels, from + 1)},
          {"direction", "column"},
          {"splitPercentage", 100.0 / static_cast<double>(panels.size() - from)}};
}

struct LayoutPlot {
  std::string topic;
  std::string title;
  std::set<double> limits{};
};

// The inputs that can be drawn, each once.
std::vector<LayoutPlot> plots_of(const RuleSet& rules) {
  std::vector<LayoutPlot> plots;
  const auto add = [&](const std::string& topic, const std::string& title, const Input& input,
                       bool is_limited) {
    auto found = std::ranges::find(plots, topic, &LayoutPlot::topic);
    if (found == plots.end()) found = plots.insert(plots.end(), {topic, title});
    if (is_limited) found->limits.insert(input.thresholds.begin(), input.thresholds.end());
  };
  for (const Input& input : rules.inputs) {
    using enum Input::Kind;
    switch (input.subject()) {
      case Input::Subject::kSignal: {
        const std::string& name = rules[input.signal].name;
        if (std::holds_alternative<GroupId>(rules[input.signal].source)) break;
        const bool is_limited = input.kind == kSignal || input.kind == kMean ||
                                input.kind == kMin || input.kind == kMax;
        add(topic_of("signals", name), name, input, is_limited);
        break;
      }
      case Input::Subject::kTopic:
        if (input.kind != kGoals && input.kind != kGoalAge && !rules[input.topic].publisher)
          add(topic_of("gaps", rules[input.topic].name),
              "seconds between messages of " + rules[input.topic].name, input, input.kind == kAge);
        break;
      case Input::Subject::kDiagnostic:
        add(topic_of("levels", rules.diagnostics[input.diagnostic.index].name),
            describe(input, rules), input, true);
        break;
      case Input::Subject::kParameter: {
        const Parameter& of = rules[input.parameter];
        add(topic_of("parameters", rules[of.component].name + "_" + of.name),
            describe(input, rules), input, true);
        break;
      }
      case Input::Subject::kComponent:
        break;
    }
  }
  return plots;
}

}  // namespace

std::string foxglove_layout(const RuleSet& rules) {
  constexpr std::size_t kMostPlots = 6;
  Json panels = Json::object();
  std::vector<std::string> plots;
  const auto place = [&](const std::string& kind, std::size_t number, Json settings) {
    const std::string id = kind + "!culprit" + std::to_string(number);
    panels[id] = std::move(settings);
    return id;
  };
  const auto path = [](const std::string& value, const std::string& label) {
    return Json{
        {"value", value}, {"label", label}, {"enabled", true}, {"timestampMethod", "receiveTime"}};
  };
  Json states = Json::array();
  for (const Rule& rule : rules.rules)
    states.push_back(path(topic_of("rules", rule.name) + ".state", rule.name));
  Json left = place("StateTransitions", 1, {{"paths", std::move(states)}, {"isSynced", true}});
  std::size_t number = 0;
  for (const LayoutPlot& plot : plots_of(rules)) {
    if (number >= kMostPlots) break;
    Json paths = Json::array({path(plot.topic + ".value", plot.title)});
    // A number by itself is a line across the plot.
    for (const double limit : plot.limits) paths.push_back(path(to_string(Value(limit)), "limit"));
    plots.push_back(place("Plot", ++number,
                          {{"paths", std::move(paths)},
                           {"showXAxisLabels", true},
                           {"showYAxisLabels", true},
                           {"showLegend", false},
                           {"legendDisplay", "none"},
                           {"isSynced", true},
                           {"xAxisVal", "timestamp"},
                           {"foxglovePanelTitle", plot.title},
                           {"lichtblickPanelTitle", plot.title}}));
  }
  if (!plots.empty()) {
    constexpr std::size_t kPercentOfRule = 6, kMostPercent = 50;  // of the height
    left = {{"first", std::move(left)},
            {"second", stacked(plots)},
            {"direction", "column"},
            {"splitPercentage", std::min(kMostPercent, kPercentOfRule * (rules.rules.size() + 1))}};
  }
  const std::string log =
      place("RosOut", 1,
            {{"searchTerms", Json::array()}, {"minLogLevel", 1}, {"topicToRender", kLogTopic}});
  const std::string incidents =
      place("RawMessages", 1, {{"topicPath", kIncidentTopic}, {"diffEnabled", false}});
  constexpr int kLeftPercent = 65;
  return to_indented({{"configById", std::move(panels)},
                      {"globalVariables", Json::object()},
                      {"userNodes", Json::object()},
                      {"playbackConfig", {{"speed", 1}}},
                      {"layout",
                       {{"first", std::move(left)},
                        {"second", stacked({log, incidents})},
                        {"direction", "row"},
                        {"splitPercentage", kLeftPercent}}}}) +
         "\n";
}

fs::path layout_beside(const fs::path& file) {
  return fs::path(file).replace_extension(".layout.json");
}

Expected<void> write_foxglove(const RuleSet& rules, std::unique_ptr<const Planner> planner,
                              const FoxgloveWish& wish) {
  auto bag = bag::BagFile::open(wish.bag);
  if (!bag) return Error{bag.error()};
  std::error_code none;
  for (const bag::BagFile::Part& each : bag->parts()) {
    if (fs::equivalent(each.path, wish.file, none))
      return Error{"'" + wish.file.string() + "' is a part of the recording; give another file"};
  }
  std::ofstream out(wish.file, std::ios::binary | std::ios::trunc);
  const auto refused = [&] {
    return Error{"cannot write '" + wish.file.string() + "': " + std::strerror(errno)};
  };
  if (!out) return refused();
  FoxgloveFile file(rules, [&](std::string_view bytes) {
    return static_cast<bool>(out.write(bytes.data(), static_cast<std::streamsize>(bytes.size())));
  });
  ros2::MessageLibrary library(wish.message_path);
  bag::BagReading reading(rules, bag->contents(), library);
  replay::BagReplay::Listener listener;
  listener.on_event = [&](const Event& event, std::int64_t clock) { file.add(event, clock); };
  listener.on_judged = [&](RuleId rule, bool is_known, std::int64_t clock) {
    file.judge(rule, is_known, clock);
  };
  listener.on_observation = [&](const Observation& observation, std::int64_t clock) {
    file.add(observation.what, clock);
  };
  replay::BagReplay replay(rules, std::move(planner), reading, std::move(listener));
  std::int64_t clock = 0;
  for (bag::BagMessage message; bag->next(message);) {
    clock = message.recorded_at;
    if (!replay.start()) file.begin(clock);
    replay.step(message);
  }
  if (!replay.start()) return Error{"the bag '" + wish.bag.string() + "' has no message"};
  const bool is_written = file.end(clock);
  out.flush();
  if (!is_written || !out) return refused();
  return {};
}

}  // namespace culprit::incident_reports
