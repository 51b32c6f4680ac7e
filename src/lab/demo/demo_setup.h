// Base of all demonstrations: a world of its own for a live robot.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "live/live_session.h"
#include "owners/supervisor.h"
#include "ros2/domain_lock.h"

namespace culprit::lab {

// The rules of an embedded file, which has no errors.
live::LoadedRules embedded_file(const char* name, const char* text);
RuleSet embedded_rules(const char* name, const char* text);

// A new folder for logs and state.
Expected<std::filesystem::path> make_state_folder();

// A DDS domain on loopback that is free, as long as the lock lives: this one, or any. Sets
// ROS_DOMAIN_ID and ROS_LOCALHOST_ONLY of this process, so call it before there are threads that
// read the environment.
Expected<ros2::DomainLock> make_own_domain(std::optional<std::uint32_t> wanted);

// How culprit manages the robot of a demonstration: without a journal, and it forgets all when it
// ends.
live::LiveSession::Options demo_session(const char* rules_file, live::LiveRobot::Options robot,
                                        PlannerFactory planner, const std::filesystem::path& state);
// Why nothing is kept.
inline constexpr const char* kForgets = "a demonstration forgets all when it ends";

// How processes of a demonstration are started: logs below `state`, and they end with it.
owners::Supervisor::Options demo_processes(const std::filesystem::path& state);

// On which domain the robot is, and how to look at it there.
void say_domain(const char* robot, std::uint32_t domain);

// Starts each component's process.
void start_all(owners::Supervisor& supervisor, const RuleSet& rules);

}  // namespace culprit::lab
