#include "cli/commands.h"

#include <algorithm>
#include <iterator>

#include "cli/culprit_manual.h"
#include "terminal/help.h"

namespace culprit::cli {
namespace {

// A command of culprit-lab that culprit offers, too.
struct OfLaboratory {
  const char* name;
  const char* description;
};
constexpr OfLaboratory kOfLaboratory[] = {
    {"demo", "Demonstrate a repair on a live robot (by culprit-lab)"},
    {"study", "Campaigns over the exemplars and over random robots (by culprit-lab)"},
    {"torture", "Run culprit on random robots with all kinds of faults (by culprit-lab)"},
};

}  // namespace

bool is_of_laboratory(std::string_view command) {
  return std::any_of(std::begin(kOfLaboratory), std::end(kOfLaboratory),
                     [&](const OfLaboratory& each) { return each.name == command; });
}

void add_all(CLI::App& app, const std::string& version, int& exit_code) {
  add_run(app, version, exit_code);
  add_doctor(app, exit_code);
  add_init(app, exit_code);
  add_drill(app, exit_code);
  add_graph(app, exit_code);
  add_plan(app, exit_code);
  add_modes(app, exit_code);
  add_status(app, exit_code);
  add_top(app, exit_code);
  add_orders(app, exit_code);
  add_names(app, exit_code);
  add_record(app, exit_code);
  add_alerts(app, exit_code);
  add_check(app, exit_code);
  add_explain(app, exit_code);
  add_fmt(app, exit_code);
  add_test(app, exit_code);
  add_import(app, exit_code);
  add_export(app, exit_code);
  add_policy(app, exit_code);
  add_web(app, exit_code);
  add_lsp(app, version, exit_code);
  add_mcp(app, version, exit_code);
  add_log(app, exit_code);
  add_incident(app, exit_code);
  add_audit(app, exit_code);
  add_beliefs(app, exit_code);
  add_replay(app, exit_code);
  add_info(app, exit_code);
#ifdef CULPRIT_FLEET
  add_fleet(app, exit_code);
#endif
  for (const OfLaboratory& each : kOfLaboratory) app.add_subcommand(each.name, each.description);
  add_help(app, exit_code);
  group_commands(app);
  add_manual(app, culprit_manual(), exit_code);
}

}  // namespace culprit::cli
