// How a recording went, topic by topic: arrivals, header stamps, values, transforms, diagnostics, logs and states.
//
//     const auto course = read_course("my_bag", library);
//     for (const TopicCourse& topic : course->topics) look_at(topic);
//
// One pass from the beginning to the end. Memory: 8 bytes a message, 16 with a header; messages themselves are not kept.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "bag_doctor/offered_qos.h"
#include "bag_doctor/robot_graph.h"
#include "base/expected.h"
#include "base/time.h"
#include "ros2/message_library.h"

namespace culprit::bag_doctor {

// Nanoseconds since 1970, as recorded but without jumps of the clock (bag::BagMessage::at).
using Nanoseconds = std::int64_t;

// Messages in a row of which a value did not change.
struct Run {
  Nanoseconds from = 0, to = 0;
  std::size_t messages = 0;
};

// One number of a topic's messages; or, with an empty path, all of their content behind the header.
struct FieldCourse {
  std::string path{};
  std::size_t count = 0;  // finite values
  double least = 0, most = 0;
  std::size_t changes = 0;  // from one message to the next
  Run longest{}, second{};  // without a change
  // NaN or infinite. `finite_before` the first of them, and the longest row of them.
  std::size_t not_finite = 0, finite_before = 0;
  Run longest_not_finite{};
};

struct TopicCourse {
  std::string name;
  std::string type;
  std::vector<std::string>
      other_types{};                // that messages of this name have, too; only their times count
  Nanoseconds other_type_from = 0;  // the first of them
  std::vector<Nanoseconds> times{};
  std::vector<Nanoseconds> stamps{};  // by message; empty: its messages have no header
  std::vector<FieldCourse> fields{};
  FieldCourse content{};      // of scans, clouds and images; else without a count
  std::size_t undecoded = 0;  // messages that do not fit their type
  Nanoseconds undecoded_from = 0, undecoded_to = 0;
  bool is_latched = false;  // all publishers offered transient local
};

// From one frame to another.
struct TransformCourse {
  std::string parent, child;
  bool is_static = false;
  std::vector<Nanoseconds> times{};
  std::vector<Nanoseconds> stamps{};
};

struct StatusCourse {
  struct Change {
    Nanoseconds at = 0;
    std::uint8_t level = 0;
    std::string message;
  };
  std::string name;
  std::vector<Change> changes{};  // of the level, the first report included
  Nanoseconds last = 0;
  std::size_t count = 0;
};

// A node's log messages on /rosout at ERROR or FATAL.
struct LogCourse {
  struct Line {
    Nanoseconds at = 0;
    std::uint8_t level = 0;
    std::string text;
  };
  std::vector<Line> first{};  // a few of them
  std::size_t errors = 0, fatals = 0;
  Nanoseconds last = 0;
};

struct Transition {
  Nanoseconds at = 0;
  std::string from, to;  // "active", "errorprocessing"
};

struct BagCourse {
  // The clock was set while it was recorded.
  struct Jump {
    Nanoseconds at = 0;
    Nanoseconds by = 0;  // negative: back
  };
  // The copy lacks messages there, which says nothing about the robot.
  struct Hole {
    Nanoseconds from = 0, to = 0;
  };
  std::string path;
  Nanoseconds begin = 0, end = 0;
  Nanoseconds begin_clock = 0;  // nanoseconds since 1970, as recorded
  std::uint64_t messages = 0;
  std::vector<TopicCourse> topics{};
  std::vector<TransformCourse> transforms{};
  std::map<std::string, StatusCourse> statuses{};
  std::map<std::string, LogCourse> logs{};                       // by logger: "arm.gripper"
  std::map<std::string, std::vector<Transition>> transitions{};  // by node
  std::set<std::string> nodes{};  // that show themselves: parameters, transitions, logs
  RobotGraph graph{};             // that was recorded; may be empty
  std::map<std::string, std::vector<OfferedQos>> offers{};  // by topic
  std::vector<Jump> jumps{};
  std::vector<Hole> holes{};
  std::vector<std::string> losses{};    // what could not be read
  std::vector<std::string> remarks{};   // files that are no part of it
  std::vector<std::string> left_out{};  // what was not looked at, in sentences
};

struct CourseLimits {
  std::size_t most_times = 64'000'000;  // arrivals that are kept, of all topics
  std::size_t most_fields = 24;         // numbers of a topic
};

// `library`: where types are found that the bag does not describe. Errors: it cannot be opened, or has no message.
Expected<BagCourse> read_course(const std::filesystem::path& bag, ros2::MessageLibrary& library,
                                const CourseLimits& limits = {});

}  // namespace culprit::bag_doctor
