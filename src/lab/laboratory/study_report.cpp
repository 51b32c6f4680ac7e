#include "laboratory/study_report.h"

#include <array>
#include <sys/wait.h>

#include <fmt/core.h>

#include "base/environment.h"
#include "base/temporary_folder.h"
#include "base/text_file.h"
#include "owners/spawn.h"
#include "study/tables/render.h"

namespace culprit::lab {
namespace {

namespace fs = std::filesystem;

// A virtual environment's Python seldom has the libraries that Debian installs for its own.
constexpr std::array kPythons = {"python3", "/usr/bin/python3"};
constexpr const char* kNoBytecode = "-B";  // a package would leave it behind
constexpr const char* kPackages = "python3-matplotlib python3-scipy";

fs::path script(const std::string& name) {
  return (own_folder() / "../share/culprit/studies" / name).lexically_normal();
}

Expected<void> write_files(const std::vector<ReportFile>& files, const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return Error{folder.string() + ": " + error.message()};
  for (const ReportFile& file : files) {
    if (auto written = write_text((folder / file.name).string(), file.text); !written)
      return written;
  }
  return {};
}

}  // namespace

Expected<void> run_python(std::vector<std::string> arguments, const fs::path& log) {
  std::error_code ignored;
  fs::remove(log, ignored);
  const auto pid = owners::spawn({std::move(arguments), {}, log});
  if (!pid) return Error{pid.error()};
  int status = 0;
  while (waitpid(*pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
  const auto printed = read_text(log.string());
  if (!printed) return Error{printed.error()};
  const std::size_t end = printed->find_last_not_of('\n');
  if (end == std::string::npos) return Error{"the script failed and printed nothing"};
  const std::size_t before = printed->rfind('\n', end);
  return Error{printed->substr(before == std::string::npos ? 0 : before + 1, end - before)};
}

void ReportOptions::add_to(CLI::App& command) {
  command
      .add_option("--report", folder,
                  fmt::format("Also write a page, figures, LaTeX tables and data into this folder; "
                              "--report, --html and --svg need {}",
                              kPackages))
      ->type_name("FOLDER");
  command.add_option("--html", html, "Also write a report, as one self-contained page")
      ->type_name("FILE");
  command.add_option("--svg", plot_folder, "Also write each plot into this folder, for papers")
      ->type_name("FOLDER");
}

Expected<std::string> find_report_python() {
  const auto folder = TemporaryFolder::make("report");
  if (!folder) return Error{folder.error()};
  std::string missing = std::string("python3 ") + kPackages;
  for (const char* python : kPythons) {
    const auto checked = run_python({python, kNoBytecode, script("report.py")}, *folder / "log");
    if (checked) return std::string(python);
    if (checked.error().starts_with("python3-")) missing = checked.error();
  }
  return Error{"Python or one of its libraries is absent; install: sudo apt install " + missing};
}

void warn_of_missing_python(const ReportOptions& options) {
  if (!options.is_wanted()) return;
  if (const auto python = find_report_python(); !python)
    fmt::print(stderr, "culprit: warning: there will be no report: {}\n", python.error());
}

Expected<void> make_report(const std::string& study, const std::vector<ReportFile>& files,
                           const ReportOptions& options) {
  const auto temporary = TemporaryFolder::make("report");
  if (!temporary) return Error{temporary.error()};
  const fs::path data = options.folder.empty() ? *temporary / "data" : fs::path(options.folder);
  if (auto written = write_files(files, data); !written) return written;
  const auto python = find_report_python();
  if (!python) {
    const std::string& place = !options.folder.empty() ? options.folder
                               : !options.html.empty() ? options.html
                                                       : options.plot_folder;
    return Error{place + ": no report is written: " + python.error()};
  }
  const std::vector<std::string> command = {*python, kNoBytecode, script(study + ".py"), data};
  if (!options.folder.empty()) {
    if (auto made = run_python(command, *temporary / "log"); !made) return made;
  }
  if (options.html.empty() && options.plot_folder.empty()) return {};
  std::vector<std::string> parts = command;
  if (!options.html.empty()) parts.insert(parts.end(), {"--html", options.html});
  if (!options.plot_folder.empty()) parts.insert(parts.end(), {"--svg", options.plot_folder});
  return run_python(parts, *temporary / "log");
}

Expected<std::string> latex(const std::vector<study::Table>& tables) {
  const auto folder = TemporaryFolder::make("report");
  if (!folder) return Error{folder.error()};
  const fs::path input = *folder / "tables.json";
  const fs::path output = *folder / "tables.tex";
  if (auto written = write_text(input.string(), study::tables_json(tables)); !written)
    return Error{written.error()};
  const auto made =
      run_python({"python3", kNoBytecode, script("latex.py"), input, output}, *folder / "log");
  if (!made) return Error{"LaTeX needs Python (sudo apt install python3): " + made.error()};
  return read_text(output.string());
}

}  // namespace culprit::lab
