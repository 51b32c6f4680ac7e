// A robot as it was while it was healthy, to compare with later: which nodes there were, with what
// they offer and use, their parameters and states, how often their topics came, which transforms and
// which diagnostics there were.
//
//     culprit doctor --save healthy.json
//     culprit doctor --against healthy.json
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>

#include "base/expected.h"
#include "doctor/examine.h"
#include "doctor/picture.h"

namespace culprit::doctor {

struct Baseline {
  struct Wire {
    std::string type;
    std::string qos;  // in words
    bool operator==(const Wire&) const = default;
  };
  struct Node {
    std::map<std::string, Wire> publishes, subscribes, serves;
    std::map<std::string, std::string> parameters;  // as YAML has them
    std::string lifecycle;                          // empty: it is not managed, or did not answer
    std::int64_t memory = 0;                        // bytes of its process; 0: not known
    bool operator==(const Node&) const = default;
  };
  struct Rate {
    std::size_t messages = 0;
    double seconds = 0;   // from the first to the last of them
    double listened = 0;  // seconds
    bool operator==(const Rate&) const = default;
  };
  std::map<std::string, Node> nodes;
  std::map<std::string, Rate> topics;
  std::set<std::pair<std::string, std::string>> transforms;  // parent and child
  std::set<std::string> statuses;
  bool operator==(const Baseline&) const = default;
};

// The baseline of a picture that was taken with Extent::kEverything. Tools are no part of the
// robot.
Baseline baseline_of(const Picture& picture);

// D100 to D109: parts of `now` that are missing, new, slower or different.
Findings compare(const Baseline& healthy, const Baseline& now);

// As a JSON file, and back. Errors say where and why `text` is none.
std::string to_text(const Baseline& baseline);
Expected<Baseline> parse_baseline(const std::string& text);

}  // namespace culprit::doctor
