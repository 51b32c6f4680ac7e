#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <unistd.h>

#include <fmt/chrono.h>
#include <fmt/core.h>

#include "base/environment.h"
#include "base/text_file.h"
#include "cli/commands.h"
#include "cli/run_recording.h"
#include "cli/unit_settings.h"
#include "link/rights.h"
#include "live/rule_file.h"
#include "live/snapshots.h"
#include "ros2/options.h"

namespace culprit::cli {
namespace {

struct PolicyOptions {
  std::string rules;
  std::string format = "sros2";
  std::string enclave;
  std::string output;
  int days = 3650;
  bool improvise = false;
  bool other_users = false;
  std::string snapshot_of;  // a recorder's node; empty: nobody is asked for snapshots
};

const ros2::NodeName kSelf{"/", "culprit"};

void advise(const std::string& advice) { fmt::print(stderr, "culprit: {}\n", advice); }

std::string file_of(const PolicyOptions& options, const char* otherwise) {
  return options.output.empty() ? otherwise : options.output;
}

// The keys may not be there yet, so the variables about them are not read.
Expected<std::uint32_t> domain() {
  const auto options = ros2::options_from_environment([](const char* name) {
    return std::string_view(name).starts_with("ROS_SECURITY") ? nullptr : std::getenv(name);
  });
  return options ? Expected<std::uint32_t>(options->domain) : Error{options.error()};
}

link::Rights rights(const RuleSet& rules, const PolicyOptions& options) {
  link::Rights rights = link::rights_of(rules, kSelf);
  if (!options.snapshot_of.empty()) {
    rights.calls.push_back(live::Snapshots::service_of(options.snapshot_of));
    std::ranges::sort(rights.calls);
  }
  return rights;
}

Expected<std::string> sros2_form(const RuleSet& rules, const PolicyOptions& options) {
  advise(
      fmt::format("make signed permissions of it: ros2 security create_permission KEYSTORE {} {}",
                  options.enclave, file_of(options, "FILE")));
  return link::sros2_policy(rights(rules, options), kSelf, options.enclave);
}

Expected<std::string> permissions_form(const RuleSet& rules, const PolicyOptions& options) {
  const auto number = domain();
  if (!number) return Error{number.error()};
  const auto day = [](std::chrono::system_clock::time_point at) {
    return fmt::format("{:%Y-%m-%d}T00:00:00", fmt::gmtime(at));
  };
  const auto now = std::chrono::system_clock::now();
  advise(fmt::format(
      "sign it, and put the result into the enclave's folder: openssl smime -sign -text -in {} "
      "-out permissions.p7s -signer KEYSTORE/public/permissions_ca.cert.pem -inkey "
      "KEYSTORE/private/permissions_ca.key.pem",
      file_of(options, "permissions.xml")));
  return link::permissions(rights(rules, options), options.enclave, *number,
                           {day(now), day(now + std::chrono::hours(24) * options.days)});
}

Expected<std::string> systemd_form(const RuleSet& rules, const PolicyOptions& options) {
  const auto number = domain();
  if (!number) return Error{number.error()};
  UnitOptions unit;
  unit.rules = std::filesystem::absolute(options.rules).lexically_normal();
  unit.nodes = options.other_users ? NodeOwner::kOtherUsers : NodeOwner::kSameUser;
  unit.environment.emplace_back("ROS_DOMAIN_ID", std::to_string(*number));
  for (const char* name :
       {"ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_STATIC_PEERS",
        "ROS_SECURITY_ENABLE", "ROS_SECURITY_STRATEGY", "ROS_SECURITY_KEYSTORE"}) {
    if (const std::string value = environment(name); !value.empty())
      unit.environment.emplace_back(name, value);
  }
  if (options.enclave != "/culprit")
    unit.environment.emplace_back("ROS_SECURITY_ENCLAVE_OVERRIDE", options.enclave);
  return unit_settings(rules, unit);
}

int write_policy(PolicyOptions& options) {
  if (options.enclave.empty()) options.enclave = environment("ROS_SECURITY_ENCLAVE_OVERRIDE");
  if (options.enclave.empty()) options.enclave = "/culprit";
  if (!is_valid_topic_name(options.enclave))
    return fail("'" + printable(options.enclave) + "' is no enclave; it is a path such as /culprit",
                kUsage);
  auto loaded = live::read_rules(options.rules);
  if (loaded && options.improvise) loaded = improvised(std::move(*loaded), options.rules);
  if (!loaded) return fail(loaded.error());
  const auto text = options.format == "sros2"         ? sros2_form(loaded->rules, options)
                    : options.format == "permissions" ? permissions_form(loaded->rules, options)
                                                      : systemd_form(loaded->rules, options);
  if (!text) return fail(text.error(), kUsage);
  const auto written = write_text(options.output, *text);
  return written ? kOk : fail(written.error());
}

}  // namespace

void add_policy(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<PolicyOptions>();
  CLI::App* command =
      app.add_subcommand("policy",
                         "Write the minimal permissions for a rule file: culprit's permissions on "
                         "a secured DDS domain (SROS2), or the settings of its systemd unit");
  command->add_option("RULES", options->rules, "The rule file")->type_name("FILE")->required();
  command
      ->add_option("--format", options->format,
                   "sros2: a policy for the tools of ROS 2; permissions: of DDS, to be signed with "
                   "openssl; systemd: a drop-in for packaging/culprit.service")
      ->check(CLI::IsMember({"sros2", "permissions", "systemd"}))
      ->capture_default_str();
  command->add_option(
      "--enclave", options->enclave,
      "The enclave with culprit's keys (default: ROS_SECURITY_ENCLAVE_OVERRIDE, /culprit)");
  command->add_option("--days", options->days, "Validity of the permissions in days, from today")
      ->check(CLI::Range(1, 36500))
      ->capture_default_str();
  command->add_flag("--improvise", options->improvise, "For culprit run --improvise");
  add_snapshot(*command, options->snapshot_of, "For culprit run --snapshot");
  command->add_flag("--other-users", options->other_users,
                    "systemd: the robot's nodes run as other users than culprit");
  command->add_option("-o,--output", options->output, "Output file (default: stdout)")
      ->type_name("FILE");
  command->callback([options, &exit_code] { exit_code = write_policy(*options); });
}

}  // namespace culprit::cli
