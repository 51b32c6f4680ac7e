// The parts of a robot that rules can name, as they are at the moment. An adapter collects them,
// checks and editors compare them with the names in rule files.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/value.h"
#include "language/rule_set.h"

namespace culprit {

struct LiveInventory {
  struct Node {
    // By name; lists are texts (base/value_list.h), and unset ones have no value. Empty while the node has
    // not listed them.
    std::optional<std::map<std::string, std::optional<Value>>> parameters;
    std::string lifecycle;  // "active"; empty where it is not managed, or has not told
    int pid = 0;            // on this machine; 0: it is not proven which
    // The owner that runs it where the rules name none, and the clause to declare: "systemd as
    // lidar.service: UNIT lidar.service". Empty: the rules name it, or it is unknown.
    std::string owner{};
    bool operator==(const Node&) const = default;
  };
  struct Topic {
    std::string type;                  // "sensor_msgs/msg/Image"
    std::set<std::string> publishers;  // the nodes, by their full names
    // Only for topics that are watched.
    std::optional<double> rate;  // Hz
    std::map<std::string, Value> fields;
    std::map<std::string, std::string> unreadable;  // fields that it has not, with the reason
    bool is_published() const { return !publishers.empty(); }
    bool operator==(const Topic&) const = default;
  };
  // A diagnostic status.
  struct Status {
    std::string name;
    std::string hardware_id;
    std::uint8_t level = 0;  // 0 OK, 1 WARN, 2 ERROR, 3 STALE
    std::map<std::string, std::string> values;
    // Rules name a status by its name or its hardware id.
    bool is_called(const std::string& what) const { return name == what || hardware_id == what; }
    bool operator==(const Status&) const = default;
  };

  // All by their full names.
  std::map<std::string, Node> nodes;
  std::map<std::string, Topic> topics;
  std::map<std::string, std::string> services;  // with their types
  std::vector<Status> diagnostics;
  // The units of the rules that culprit could not start and end.
  struct UnitTrouble {
    SystemdUnit unit;
    std::string why;
    bool operator==(const UnitTrouble&) const = default;
  };
  std::vector<UnitTrouble> unit_troubles{};
  // Likewise its containers.
  struct ContainerTrouble {
    EngineContainer container;
    std::string why;
    bool operator==(const ContainerTrouble&) const = default;
  };
  std::vector<ContainerTrouble> container_troubles{};
  // The same for the computers that they are on.
  struct HostTrouble {
    std::string host;
    std::string why;
    bool operator==(const HostTrouble&) const = default;
  };
  std::vector<HostTrouble> host_troubles{};
  // A call in the rules that does not fit the services on the robot.
  struct RequestTrouble {
    std::string service;  // by its full name
    std::string request;
    std::string why;
    bool operator==(const RequestTrouble&) const = default;
  };
  std::vector<RequestTrouble> request_troubles{};
  // A clause of the rules that could not be started: launch commands, and classes of containers.
  struct LaunchTrouble {
    // kRunning: it could be started, and would then run otherwise than it does now.
    enum class Clause : std::uint8_t { kLaunch, kSetup, kFolder, kPlugin, kParameters, kRunning };
    std::string component;
    Clause clause = Clause::kLaunch;
    std::string text;  // of the clause: the program, the file, the folder, the class
    std::string why;
    bool operator==(const LaunchTrouble&) const = default;
  };
  std::vector<LaunchTrouble> launch_troubles{};
  bool operator==(const LiveInventory&) const = default;

  // Whether anybody is there but tools, whose nodes are hidden, and culprit.
  bool has_robot() const;
  // The full name of the component's node, empty if it is not there: the NODE that it is declared
  // with, or else the first one whose own name is the component's.
  std::string node_of(const Component& component) const;
  // The present value of a signal. Empty if there is none to read, or the signal is not watched.
  std::optional<Value> value_of(const Signal& signal, const RuleSet& rules) const;
  std::optional<Value> value_of_parameter(const std::string& node,
                                          const std::string& parameter) const;
};

// The parts of a robot that are of interest: reading more would disturb it for nothing.
struct LiveInterest {
  std::set<std::string> nodes;  // whose parameters and state are read; by full or own name
  std::map<std::string, std::set<std::string>> fields_of_topics;  // watched, also without a field
  bool operator==(const LiveInterest&) const = default;

  bool includes_node(const std::string& full_name) const;
};

// The interest in all parts that the rules name.
LiveInterest interest_of(const RuleSet& rules);

}  // namespace culprit
