// Independent pieces of work on several threads, whose results come out in order.
//
// The work ahead is bounded, so memory does not grow with the number of pieces.
#pragma once

#include <cstdint>
#include <optional>
#include <thread>
#include <vector>

#include "base/mutex.h"

namespace culprit::study {

// Calls `compute(i)` for i in [first, end) on `jobs` >= 1 threads, and `consume(i, result)` for
// each in ascending order on the calling thread. If `consume` gives false, no more work is begun.
// `compute` may be called from several threads at once.
template <class Compute, class Consume>
void work_in_order(std::uint64_t first, std::uint64_t end, unsigned jobs, Compute compute,
                   Consume consume) {
  using Result = decltype(compute(first));
  const std::uint64_t ahead = std::uint64_t{jobs} * 4;  // beyond what is consumed
  struct State {
    Mutex mutex{};
    ConditionVariable changed{};
    std::vector<std::optional<Result>> done CULPRIT_GUARDED_BY(mutex);  // i in place i % ahead
    std::uint64_t begun CULPRIT_GUARDED_BY(mutex);
    std::uint64_t consumed CULPRIT_GUARDED_BY(mutex);
    bool is_over CULPRIT_GUARDED_BY(mutex) = false;
  };
  State state{.done = std::vector<std::optional<Result>>(ahead), .begun = first, .consumed = first};

  const auto worker = [&] {
    for (MutexLock lock(state.mutex);;) {
      state.changed.wait(lock, [&]() CULPRIT_REQUIRES(state.mutex) {
        return state.is_over || state.begun == end || state.begun < state.consumed + ahead;
      });
      if (state.is_over || state.begun == end) return;
      const std::uint64_t mine = state.begun++;
      lock.unlock();
      Result result = compute(mine);
      lock.lock();
      state.done[mine % ahead] = std::move(result);
      state.changed.notify_all();
    }
  };
  std::vector<std::thread> threads;
  for (unsigned t = 0; t < jobs; ++t) threads.emplace_back(worker);

  for (std::uint64_t next = first; next < end; ++next) {
    MutexLock lock(state.mutex);
    state.changed.wait(
        lock, [&]() CULPRIT_REQUIRES(state.mutex) { return state.done[next % ahead].has_value(); });
    Result result = std::move(*state.done[next % ahead]);
    state.done[next % ahead].reset();
    state.consumed = next + 1;
    state.changed.notify_all();
    lock.unlock();
    if (!consume(next, std::move(result))) break;
  }
  {
    const MutexLock lock(state.mutex);
    state.is_over = true;
  }
  state.changed.notify_all();
  for (std::thread& thread : threads) thread.join();
}

}  // namespace culprit::study
