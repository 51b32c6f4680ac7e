#include "web/study_runner.h"

#include <algorithm>
#include <charconv>
#include <csignal>
#include <sys/wait.h>

#include "base/environment.h"
#include "base/text_file.h"
#include "owners/spawn.h"

namespace culprit::web {
namespace {

constexpr const char* kResult = "result.json";
constexpr const char* kReport = "report.html";
constexpr const char* kLog = "study.log";
// The paper's evaluation plays each configuration so often.
constexpr std::uint32_t kPaperRuns = 162;

std::vector<std::string> command_of(const std::filesystem::path& laboratory,
                                    const Studies::Campaign& campaign, const std::string& result,
                                    const std::string& report) {
  const bool is_rca = campaign.study == "rca";
  std::vector<std::string> command = {"env",
                                      std::string(kProgressVariable) + "=lines",
                                      "nice",
                                      "-n",
                                      "19",
                                      laboratory.string(),
                                      "study",
                                      campaign.study,
                                      is_rca ? "--episodes" : "--runs",
                                      std::to_string(campaign.runs),
                                      "--seed",
                                      std::to_string(campaign.seed),
                                      "--jobs",
                                      "1",
                                      "--json",
                                      "--output",
                                      result};
  // A shorter campaign also learns in shorter series: those of `culprit study all --quick`.
  if (campaign.study == "sunset" && campaign.runs < kPaperRuns)
    command.insert(command.end(), {"--experiments", "100", "--repetitions", "4"});
  if (!is_rca) command.insert(command.end(), {"--html", report});
  return command;
}

}  // namespace

std::optional<std::pair<std::uint64_t, std::uint64_t>> last_progress(const std::string& log) {
  const std::size_t slash = log.rfind('/');
  if (slash == std::string::npos || slash == 0) return std::nullopt;
  const std::size_t before = log.find_last_not_of("0123456789", slash - 1);
  const char* const begin = log.data() + (before == std::string::npos ? 0 : before + 1);
  const char* const end = log.data() + log.size();
  std::pair<std::uint64_t, std::uint64_t> done;
  const bool has_done = std::from_chars(begin, log.data() + slash, done.first).ec == std::errc();
  const bool has_total =
      std::from_chars(log.data() + slash + 1, end, done.second).ec == std::errc();
  return has_done && has_total ? std::optional(done) : std::nullopt;
}

std::string after_progress(const std::string& log) {
  std::size_t begin = 0;
  for (std::size_t line = 0; line < log.size();) {
    const std::size_t end = std::min(log.find('\n', line), log.size() - 1) + 1;
    if (log[line] == '[') begin = end;
    line = end;
  }
  return log.substr(begin);
}

Expected<void> StudyRunner::start(const Studies::Campaign& campaign) {
  const MutexLock lock(mutex_);
  look();
  if (pid_ != 0) return Error{"a campaign is running already; stop it first"};
  const auto laboratory = find_laboratory();
  if (!laboratory) return Error{laboratory.error()};
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  for (const char* name : {kResult, kReport, kLog}) std::filesystem::remove(file(name), error);
  const auto pid = owners::spawn(
      {command_of(*laboratory, campaign, file(kResult).string(), file(kReport).string()),
       {},
       file(kLog)});
  if (!pid) return Error{pid.error()};
  pid_ = *pid;
  begin_ = Clock::now();
  last_ = {campaign, "running", 0, {}, "", false};
  return {};
}

void StudyRunner::stop() {
  const MutexLock lock(mutex_);
  look();
  if (pid_ == 0) return;
  kill(-pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
  pid_ = 0;
  last_->state = "stopped";
}

void StudyRunner::look() {
  if (pid_ == 0) return;
  last_->seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
  const auto log = read_text(file(kLog).string());
  if (log) last_->done = last_progress(*log);
  int status = 0;
  if (waitpid(pid_, &status, WNOHANG) != pid_) return;
  pid_ = 0;
  std::error_code error;
  // The result is written before the report, which needs Python.
  const bool is_done = std::filesystem::exists(file(kResult), error);
  const bool is_whole = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  last_->state = is_done ? "done" : "failed";
  last_->has_report = is_whole && std::filesystem::exists(file(kReport), error);
  if (!is_whole) last_->trouble = log ? after_progress(*log) : log.error();
}

std::optional<Studies::Progress> StudyRunner::progress() {
  const MutexLock lock(mutex_);
  look();
  return last_;
}

Expected<std::string> StudyRunner::finished(const char* name) {
  const MutexLock lock(mutex_);
  look();
  if (!last_ || last_->state != "done") return Error{"no campaign has ended well yet"};
  return read_text(file(name).string());
}

Expected<std::string> StudyRunner::result() { return finished(kResult); }

Expected<std::string> StudyRunner::report() { return finished(kReport); }

Studies StudyRunner::studies() {
  return {[this](const Studies::Campaign& campaign) { return start(campaign); }, [this] { stop(); },
          [this] { return progress(); }, [this] { return result(); }, [this] { return report(); }};
}

}  // namespace culprit::web
