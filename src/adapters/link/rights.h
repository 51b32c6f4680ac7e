// The rights of culprit on a secured domain (SROS2): those that a rule file needs, and no more.
//
// rights_of() gives them in names of ROS 2. It is written as a policy of SROS2, whose tools make
// permissions of it and sign them, or as the permissions themselves, which openssl signs. All
// endpoints that link.h, component_link.h, node.h and ros_api.h create must be among the rights; a
// test runs them so.
//
// Sources: sros2's policy.xsd (version 0.2.0); DDS Security 1.1, 9.4.1.3 (permissions); names.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "language/rule_set.h"
#include "ros2/names.h"

namespace culprit::link {

// Each ascending, without duplicates. A `*` stands for any text, slashes included: where the rules
// name a node without its namespace.
struct Rights {
  std::vector<std::string> publishes;   // topics
  std::vector<std::string> subscribes;  // topics
  std::vector<std::string> offers;      // services
  std::vector<std::string> calls;       // services
};

// The rights of the node `self` with these rules.
Rights rights_of(const RuleSet& rules, const ros2::NodeName& self);

// `enclave` is the one that culprit's keys are of: "/culprit".
// @pre is_valid_topic_name(enclave)
std::string sros2_policy(const Rights& rights, const ros2::NodeName& self,
                         const std::string& enclave);

struct Validity {
  std::string from;  // "2026-01-31T00:00:00", UTC
  std::string to;
};
// Not signed. @pre is_valid_topic_name(enclave)
std::string permissions(const Rights& rights, const std::string& enclave, std::uint32_t domain,
                        const Validity& validity);

}  // namespace culprit::link
