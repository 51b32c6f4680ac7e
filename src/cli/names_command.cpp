// The names that a shell completes: of the components, rules, strategies, topics, nodes and open incidents of the culprits that run here.
//
// A person waits for them: each culprit has kTimeToAnswer, and without an answer nothing is offered and nothing printed.
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

// The answer to GET `path`, or an empty document.
Json ask(const RunningCulprit& culprit, const std::string& path) {
  auto answer =
      culprit.client.with_patience(kTimeToAnswer).get(path, http::LocalClient::kLargeAnswer);
  return answer && answer->is_object() ? std::move(*answer) : Json::object();
}

void append_texts(const Json& document, const char* list, const char* member,
                  std::vector<std::string>& names) {
  const auto all = document.find(list);
  if (all == document.end() || !all->is_array()) return;
  for (const Json& each : *all) {
    if (auto name = http::text_of(each, member)) names.push_back(std::move(*name));
  }
}

void add_strategies(const Json& robot, std::vector<std::string>& names) {
  const auto rules = robot.find("rules");
  if (rules == robot.end() || !rules->is_array()) return;
  for (const Json& rule : *rules) {
    std::vector<std::string> own;
    if (rule.is_object()) append_texts(rule, "strategies", "name", own);
    for (const std::string& strategy : own)
      names.push_back(http::text_of(rule, "name").value_or("") + "." + strategy);
  }
}

void add_topics(const Json& robot, std::vector<std::string>& names) {
  const auto topics = robot.find("topics");
  if (topics == robot.end() || !topics->is_array()) return;
  for (const Json& topic : *topics) {
    if (topic.is_string()) names.push_back(topic.get<std::string>());
  }
}

void collect_names(const RunningCulprit& culprit, const std::string& kind,
                   std::vector<std::string>& names) {
  if (kind == "incidents")  // the open ones: older ones are in the journal, which may be long
    return append_texts(ask(culprit, "/api/state"), "incidents", "id", names);
  const Json robot = ask(culprit, "/api/robot");
  if (kind == "strategies") return add_strategies(robot, names);
  if (kind == "topics") return add_topics(robot, names);
  append_texts(robot, "components", kind == "nodes" ? "node" : "name", names);
  if (kind == "names") append_texts(robot, "rules", "name", names);
}

// Those of the domain that is meant. If none runs there: all of this user, as a shell does not tell the --domain that stands before the cursor.
Expected<CulpritsHere> culprits_to_ask(WhichCulprit which) {
  auto here = culprits_here(which);
  if (!here || !here->answering.empty() || which.domain) return here;
  which.all = true;
  return culprits_here(which);
}

int print_names(const NamesOptions& options) {
  const auto here = culprits_to_ask(options.which);
  if (!here) return kFailed;  // nobody reads a message
  std::vector<std::string> names;
  for (const RunningCulprit& culprit : here->answering) collect_names(culprit, options.kind, names);
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
  command
      ->add_option("KIND", options->kind,
                   "components, names (also rules), strategies, topics, nodes or incidents")
      ->check(CLI::IsMember({"components", "names", "strategies", "topics", "nodes", "incidents"}))
      ->required();
  options->which.add_to(*command);
  command->callback([options, &exit_code] { exit_code = print_names(*options); });
}

}  // namespace culprit::cli
