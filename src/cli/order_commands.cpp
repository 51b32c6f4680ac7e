// Orders to a running culprit from a terminal: pause, resume, mute, approve, refuse, propose,
// run-strategy.
#include <algorithm>
#include <functional>
#include <memory>
#include <tuple>

#include "base/closest.h"
#include "base/duration_words.h"
#include "base/live_clock.h"
#include "base/name_grammar.h"
#include "cli/commands.h"
#include "cli/give_order.h"
#include "owners/started_processes.h"
#include "ros2/options.h"
#include "terminal/console.h"
#include "terminal/seconds_option.h"

namespace culprit::cli {
namespace {

struct OrderOptions {
  WhichCulprit which;
  std::string reason;
  std::string name;  // of what it is about
  double seconds = 0;
  bool lifts = false;
  bool json = false;
};

// "; did you mean 'camera'?"
std::string suggestion(const std::string& name, const std::vector<std::string>& known) {
  const std::string near = closest(name, {known.begin(), known.end()});
  return near.empty() ? "" : "; did you mean '" + near + "'?";
}

// The names of a list of what GET /api/robot says.
std::vector<std::string> names_in(const Json& document, const char* list) {
  std::vector<std::string> names;
  if (!document.is_object() || !document.contains(list) || !document[list].is_array()) return names;
  for (const Json& each : document[list]) {
    if (auto name = http::text_of(each, "name")) names.push_back(std::move(*name));
  }
  return names;
}

using MakeOrder = std::function<Expected<Json>(const RunningCulprit&, const OrderOptions&)>;

// {"rule": …, "strategy": …} of "Rule.strategy", or of a strategy whose name is the only one of its kind.
Expected<Json> strategy_named(const RunningCulprit& culprit, const std::string& name) {
  const auto robot = culprit.client.get("/api/robot", http::LocalClient::kLargeAnswer);
  if (!robot) return Error{robot.error()};
  std::vector<Json> found;
  std::vector<std::string> known;
  for (const Json& rule : robot->value("rules", Json::array())) {
    const std::string of_rule = http::text_of(rule, "name").value_or("");
    for (const std::string& strategy : names_in(rule, "strategies")) {
      known.push_back(of_rule + "." + strategy);
      if (name == known.back() || name == strategy)
        found.push_back({{"rule", of_rule}, {"strategy", strategy}});
    }
  }
  if (found.size() == 1) return found.front();
  if (found.empty())
    return Error{"the rules have no strategy '" + printable(name) + "'" + suggestion(name, known)};
  return Error{"several rules have a strategy '" + name + "'; name the rule, too: " +
               http::text_of(found.front(), "rule").value_or("") + "." + name};
}

MakeOrder about_strategy(const char* word) {
  return [word](const RunningCulprit& culprit, const OrderOptions& options) {
    auto order = strategy_named(culprit, options.name);
    if (order) (*order)["order"] = word;
    return order;
  };
}

Expected<Json> mute_of(const RunningCulprit& culprit, const OrderOptions& options) {
  const auto robot = culprit.client.get("/api/robot", http::LocalClient::kLargeAnswer);
  if (!robot) return Error{robot.error()};
  const auto components = names_in(*robot, "components");
  const auto rules = names_in(*robot, "rules");
  const auto is_among = [&](const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), options.name) != names.end();
  };
  Json order{{"order", options.lifts ? "lift" : "silence"}};
  if (!options.lifts && options.seconds > 0) order["seconds"] = options.seconds;
  if (is_among(components) || is_among(rules)) {
    order[is_among(components) ? "component" : "rule"] = options.name;
    return order;
  }
  std::vector<std::string> known = components;
  known.insert(known.end(), rules.begin(), rules.end());
  return Error{"there is no component and no rule '" + printable(options.name) + "'" +
               suggestion(options.name, known)};
}

