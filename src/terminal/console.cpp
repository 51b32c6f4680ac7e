#include "terminal/console.h"

#include <cstdlib>
#include <mutex>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <fmt/core.h>

#include "knowledge/describe.h"

namespace culprit {
namespace {

struct Label {
  std::string_view text;
  std::string_view colour;
};

struct Labels {
  Label operator()(const FailureDetected&) const { return {"detected", "\033[1;31m"}; }
  Label operator()(const FailureResolved&) const { return {"resolved", "\033[1;32m"}; }
  Label operator()(const FailureLost&) const { return {"lost sight", "\033[33m"}; }
  Label operator()(const StrategyChosen&) const { return {"decided", "\033[1;36m"}; }
  Label operator()(const FailureHeldBack&) const { return {"waiting", "\033[2m"}; }
  Label operator()(const AdaptationDone&) const { return {"done", "\033[36m"}; }
  Label operator()(const AdaptationFailed&) const { return {"failed", "\033[33m"}; }
  Label operator()(const StrategyFailed&) const { return {"no help", "\033[33m"}; }
  Label operator()(const StrategyResumed&) const { return {"resumed", "\033[36m"}; }
  Label operator()(const Undone&) const { return {"undone", "\033[36m"}; }
  Label operator()(const RoundSpent&) const { return {"pause", "\033[33m"}; }
  Label operator()(const RuleExhausted&) const { return {"EXHAUSTED", "\033[1;31m"}; }
  Label operator()(const LastResortReached&) const { return {"LAST", "\033[1;31m"}; }
  Label operator()(const ComponentLost&) const { return {"lost", "\033[31m"}; }
  Label operator()(const ComponentFound&) const { return {"found", "\033[32m"}; }
  Label operator()(const NeverSeen&) const { return {"never seen", "\033[33m"}; }
  Label operator()(const LifecycleIntended&) const { return {"lifecycle", ""}; }
  Label operator()(const CameUp&) const { return {"came up", ""}; }
  Label operator()(const RivalSeen&) const { return {"RIVAL", "\033[1;33m"}; }
  Label operator()(const Trouble&) const { return {"trouble", "\033[33m"}; }
  Label operator()(const OrderAccepted&) const { return {"order", "\033[1;35m"}; }
  Label operator()(const OrderRefused&) const { return {"refused", "\033[35m"}; }
  Label operator()(const ActionHeldBack&) const { return {"held back", "\033[33m"}; }
  Label operator()(const ApprovalAsked&) const { return {"APPROVE?", "\033[1;35m"}; }
  Label operator()(const ApprovalLapsed&) const { return {"lapsed", "\033[35m"}; }
  Label operator()(const StrategyAbandoned&) const { return {"abandoned", "\033[33m"}; }
  Label operator()(const OrderCarriedOut&) const { return {"done", "\033[36m"}; }
  Label operator()(const OutcomePending&) const { return {"pending", ""}; }
  Label operator()(const OutcomeCounted&) const { return {"learned", ""}; }
  Label operator()(const FailureFlaps&) const { return {"FLAPPING", "\033[1;31m"}; }
  Label operator()(const SilenceEnded&) const { return {"silence", "\033[35m"}; }
  Label operator()(const StormBegan&) const { return {"STORM", "\033[1;31m"}; }
  Label operator()(const StormEnded&) const { return {"calm", "\033[32m"}; }
  Label operator()(const JudgementSuspended&) const { return {"DEAF", "\033[1;31m"}; }
  Label operator()(const JudgementResumed&) const { return {"hears", "\033[32m"}; }
  Label operator()(const SleepNoticed&) const { return {"slept", "\033[33m"}; }
};

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
  if (text.empty()) return "";
  const Label label = std::visit(Labels{}, event.what);
  const bool is_coloured = colour == Colour::kOn;
  return fmt::format("{:8.3f}  {}{:<10}{}  {}", seconds(event.at - start),
                     is_coloured ? label.colour : "", label.text, is_coloured ? "\033[0m" : "",
                     text);
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
  const std::lock_guard lock(mutex_);
  stop_ = std::move(stop);
  if (stopped_ && stop_) stop_();
}

void StopSignals::on_reload(std::function<void()> reload) {
  const std::lock_guard lock(mutex_);
  reload_ = std::move(reload);
}

void StopSignals::stop() {
  const std::lock_guard lock(mutex_);
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
    const std::lock_guard lock(mutex_);
    if (reload_) reload_();
  }
}

}  // namespace culprit
