// The Model Context Protocol (revision 2025-06-18): an assistant asks a running culprit, and may put a
// strategy before a person. It does no I/O of its own.
//
//     {"jsonrpc":"2.0","id":2,"method":"tools/call","params":{"name":"status","arguments":{}}}
//
// No tool changes the robot. `propose` asks a person (culprit run --approve); that person decides.
// Answers consist of culprit's own JSON. Control characters and marks of direction in it are escaped, and
// each answer says that its text is data: names and messages come from the robot.
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/expected.h"
#include "json/json.h"

namespace culprit::mcp {

class McpServer {
 public:
  // How a command of culprit ended.
  struct Ran {
    int status = 0;
    std::string out;
    std::string err;
  };
  // Runs culprit with these words. Errors: it did not end in time, or printed too much.
  using Run = std::function<Expected<Ran>(const std::vector<std::string>& words)>;
  // The JSON report of culprit check on a text.
  using Check = std::function<Json(const std::string& text)>;

  struct Options {
    std::string version;
    std::string rules{};              // the rule file for `plan`; empty: `plan` is refused
    std::set<std::string> allowed{};  // names of tools; see all_tools()
  };

  McpServer(Options options, Run run, Check check)
      : options_(std::move(options)), run_(std::move(run)), check_(std::move(check)) {}

  // The names of all tools, and of those that are allowed unless the user lists others.
  static std::vector<std::string> all_tools();
  static std::set<std::string> reading_tools();

  // The answer to a message of the client, of any content; empty where it gets none.
  std::optional<Json> handle(const Json& message);

 private:
  // An object with the member "result" or the member "error".
  Json answer(const std::string& method, const Json& params);
  Json initialize(const Json& params);
  Json list(const Json& params) const;
  Json call(const Json& params) const;
  Json run(const std::string& tool, const std::vector<std::string>& words) const;

  const Options options_;
  const Run run_;
  const Check check_;
  bool is_initialized_ = false;
};

}  // namespace culprit::mcp