int order(const OrderOptions& options, const MakeOrder& make) {
  const bool all = options.which.all;
  auto here = culprits_here(options.which);
  if (!here) return fail(here.error() + "\nNothing was ordered.", kUsage);
  if (here->answering.empty()) return fail(none_to_ask(*here) + "\nNothing was ordered.");
  if (here->answering.size() > 1 && !all)
    return fail(several_to_choose(*here) + "\nNothing was ordered.", kUsage);
  std::vector<Json> orders;
  for (const RunningCulprit& culprit : here->answering) {
    auto made = make(culprit, options);
    if (!made) return fail(made.error() + "\nNothing was ordered.", kUsage);
    orders.push_back(std::move(*made));
  }
  bool is_all_done = true;
  Json list = Json::array();
  auto outcomes = give_all(here->answering, std::move(orders), options.reason);
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const RunningCulprit& culprit = here->answering[i];
    OutcomeOfOrder& outcome = outcomes[i];
    is_all_done &= outcome.is_done;
    if (!options.json)
      say(outcome.is_done ? stdout : stderr, "{}: {}\n", culprit.name(),
          escape_controls(outcome.text));
    list.push_back({{"process", culprit.process},
                    {"done", outcome.is_done},
                    {"text", outcome.text},
                    {"answer", std::move(outcome.answer)}});
  }
  if (options.json)
    say(stdout, "{}\n",
        to_line({{"orders", list}, {"others", here->others}, {"not_meant", here->not_meant}}));
  // The user may have meant one of these.
  for (const auto* others : {&here->others, &here->not_meant}) {
    for (const std::string& other : *others) say(stderr, "culprit: {}\n", escape_controls(other));
  }
  return is_all_done && (here->others.empty() || !all) ? kOk : kFailed;
}

// Seconds that a mute still lasts at `now`, a time of the robot; null: until it is lifted.
Json seconds_left(const Json& mute, double now) {
  const auto until = mute.find("until");
  if (until == mute.end() || !until->is_number()) return nullptr;
  return std::max(until->get<double>() - now, 0.0);
}

// "rule Slow, for another 12 min, by ada: maintenance"
std::string mute_line(const Json& mute) {
  const bool is_rule = mute.contains("rule");
  std::string line = (is_rule ? "rule " : "component ") +
                     http::text_of(mute, is_rule ? "rule" : "component").value_or("");
  if (const auto left = mute.find("left_s"); left != mute.end() && left->is_number())
    line += ", for another " + in_words(from_seconds(left->get<double>()));
  const std::string author = http::text_of(mute, "author").value_or("");
  const std::string reason = http::text_of(mute, "reason").value_or("");
  if (!author.empty()) line += ", by " + author;
  return reason.empty() ? line : line + ": " + reason;
}

// "mute off camera": why `name` can hardly be one; empty: it can.
std::string slip_of_mute(const std::string& name) {
  if (name == "off" || name == "remove" || name == "delete")
    return "'" + name + "' is no component and no rule; write mute NAME --lift";
  return name == "add" ? "'add' is no component and no rule; write mute NAME" : "";
}

// Lists muted components and rules.
int list_mutes(const OrderOptions& options) {
  auto here = culprits_here(options.which);
  if (!here) return fail(here.error(), kUsage);
  if (here->answering.empty()) return fail(none_to_ask(*here));
  Json list = Json::array();
  for (const RunningCulprit& culprit : here->answering) {
    // The state is a new one, and culprit publishes what is muted before it.
    const auto state = culprit.client.get("/api/state", http::LocalClient::kLargeAnswer);
    const auto control = culprit.client.get("/api/control", http::LocalClient::kLargeAnswer);
    if (!control || !state)
      return fail(culprit.name() +
                  " does not answer: " + (control ? state.error() : control.error()));
    Json mutes = control->value("silences", Json::array());
    const double now = state->is_object() ? state->value("t", 0.0) : 0.0;
    for (Json& mute : mutes) {
      if (mute.is_object()) mute["left_s"] = seconds_left(mute, now);
    }
    list.push_back({{"process", culprit.process}, {"silences", mutes}});
    if (options.json) continue;
    say(stdout, "{}: {}\n", culprit.name(), mutes.empty() ? "nothing is muted" : "these are muted");
    for (const Json& mute : mutes) say(stdout, "  {}\n", escape_controls(mute_line(mute)));
  }
  if (options.json) say(stdout, "{}\n", to_line(list));
  return kOk;
}

CLI::App* add_order(CLI::App& app, int& exit_code, const char* name, const char* description,
                    MakeOrder make, const std::shared_ptr<OrderOptions>& options) {
  CLI::App* command = app.add_subcommand(name, description);
  command->add_option("--reason", options->reason, "Reason, kept in the journal");
  command->add_flag("--json", options->json, "Print the result as a JSON document");
  options->which.add_to(*command);
  command->callback(
      [options, make = std::move(make), &exit_code] { exit_code = order(*options, make); });
  return command;
}

