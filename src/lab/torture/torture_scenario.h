// One torture: a robot, its rules, what breaks, what is lost or wrong on the way, and what people
// do meanwhile. All of it is data, drawn from a seed, so that a failing one can be made smaller.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "execute/governor.h"

namespace culprit::torture {

// A component that needs others, earlier ones.
struct Part {
  std::vector<std::size_t> needs;
  std::string criticality = "ERROR";
  int restart_percent = 50;
  int redeploy_percent = 50;
  bool has_last_resort = false;
  Duration boots{};  // so long after the rest of the robot
};

struct Mishap {
  enum class Kind : std::uint8_t {
    kKill,
    kStop,
    kHang,
    kDrift,  // a parameter has a bad value, and a signal shows it
    kBreak,  // until it is activated anew
    kBurn,   // until its process is another
    kBeyondRepair,
    kCrash,       // of the manager: it begins anew, with its beliefs
    kJump,        // of the manager's clock, forwards
    kStaleStamp,  // what is observed for a while carries a time that is past
    kMove,        // the robot drives for a while: the interlock is closed
    kPause,       // by a person, for a while
    kSilence,     // of the component, for a while
    kRunByHand,
    kFlap,       // it works and does not, in turns, for a while
    kNamesake,   // for a while another node has its name
    kRival,      // for a while its launcher starts it again when it is gone
    kDeaf,       // for a while the manager hears nothing of topics, and knows it a moment later
    kStall,      // the manager stands still for a while
    kTotalLoss,  // every process is killed
    kLaunchEnds  // somebody ends what was launched together, and starts it again after a while
  };
  Time at{};
  Kind kind = Kind::kKill;
  std::size_t part = 0;
  Duration lasts{};  // where it ends by itself
};
std::string_view to_string(Mishap::Kind kind);

// Disturbances between manager and robot, while mishaps occur.
struct Noise {
  double loss = 0;         // of samples
  double duplication = 0;  // of any observation
  Duration lateness{};     // at most; what one source says stays in order, sources overtake
  double lost_reply = 0;
  double false_success = 0;  // "done", and nothing was done
  double false_failure = 0;  // "refused", and it was done
};

struct Scenario {
  std::uint64_t seed = 0;
  std::vector<Part> parts;
  std::vector<Mishap> mishaps;  // by time
  Noise noise;
  Governor::Options governor;
  bool has_interlock = false;
  // All parts publish and hear one topic, as /rosout or /parameter_events.
  bool has_infrastructure = false;
  bool has_launcher = false;  // it started all parts
  bool uses_paper_planner = false;
  bool operator_answers = true;  // where each strategy has to be approved
};

// How long it takes until all that was launched together has ended.
inline constexpr Duration kEndsOfLaunch = std::chrono::milliseconds(1500);

inline constexpr Duration kPeriod = std::chrono::milliseconds(200);  // of what each part says

Scenario draw(std::uint64_t seed);
// The parts that this part needs, directly or not.
std::vector<std::size_t> all_needs(const Scenario& scenario, std::size_t part);
std::string rules_of(const Scenario& scenario);
std::string describe(const Mishap& mishap);

}  // namespace culprit::torture
