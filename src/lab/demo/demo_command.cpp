#include "demo/demo_command.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "base/environment.h"
#include "base/joined.h"
#include "base/text_file.h"
#include "demo/demo_setup.h"
#include "demo/rover_demo.h"
#include "demo/suave_demo_command.h"
#include "demo/sunset_demo.h"
#include "json/json.h"
#include "live/observers.h"
#include "live/robot_names.h"
#include "terminal/command.h"
#include "terminal/console.h"
#include "terminal/local_service.h"
#include "terminal/planner_options.h"
#include "terminal/web_service.h"
#include "web/calls.h"
#include "web/hub_observer.h"
#include "web/order_routes.h"
#include "web/study_runner.h"

namespace culprit::lab {
namespace {

struct DemoOptions {
  bool is_extended = false;
  std::string robot = "sunset";
  std::string scenario;
  std::uint64_t seed = 1;
  double speed = 1;
  std::string output;
  PlannerOptions planner;
  std::optional<std::uint32_t> domain;
  bool stay = false;
  bool ends = false;
  WebOptions web;
};

// The differences between the robots that a demonstration breaks.
struct Sunset {
  using Demo = SunsetDemo;
  using Plays = std::vector<Play>;
  static constexpr const char* kName = "SUNSET";
  static constexpr const char* kNodes =
      "camera, depth, image_enhancement, sensor_fusion, segmentation";
  static constexpr const char* kRules = "sunset.rules";
  static constexpr const char* kProgram = "sunset-node";
  static constexpr const char* kCrashes = "camera";
  static constexpr const char* kHangs = "segmentation";
  static constexpr const char* kGoesOn = "The robot flies on";
  static Expected<Plays> plays_for(const DemoOptions& options);
  static void set(SunsetDemo::Options& setup, const DemoOptions& options) {
    setup.speed = options.speed;
  }
  static web::Faults faults_of(SunsetDemo& demo);
};

struct Rover {
  using Demo = RoverDemo;
  using Plays = std::vector<rover::Play>;
  static constexpr const char* kName = "the rover";
  static constexpr const char* kNodes = "seventeen processes in the shape of Nav2";
  static constexpr const char* kRules = "rover.rules";
  static constexpr const char* kProgram = "rover-node";
  static constexpr const char* kCrashes = "planner_server";
  static constexpr const char* kHangs = "controller_server";
  static constexpr const char* kGoesOn = "The rover drives on";
  static Expected<Plays> plays_for(const DemoOptions& options);
  static void set(RoverDemo::Options&, const DemoOptions&) {}
  static web::Faults faults_of(RoverDemo& demo);
};

Expected<Rover::Plays> Rover::plays_for(const DemoOptions& options) {
  Plays plays;
  const std::string& one = options.scenario;
  for (const std::string& name :
       one.empty() ? std::vector<std::string>{"lidar:stall", "kidnapped", "kill:controller_server",
                                              "lidar:unplugged"}
                   : std::vector<std::string>{one}) {
    auto play = rover::find_play(name);
    if (!play) return Error{play.error()};
    plays.push_back(std::move(*play));
  }
  return plays;
}

Expected<std::vector<Play>> Sunset::plays_for(const DemoOptions& options) {
  if (options.scenario.empty()) return default_plays();
  if (options.scenario == "random") {
    const auto all = sunset::scenarios();
    std::mt19937_64 random(options.seed);
    // Not std::uniform_int_distribution: its results differ between standard libraries.
    auto play = find_play(all[random() % all.size()].label());
    if (!play) return Error{play.error()};
    return std::vector<Play>{*play};
  }
  auto play = find_play(options.scenario);
  if (!play) return Error{play.error()};
  return std::vector<Play>{*play};
}

std::string names_or_none(const std::vector<std::string>& items) {
  const std::string all = joined(items);
  return all.empty() ? "none" : all;
}

Json to_json(const std::vector<PlayOutcome>& outcomes) {
  Json document{{"scenarios", Json::array()}};
  std::size_t resolved = 0;
  std::size_t unresolved = 0;
  for (const PlayOutcome& o : outcomes) {
    Json entry{{"name", o.name},
               {"faults", o.faults},
               {"failures", o.failures},
               {"strategies", o.strategies},
               {"strategies_executed", o.strategies.size()},
               {"strategies_succeeded", o.strategies_succeeded},
               {"unnecessary_redeployments", o.unnecessary_redeployments},
               {"reaction_time_s", o.reaction_times},
               {"downtime_s", o.downtime},
               {"mean_iou", nullptr},
               {"blamed", o.blamed},
               {"resolved", o.is_resolved()}};
    if (o.mean_iou) entry["mean_iou"] = *o.mean_iou;
    document["scenarios"].push_back(std::move(entry));
    resolved += o.reaction_times.size();
    unresolved += o.unresolved;
  }
  document["resolved"] = resolved;
  document["unresolved"] = unresolved;
  return document;
}

void print_outcome(const PlayOutcome& o) {
  std::string reactions;
  for (const double t : o.reaction_times)
    reactions += fmt::format("{}{:.2f}", reactions.empty() ? "" : ", ", t);
  say(stdout, "\n  faults                     {}\n", names_or_none(o.faults));
  say(stdout, "  failures                   {}\n", names_or_none(o.failures));
  say(stdout, "  strategies executed        {} ({} resolved a failure)\n", o.strategies.size(),
      o.strategies_succeeded);
  say(stdout, "  unnecessary redeployments  {}\n", o.unnecessary_redeployments);
  say(stdout, "  reaction times             {} s\n", reactions.empty() ? "-" : reactions);
  say(stdout, "  downtime                   {:.2f} s\n", o.downtime);
  if (o.mean_iou) say(stdout, "  mean IoU                   {:.2f}\n", *o.mean_iou);
  if (!o.blamed.empty()) say(stdout, "  held responsible           {}\n", names_or_none(o.blamed));
  if (!o.is_resolved()) say(stdout, "  NOT RESOLVED               {}\n", o.complaint);
}

const char* verdict(const PlayOutcome& o) {
  if (!o.is_resolved()) return "NOT HEALED";
  return o.is_for_a_person ? "stands, for a person" : "healed";
}

void print_summary(const std::vector<PlayOutcome>& outcomes) {
  say(stdout, "\n{:<42} {:>8} {:>10} {:>9} {:>9} {:>8} {:>5}\n", "scenario", "failures",
      "strategies", "redeploys", "reaction", "downtime", "IoU");
  for (const PlayOutcome& o : outcomes) {
    const double mean = o.reaction_times.empty() ? 0
                                                 : std::accumulate(o.reaction_times.begin(),
                                                                   o.reaction_times.end(), 0.0) /
                                                       static_cast<double>(o.reaction_times.size());
    say(stdout, "{:<42} {:>8} {:>10} {:>9} {:>7.2f} s {:>6.2f} s {:>5}  {}\n", o.name,
        o.failures.size(), o.strategies.size(), o.unnecessary_redeployments, mean, o.downtime,
        o.mean_iou ? fmt::format("{:.2f}", *o.mean_iou) : "-", verdict(o));
  }
  say(stdout,
      "redeploys: those that were not necessary. reaction: mean, from detection to resolution.\n");
}

web::Faults Rover::faults_of(RoverDemo& demo) {
  web::Faults faults;
  for (const rover::Fault& fault : rover::faults()) faults.all.push_back({fault.name, fault.cause});
  faults.inject = [&demo](const std::string& name) { return demo.inject(name); };
  faults.clear = [&demo] { return demo.clear_faults(); };
  return faults;
}

web::Faults Sunset::faults_of(SunsetDemo& demo) {
  web::Faults faults;
  for (const sunset::Fault& fault : sunset::faults())
    faults.all.push_back({std::string(fault.name), std::string(sunset::name_of(fault.member))});
  for (const sunset::Member member : sunset::kManagedMembers) {
    const std::string name(sunset::name_of(member));
    for (const char* what : {"kill:", "stop:"}) faults.all.push_back({what + name, name});
  }
  faults.inject = [&demo](const std::string& name) { return demo.inject(name); };
  faults.clear = [&demo] { return demo.clear_faults(); };
  return faults;
}

std::vector<http::Route> web_routes(web::Faults faults, http::Hub& hub, const web::Metrics& metrics,
                                    const web::Histories& histories, web::OrderDesk& orders,
                                    web::RuleDesk& desk, web::StudyRunner& studies,
                                    live::RobotNames& names, PlannerFactory planner) {
  std::vector<http::Route> routes = web::live_routes(hub);
  for (http::Route& route : web::order_routes(orders, hub)) routes.push_back(std::move(route));
  for (http::Route& route : web::status_routes(hub, metrics)) routes.push_back(std::move(route));
  for (http::Route& route : web::rule_routes(desk)) routes.push_back(std::move(route));
  const auto look = [&names](const LiveInterest& interest) { return names.look(interest); };
  for (http::Route& route : web::name_routes(look)) routes.push_back(std::move(route));
  for (http::Route& route : web::incident_routes(hub, "")) routes.push_back(std::move(route));
  for (http::Route& route : web::doctor_routes(web::examine_robot))
    routes.push_back(std::move(route));
  routes.push_back(
      web::component_route(hub, histories.usage, look,
                           [&names](const std::string& node) { return names.log_of(node); }));
  routes.push_back(web::map_route(
      [&names](const std::string& topic, std::uint64_t known) { return names.map(topic, known); }));
  routes.push_back(web::series_route(histories));
  routes.push_back(web::past_series_route(""));
  routes.push_back(web::what_if_route(std::move(planner)));
  for (http::Route& route : web::study_routes(studies.studies()))
    routes.push_back(std::move(route));
  routes.push_back(web::single_run_route());
  for (http::Route& route : web::fault_routes(std::move(faults)))
    routes.push_back(std::move(route));
  return routes;
}

template <class Robot>
void print_how_to_break(const std::string& address, std::uint32_t domain) {
  say(stdout,
      "  in the browser             {0}\n"
      "  a crash                    pkill -KILL -f '{1} {2}'\n"
      "  a hang                     pkill -STOP -f '{1} {3}'\n",
      address, Robot::kProgram, Robot::kCrashes, Robot::kHangs);
  if (const std::string culprit = culprit_at_terminal(); !culprit.empty())
    say(stdout, "  and see what culprit does  {} status --domain {}\n", culprit, domain);
}

template <class Robot>
typename Robot::Demo::Options setup_of(const DemoOptions& options, live::Observer& observer) {
  typename Robot::Demo::Options setup;
  Robot::set(setup, options);
  setup.seed = options.seed;
  setup.domain = options.domain;
  setup.planner = options.planner.factory();
  setup.on_event = [colour = colour_of(STDOUT_FILENO)](const Event& event, const RuleSet& rules,
                                                       Time start) {
    const std::string text = line(event, rules, start, colour);
    if (!text.empty()) say(stdout, "{}\n", text);
  };
  setup.observer = &observer;
  return setup;
}

// Errors: a play could not go on.
template <class Demo, class Plays>
Expected<std::vector<PlayOutcome>> play_each(Demo& demo, const Plays& plays) {
  std::vector<PlayOutcome> outcomes;
  for (const auto& play : plays) {
    say(stdout, "\nScenario {} of {}: {}\nInjecting {}\n", outcomes.size() + 1, plays.size(),
        play.name, names_or_none(play.fault_names()));
    auto outcome = demo.play(play);
    if (!outcome) return Error{outcome.error()};
    print_outcome(*outcome);
    outcomes.push_back(std::move(*outcome));
  }
  return outcomes;
}

bool are_all_healed(const std::vector<PlayOutcome>& outcomes) {
  return std::all_of(outcomes.begin(), outcomes.end(),
                     [](const PlayOutcome& o) { return o.is_resolved(); });
}

template <class Robot>
int demo_robot(const DemoOptions& options) {
  using Demo = typename Robot::Demo;
  const auto plays = Robot::plays_for(options);
  if (!plays) return fail(plays.error(), kUsage);
  StopSignals signals;
  say(stdout, "Starting {}: {}\n", Robot::kName, Robot::kNodes);
  Demo* running = nullptr;
  http::Hub hub([&] { running->interrupt(); });
  web::Metrics metrics;
  web::HubObserver observer(hub, metrics);
  web::Histories histories;
  live::Observers observers({&observer, &histories.usage, &histories.signals});
  auto demo = Demo::start(setup_of<Robot>(options, observers), signals.stopped());
  if (!demo) return fail(demo.error(), kFailed);
  running = demo->get();
  say_domain(Robot::kName, (*demo)->domain());
  web::RuleDesk desk(Robot::kRules, Demo::rule_text());
  web::OrderDesk orders((*demo)->keeper().keeping());
  live::RobotNames names;
  web::StudyRunner studies(default_state_folder() / "studies");
  orders.open((*demo)->rules(), [&](Order order) { (*demo)->submit(std::move(order)); });
  const auto server = serve(options.web,
                            web_routes(Robot::faults_of(**demo), hub, metrics, histories, orders,
                                       desk, studies, names, options.planner.factory()),
                            &hub);
  if (!server) return fail(server.error(), kUsage);
  histories.start();
  std::vector<http::Route> local = web::live_routes(hub);
  for (http::Route& route : web::order_routes(orders, hub)) local.push_back(std::move(route));
  const auto asked =
      serve_this_machine({"", (*demo)->rules().robot, Robot::kRules, (*demo)->domain(), "culprit",
                          (*server)->address(), culprit_at_terminal()},
                         std::move(local), hub);
  if (options.stay) {
    say(stdout, "Break it in the browser, and see what becomes of it; Ctrl-C ends it.\n");
    print_how_to_break<Robot>((*server)->address(), (*demo)->domain());
    signals.wait_until_stopped();
    return kOk;
  }
  const auto outcomes = play_each(**demo, *plays);
  if (!outcomes) return fail(outcomes.error(), kFailed);
  print_summary(*outcomes);
  const bool all_healed = are_all_healed(*outcomes);
  if (!all_healed)
    say(stdout, "The logs of the nodes are in {}\n", ((*demo)->keep_state() / "log").string());
  if (!options.output.empty()) {
    const auto written = write_text(options.output, to_indented(to_json(*outcomes)) + "\n");
    if (!written) return fail(written.error(), kFailed);
  }
  const bool is_watched = isatty(STDIN_FILENO) != 0 && isatty(STDOUT_FILENO) != 0;
  if (is_watched && !options.ends) {
    say(stdout, "\n{}; Ctrl-C ends it. Break it yourself:\n", Robot::kGoesOn);
    print_how_to_break<Robot>((*server)->address(), (*demo)->domain());
    signals.wait_until_stopped();
  }
  return all_healed ? kOk : kFailed;
}

int demo(const DemoOptions& options) {
  if (options.robot != "suave" && options.is_extended) {
    say(stderr, "culprit: --extended is for --robot suave\n");
    return kUsage;
  }
  if (options.robot == "sunset") return demo_robot<Sunset>(options);
  if (options.robot == "rover" && options.speed != 1) {
    say(stderr, "culprit: the rover lives at --speed 1 only\n");
    return kUsage;
  }
  if (options.robot == "rover") return demo_robot<Rover>(options);
  if (!options.scenario.empty() || options.stay) {
    say(stderr,
        "culprit: --scenario and --stay are for the other robots; SUAVE has its missions, the "
        "standard one and --extended\n");
    return kUsage;
  }
  SuaveDemo::Options setup;
  setup.is_extended = options.is_extended;
  setup.speed = options.speed;
  setup.seed = options.seed;
  setup.domain = options.domain;
  setup.planner = options.planner.factory();
  return demo_suave(std::move(setup), options.output);
}

}  // namespace

void add_demo(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<DemoOptions>();
  CLI::App* command = app.add_subcommand(
      "demo",
      "Demonstrate a repair on a live robot: SUNSET, a drone's segmentation pipeline of real "
      "processes.\n"
      "Plays three scenarios, each with an ERROR, a WARNING and a NON_CRITICAL fault at once.\n"
      "Then it goes on until Ctrl-C if a person watches.\n"
      "With --robot suave: an underwater robot that must find a pipeline in murky water, and loses "
      "a thruster.\n"
      "With --robot rover: a mobile robot in the shape of Nav2, which drives from room to room.");
  command->add_option("--robot", options->robot, "Robot")
      ->check(CLI::IsMember({"sunset", "suave", "rover"}))
      ->capture_default_str();
  command->add_option(
      "--scenario", options->scenario,
      "One scenario instead: 001 to 018, a name such as image_shift+gpu_failure, 'random', or "
      "faults of processes: kill:camera, stop:depth, crash:segmentation, kill:camera+segmentation. "
      "With "
      "--robot rover: faults by name, such as lidar:stall+kidnapped");
  command->add_flag(
      "--extended", options->is_extended,
      "With --robot suave: the battery runs low as well, and killed processes are started again");
  command->add_option("--seed", options->seed, "Seed of the flight or dive, and of 'random'")
      ->capture_default_str();
  command->add_option("--speed", options->speed, "Speed relative to real time")
      ->check(CLI::Range(0.1, 20.0))
      ->capture_default_str();
  command
      ->add_option("-o,--output,--json", options->output,
                   "Also write the outcome to this file, as one JSON document")
      ->type_name("FILE");
  command
      ->add_option("--domain", options->domain,
                   "The DDS domain (default: the first from 1 on that is free on this machine)")
      ->check(CLI::Range(0, 101));
  command->add_flag("--end", options->ends, "End after the scenarios, also at a terminal");
  command
      ->add_flag("--stay", options->stay,
                 "Play no scenario: go on until Ctrl-C, and break the robot in the browser")
      ->excludes("--scenario")
      ->excludes("--end");
  options->planner.add_to(*command);
  options->web.add_to(*command);
  command->callback([options, &exit_code] { exit_code = demo(*options); });
}

}  // namespace culprit::lab
