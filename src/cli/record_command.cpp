#include <memory>

#include "base/name_grammar.h"
#include "cli/commands.h"
#include "cli/running_culprit.h"
#include "terminal/console.h"

namespace culprit::cli {
namespace {

struct RecordOptions {
  WhichCulprit which;
  std::string name = "by-hand";
  bool json = false;
};

int record(const RecordOptions& options) {
  const auto culprit = the_culprit(options.which);
  if (!culprit) return fail(culprit.error() + "\nNothing is recorded.");
  const auto answer =
      culprit->client.ask(http::Method::kPost, "/api/recordings", {{"reason", options.name}});
  if (!answer) return fail(answer.error());
  const std::string error = http::text_of(answer->body, "error").value_or("");
  if (answer->status != 200) return fail("nothing is recorded: " + error);
  if (options.json) {
    say(stdout, "{}\n", to_line(answer->body));
  } else {
    say(stdout, "{}: recording to {}\n", culprit->name(),
        escape_controls(http::text_of(answer->body, "recording").value_or("")));
  }
  return kOk;
}

}  // namespace

void add_record(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<RecordOptions>();
  CLI::App* command = app.add_subcommand(
      "record",
      "Have a running culprit (run --record) write a recording of the last and the next seconds");
  command->add_option("--name", options->name, "Name of the recording, beside its time")
      ->capture_default_str();
  command->add_flag("--json", options->json, "Print the recording's path as a JSON document");
  options->which.add_to(*command);
  command->callback([options, &exit_code] { exit_code = record(*options); });
}

}  // namespace culprit::cli
