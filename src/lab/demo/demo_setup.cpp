#include "demo/demo_setup.h"

#include <stdlib.h>

#include <fmt/core.h>

#include "base/environment.h"
#include "demo/embedded_rules.h"
#include "language/checker.h"
#include "language/reuse/expansion.h"
#include "terminal/console.h"

namespace culprit::lab {

live::LoadedRules embedded_file(const char* name, const char* text) {
  // The only file that any of them includes.
  const Expansion all = expand(Source(name, text), [](const std::string& file, const std::string&) {
    return Expected<Source>(Source(file, kNav2Pack));
  });
  return {*check(all).rules, all.source, ""};
}

RuleSet embedded_rules(const char* name, const char* text) {
  return embedded_file(name, text).rules;
}

live::LiveSession::Options demo_session(const char* rules_file, live::LiveRobot::Options robot,
                                        PlannerFactory planner,
                                        const std::filesystem::path& state) {
  live::LiveSession::Options options;
  options.rules_file = rules_file;
  options.robot = std::move(robot);
  options.planner = std::move(planner);
  options.discovery = std::chrono::seconds(20);  // the nodes are only just being started
  options.has_preflight = false;
  options.journal = state / "journal";
  options.no_journal = kForgets;
  return options;
}

Expected<std::filesystem::path> make_state_folder() {
  std::string path = (std::filesystem::temp_directory_path() / "culprit-demo-XXXXXX").string();
  if (mkdtemp(path.data()) == nullptr)
    return Error{"cannot make a folder in " + std::filesystem::temp_directory_path().string()};
  return std::filesystem::path(path);
}

Expected<ros2::DomainLock> make_own_domain(std::optional<std::uint32_t> wanted) {
  auto domain = wanted ? ros2::DomainLock::reserve(*wanted, *wanted) : ros2::DomainLock::reserve();
  if (!domain) return domain;
  setenv("ROS_DOMAIN_ID", std::to_string(domain->domain()).c_str(), 1);
  setenv("ROS_LOCALHOST_ONLY", "1", 1);
  return domain;
}

owners::Supervisor::Options demo_processes(const std::filesystem::path& state) {
  owners::Supervisor::Options options;
  options.log_folder = state / "log";
  options.search_first = {own_folder()};
  options.lifetime = owners::Lifetime::kStarter;
  return options;
}

void say_domain(const char* robot, std::uint32_t domain) {
  const std::string culprit = culprit_at_terminal();
  say(stdout, "{} is on domain {}{}\n", robot, domain,
      culprit.empty()
          ? ""
          : fmt::format("; to look at it: ROS_DOMAIN_ID={} ROS_LOCALHOST_ONLY=1 {} graph", domain,
                        culprit));
}

void start_all(owners::Supervisor& supervisor, const RuleSet& rules) {
  for (std::size_t c = 0; c < rules.components.size(); ++c) supervisor.start({}, ComponentId(c));
}

}  // namespace culprit::lab
