#include <fmt/core.h>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/web_service.h"
#include "web/rule_routes.h"

namespace culprit::cli {
namespace {

struct WebCommandOptions {
  std::string rules;
  WebOptions web;
};

int edit(const WebCommandOptions& options) {
  web::RuleDesk desk(options.rules);
  if (const auto readable = desk.read(); !readable) {
    fmt::print(stderr, "culprit: {}\n", readable.error());
    return kFailed;
  }
  StopSignals signals;
  const auto server = serve(options.web, web::rule_routes(desk), nullptr);
  if (!server) {
    fmt::print(stderr, "culprit: {}\n", server.error());
    return kFailed;
  }
  signals.wait_until_stopped();
  return kOk;
}

}  // namespace

void add_web(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<WebCommandOptions>();
  CLI::App* command = app.add_subcommand(
      "web", "Write rules in a browser: as text or in a form, checked as you type");
  command->add_option("RULES", options->rules, "The rule file, which may be new")->required();
  options->web.add_to(*command);
  command->callback([options, &exit_code] { exit_code = edit(*options); });
}

}  // namespace culprit::cli
