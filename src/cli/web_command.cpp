#include <fmt/core.h>

#include "base/environment.h"
#include "cli/commands.h"
#include "live/robot_names.h"
#include "terminal/console.h"
#include "terminal/web_service.h"
#include "web/calls.h"
#include "web/study_runner.h"

namespace culprit::cli {
namespace {

struct WebCommandOptions {
  std::string rules;
  bool robot = false;
  WebOptions web;
};

int edit(const WebCommandOptions& options) {
  web::RuleDesk desk(options.rules);
  if (const auto readable = desk.read(); !readable) {
    fmt::print(stderr, "culprit: {}\n", readable.error());
    return kFailed;
  }
  StopSignals signals;
  web::StudyRunner studies(default_state_folder() / "studies");
  std::vector<http::Route> routes = web::rule_routes(desk);
  for (http::Route& route : web::study_routes(studies.studies()))
    routes.push_back(std::move(route));
  routes.push_back(web::single_run_route());
  routes.push_back(web::hindsight_route(web::usual_journal));
  live::RobotNames names;
  if (options.robot) {
    for (http::Route& route :
         web::name_routes([&names](const LiveInterest& interest) { return names.look(interest); },
                          desk.loader()))
      routes.push_back(std::move(route));
    for (http::Route& route : web::doctor_routes(web::examine_robot))
      routes.push_back(std::move(route));
  }
  const auto server = serve(options.web, std::move(routes), nullptr);
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
      "web",
      "Write rules in a browser, as text or in a form, checked as you type; and run studies");
  command->add_option("RULES", options->rules, "The rule file, which may be new")
      ->type_name("FILE")
      ->required();
  command->add_flag("--robot", options->robot,
                    "Offer the live robot's nodes, topics, parameters and services");
  options->web.add_to(*command);
  command->callback([options, &exit_code] { exit_code = edit(*options); });
}

}  // namespace culprit::cli
