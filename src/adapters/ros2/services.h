// The service types that this link itself speaks, as pairs of messages.
//
// An empty struct is an empty message; cdr.h gives it the dummy byte that ROS wants.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ros2/messages.h"

namespace culprit::ros2::srv {

struct GetState {
  static constexpr std::string_view kType = "lifecycle_msgs/srv/GetState";
  struct Request {};
  struct Response {
    msg::State current_state;
    static void visit(auto& self, auto& each) { each(self.current_state); }
  };
};

struct ChangeState {
  static constexpr std::string_view kType = "lifecycle_msgs/srv/ChangeState";
  struct Request {
    msg::Transition transition;  // a label wins over the id
    static void visit(auto& self, auto& each) { each(self.transition); }
  };
  struct Response {
    bool success = false;
    static void visit(auto& self, auto& each) { each(self.success); }
  };
};

struct GetAvailableStates {
  static constexpr std::string_view kType = "lifecycle_msgs/srv/GetAvailableStates";
  struct Request {};
  struct Response {
    std::vector<msg::State> available_states;
    static void visit(auto& self, auto& each) { each(self.available_states); }
  };
};

struct GetAvailableTransitions {
  static constexpr std::string_view kType = "lifecycle_msgs/srv/GetAvailableTransitions";
  struct Request {};
  struct Response {
    std::vector<msg::TransitionDescription> available_transitions;
    static void visit(auto& self, auto& each) { each(self.available_transitions); }
  };
};

// A request with any undeclared name is answered with an empty list (rclcpp, Humble).
struct GetParameters {
  static constexpr std::string_view kType = "rcl_interfaces/srv/GetParameters";
  struct Request {
    std::vector<std::string> names;
    static void visit(auto& self, auto& each) { each(self.names); }
  };
  struct Response {
    std::vector<msg::ParameterValue> values;
    static void visit(auto& self, auto& each) { each(self.values); }
  };
};

struct GetParameterTypes {
  static constexpr std::string_view kType = "rcl_interfaces/srv/GetParameterTypes";
  struct Request {
    std::vector<std::string> names;
    static void visit(auto& self, auto& each) { each(self.names); }
  };
  struct Response {
    std::vector<std::uint8_t> types;
    static void visit(auto& self, auto& each) { each(self.types); }
  };
};

struct SetParameters {
  static constexpr std::string_view kType = "rcl_interfaces/srv/SetParameters";
  struct Request {
    std::vector<msg::Parameter> parameters;
    static void visit(auto& self, auto& each) { each(self.parameters); }
  };
  struct Response {
    std::vector<msg::SetParametersResult> results;
    static void visit(auto& self, auto& each) { each(self.results); }
  };
};

struct SetParametersAtomically {
  static constexpr std::string_view kType = "rcl_interfaces/srv/SetParametersAtomically";
  struct Request {
    std::vector<msg::Parameter> parameters;
    static void visit(auto& self, auto& each) { each(self.parameters); }
  };
  struct Response {
    msg::SetParametersResult result;
    static void visit(auto& self, auto& each) { each(self.result); }
  };
};

struct ListParameters {
  static constexpr std::string_view kType = "rcl_interfaces/srv/ListParameters";
  struct Request {
    std::vector<std::string> prefixes;
    std::uint64_t depth = 0;  // 0: all levels
    static void visit(auto& self, auto& each) { each(self.prefixes, self.depth); }
  };
  struct Response {
    std::vector<std::string> names;
    std::vector<std::string> prefixes;
    static void visit(auto& self, auto& each) { each(self.names, self.prefixes); }
  };
};

struct DescribeParameters {
  static constexpr std::string_view kType = "rcl_interfaces/srv/DescribeParameters";
  struct Request {
    std::vector<std::string> names;
    static void visit(auto& self, auto& each) { each(self.names); }
  };
  struct Response {
    std::vector<msg::ParameterDescriptor> descriptors;
    static void visit(auto& self, auto& each) { each(self.descriptors); }
  };
};

struct Trigger {
  static constexpr std::string_view kType = "std_srvs/srv/Trigger";
  struct Request {};
  struct Response {
    bool success = false;
    std::string message;
    static void visit(auto& self, auto& each) { each(self.success, self.message); }
  };
};

struct SetBool {
  static constexpr std::string_view kType = "std_srvs/srv/SetBool";
  struct Request {
    bool data = false;
    static void visit(auto& self, auto& each) { each(self.data); }
  };
  struct Response {
    bool success = false;
    std::string message;
    static void visit(auto& self, auto& each) { each(self.success, self.message); }
  };
};

// A recorder with `ros2 bag record --snapshot-mode`, at ~/snapshot (Humble and newer).
struct Snapshot {
  static constexpr std::string_view kType = "rosbag2_interfaces/srv/Snapshot";
  struct Request {};
  struct Response {
    bool success = false;
    static void visit(auto& self, auto& each) { each(self.success); }
  };
};

// A component container (rclcpp_components). Answered once the node has been made.
struct LoadNode {
  static constexpr std::string_view kType = "composition_interfaces/srv/LoadNode";
  struct Request {
    std::string package_name;
    std::string plugin_name;
    std::string node_name;       // empty: what the class calls itself
    std::string node_namespace;  // likewise
    std::uint8_t log_level = 0;  // 0: as the container's
    std::vector<std::string> remap_rules;
    std::vector<msg::Parameter> parameters;
    std::vector<msg::Parameter> extra_arguments;
    static void visit(auto& self, auto& each) {
      each(self.package_name, self.plugin_name, self.node_name, self.node_namespace, self.log_level,
           self.remap_rules, self.parameters, self.extra_arguments);
    }
  };
  struct Response {
    bool success = false;
    std::string error_message;
    std::string full_node_name;
    std::uint64_t unique_id = 0;
    static void visit(auto& self, auto& each) {
      each(self.success, self.error_message, self.full_node_name, self.unique_id);
    }
  };
};

struct UnloadNode {
  static constexpr std::string_view kType = "composition_interfaces/srv/UnloadNode";
  struct Request {
    std::uint64_t unique_id = 0;
    static void visit(auto& self, auto& each) { each(self.unique_id); }
  };
  struct Response {
    bool success = false;
    std::string error_message;
    static void visit(auto& self, auto& each) { each(self.success, self.error_message); }
  };
};

struct ListNodes {
  static constexpr std::string_view kType = "composition_interfaces/srv/ListNodes";
  struct Request {};
  struct Response {
    std::vector<std::string> full_node_names;
    std::vector<std::uint64_t> unique_ids;  // as many
    static void visit(auto& self, auto& each) { each(self.full_node_names, self.unique_ids); }
  };
};

// system_modes: success means accepted, not done.
struct ChangeMode {
  static constexpr std::string_view kType = "system_modes_msgs/srv/ChangeMode";
  struct Request {
    std::string mode_name;
    static void visit(auto& self, auto& each) { each(self.mode_name); }
  };
  struct Response {
    bool success = false;
    static void visit(auto& self, auto& each) { each(self.success); }
  };
};

struct GetMode {
  static constexpr std::string_view kType = "system_modes_msgs/srv/GetMode";
  struct Request {};
  struct Response {
    std::string current_mode;
    static void visit(auto& self, auto& each) { each(self.current_mode); }
  };
};

// Jazzy and newer: ~/get_type_description of each node, for the types that it uses.
struct GetTypeDescription {
  static constexpr std::string_view kType = "type_description_interfaces/srv/GetTypeDescription";
  struct Request {
    std::string type_name;
    std::string type_hash;
    bool include_type_sources = false;
    static void visit(auto& self, auto& each) {
      each(self.type_name, self.type_hash, self.include_type_sources);
    }
  };
  struct Response {
    bool successful = false;
    std::string failure_reason;
    msg::TypeDescription type_description;
    std::vector<msg::TypeSource> type_sources;
    std::vector<msg::TypeDetail> extra_information;
    static void visit(auto& self, auto& each) {
      each(self.successful, self.failure_reason, self.type_description, self.type_sources,
           self.extra_information);
    }
  };
};

}  // namespace culprit::ros2::srv
