#include "terminal/console.h"

#include <cstdlib>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <fmt/core.h>

#include "knowledge/describe.h"

namespace culprit {
namespace {

std::string colour_code(const EventWords& words) {
  constexpr std::string_view kDim = "2";
  constexpr std::string_view kRed = "31";
  constexpr std::string_view kGreen = "32";
  constexpr std::string_view kYellow = "33";
  constexpr std::string_view kMagenta = "35";
  constexpr std::string_view kCyan = "36";
  const std::string_view colour = words.tone == Tone::kAlarm     ? kRed
                                  : words.tone == Tone::kRelief  ? kGreen
                                  : words.tone == Tone::kWarning ? kYellow
                                  : words.tone == Tone::kPerson  ? kMagenta
                                  : words.tone == Tone::kAction  ? kCyan
                                                                 : kDim;
  return fmt::format("\033[{}{}m", words.weight == Weight::kStrong ? "1;" : "", colour);
}

sigset_t awaited(Hangup hangup) {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) sigaddset(&signals, signal);
  if (hangup == Hangup::kReloads) sigaddset(&signals, SIGHUP);
  return signals;
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
  const bool is_coloured = colour == Colour::kOn;
  return fmt::format("{:8.3f}  {}{:<10}{}  {}", seconds(after),
                     is_coloured ? colour_code(words) : "", words.label,
                     is_coloured ? "\033[0m" : "", text);
}

void say_text(std::FILE* stream, const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stream);
  std::fflush(stream);
  std::clearerr(stream);
}

StopSignals::StopSignals(Hangup hangup)
    : hangup_(hangup), has_terminal_(isatty(STDOUT_FILENO) != 0) {
  ::signal(SIGPIPE, SIG_IGN);
  const sigset_t signals = awaited(hangup_);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  thread_ = std::thread([this] { wait(); });
}

StopSignals::~StopSignals() {
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

void StopSignals::stop() {
  const MutexLock lock(mutex_);
  stopped_ = true;
  stopped_.notify_all();
  if (stop_) stop_();
}

// Waits for it; once the program is to end, not for ever.
int StopSignals::next_signal() {
  const sigset_t signals = awaited(hangup_);
  int signal = 0;
  if (!stopped_ || patience_.load() == Duration::max()) {
    sigwait(&signals, &signal);
    return signal;
  }
  const Duration patience = patience_;
  const timespec limit{patience.count() / 1'000'000'000, patience.count() % 1'000'000'000};
  while ((signal = sigtimedwait(&signals, nullptr, &limit)) < 0 && errno == EINTR) {
  }
  if (signal > 0) return signal;
  fmt::print(stderr, "culprit: something does not end; it is left behind\n");
  std::fflush(nullptr);
  std::_Exit(1);
}

void StopSignals::wait() {
  while (true) {
    const int signal = next_signal();
    if (signal == SIGUSR1) return;
    const bool is_terminal_gone = has_terminal_ && isatty(STDOUT_FILENO) == 0;
    if (signal != SIGHUP || is_terminal_gone) {
      stop();
      continue;
    }
    const MutexLock lock(mutex_);
    if (reload_) reload_();
  }
}

}  // namespace culprit