MakeOrder plain(const char* word) {
  return [word](const RunningCulprit&, const OrderOptions&) -> Expected<Json> {
    return Json{{"order", word}};
  };
}

// Without a culprit that answers: those that one left behind.
int end_what_is_left(const WhichCulprit& which) {
  const auto environment = ros2::options_from_environment();
  if (!which.domain && !environment) return fail(environment.error(), kUsage);
  const auto domain = which.domain ? *which.domain : environment->domain;
  const auto processes = owners::started_processes(std::to_string(domain) + "/");
  if (processes.empty()) {
    say(stdout, "No process runs that a culprit started on domain {}.\n", domain);
    return kOk;
  }
  for (const owners::StartedProcess& each : processes)
    say(stdout, "ends {}\n", escape_controls(to_string(each, live_now())));
  const auto left = owners::end_processes(processes);
  for (const owners::StartedProcess& each : left)
    say(stderr, "culprit: still there: {}\n", escape_controls(to_string(each, live_now())));
  return left.empty() ? kOk : kFailed;
}

int end_started(const OrderOptions& options) {
  const auto here = culprits_here(options.which);
  if (!here) return fail(here.error(), kUsage);
  if (!here->answering.empty()) return order(options, plain("end_started"));
  for (const std::string& other : here->others)
    say(stderr, "culprit: {}\n", escape_controls(other));
  return end_what_is_left(options.which);
}

void add_end_started(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<OrderOptions>();
  CLI::App* command = app.add_subcommand(
      "end-started",
      "End the processes that culprit started, also those that a culprit left behind.\nA running "
      "culprit keeps them down until culprit revive.");
  command->add_option("--reason", options->reason, "Reason, kept in the journal");
  options->which.add_to(*command);
  command->callback([options, &exit_code] { exit_code = end_started(*options); });
}

}  // namespace

void add_orders(CLI::App& app, int& exit_code) {
  const auto make = [] { return std::make_shared<OrderOptions>(); };
  auto options = make();
  CLI::App* pause = add_order(app, exit_code, "pause",
                              "Pause a running culprit: it changes nothing until it is resumed",
                              plain("pause"), options);
  options->which.add_all_to(*pause);
  add_order(app, exit_code, "resume", "Resume a paused culprit", plain("resume"), make());
  add_order(app, exit_code, "revive",
            "Have a running culprit restart the components that a person ended", plain("revive"),
            make());
  add_end_started(app, exit_code);

  options = make();
  CLI::App* mute =
      add_order(app, exit_code, "mute",
                "Mute a component or a rule: no strategy starts for it. It is still watched",
                mute_of, options);
  mute->alias("silence");  // as it was called before
  mute->add_option("NAME", options->name, "A component or a rule; list: what is muted now")
      ->type_name("NAME")
      ->required()
      ->check(slip_of_mute);
  auto* lasts = add_seconds(*mute, "--for", options->seconds, "How long (default: until --lift)", 1,
                            7 * 24 * 3600)
                    ->default_str("");
  mute->add_flag("--lift", options->lifts, "Unmute it now")->excludes(lasts);
  mute->callback([options, &exit_code] {
    const bool is_list = options->name == "list" && !options->lifts;
    exit_code = is_list ? list_mutes(*options) : order(*options, mute_of);
  });

  for (const auto& [word, call, description] :
       {std::tuple("approve", "approve",
                   "Approve the strategy that a running culprit proposes (run --approve)"),
        std::tuple("refuse", "refuse",
                   "Reject the proposed strategy; culprit proposes the next one"),
        std::tuple("propose", "propose",
                   "Propose a strategy for a present failure. It begins once a person approves it "
                   "(run --approve)"),
        std::tuple("run-strategy", "run", "Have a running culprit carry out a strategy now")}) {
    options = make();
    add_order(app, exit_code, word, description, about_strategy(call), options)
        ->add_option("STRATEGY", options->name, "As culprit status names it: Rule.strategy")
        ->type_name("STRATEGY")
        ->required();
  }
}

}  // namespace culprit::cli
