#include "torture/torture_scenario.h"

#include <algorithm>
#include <array>

#include "simulation/random.h"

namespace culprit::torture {
namespace {

using namespace std::chrono_literals;
using simulation::Random;
using Kind = Mishap::Kind;

constexpr Time kFirst{5s};       // the robot is up by then
constexpr int kMishaps = 10000;  // ms in which mishaps begin

// `density`: how likely it needs each of the others.
Part draw_part(std::size_t index, double density, Random& random) {
  Part part;
  for (std::size_t other = 0; other < index; ++other) {
    if (random.chance(density)) part.needs.push_back(other);
  }
  constexpr std::array kCriticalities = {"ERROR", "WARNING", "NON_CRITICAL"};
  part.criticality = kCriticalities[static_cast<std::size_t>(random.below(3))];
  part.restart_percent = 1 + random.below(100);
  part.redeploy_percent = 1 + random.below(100);
  part.has_last_resort = random.chance(0.2);
  if (random.chance(0.1)) part.boots = std::chrono::milliseconds(random.below(15000));
  return part;
}

Mishap draw_mishap(std::size_t parts, Random& random) {
  // Faults are the rule, the rest the exception.
  constexpr std::array kKinds = {
      Kind::kKill,    Kind::kKill,      Kind::kStop,         Kind::kHang,     Kind::kDrift,
      Kind::kDrift,   Kind::kBreak,     Kind::kBreak,        Kind::kBurn,     Kind::kBurn,
      Kind::kCrash,   Kind::kJump,      Kind::kMove,         Kind::kPause,    Kind::kStaleStamp,
      Kind::kSilence, Kind::kRunByHand, Kind::kBeyondRepair, Kind::kFlap,     Kind::kNamesake,
      Kind::kDeaf,    Kind::kStall,     Kind::kRival,        Kind::kTotalLoss};
  Mishap mishap;
  mishap.at = kFirst + std::chrono::milliseconds(random.below(kMishaps));
  mishap.kind = kKinds[static_cast<std::size_t>(random.below(static_cast<int>(kKinds.size())))];
  mishap.part = static_cast<std::size_t>(random.below(static_cast<int>(parts)));
  mishap.lasts = std::chrono::milliseconds(100 + random.below(5000));
  if (mishap.kind == Kind::kFlap) mishap.lasts *= 10;
  return mishap;
}

Noise draw_noise(Random& random) {
  Noise noise;
  if (random.chance(0.3)) return noise;
  noise.loss = random.chance(0.5) ? random.uniform(0, 0.3) : 0;
  noise.duplication = random.chance(0.5) ? random.uniform(0, 0.3) : 0;
  noise.lateness = random.chance(0.5) ? std::chrono::milliseconds(random.below(400)) : 0ms;
  noise.lost_reply = random.chance(0.3) ? random.uniform(0, 0.3) : 0;
  noise.false_success = random.chance(0.3) ? random.uniform(0, 0.3) : 0;
  noise.false_failure = random.chance(0.3) ? random.uniform(0, 0.3) : 0;
  return noise;
}

Governor::Options draw_governor(Random& random) {
  if (random.chance(0.4)) return Governor::Options::recommended();
  const auto intensity = [&] {
    return random.chance(0.5)
               ? Intensity{}
               : Intensity{1 + random.below(6), std::chrono::seconds(1 + random.below(30))};
  };
  Governor::Options options;
  options.limits.overall = intensity();
  options.limits.per_kind = intensity();
  options.limits.per_component = intensity();
  if (random.chance(0.5)) options.limits.backoff = {1s, 10s, 20s};
  if (random.chance(0.3)) options.limits.quiet_after_launch = 2s;
  if (random.chance(0.2)) options.approval = Approval::kEach;
  if (random.chance(0.5)) options.storm.share = 0.6;
  return options;
}

}  // namespace

std::string_view to_string(Kind kind) {
  switch (kind) {
    case Kind::kKill:
      return "is killed";
    case Kind::kStop:
      return "is stopped";
    case Kind::kHang:
      return "hangs";
    case Kind::kDrift:
      return "drifts";
    case Kind::kBreak:
      return "breaks";
    case Kind::kBurn:
      return "burns";
    case Kind::kBeyondRepair:
      return "breaks beyond repair";
    case Kind::kCrash:
      return "the manager crashes";
    case Kind::kJump:
      return "the clock jumps";
    case Kind::kStaleStamp:
      return "stamps are stale";
    case Kind::kMove:
      return "the robot moves";
    case Kind::kPause:
      return "a person pauses";
    case Kind::kSilence:
      return "is muted";
    case Kind::kRunByHand:
      return "a person runs its redeploy";
    case Kind::kFlap:
      return "comes and goes";
    case Kind::kNamesake:
      return "has a namesake";
    case Kind::kRival:
      return "is started again by its launcher";
    case Kind::kDeaf:
      return "nothing is heard";
    case Kind::kStall:
      return "the manager stands still";
    case Kind::kTotalLoss:
      return "everything is killed";
    case Kind::kLaunchEnds:
      return "a person ends the launch";
  }
  return "";
}

std::string describe(const Mishap& mishap) {
  const bool is_about_part =
      mishap.kind < Kind::kCrash || (mishap.kind >= Kind::kSilence && mishap.kind < Kind::kDeaf);
  return (is_about_part ? "c" + std::to_string(mishap.part) + " " : "") +
         std::string(to_string(mishap.kind)) + " (" + culprit::to_string(mishap.lasts) + ")";
}

Scenario draw(std::uint64_t seed) {
  Random random(seed);
  Scenario scenario;
  scenario.seed = seed;
  const bool is_large = random.chance(0.05);
  const int parts = is_large ? 7 + random.below(24) : 1 + random.below(6);
  for (int i = 0; i < parts; ++i)
    scenario.parts.push_back(draw_part(static_cast<std::size_t>(i), is_large ? 0.1 : 0.35, random));
  const int mishaps = is_large ? 9 + random.below(12) : 1 + random.below(8);
  for (int i = 0; i < mishaps; ++i)
    scenario.mishaps.push_back(draw_mishap(scenario.parts.size(), random));
  scenario.noise = draw_noise(random);
  scenario.governor = draw_governor(random);
  scenario.has_interlock = random.chance(0.3);
  scenario.uses_paper_planner = random.chance(0.4);
  scenario.operator_answers = random.chance(0.8);
  scenario.has_infrastructure = random.chance(0.3);
  if (random.chance(0.5)) scenario.governor.limits.restarts = {1 + random.below(5), 1h};
  scenario.has_launcher = random.chance(0.3);
  if (scenario.has_launcher && random.chance(0.5)) {
    scenario.mishaps.push_back(draw_mishap(scenario.parts.size(), random));
    scenario.mishaps.back().kind = Kind::kLaunchEnds;
    scenario.mishaps.back().lasts += kEndsOfLaunch;
  }
  std::stable_sort(scenario.mishaps.begin(), scenario.mishaps.end(),
                   [](const Mishap& a, const Mishap& b) { return a.at < b.at; });
  return scenario;
}

std::vector<std::size_t> all_needs(const Scenario& scenario, std::size_t part) {
  // A part needs earlier ones only.
  std::vector<bool> is_needed(part, false);
  for (const std::size_t other : scenario.parts[part].needs) is_needed[other] = true;
  std::vector<std::size_t> all;
  for (std::size_t other = part; other-- > 0;) {
    if (!is_needed[other]) continue;
    all.push_back(other);
    for (const std::size_t further : scenario.parts[other].needs) is_needed[further] = true;
  }
  return all;
}

std::string rules_of(const Scenario& scenario) {
  std::string text = "CYCLE 100ms\nSIGNAL moving DIAGNOSTIC base KEY moving\n";
  if (scenario.has_interlock) text += "INTERLOCK moving == false\n";
  // bayes must cope without; the paper's planner would not be run like that.
  if (scenario.has_infrastructure && scenario.uses_paper_planner)
    text += "IGNORE TOPIC /infrastructure\n";
  for (std::size_t i = 0; i < scenario.parts.size(); ++i) {
    const Part& part = scenario.parts[i];
    const std::string n = std::to_string(i);
    const std::string c = "c" + n;
    text += "COMPONENT " + c + " NODE /" + c + " LAUNCH \"" + c + "\"\n";
    text += "SIGNAL drift" + n + " DIAGNOSTIC " + c + " KEY drift\n";
    text += "RULE Silent" + n + "\nPOLICIES " + part.criticality + " ATTEMPTS 4\nTRIGGER age(/" +
            c + ") > 900ms\n";
    text += "STRATEGY restart " + std::to_string(part.restart_percent) + " 10\nADAPTATION " + c +
            " restart 5\n";
    text += "STRATEGY redeploy " + std::to_string(part.redeploy_percent) + " 10\nADAPTATION " + c +
            " redeploy 10\n";
    if (part.has_last_resort) {
      constexpr std::array kWithin = {"", " WITHIN 500ms", " WITHIN 5s"};
      text += "STRATEGY safe 100 10 LASTRESORT" +
              std::string(kWithin[static_cast<std::size_t>(part.restart_percent) % 3]) +
              "\nADAPTATION " + c + " set_parameter safe true 1\n";
    }
    text += "RULE Drift" + n + "\nPOLICIES NON_CRITICAL ATTEMPTS 4\nTRIGGER drift" + n +
            " > 0.5\nSTRATEGY tune 80 10\nADAPTATION " + c + " set_parameter drift 0.0 5\n";
  }
  return text;
}

}  // namespace culprit::torture
