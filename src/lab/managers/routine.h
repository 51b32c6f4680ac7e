// A program's thread as a coroutine in virtual time.
//
// It goes on until it has to wait (ScriptedManager has what it can wait for) and is taken up again
// where it was. A routine that awaits another one goes on when that one is done.
#pragma once

#include <coroutine>
#include <exception>
#include <utility>

namespace culprit::study {

class [[nodiscard]] Routine {
 public:
  struct promise_type;
  using Handle = std::coroutine_handle<promise_type>;

  struct Final {
    bool await_ready() const noexcept { return false; }
    std::coroutine_handle<> await_suspend(Handle self) const noexcept {
      if (self.promise().caller) return self.promise().caller;
      return std::noop_coroutine();
    }
    void await_resume() const noexcept {}
  };

  struct promise_type {
    std::coroutine_handle<> caller;  // that awaits the routine; null: nobody

    Routine get_return_object() { return Routine(Handle::from_promise(*this)); }
    std::suspend_always initial_suspend() const noexcept { return {}; }
    Final final_suspend() const noexcept { return {}; }
    void return_void() const noexcept {}
    void unhandled_exception() const noexcept { std::terminate(); }
  };

  Routine(Routine&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  Routine& operator=(Routine&&) = delete;
  ~Routine() {
    if (handle_) handle_.destroy();
  }

  // Begins it. For routines without a co_await.
  void begin() const { handle_.resume(); }

  bool await_ready() const noexcept { return false; }
  Handle await_suspend(std::coroutine_handle<> caller) const noexcept {
    handle_.promise().caller = caller;
    return handle_;
  }
  void await_resume() const noexcept {}

 private:
  explicit Routine(Handle handle) : handle_(handle) {}

  Handle handle_;
};

}  // namespace culprit::study
