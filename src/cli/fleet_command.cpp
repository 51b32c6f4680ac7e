// culprit fleet: sets the database of a fleet up, and shows what is in it.
#ifdef CULPRIT_FLEET
#include <atomic>
#include <memory>

#include <fmt/core.h>

#include "base/live_clock.h"
#include "base/text_file.h"
#include "cli/commands.h"
#include "fleet/schema.h"
#include "fleet_reports/reports.h"

namespace culprit::cli {
namespace {

struct FleetCommand {
  std::string address;
  int keep_days = fleet::Setup().keep_days;
  fleet_reports::Scope scope;
  bool as_json = false;
  bool as_sql = false;
  std::string html;
};

// The only way to interrupt a command is to end it.
const std::atomic<bool> kGoesOn = false;

Expected<fleet::Postgres> connect(const FleetCommand& options) {
  const auto address = fleet::address_from(options.address);
  if (!address) return Error{address.error()};
  auto server = fleet::Postgres::connect(*address, kGoesOn);
  if (!server) return Error{"the fleet's database cannot be used: " + server.error()};
  return server;
}

int init(const FleetCommand& options) {
  auto server = connect(options);
  if (!server) return fail(server.error());
  const auto done = fleet::set_up(*server, {options.keep_days});
  if (!done) return fail("nothing was changed: " + done.error());
  for (const std::string& each : *done) fmt::print("{}\n", each);
  if (done->empty()) fmt::print("nothing had to be done\n");
  fmt::print(
      "a login for a robot:   CREATE ROLE rover7 LOGIN IN ROLE culprit_robot;\n"
      "a login for a person:  CREATE ROLE ada LOGIN IN ROLE culprit_reader;\n");
  return kOk;
}

int show(const fleet_reports::Report& report, const FleetCommand& options) {
  const double now = static_cast<double>(wall_now()) / 1e9;
  if (!options.html.empty()) {
    const auto written = write_text(options.html, fleet_reports::to_html(report, now));
    return written ? kOk : fail(written.error());
  }
  fmt::print("{}", options.as_json ? fleet_reports::to_json_text(report)
                                   : fleet_reports::to_text(report, now));
  return kOk;
}

using Queries = std::vector<fleet_reports::TableQuery> (*)(const fleet_reports::Scope& scope);

struct Kind {
  const char* name;
  const char* help;
  Queries queries;
  bool compares = false;
};

int report(const Kind& kind, const FleetCommand& options) {
  if (options.as_sql) {
    fmt::print("{}", fleet_reports::sql_of(kind.queries(options.scope)));
    return kOk;
  }
  auto server = connect(options);
  if (!server) return fail(server.error());
  if (const auto fits = fleet::check_schema(*server); !fits)
    return fail("the fleet's database cannot be used: " + fits.error());
  const auto made = kind.compares
                        ? fleet_reports::compare(*server, options.scope)
                        : fleet_reports::make_report(*server, std::string("Fleet: ") + kind.name,
                                                     kind.queries(options.scope));
  if (!made) return fail(made.error());
  return show(*made, options);
}

constexpr Kind kKinds[] = {
    {"status", "Failed and unreachable robots, and the state of the models",
     fleet_reports::status_queries},
    {"incidents", "The latest incidents, the worst rules and components, and times to repair",
     fleet_reports::incident_queries},
    {"beliefs", "The outcomes of each strategy on all robots", fleet_reports::belief_queries},
    {"compare", "Robots that differ from the others, and a comparison of versions",
     fleet_reports::version_queries, true}};

void add_address(CLI::App& command, FleetCommand& options) {
  command
      .add_option("ADDRESS", options.address,
                  "The database: postgresql://HOST/DATABASE, or service=NAME; without a password")
      ->required();
}

void add_report(CLI::App& fleet, const Kind& kind, int& exit_code) {
  auto options = std::make_shared<FleetCommand>();
  CLI::App* command = fleet.add_subcommand(kind.name, kind.help);
  add_address(*command, *options);
  command->add_option("--model", options->scope.model, "Only robots of this model");
  command->add_option("--robot", options->scope.robot, "Only the robot of this name");
  command->add_option("--days", options->scope.days, "Number of past days")
      ->check(CLI::Range(1, 3650))
      ->capture_default_str();
  auto* json = command->add_flag("--json", options->as_json, "Print the result as a JSON document");
  auto* html = command->add_option("--html", options->html, "Write the tables to this HTML file")
                   ->type_name("FILE");
  auto* sql = command->add_flag("--sql", options->as_sql, "Print the queries that make the tables");
  json->excludes(html)->excludes(sql);
  html->excludes(sql);
  command->callback([options, &kind, &exit_code] { exit_code = report(kind, *options); });
}

}  // namespace

void add_fleet(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("fleet", "Data that the robots of a fleet share in a PostgreSQL database");
  command->require_subcommand(1);
  auto options = std::make_shared<FleetCommand>();
  CLI::App* set_up =
      command->add_subcommand("init", "Set up the database, or update it, and report the changes");
  add_address(*set_up, *options);
  set_up->add_option("--keep", options->keep_days, "Days that failures are kept")
      ->check(CLI::Range(1, 36500))
      ->capture_default_str();
  set_up->callback([options, &exit_code] { exit_code = init(*options); });
  for (const Kind& kind : kKinds) add_report(*command, kind, exit_code);
}

}  // namespace culprit::cli
#endif
