#include "cli/culprit_program.h"

#include <cerrno>
#include <cstring>
#include <string_view>
#include <unistd.h>
#include <utility>
#include <vector>

#include "base/environment.h"
#include "cli/commands.h"
#include "cli/culprit_manual.h"
#include "cli/run_configuration.h"
#include "terminal/console.h"
#include "terminal/program.h"

namespace culprit::cli {
namespace {

// In place of this program. Comes back only if that is impossible.
int become_laboratory(char** argv) {
  const auto laboratory = find_laboratory();
  if (!laboratory) return fail(laboratory.error());
  execv(laboratory->c_str(), argv);
  return fail("cannot start " + laboratory->string() + ": " + std::strerror(errno));
}

// The command line of `run`, with the options of its configuration file.
class RunLine {
 public:
  // Errors: the file has a mistake.
  static Expected<RunLine> of(int argc, char** argv) {
    auto whole = with_configuration({argv + 1, argv + argc});
    if (!whole) return Error{whole.error()};
    return RunLine(argv[0], std::move(*whole));
  }

  const std::string& printed() const { return whole_.printed; }
  // Valid as long as this.
  std::vector<char*> arguments() {
    std::vector<char*> all{program_};
    for (std::string& word : whole_.words) all.push_back(word.data());
    all.push_back(nullptr);
    return all;
  }

 private:
  RunLine(char* program, RunConfiguration whole) : program_(program), whole_(std::move(whole)) {}
  char* program_;
  RunConfiguration whole_;
};

int parse_line(const std::string& version, int argc, char** argv) {
  CLI::App app{
      "culprit keeps ROS 2 robots working: it finds the component that is responsible when many "
      "things fail at once, "
      "and applies the fewest, cheapest adaptations that bring the robot back."};
  app.name("culprit");
  app.set_version_flag("--version", "culprit " + version);
  const auto add_commands = [&](int& exit_code) {
    add_all(app, version, exit_code);
    app.footer(examples_of(culprit_manual()));  // commands that come later would have it, too
  };
  return run_program(app, add_commands, argc, argv);
}

int run_with_configuration(const std::string& version, int argc, char** argv) {
  auto line = RunLine::of(argc, argv);
  if (!line)
    return fail(line.error() +
                    "\nUsage: culprit run [OPTIONS] RULES\nRun 'culprit help run' for "
                    "more information.",
                kUsage);
  if (!line->printed().empty()) {
    say_text(stdout, line->printed());
    return kOk;
  }
  auto arguments = line->arguments();
  return parse_line(version, static_cast<int>(arguments.size()) - 1, arguments.data());
}

}  // namespace

int run_culprit(const std::string& version, int argc, char** argv) {
  if (argc > 1 && is_of_laboratory(argv[1])) return become_laboratory(argv);
  const bool is_run = argc > 1 && std::string_view(argv[1]) == "run";
  return is_run ? run_with_configuration(version, argc, argv) : parse_line(version, argc, argv);
}

}  // namespace culprit::cli
