// The calls of the API, but for orders (order_routes.h): the functions that make their routes, and what each needs to answer.
//
// Callers' functions are called from any thread and may block for a moment. References must outlive the routes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/expected.h"
#include "base/time.h"
#include "http/hub.h"
#include "http/routes.h"
#include "language/live_inventory.h"
#include "language/reuse/expansion.h"
#include "link/map_picture.h"
#include "plan/planner.h"
#include "ros2/messages.h"
#include "web/metrics.h"
#include "web/rule_desk.h"
#include "web/signal_history.h"
#include "web/usage_history.h"

namespace culprit::web {

// ---- the robot

// The stream's data for clients that do not stay.
std::vector<http::Route> live_routes(http::Hub& hub);

// The incidents so far, the events of one of them, and a page about it to send. `recordings`: the folder of the black box
// (recorder/recording_folder.h); empty: there is none. Incidents are read from `journal`. Without a journal, or if it cannot be
// read, they come from the events that the stream still has.
std::vector<http::Route> incident_routes(http::Hub& hub, std::filesystem::path journal,
                                         std::filesystem::path recordings = {});

// The robot's names by now; from now on the names in `interest` are observed, too.
using Look = std::function<Expected<LiveInventory>(const LiveInterest& interest)>;
// Lists the robot's names, for forms. `load` finds what the rules include.
std::vector<http::Route> name_routes(Look look, RuleLoader load = nullptr);
// By name; null where a value is a list or not set.
Json parameters_to_json(const LiveInventory::Node& node);

// The last lines that a node logged. Errors: the robot's network cannot be joined.
using LogOf = std::function<Expected<std::vector<ros2::msg::Log>>(const std::string& node)>;
// One component, beyond the stream's data on all: its process's usage, now and before, its parameters, and its latest log
// lines. A page calls it repeatedly while it shows the component.
http::Route component_route(http::Hub& hub, const UsageHistory& usage, Look look, LogOf log_of);

// The content of a map view; `known` is the number of the map that the page has. Errors: as above.
using MapOf =
    std::function<Expected<link::MapPicture>(const std::string& topic, std::uint64_t known)>;
// The map, with the robot, its path and its laser scan. A page calls it repeatedly while it shows the map.
http::Route map_route(MapOf map_of);

// Both observe the robot once they are started, whether a page is open or not.
struct Histories {
  UsageHistory usage;
  SignalHistory signals;

  // As soon as a page is served.
  void start() {
    usage.start();
    signals.start();
  }
};
// One curve: what a plot of the page shows before it follows the stream.
http::Route series_route(const Histories& histories);
// Curves of the past, and its failures and repairs, which a process of its own reads from `journal`; and how far back they
// reach. Empty: no journal is written.
http::Route past_series_route(std::filesystem::path journal);

// Examines the robot for this time; returns what `culprit doctor --json` prints. Errors: it cannot be examined.
using Doctor = std::function<Expected<Json>(Duration time)>;
// Examines the robot without rules (docs/doctor.md). One examination runs at a time: each joins the robot's network.
std::vector<http::Route> doctor_routes(Doctor doctor);
// Examines the robot of the environment (ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY).
Expected<Json> examine_robot(Duration time);

// Begins a recording, called `why`; gives where it is. Errors: why not.
using RecordNow = std::function<Expected<std::filesystem::path>(const std::string& why)>;
// Records the robot now (docs/recording.md). `record` is empty where nothing is recorded.
std::vector<http::Route> recording_routes(RecordNow record);

// The questions of other programs to a service: whether it lives, whether it is ready, its metrics. A decision loop that does
// not come round in `patience` hangs.
std::vector<http::Route> status_routes(
    http::Hub& hub, const Metrics& metrics,
    std::chrono::milliseconds patience = std::chrono::seconds(2));

// ---- the rules

// The rule file: read, check, ask the language server, draw, change form, save.
std::vector<http::Route> rule_routes(RuleDesk& desk);

// Decides for a given state of the robot, as `planner` does (docs/plan.md). Changes nothing and needs no robot. `load` finds what
// the rules include. A few at once, with a lower priority.
http::Route what_if_route(PlannerFactory planner, RuleLoader load = nullptr);

// The journal for the rules that were sent. Errors: there is none, and why.
using JournalOf = std::function<Expected<std::filesystem::path>(const std::string& rules)>;
// Replays the journal: the decisions that other rules would have made in the last while.
http::Route hindsight_route(JournalOf journal_of);
// The journal of the robot that the rules name, at the default path of culprit run.
Expected<std::filesystem::path> usual_journal(const std::string& rules);

// Begins a reload: gives how many rules the file has, or why nothing changes, with the diagnostics of the file.
using Reload = std::function<Expected<std::size_t>(const std::string& author)>;
// The manager goes on with the rules as the file has them now.
std::vector<http::Route> reload_routes(Reload reload);

// ---- demonstrations and studies

// The faults that can be injected, and functions that do so.
struct Faults {
  struct Fault {
    std::string name;
    std::string component;  // where it is
  };
  std::vector<Fault> all;
  std::function<Expected<void>(const std::string& name)> inject;
  std::function<Expected<void>()> clear;  // all that were injected
};
// Break a robot on purpose: of demonstrations only.
std::vector<http::Route> fault_routes(Faults faults);

// The runner of campaigns over an exemplar.
struct Studies {
  static constexpr std::uint32_t kMostRuns = 100'000;

  struct Campaign {
    std::string study;  // "sunset", "suave", "rca"
    std::uint32_t runs = 0;
    std::uint64_t seed = 1;
  };
  struct Progress {
    Campaign campaign;
    std::string state;  // "running", "done", "failed", "stopped"
    double seconds = 0;
    std::optional<std::pair<std::uint64_t, std::uint64_t>> done;  // of how many; nothing: not known
    std::string trouble;                                          // of a failed one, in words
    bool has_report = false;
  };

  std::function<Expected<void>(const Campaign&)> start;  // an error: one is running
  std::function<void()> stop;
  std::function<std::optional<Progress>()> progress;  // of the last one
  std::function<Expected<std::string>()> result;      // of the last one: JSON (docs/study-files.md)
  std::function<Expected<std::string>()> report;      // of the last one: HTML
};
// Start a campaign, and show how it went. One at a time: it is to be a guest on the machine.
std::vector<http::Route> study_routes(Studies studies);

// Plays one run of a study's campaign again, for the timeline: culprit-lab plays it. One at a time, as a guest: in a process of
// the lowest priority.
http::Route single_run_route();

}  // namespace culprit::web
