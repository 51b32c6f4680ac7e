// The helper program that speaks a robot's middleware for us (docs/link-protocol.md), and how it is started.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace culprit::ros2 {

struct HelperOptions {
  std::vector<std::string>
      command;  // a program's path, and arguments; the socket's number is added
  std::vector<std::string> environment;  // "NAME=value", all that it gets
  // The node that it makes.
  std::string name_space = "/";
  std::string name = "culprit_onlooker";
  // Receives remarks for people. May be empty; called on any thread.
  std::function<void(std::string)> on_trouble{};
};

}  // namespace culprit::ros2
