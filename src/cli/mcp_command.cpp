#include <iostream>
#include <set>

#include "cli/commands.h"
#include "cli/diagnostic_report.h"
#include "language/checker.h"
#include "language/reuse/expansion.h"
#include "mcp/mcp_server.h"
#include "owners/piped_program.h"
#include "owners/spawn.h"
#include "terminal/console.h"

namespace culprit::cli {
namespace {

// A doctor looks for 8 s and asks for some more.
constexpr Duration kLimit = std::chrono::seconds(60);
constexpr std::size_t kLongestLine = std::size_t{1} << 20;  // bytes

struct McpOptions {
  std::string rules;
  std::vector<std::string> allowed;
};

// culprit itself, as the command that a person would type: the same answer, and a crash or a hang of it
// ends nothing here.
Expected<mcp::McpServer::Ran> run_culprit(const std::vector<std::string>& words) {
  std::vector<std::string> command{"/proc/self/exe"};
  command.insert(command.end(), words.begin(), words.end());
  auto ran = owners::run_piped(std::move(command), owners::environment_with({}), kLimit);
  if (!ran) return Error{ran.error()};
  using End = owners::PipedRun::End;
  if (ran->end == End::kTime) return Error{"it did not end within a minute"};
  if (ran->end == End::kTooMuch) return Error{"its answer is longer than 1 MiB"};
  return mcp::McpServer::Ran{ran->status, std::move(ran->out), std::move(ran->err)};
}

Json check_text(const std::string& text) {
  const Expansion file = expand(Source("text", text));  // without files to INCLUDE
  std::vector<CheckedFile> files;
  files.push_back({file.source, check(file).diagnostics});
  return json_report(files);
}

// The next line without its end; empty at the end of the input. A line that is too long is
// skipped up to its end and comes as "", which is no JSON.
std::optional<std::string> next_line(std::istream& in) {
  std::string line;
  bool is_too_long = false;
  for (int c = in.get();; c = in.get()) {
    if (c == std::istream::traits_type::eof()) {
      if (line.empty() && !is_too_long) return std::nullopt;
      return is_too_long ? "" : line;
    }
    if (c == '\n') return is_too_long ? "" : line;
    is_too_long |= line.size() >= kLongestLine;
    if (!is_too_long) line += static_cast<char>(c);
  }
}

int serve(const std::string& version, const McpOptions& options) {
  std::set<std::string> allowed(options.allowed.begin(), options.allowed.end());
  if (allowed.empty()) allowed = mcp::McpServer::reading_tools();
  mcp::McpServer server({version, options.rules, std::move(allowed)}, run_culprit, check_text);
  while (const auto line = next_line(std::cin)) {
    if (line->find_first_not_of(" \t\r") == std::string::npos && !line->empty()) continue;
    const auto answer = server.handle(parse_strict_json(*line));
    if (answer) std::cout << to_line(*answer) << '\n' << std::flush;
    if (!std::cout) return kFailed;
  }
  return kOk;
}

}  // namespace

void add_mcp(CLI::App& app, const std::string& version, int& exit_code) {
  auto options = std::make_shared<McpOptions>();
  CLI::App* command = app.add_subcommand(
      "mcp",
      "Serve an assistant: the Model Context Protocol on standard input and output.\nIts tools "
      "read; "
      "propose, if allowed, puts a strategy before a person and never acts by itself");
  command->add_option("--rules", options->rules, "The rule file for the tool plan")
      ->type_name("FILE")
      ->check(CLI::ExistingFile);
  command
      ->add_option("--allow", options->allowed,
                   "Allowed tools (default: all that only read: not propose)")
      ->delimiter(',')
      ->check(CLI::IsMember(mcp::McpServer::all_tools()));
  command->callback([version, options, &exit_code] { exit_code = serve(version, *options); });
}

}  // namespace culprit::cli
