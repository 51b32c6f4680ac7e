// A robot as it was seen for some seconds: what findings are made of. Plain data, so that each kind
// of finding can be tested without a robot.
//
// Data of this machine only (processes, disks, shared memory) is missing for others.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/time.h"
#include "ros2/graph.h"
#include "ros2/messages.h"

namespace culprit::doctor {

// Since the look began.
using Offset = Duration;

struct Node {
  ros2::GraphNode node;
  std::vector<ros2::GraphEndpoint> endpoints{};
};

// A participant on DDS: one process, as a rule, with all of its nodes.
struct Participant {
  std::vector<std::string> nodes{};
  ros2::Vendor vendor = ros2::Vendor::kOther;
  std::string host{};  // empty: not said
  int pid = 0;         // on this machine; 0: not known
  bool is_secured = false;
  bool is_local = false;                // it listens on loopback addresses only
  std::optional<ros2::GidSize> form{};  // in which it says what its nodes are called
  std::size_t undiscovered = 0;  // endpoints that it says its nodes have, and that never came
  bool shares_memory = false;    // it takes messages through shared memory
  // Participants with the same take each other to be on one machine (Fast DDS: the beginning of their GUID).
  std::uint32_t host_number = 0;
};

// A node that did not answer a request in time, and whether its process has ended.
struct Unanswered {
  double seconds = 0;  // how long an answer was waited for
  bool has_ended = false;
};

// The state of a lifecycle node, asked twice. Labels as rcl has them; empty: it did not answer.
struct Lifecycle {
  std::string first{};
  std::string last{};
  Duration between{};
};

// A node came or left after it was known who is there.
struct Coming {
  Offset at{};
  bool is_there = false;
  bool was_lost = false;  // it left without a good-bye
  int pid = 0;
};

// How the messages of a topic came.
struct Flow {
  Duration listened{};
  std::size_t messages = 0;
  // Sent between two that came, and lost on the way, as the sequence numbers of each writer show.
  std::size_t lost = 0;
  Duration first_to_last{};
  std::vector<Duration> pauses{};  // between messages, the first of them; the last one is still on
  // The time stamps of its messages' headers; empty where the type has none, or all stamps are
  // zero.
  struct Stamps {
    std::size_t count = 0;
    // Sent (by the writer's clock) after the stamp: the middle, of the first of them.
    Duration lag{};
    // The same by the simulated clock at the arrival; empty without one.
    std::optional<Duration> simulated_lag{};
    std::size_t jumps_back = 0;  // of one writer and frame
    Duration furthest_back{};
  };
  std::optional<Stamps> stamps{};
  std::set<std::string> frames{};               // that they name
  std::optional<rtps::SystemTime> last_sent{};  // of the newest, also of what was sent before
};

// /clock.
struct SimulatedClock {
  std::size_t ticks = 0;
  Duration first{}, last{};  // that it showed
  std::size_t jumps_back = 0;
};

// From one frame to another, as one publisher says.
struct Transform {
  std::string parent, child;
  std::string node;    // that publishes it; empty: not known
  std::string writer;  // tells publishers apart
  bool is_static = false;
  std::size_t count = 0;
  Offset first{}, last{};  // when it was heard
  Duration lag{};          // of the newest, sent after its stamp
  bool operator==(const Transform&) const = default;
};

struct Status {
  ros2::msg::DiagnosticStatus report{};  // the last one
  std::size_t count = 0;
  Offset first{}, last{};  // when it was heard
};

// A process of this machine.
struct Process {
  std::string program{};  // "camera_driver", as the kernel shortens it
  rtps::SystemTime started{};
  Duration age_at_first{};  // at the first sample
  std::string launcher{};   // "process 9 (ros2)"; empty: nobody, or the first process
  // Its launcher has exited, and so has the reader of its output.
  bool is_left_over = false;
  struct Sample {
    Offset at{};
    Duration processor{};    // that it used so far
    std::int64_t bytes = 0;  // of memory
  };
  std::vector<Sample> samples{};
  // The least share of a core that one of its threads used from one sample to the next; nothing
  // if it was not looked at.
  std::optional<double> busiest_thread{};
  // The parameters on its command line, by node.
  std::map<std::string, std::map<std::string, std::string>> parameters{};
  unsigned user = 0;
  std::uint64_t shared_memory = 0;  // which one it sees; 0: not known
  // Ports of Fast DDS in shared memory, by the names of their files: those whose lock it holds, which it reads; and those
  // that it keeps open although there is another file of that name now.
  std::set<std::string> ports_read{}, ports_lost{};
};

struct Disk {
  std::string folder;               // one of those that are on it
  std::string used_for;             // "logs of /slam"
  std::int64_t size = 0, free = 0;  // bytes; free at the end
  std::int64_t taken = 0;           // while the doctor looked
};

// A domain other than the one looked at, that processes of this machine are on.
struct OtherDomain {
  std::uint32_t domain = 0;
  std::vector<std::string> programs{};
  // Those of them that were started by the same launcher as a node that was seen: the program, and
  // that node.
  std::map<std::string, std::string> siblings{};
};

struct Picture {
  std::uint32_t domain = 0;
  Duration looked{};
  // How long that thread of the doctor waited for a processor that waited longest (held_up.h).
  Duration waited{};
  std::vector<Node> nodes{};  // of one name, the newest
  // All nodes of a name that more than one has, in processes that are not known to have ended.
  std::map<std::string, std::vector<ros2::GraphNode>> namesakes{};
  std::vector<Participant> participants{};
  std::map<std::string, Unanswered> unanswered{};
  std::size_t asked = 0;  // nodes
  std::map<std::string, Lifecycle> lifecycles{};
  std::map<std::string, bool> uses_simulated_time{};
  // By node; values as YAML has them. Only of nodes that were asked.
  std::map<std::string, std::map<std::string, std::string>> parameters{};
  std::map<std::string, std::vector<Coming>> comings{};
  std::map<std::string, Status> statuses{};
  std::map<std::string, Flow> flows{};  // of topics that were listened to
  std::optional<SimulatedClock> clock{};
  std::vector<Transform> transforms{};
  Duration transforms_listened{};
  std::map<int, Process> processes{};
  std::int64_t free_memory = 0;  // bytes of this machine; 0: not known
  std::vector<Disk> disks{};
  std::vector<OtherDomain> other_domains{};
  // The parts that were not examined, in sentences.
  std::vector<std::string> left_out{};
};

}  // namespace culprit::doctor
