#include <iostream>
#include <poll.h>
#include <unistd.h>

#include <fmt/core.h>

#include "cli/commands.h"
#include "inbox/inbox.h"
#include "live/robot_survey.h"
#include "lsp/language_server.h"
#include "lsp/message_stream.h"
#include "rule_files/rule_files.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;

// How long the robot's graph takes until it can be called incomplete, and how often it is looked at
// from there on.
constexpr Duration kDiscovery = 3s;
constexpr Duration kRefresh = 500ms;

struct LspOptions {
  bool robot = false;
  std::vector<std::filesystem::path> message_path;
};

// Whether the client has sent something by then, or has gone.
bool input_by(Time end) {
  if (std::cin.rdbuf()->in_avail() > 0) return true;
  pollfd input{STDIN_FILENO, POLLIN, 0};
  const Duration left = std::max(end - live_now(), Duration::zero());
  const auto wait = std::chrono::ceil<std::chrono::milliseconds>(left).count();
  return poll(&input, 1, static_cast<int>(wait)) > 0;
}

// Shows the server what the robot has, between two messages: the survey has threads of its own, the
// server needs none.
class Watch {
 public:
  Watch(lsp::LanguageServer& server, link::Survey& survey)
      : server_(server), survey_(survey), next_(live_now() + kDiscovery) {}

  // Returns when the client has sent something.
  void wait_for_input() {
    do {
      ask();
      if (live_now() < next_) continue;
      server_.see(survey_.inventory());
      next_ = live_now() + kRefresh;
    } while (!input_by(next_));
  }

 private:
  void ask() {
    LiveInterest interest = server_.interest();
    if (interest == asked_) return;
    survey_.ask_for(interest);
    asked_ = std::move(interest);
  }

  lsp::LanguageServer& server_;
  link::Survey& survey_;
  Time next_;
  LiveInterest asked_;
};

int serve(const std::string& version, const LspOptions& options) {
  std::ios::sync_with_stdio(false);  // so that std::cin tells what it holds already
  const auto load = [](const std::string& file, const std::string& from) -> Expected<Source> {
    if (from.empty()) return Error{"save this file first: others are found beside it"};
    return rule_files::load(file, from);
  };
  lsp::LanguageServer server(version,
                             [](const Json& message) { lsp::write_message(std::cout, message); },
                             {load, rule_files::includable});
  std::unique_ptr<link::Survey> survey;
  std::optional<Watch> watch;
  if (options.robot) {
    auto opened = live::open_survey(options.message_path);
    if (!opened) {
      fmt::print(stderr, "culprit: {}\n", opened.error());
      return kFailed;
    }
    survey = std::move(*opened);
    watch.emplace(server, *survey);
  }
  while (true) {
    if (watch) watch->wait_for_input();
    const auto message = lsp::read_message(std::cin);
    if (!message) {
      fmt::print(stderr, "culprit: the client sent {}\n", message.error());
      return kFailed;
    }
    if (!*message || !server.handle(**message)) return server.exit_code();
  }
}

}  // namespace

void add_lsp(CLI::App& app, const std::string& version, int& exit_code) {
  auto options = std::make_shared<LspOptions>();
  CLI::App* command = app.add_subcommand(
      "lsp", "Serve an editor: the Language Server Protocol on standard input and output");
  command->add_flag_function(
      "--stdio", [](std::int64_t) {}, "For editors that give it: culprit lsp always uses these");
  command->add_flag("--robot", options->robot,
                    "Also show the live robot's names and values, and names that it lacks");
  command
      ->add_option("--message-path", options->message_path,
                   "Folders with .msg files: <folder>/<package>/msg/<Type>.msg")
      ->type_name("FOLDER");
  command->callback([version, options, &exit_code] { exit_code = serve(version, *options); });
}

}  // namespace culprit::cli
