#include "cli/run_recording.h"

#include "base/name_grammar.h"
#include "terminal/command.h"
#include "terminal/seconds_option.h"

namespace culprit::cli {

void say_of_recording(const std::string& text) { say(stderr, "culprit: {}\n", text); }

namespace {

constexpr std::uint64_t kLeastMemory = 1'000'000;
constexpr std::uint64_t kMostMemory = 100'000'000'000;
constexpr double kMostSeconds = 600;

void add_bytes(CLI::App& command, const std::string& name, std::uint64_t& value,
               const std::string& what, const std::string& usual) {
  // A thousand bytes are a kB, as disks are sold; a KiB is 1024.
  command.add_option(name, value, what)
      ->transform(CLI::AsSizeValue(true))
      ->type_name("SIZE")
      ->default_str(usual);
}

}  // namespace

CLI::Option* add_snapshot(CLI::App& command, std::string& node, const std::string& what) {
  return command.add_option("--snapshot", node, what)
      ->type_name("NODE")
      ->check([](const std::string& name) {
        return is_valid_topic_name(name)
                   ? std::string()
                   : "it has to be the full name of a node, as /rosbag2_recorder is";
      });
}

void RecordingOptions::add_to(CLI::App& command) {
  const std::string kGroup = "Recording";
  CLI::Option* on = command.add_flag(
      "--record", is_on,
      "Keep the last seconds of the robot's topics, and write a recording (MCAP) of each incident "
      "(docs/recording.md)");
  add_seconds(command, "--record-before", before_seconds, "Start of a recording before the failure",
              0, kMostSeconds);
  add_seconds(command, "--record-after", after_seconds,
              "End of a recording after the recovery; after 5 min at the latest", 0, 300);
  command
      .add_option("--record-topics", topics,
                  "Topics to record, with * as wildcard, or ! to exclude (default: all; large ones "
                  "within --record-budget)")
      ->type_name("TOPIC")
      ->check([](const std::string& topic) {
        return topic.find_first_of(", ") == std::string::npos
                   ? std::string()
                   : "'" + topic + "' is no topic; give each topic by itself";
      });
  add_bytes(command, "--record-budget", memory,
            "Memory for recent messages; a quarter is for large ones", "200MB");
  add_bytes(command, "--record-disk", disk,
            "Disk space for all recordings; the oldest is deleted first", "5GB");
  command
      .add_option("--record-folder", folder,
                  "Folder for recordings (default: recordings in the state folder)")
      ->type_name("FOLDER")
      ->check(trouble_of_folder);
  add_snapshot(command, snapshot_of,
               "Request a snapshot from this recorder at each incident; the one of 'ros2 bag "
               "record --snapshot-mode' is /rosbag2_recorder (docs/recording.md)")
      ->group(kGroup);
  const auto in_range = [](const std::string& bytes) {
    std::size_t number = 0;
    const bool is_in =
        CLI::detail::lexical_cast(bytes, number) && number >= kLeastMemory && number <= kMostMemory;
    return is_in ? std::string() : bytes + " B is not from 1MB to 100GB; write a unit, as in 200MB";
  };
  command.get_option("--record-budget")->check(CLI::Validator(in_range, ""));
  for (CLI::Option* option : command.get_options()) {
    const std::string name = option->get_name();
    if (name.rfind("--record", 0) != 0) continue;
    option->group(kGroup);
    if (option != on) option->needs(on);
  }
}

Expected<std::unique_ptr<RunRecording>> RunRecording::open(const RecordingOptions& options,
                                                           const About& about) {
  if (!options.is_on) return std::unique_ptr<RunRecording>();
  recorder::IncidentRecorder::Options box;
  box.folder = options.folder_in(about.state);
  box.robot = about.robot;
  box.library = "culprit " + about.version;
  box.before = from_seconds(options.before_seconds);
  box.after = from_seconds(options.after_seconds);
  box.memory = options.memory;
  box.disk = options.disk;
  box.say = say_of_recording;
  recorder::RobotTap::Options tap;
  tap.participant = about.participant;
  tap.types = about.types;
  tap.topics = recorder::TopicChoice(options.topics);
  tap.before = box.before;
  tap.large_bytes = recorder::IncidentRecorder::large_share(box.memory);
  tap.say = say_of_recording;
  std::unique_ptr<RunRecording> run(new RunRecording(std::move(box)));
  auto opened = recorder::RobotTap::open(std::move(tap), run->recorder_);
  if (!opened) return Error{"the robot's topics cannot be recorded: " + opened.error()};
  run->tap_ = std::move(*opened);
  return run;
}

}  // namespace culprit::cli
