// Independent pieces of work on several threads, whose results come out in order.
//
// What is done ahead is bounded, so memory does not grow with the number of pieces.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace culprit::study {

// Calls `compute(i)` for i in [first, end) on `jobs` >= 1 threads, and `consume(i, result)` for
// each in ascending order on the calling thread. If `consume` gives false, no more work is begun.
// `compute` may be called from several threads at once.
template <class Compute, class Consume>
void work_in_order(std::uint64_t first, std::uint64_t end, unsigned jobs, Compute compute,
                   Consume consume) {
  using Result = decltype(compute(first));
  const std::uint64_t ahead = std::uint64_t{jobs} * 4;  // beyond what is consumed
  std::mutex mutex;                                     // guards what follows
  std::condition_variable changed;
  std::vector<std::optional<Result>> done(ahead);  // result i in place i % ahead
  std::uint64_t begun = first;
  std::uint64_t consumed = first;
  bool is_over = false;

  const auto worker = [&] {
    for (std::unique_lock lock(mutex);;) {
      changed.wait(lock, [&] { return is_over || begun == end || begun < consumed + ahead; });
      if (is_over || begun == end) return;
      const std::uint64_t mine = begun++;
      lock.unlock();
      Result result = compute(mine);
      lock.lock();
      done[mine % ahead] = std::move(result);
      changed.notify_all();
    }
  };
  std::vector<std::thread> threads;
  for (unsigned t = 0; t < jobs; ++t) threads.emplace_back(worker);

  for (std::uint64_t next = first; next < end; ++next) {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return done[next % ahead].has_value(); });
    Result result = std::move(*done[next % ahead]);
    done[next % ahead].reset();
    consumed = next + 1;
    changed.notify_all();
    lock.unlock();
    if (!consume(next, std::move(result))) break;
  }
  {
    const std::lock_guard lock(mutex);
    is_over = true;
  }
  changed.notify_all();
  for (std::thread& thread : threads) thread.join();
}

}  // namespace culprit::study
