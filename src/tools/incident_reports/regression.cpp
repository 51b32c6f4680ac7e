#include "incident_reports/regression.h"

#include <fstream>
#include <map>

#include <fmt/core.h>

#include "bag/bag_file.h"
#include "bag/bag_reading.h"
#include "base/environment.h"
#include "base/text_file.h"
#include "incident_reports/incident_json.h"
#include "incident_reports/incident_report.h"
#include "incident_reports/journal_incidents.h"
#include "language/checker.h"
#include "plan/bayes/bayes_planner.h"
#include "recorder/mcap_writer.h"
#include "recorder/recording_folder.h"
#include "replay/bag_replay.h"

namespace culprit::incident_reports {
namespace {

using namespace std::chrono_literals;

constexpr Duration kBefore = 20s, kBehind = 10s;  // as the recorder keeps them

std::int64_t nanoseconds(double seconds_since_1970) {
  return static_cast<std::int64_t>(seconds_since_1970 * 1e9);
}

// Writes the messages of a bag to another.
class Copying {
 public:
  Copying(const bag::BagContents& contents, std::ofstream& file)
      : contents_(contents),
        writer_(
            [&file](std::string_view bytes) {
              file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
              return file.good();
            },
            "ros2", "culprit") {}

  void add(std::size_t topic, std::int64_t at, std::string_view bytes) {
    const std::uint16_t channel = channel_of(topic);
    if (channel == 0) return;
    writer_.add({channel, 0, at, at}, bytes);
    ++count_;
  }
  std::uint64_t end() {
    writer_.end();
    return count_;
  }

 private:
  std::uint16_t channel_of(std::size_t topic) {
    const auto [found, is_new] = channels_.try_emplace(topic, 0);
    if (!is_new) return found->second;
    const bag::BagTopic& of = contents_.topics()[topic];
    const std::string* text = contents_.definition_of(of.type);
    const std::uint16_t schema = writer_.add_schema(
        {of.type, text == nullptr ? "" : "ros2msg", text == nullptr ? "" : *text});
    recorder::McapWriter::Texts metadata;
    if (!of.offered_qos.empty()) metadata["offered_qos_profiles"] = of.offered_qos;
    return found->second = writer_.add_channel({schema, of.name, of.encoding, metadata});
  }

