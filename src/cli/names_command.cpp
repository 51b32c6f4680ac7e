// The names that a shell completes: of the components, rules and strategies of the culprits that run here.
#include <algorithm>
#include <memory>

#include "base/name_grammar.h"
#include "cli/commands.h"
#include "cli/running_culprit.h"
#include "terminal/console.h"

namespace culprit::cli {
namespace {

struct NamesOptions {
  std::string kind;
  WhichCulprit which;
};

void collect_names(const Json& robot, const std::string& kind, std::vector<std::string>& names) {
  const auto add_all = [&](const char* list) {
    for (const Json& each : robot.value(list, Json::array()))
      names.push_back(web::text_of(each, "name").value_or(""));
  };
  if (kind != "strategies") add_all("components");
  if (kind == "names") add_all("rules");
  if (kind != "strategies") return;
  for (const Json& rule : robot.value("rules", Json::array())) {
    for (const Json& strategy : rule.value("strategies", Json::array()))
      names.push_back(web::text_of(rule, "name").value_or("") + "." +
                      web::text_of(strategy, "name").value_or(""));
  }
}

int print_names(const NamesOptions& options) {
  const auto here = culprits_here(options.which);
  if (!here) return kFailed;  // nobody reads a message
  std::vector<std::string> names;
  for (const RunningCulprit& culprit : here->answering) {
    const auto robot = culprit.client.get("/api/robot", web::LocalClient::kLargeAnswer);
    if (robot && robot->is_object()) collect_names(*robot, options.kind, names);
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  for (const std::string& name : names) say(stdout, "{}\n", escape_controls(name));
  return kOk;
}

}  // namespace

void add_names(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<NamesOptions>();
  CLI::App* command = app.add_subcommand("names", "Print the names that a shell completes");
  command->group("");
  command->add_option("KIND", options->kind, "components, names (also rules) or strategies")
      ->check(CLI::IsMember({"components", "names", "strategies"}))
      ->required();
  options->which.add_to(*command);
  command->callback([options, &exit_code] { exit_code = print_names(*options); });
}

}  // namespace culprit::cli
