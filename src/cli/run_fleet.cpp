#include "cli/run_fleet.h"

#include "base/environment.h"

#ifdef CULPRIT_FLEET
#include "fleet/member.h"
#include "fleet/outbox.h"
#endif

namespace culprit::cli {

void FleetOptions::add_to(CLI::App& command) {
  command.add_option("--fleet", address,
                     "Share outcomes with other robots in this PostgreSQL database "
                     "(postgresql://HOST/DATABASE, without a password; docs/fleet.md)");
  command.add_option("--fleet-name", name, "This robot's name for people (default: its host name)");
  command.add_option(
      "--fleet-context", context,
      "The robot's place or task; outcomes of robots in other contexts do not count");
}

#ifdef CULPRIT_FLEET
namespace {

class FleetOfRun : public live::Fleet {
 public:
  explicit FleetOfRun(fleet::Member::Options options) : member_(std::move(options)) {}

  std::string context() const override { return member_.context(); }
  void begins(const RuleSet& rules, std::function<void(PriorsTold)> priors,
              std::function<void(const std::string&)> trouble) override {
    member_.begin(rules, {std::move(priors), std::move(trouble)});
  }
  void ends() override { member_.end(); }
  void happened() override { member_.happened(); }

 private:
  fleet::Member member_;
};

}  // namespace

Expected<std::unique_ptr<live::Fleet>> join_fleet(const FleetOptions& options,
                                                  const std::filesystem::path& journal) {
  if (options.address.empty()) return std::unique_ptr<live::Fleet>();
  auto address = fleet::address_from(options.address);
  if (!address) return Error{address.error()};
  return std::unique_ptr<live::Fleet>(std::make_unique<FleetOfRun>(
      fleet::Member::Options{*address, journal, options.name.empty() ? host_name() : options.name,
                             options.context, fleet::machine_id()}));
}
#else
Expected<std::unique_ptr<live::Fleet>> join_fleet(const FleetOptions& options,
                                                  const std::filesystem::path&) {
  if (options.address.empty()) return std::unique_ptr<live::Fleet>();
  return Error{"this culprit was built without fleets (CMake: CULPRIT_FLEET)"};
}
#endif

}  // namespace culprit::cli
