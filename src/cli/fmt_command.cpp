#include <memory>
#include <unistd.h>

#include <fmt/core.h>

#include "base/text_file.h"
#include "cli/commands.h"
#include "cli/layout_diff.h"
#include "language/formatter.h"
#include "rule_files/rule_files.h"
#include "terminal/console.h"

namespace culprit::cli {
namespace {

struct FmtOptions {
  std::vector<std::string> files;
  bool check = false;
  bool diff = false;
};

int show(const FmtOptions& options, const std::string& name, const std::string& before,
         const std::string& after) {
  if (options.diff) fmt::print("{}", layout_diff(name, before, after));
  if (!options.check || before == after) return kOk;
  if (!options.diff) fmt::print("{}\n", name);
  return kFailed;
}

int format_file(const FmtOptions& options, const std::string& file) {
  const auto text = read_text(file);
  if (!text) return fail(text.error());
  const std::string name = file == "-" ? "<stdin>" : file;
  const auto formatted = format(Source(name, *text), colour_of(STDERR_FILENO));
  if (!formatted) {
    fmt::print(stderr, "{}", formatted.error());
    return fail(name + " has errors and stays as it is");
  }
  if (options.check || options.diff) return show(options, name, *text, *formatted);
  if (file == "-") {
    fmt::print("{}", *formatted);
    return kOk;
  }
  if (*text == *formatted) return kOk;
  if (const auto replaced = write_text(file, *formatted); !replaced) return fail(replaced.error());
  fmt::print("{}: formatted\n", file);
  return kOk;
}

int format_files(const FmtOptions& options) {
  int exit_code = kOk;
  for (const std::string& path : options.files) {
    const auto files = rule_files::files_in(path, ".rules");
    if (!files) exit_code = fail(files.error());
    for (const std::string& file : files ? *files : std::vector<std::string>{}) {
      if (format_file(options, file) != kOk) exit_code = kFailed;
    }
  }
  return exit_code;
}

}  // namespace

void add_fmt(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<FmtOptions>();
  CLI::App* command = app.add_subcommand("fmt", "Format rule files; their meaning stays the same");
  command
      ->add_option(
          "FILES", options->files,
          "Rule files, and folders of *.rules; - formats the standard input to the standard output")
      ->type_name("FILE")
      ->required();
  command->add_flag("--check", options->check,
                    "Write nothing; list the files that would change, and fail if there are any");
  command->add_flag("--diff", options->diff, "Write nothing; show what would change");
  command->callback([options, &exit_code] { exit_code = format_files(*options); });
}

}  // namespace culprit::cli
