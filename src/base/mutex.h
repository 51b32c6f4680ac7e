// A mutex whose members clang checks: what CULPRIT_GUARDED_BY names may be touched only by who holds
// it, or the presets that clang builds do not compile (-Wthread-safety).
//
//     class Counter {
//       void add() { const MutexLock lock(mutex_); ++count_; }
//       void add_locked() CULPRIT_REQUIRES(mutex_);   // by who holds it
//       Mutex mutex_;
//       int count_ CULPRIT_GUARDED_BY(mutex_) = 0;
//     };
//
// std::mutex itself carries no annotations in libstdc++, hence these three around it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

#ifdef __clang__
#define CULPRIT_THREAD_ATTRIBUTE(attribute) __attribute__((attribute))
#else
#define CULPRIT_THREAD_ATTRIBUTE(attribute)
#endif
#define CULPRIT_GUARDED_BY(mutex) CULPRIT_THREAD_ATTRIBUTE(guarded_by(mutex))
#define CULPRIT_REQUIRES(mutex) CULPRIT_THREAD_ATTRIBUTE(requires_capability(mutex))
#define CULPRIT_ACQUIRES(...) CULPRIT_THREAD_ATTRIBUTE(acquire_capability(__VA_ARGS__))
#define CULPRIT_RELEASES(...) CULPRIT_THREAD_ATTRIBUTE(release_capability(__VA_ARGS__))
// For what the analysis cannot follow; say why beside it.
#define CULPRIT_NOT_ANALYZED CULPRIT_THREAD_ATTRIBUTE(no_thread_safety_analysis)

namespace culprit {

class CULPRIT_THREAD_ATTRIBUTE(capability("mutex")) Mutex {
 public:
  void lock() CULPRIT_ACQUIRES() CULPRIT_NOT_ANALYZED { mutex_.lock(); }
  // Whether it was free; who gets it adopts it: `const MutexLock lock(mutex, std::adopt_lock);`
  bool try_lock() CULPRIT_THREAD_ATTRIBUTE(try_acquire_capability(true)) CULPRIT_NOT_ANALYZED {
    return mutex_.try_lock();
  }
  void unlock() CULPRIT_RELEASES() CULPRIT_NOT_ANALYZED { mutex_.unlock(); }

 private:
  friend class MutexLock;
  std::mutex mutex_;
};

// Holds a mutex until it goes out of scope; may let go of it in between.
class CULPRIT_THREAD_ATTRIBUTE(scoped_lockable) MutexLock {
 public:
  explicit MutexLock(Mutex& mutex) CULPRIT_ACQUIRES(mutex) : lock_(mutex.mutex_) {}
  MutexLock(Mutex& mutex, std::adopt_lock_t held) CULPRIT_REQUIRES(mutex)
      : lock_(mutex.mutex_, held) {}
  ~MutexLock() CULPRIT_RELEASES() = default;
  MutexLock(const MutexLock&) = delete;
  MutexLock& operator=(const MutexLock&) = delete;

  void lock() CULPRIT_ACQUIRES() CULPRIT_NOT_ANALYZED { lock_.lock(); }
  void unlock() CULPRIT_RELEASES() CULPRIT_NOT_ANALYZED { lock_.unlock(); }

 private:
  friend class ConditionVariable;
  std::unique_lock<std::mutex> lock_;
};

// std::condition_variable for a MutexLock. A predicate that reads what the mutex guards says so itself:
//
//     changed_.wait(lock, [&]() CULPRIT_REQUIRES(mutex_) { return count_ > 0; });
class ConditionVariable {
 public:
  void notify_one() { condition_.notify_one(); }
  void notify_all() { condition_.notify_all(); }

  void wait(MutexLock& lock) { condition_.wait(lock.lock_); }
  // Which mutex the predicates want is not known here; the lock holds it.
  template <class Predicate>
  void wait(MutexLock& lock, Predicate is_over) CULPRIT_NOT_ANALYZED {
    condition_.wait(lock.lock_, is_over);
  }
  template <class Number, class Period>
  std::cv_status wait_for(MutexLock& lock, const std::chrono::duration<Number, Period>& patience) {
    return condition_.wait_for(lock.lock_, patience);
  }
  template <class Clock, class Span>
  std::cv_status wait_until(MutexLock& lock, const std::chrono::time_point<Clock, Span>& end) {
    return condition_.wait_until(lock.lock_, end);
  }
  template <class Clock, class Span, class Predicate>
  bool wait_until(MutexLock& lock, const std::chrono::time_point<Clock, Span>& end,
                  Predicate is_over) CULPRIT_NOT_ANALYZED {
    return condition_.wait_until(lock.lock_, end, is_over);
  }
  template <class Number, class Period, class Predicate>
  bool wait_for(MutexLock& lock, const std::chrono::duration<Number, Period>& patience,
                Predicate is_over) CULPRIT_NOT_ANALYZED {
    return condition_.wait_for(lock.lock_, patience, is_over);
  }

 private:
  std::condition_variable condition_;
};

}  // namespace culprit
