#include "exemplars/sunset/model/profile.h"

#include <array>
#include <string>

#include "exemplars/sunset/node_options.h"

namespace culprit::sunset::model {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// The exemplar plays its bag at this rate.
constexpr double kBagRate = 0.2;

constexpr Duration wall(double seconds_on_the_wall) {
  return std::chrono::duration_cast<Duration>(
      std::chrono::duration<double>(seconds_on_the_wall * kBagRate));
}

// Shutting a node down and launching it again, until it accepts a lifecycle call, took 2.4 to 3.4 s
// on the wall in the one log that shows it.
constexpr simulation::Span kRelaunch{wall(2.4), wall(1.0)};

// A tenth of a robot second passes at most until a shut-down process sees that it is to exit.
constexpr simulation::Span kEnd{milliseconds(10), milliseconds(100)};

// Open in the sources: the segmentation loads three networks when it is configured, "several
// seconds on the wall".
constexpr Duration kModelLoading = wall(3.0);

// Open in the sources: on a GPU a picture takes at most 0.1 s on the wall.
constexpr Duration kInference = wall(0.05);

Profile paper() {
  Profile p;
  p.name = "paper";
  p.summary = "the exemplar's behaviour of December 2025, which the published figures fit best";
  p.start = kRelaunch;
  p.configure = wall(1);
  p.model_loading = kModelLoading;
  p.end = kEnd;
  p.inference = kInference;
  p.focusing = wall(0.5);
  p.blackboard_period = milliseconds(700);
  p.manager_start = milliseconds(4200);
  p.injection = {milliseconds(6800), milliseconds(500)};
  p.injection_jitter = milliseconds(400);
  p.end_of_run = milliseconds(17500);
  return p;
}

Profile head() {
  Profile p = paper();
  p.name = "head";
  p.summary = "the exemplar as of March 2026: slow activation, a window of ten, large buffers";
  p.configure = {};
  p.sensor_activation = seconds(4);
  p.processing_activation = seconds(2);
  p.fusion_keeps = 15;
  p.frequency_window = 10;
  p.alarmed_period = milliseconds(100);
  return p;
}

Profile october() {
  Profile p = paper();
  p.name = "october";
  p.summary = "the exemplar as of October 2025: no buffers, nothing outlives a process, short runs";
  p.fusion_keeps = 1;
  p.keeps_parameters = false;
  p.activation_restores_brightness = true;
  p.manager_start = milliseconds(400);
  p.injection = {milliseconds(3100), milliseconds(100)};
  p.end_of_run = milliseconds(9700);
  return p;
}

// The processes of `culprit demo` at speed 1.
Profile live() {
  Profile p;
  p.name = "live";
  p.summary = "our live SUNSET: robot time is real time, and topics are watched directly";
  p.start = {milliseconds(30), milliseconds(20)};
  p.configure = from_seconds(kConfigureSec);
  p.end = {from_seconds(kFarewellSec), milliseconds(10)};
  p.inference = milliseconds(10);
  p.focusing = from_seconds(kFocusingSec);
  p.has_blackboard = false;
  p.manager_start = seconds(3);  // everything runs
  p.injection = {seconds(5), seconds(1)};
  p.injection_jitter = milliseconds(10);
  p.end_of_run = seconds(20);
  return p;
}

}  // namespace

std::span<const Profile> profiles() {
  static const std::array kProfiles = {paper(), head(), october(), live()};
  return kProfiles;
}

Expected<const Profile*> find_profile(std::string_view name) {
  std::string known;
  for (const Profile& profile : profiles()) {
    if (profile.name == name) return &profile;
    known += (known.empty() ? "" : ", ") + std::string(profile.name);
  }
  return Error{"there is no profile '" + std::string(name) + "'; there are " + known};
}

}  // namespace culprit::sunset::model
