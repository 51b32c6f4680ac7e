// The black box of `culprit run --record` (docs/recording.md).
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "live/black_box.h"
#include "recorder/robot_tap.h"
#include "terminal/console.h"

namespace culprit::cli {

// --snapshot NODE: the recorder that is asked for snapshots (live/snapshots.h). `node` must live as long as `command`.
CLI::Option* add_snapshot(CLI::App& command, std::string& node, const std::string& what);

struct RecordingOptions {
  bool is_on = false;
  double before_seconds = seconds(recorder::IncidentRecorder::Options().before);
  double after_seconds = seconds(recorder::IncidentRecorder::Options().after);
  std::vector<std::string> topics;                                      // patterns; empty: all
  std::uint64_t memory = recorder::IncidentRecorder::Options().memory;  // bytes
  std::uint64_t disk = recorder::IncidentRecorder::Options().disk;      // bytes
  std::string folder;       // empty: in the state folder
  std::string snapshot_of;  // a recorder's node, absolute; empty: nobody is asked for snapshots

  std::filesystem::path folder_in(const std::filesystem::path& state) const {
    return folder.empty() ? state / "recordings" : std::filesystem::path(folder);
  }
  // --record and what begins with it, and --snapshot. The options must live as long as `command`.
  void add_to(CLI::App& command);
};

// Reports remarks on the recording, from any thread.
void say_of_recording(const std::string& text);

class RunRecording {
 public:
  struct About {
    std::string version;
    std::string robot;
    std::filesystem::path state;  // the folder
    ros2::ParticipantOptions participant;
    link::TypeFinder::Options types;
  };
  // Null if it is not on. Errors: the domain cannot be joined.
  static Expected<std::unique_ptr<RunRecording>> open(const RecordingOptions& options,
                                                      const About& about);

  live::Observer& observer() { return observer_; }
  recorder::IncidentRecorder& recorder() { return recorder_; }

 private:
  explicit RunRecording(recorder::IncidentRecorder::Options options)
      : recorder_(std::move(options)), observer_(recorder_) {}

  recorder::IncidentRecorder recorder_;
  live::BlackBox observer_;
  std::unique_ptr<recorder::RobotTap> tap_;  // last: it fills the recorder
};

}  // namespace culprit::cli
