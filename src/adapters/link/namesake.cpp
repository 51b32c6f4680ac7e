#include "link/namesake.h"

#include <utility>

#include "base/name_grammar.h"

namespace culprit::link {

void Namesake::joined(const ros2::GraphNode& node, Time now) {
  text_ = "another node is called " + node.name + ", too" +
          (node.host.empty() ? "" : ", on " + printable(node.host)) +
          ": a request to one of them may reach the other; start one culprit with --node-name";
  since_ = now;
}

std::optional<std::string> Namesake::due(Time now) {
  if (!text_ || now < later(since_, kLeaves) || std::exchange(is_told_, true)) return std::nullopt;
  return text_;
}

}  // namespace culprit::link
