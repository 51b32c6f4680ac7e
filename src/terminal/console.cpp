#include "terminal/console.h"

#include <chrono>
#include <cstdlib>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <string_view>
#include <sys/time.h>
#include <unistd.h>

#include <fmt/core.h>

#include "base/name_grammar.h"
#include "knowledge/describe.h"

namespace culprit {
namespace {

std::string colour_code(Tone tone, Weight weight) {
  constexpr std::string_view kDim = "2";
  constexpr std::string_view kRed = "31";
  constexpr std::string_view kGreen = "32";
  constexpr std::string_view kYellow = "33";
  constexpr std::string_view kMagenta = "35";
  constexpr std::string_view kCyan = "36";
  const std::string_view colour = tone == Tone::kAlarm     ? kRed
                                  : tone == Tone::kRelief  ? kGreen
                                  : tone == Tone::kWarning ? kYellow
                                  : tone == Tone::kPerson  ? kMagenta
                                  : tone == Tone::kAction  ? kCyan
                                                           : kDim;
  return fmt::format("\033[{}{}m", weight == Weight::kStrong ? "1;" : "", colour);
}

// As in `culprit run my.rules | tee log`, the output may be none.
int first_terminal() {
  for (const int each : {STDOUT_FILENO, STDIN_FILENO, STDERR_FILENO}) {
    if (isatty(each) != 0) return each;
  }
  return -1;
}

bool is_ignored(int signal) {
  struct sigaction now {};
  return sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
}

sigset_t awaited(Hangup hangup) {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) sigaddset(&signals, signal);
  const bool stops = hangup == Hangup::kStops && !is_ignored(SIGHUP);
  if (stops || hangup == Hangup::kReloads) sigaddset(&signals, SIGHUP);
  return signals;
}

// A thread that ends the program could itself wait for what does not end; the kernel's timer does not. Only system
// calls are safe in here.
void leave_behind(int /*signal*/) {
  constexpr std::string_view kLastWords = "culprit: something does not end; it is left behind\n";
  const int flags = fcntl(STDERR_FILENO, F_GETFL);
  fcntl(STDERR_FILENO, F_SETFL, flags | O_NONBLOCK);
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kLastWords.data(), kLastWords.size());
  _exit(EXIT_FAILURE);
}

void leave_behind_after(Duration patience) {
  ::signal(SIGALRM, leave_behind);
  const auto all = std::chrono::ceil<std::chrono::microseconds>(patience).count();
  const itimerval timer{{0, 0}, {all / 1'000'000, all % 1'000'000}};
  setitimer(ITIMER_REAL, &timer, nullptr);
}

}  // namespace

Colour colour_of(int descriptor) {
  const bool wanted = std::getenv("NO_COLOR") == nullptr;
  return wanted && isatty(descriptor) != 0 ? Colour::kOn : Colour::kOff;
}

std::string line(const Event& event, const RuleSet& rules, Time start, Colour colour) {
  const std::string text = describe(event, rules);
  return text.empty() ? "" : line(words_of(event), event.at - start, text, colour);
}

std::string line(const EventWords& words, Duration after, const std::string& text, Colour colour) {
  return fmt::format("{:8.3f}  {}  {}", seconds(after), label_of(words, colour),
                     escape_controls(text));
}

std::string label_of(const EventWords& words, Colour colour) {
  return in_tone(fmt::format("{:<10}", words.label), words.tone, words.weight, colour);
}

std::string in_tone(const std::string& text, Tone tone, Weight weight, Colour colour) {
  return colour == Colour::kOn ? colour_code(tone, weight) + text + "\033[0m" : text;
}

void say_text(std::FILE* stream, const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stream);
  std::fflush(stream);
  std::clearerr(stream);
}

StopSignals::StopSignals(Hangup hangup) : hangup_(hangup), terminal_(first_terminal()) {
  ::signal(SIGPIPE, SIG_IGN);
  const sigset_t signals = awaited(hangup_);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  thread_ = std::thread([this] { wait(); });
}

StopSignals::~StopSignals() {
  is_over_ = true;
  pthread_kill(thread_.native_handle(), SIGUSR1);
  thread_.join();
}

void StopSignals::on_stop(std::function<void()> stop) {
  const MutexLock lock(mutex_);
  stop_ = std::move(stop);
  if (stopped_ && stop_) stop_();
}

void StopSignals::on_reload(std::function<void()> reload) {
  const MutexLock lock(mutex_);
  reload_ = std::move(reload);
}

void StopSignals::on_user_signal(std::function<void()> act) {
  const MutexLock lock(mutex_);
  user_ = std::move(act);
}

void StopSignals::stop() {
  if (patience_.load() != Duration::max() && !stopped_.exchange(true))
    leave_behind_after(patience_);
  const MutexLock lock(mutex_);
  stopped_ = true;
  stopped_.notify_all();
  if (stop_) stop_();
}

void StopSignals::wait() {
  const sigset_t signals = awaited(hangup_);
  while (true) {
    int signal = 0;
    sigwait(&signals, &signal);
    if (is_over_) return;
    if (signal == SIGUSR1) {
      const MutexLock lock(mutex_);
      if (user_) user_();
      continue;
    }
    const bool is_terminal_gone = terminal_ >= 0 && isatty(terminal_) == 0;
    if (signal != SIGHUP || hangup_ == Hangup::kStops || is_terminal_gone) {
      stop();
      continue;
    }
    const MutexLock lock(mutex_);
    if (reload_) reload_();
  }
}

}  // namespace culprit