  const bag::BagContents& contents_;
  recorder::McapWriter writer_;
  std::map<std::size_t, std::uint16_t> channels_;
  std::uint64_t count_ = 0;
};

bool is_latched(const bag::BagTopic& topic) {
  return topic.name.ends_with("tf_static") ||
         topic.offered_qos.find("transient_local") != std::string::npos ||
         topic.offered_qos.find("durability: 1") != std::string::npos;
}

// The rules that fire on the copy, and the components that they blame.
struct Seen {
  std::map<std::string, Duration> detected;  // rules, since the copy's beginning
  std::map<std::string, Duration> blamed;    // components
};

Expected<Seen> replayed(const RuleSet& rules, const std::filesystem::path& path) {
  auto bag = bag::BagFile::open(path);
  if (!bag) return Error{bag.error()};
  ros2::MessageLibrary library(ros2::message_directories({}, environment("AMENT_PREFIX_PATH")));
  bag::BagReading reading(rules, bag->contents(), library);
  Seen seen;
  std::optional<Time> begin;
  const auto take = [&](const Event& event, std::int64_t) {
    const Duration at = event.at - begin.value_or(event.at);
    if (const auto* detected = std::get_if<FailureDetected>(&event.what))
      seen.detected.try_emplace(rules[detected->rule].name, at);
    // As a test of a bag is judged (rule_test/bag_run.h).
    const auto* chosen = std::get_if<StrategyChosen>(&event.what);
    const auto* held = std::get_if<ActionHeldBack>(&event.what);
    if (chosen == nullptr && held == nullptr) return;
    for (const ComponentId component :
         rules[chosen != nullptr ? chosen->strategy : held->strategy].components)
      seen.blamed.try_emplace(rules[component].name, at);
  };
  replay::BagReplay replay(rules, std::make_unique<BayesPlanner>(), reading, {.on_event = take});
  for (bag::BagMessage message; bag->next(message);) {
    if (!begin) begin = Time(Duration(message.at));
    replay.step(message);
  }
  return seen;
}

std::string test_text(const Incident& incident, const Seen& seen, const std::string& name,
                      std::size_t& expectations) {
  std::string text = fmt::format(
      "# Made by culprit incident {0} --export-test.\nRULES {1}.rules\n\nTEST \"incident {0}\"\n  "
      "BAG {1}.mcap\n",
      incident.id, name);
  constexpr Duration kSlack = 500ms;
  const auto expect = [&](const std::string& what, Duration at) {
    text += fmt::format("  EXPECT {} BY {}\n", what,
                        to_string(std::chrono::ceil<std::chrono::milliseconds>(at + kSlack)));
    ++expectations;
  };
  for (const std::string& rule : incident.rules) {
    const auto found = seen.detected.find(rule);
    if (found != seen.detected.end()) {
      expect(rule + " DETECTED", found->second);
    } else {
      text += fmt::format(
          "  # {} was detected on the robot; the recording does not show it again.\n", rule);
    }
  }
  for (const std::string& cause : incident.causes) {
    const auto found = seen.blamed.find(cause);
    if (found != seen.blamed.end()) {
      expect("BLAME " + cause, found->second);
    } else {
      text += fmt::format("  # {} was held responsible; the recording alone does not show why.\n",
                          cause);
    }
  }
  return text;
}

}  // namespace

Expected<std::uint64_t> cut_bag(const std::filesystem::path& path, std::int64_t from,
                                std::int64_t until, const std::filesystem::path& to) {
  auto bag = bag::BagFile::open(path);
  if (!bag) return Error{bag.error()};
  std::ofstream file(to, std::ios::binary);
  Copying copy(bag->contents(), file);
  std::map<std::size_t, std::string> latched;  // the last one before
  bool has_begun = false;
  for (bag::BagMessage message; bag->next(message);) {
    if (message.recorded_at < from) {
      if (is_latched(bag->contents().topics()[message.topic]))
        latched[message.topic] = message.bytes;
      continue;
    }
    if (message.recorded_at > until) break;
    if (!std::exchange(has_begun, true)) {
      for (const auto& [topic, bytes] : latched) copy.add(topic, from, bytes);
    }
    copy.add(message.topic, message.recorded_at, message.bytes);
  }
  const std::uint64_t count = copy.end();
  file.flush();
  if (!file) return Error{"'" + to.string() + "' cannot be written"};
  if (count == 0) return Error{"the recording '" + path.string() + "' has no message of that time"};
  return count;
}

Expected<ExportedTest> export_test(const journal::Reader& journal, const std::string& id,
                                   const std::filesystem::path& recordings,
                                   const std::filesystem::path& folder) {
  const auto content = report_of(journal, id, "", 0);
  if (!content) return Error{content.error()};
  if (!*content) return Error{"there is no incident '" + id + "'; culprit incident lists them"};
  const Incident& incident = (*content)->incident;
  const auto session = session_at(journal, incident.first_row);
  if (!session) return Error{session.error()};
  if (!*session) return Error{"the journal does not have the rules of that run any more"};
  const Checked checked = check(Source((*session)->rules_path, (*session)->rules_text));
  if (!checked.rules)
    return Error{"the rules of that run cannot be read by this version of culprit"};
  const auto own = recordings_of(incident, recorder::recordings_in(recordings));
  if (own.empty())
    return Error{"there is no recording of it in '" + recordings.string() +
                 "'; culprit run --record makes one of each incident"};
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const std::string name = "incident_" + incident.id;
  ExportedTest exported{folder / (name + ".test"), folder / (name + ".mcap"),
                        folder / (name + ".rules")};
  for (const auto& each : {exported.test, exported.bag, exported.rules}) {
    if (std::filesystem::exists(each, error))
      return Error{"'" + each.string() + "' is there already; name another folder"};
  }
  const auto cut =
      cut_bag(own.front().path, nanoseconds(incident.began) - kBefore.count(),
              nanoseconds(incident.began + incident.seconds) + kBehind.count(), exported.bag);
  if (!cut) return Error{cut.error()};
  const auto seen = replayed(*checked.rules, exported.bag);
  if (!seen) return Error{seen.error()};
  const std::string text = test_text(incident, *seen, name, exported.expectations);
  if (exported.expectations == 0) {
    std::filesystem::remove(exported.bag, error);
    return Error{
        "the recording does not show what was detected, so there is nothing to expect of it"};
  }
  if (const auto written = write_text(exported.rules.string(), (*session)->rules_text); !written)
    return Error{written.error()};
  if (const auto written = write_text(exported.test.string(), text); !written)
    return Error{written.error()};
  return exported;
}

}  // namespace culprit::incident_reports
