// culprit's output on the terminal, and its signals to stop.
#pragma once

#include <atomic>
#include <cstdio>
#include <functional>
#include <string>
#include <thread>
#include <utility>

#include <fmt/core.h>

#include "base/mutex.h"
#include "knowledge/event_words.h"
#include "language/diagnostic.h"

namespace culprit {

// Colour where a person reads, plain text where a program does.
Colour colour_of(int descriptor);

// One event as a line with its time since `start`: "   3.214  detected   RGBDead (ERROR)". Empty
// for events that are not worth one.
std::string line(const Event& event, const RuleSet& rules, Time start, Colour colour);
// The same for any event with such words. Control characters in it are escaped.
std::string line(const EventWords& words, Duration after, const std::string& text, Colour colour);

// The label of an event, as wide as all are.
std::string label_of(const EventWords& words, Colour colour);
std::string in_tone(const std::string& text, Tone tone, Weight weight, Colour colour);

// Prints at once. A closed pipe or a full disk must not keep culprit from managing a robot: output
// that cannot be written is dropped.
void say_text(std::FILE* stream, const std::string& text);
template <class... Args>
void say(std::FILE* stream, fmt::format_string<Args...> format, Args&&... args) {
  say_text(stream, fmt::format(format, std::forward<Args>(args)...));
}

// What SIGHUP means. kEnds: the terminal is gone, and the program ends at once. kStops: it stops as
// on SIGTERM, unless SIGHUP was ignored (nohup). kReloads: the program reads its files anew.
enum class Hangup : std::uint8_t { kEnds, kStops, kReloads };

// Waits for SIGINT and SIGTERM on a thread of its own and then calls `stop`, once. Blocks these
// signals in this thread and in all that it creates from now on: make one first of all. From then
// on SIGPIPE is ignored: who reads the output may go, and the program goes on.
class StopSignals {
 public:
  explicit StopSignals(Hangup hangup = Hangup::kEnds);
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;

  // `stop` is called when a signal comes, on another thread. If one came already, it is called at
  // once.
  void on_stop(std::function<void()> stop);
  // `reload` is called on SIGHUP, if that means to reload; on another thread. A SIGHUP because the
  // terminal is gone still stops.
  void on_reload(std::function<void()> reload);
  // `act` is called on SIGUSR1, on another thread. Without it SIGUSR1 does nothing.
  void on_user_signal(std::function<void()> act);
  // If the program has not ended within this time after the first signal to stop, it is ended the hard way (exit code 1). So no thread that waits for a disk, a
  // terminal or a lock can hold it up.
  void end_within(Duration patience) { patience_ = patience; }
  const std::atomic<bool>& stopped() const { return stopped_; }
  // For commands that have nothing else to wait for.
  void wait_until_stopped() const { stopped_.wait(false); }

 private:
  void wait();
  void stop();

  const Hangup hangup_;
  std::atomic<bool> is_over_ = false;
  std::atomic<Duration> patience_ = Duration::max();
  const int
      terminal_;  // of standard input, output and error, the first that is one at the start; -1: none is
  std::atomic<bool> stopped_ = false;
  Mutex mutex_;
  std::function<void()> stop_ CULPRIT_GUARDED_BY(mutex_);
  std::function<void()> reload_ CULPRIT_GUARDED_BY(mutex_);
  std::function<void()> user_ CULPRIT_GUARDED_BY(mutex_);
  std::thread thread_;
};

}  // namespace culprit
