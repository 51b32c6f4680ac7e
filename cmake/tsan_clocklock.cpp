// Linked into the tests under the thread sanitizer only. Fast DDS takes some of its locks with a
// time limit, by pthread_mutex_clocklock(), which the sanitizer does not know (clang 14): what such
// a lock guards looked like a race now and then. It does know pthread_mutex_timedlock().

#include <cerrno>
#include <ctime>
#include <pthread.h>

extern "C" int pthread_mutex_clocklock(pthread_mutex_t* mutex, clockid_t clock,
                                       const timespec* until) {
  constexpr long kSecond = 1'000'000'000;  // nanoseconds
  timespec now{};
  timespec at{};
  if (clock_gettime(clock, &now) != 0 || clock_gettime(CLOCK_REALTIME, &at) != 0) return EINVAL;
  at.tv_sec += until->tv_sec - now.tv_sec;
  at.tv_nsec += until->tv_nsec - now.tv_nsec;
  if (at.tv_nsec < 0) at = {at.tv_sec - 1, at.tv_nsec + kSecond};
  if (at.tv_nsec >= kSecond) at = {at.tv_sec + 1, at.tv_nsec - kSecond};
  return pthread_mutex_timedlock(mutex, &at);
}
