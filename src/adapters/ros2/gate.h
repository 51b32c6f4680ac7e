// A callback's way to its owner: one at a time, and not after the owner's end.
//
// The middleware fetches its listener without holding it back, so a callback could still come in
// while its entity is being deleted. Every callback goes through this gate, and close() waits for
// the one inside.
#pragma once

#include "base/mutex.h"

namespace culprit::ros2 {

class Gate {
 public:
  template <class Callback>
  void pass(Callback&& callback) {
    const MutexLock lock(mutex_);
    if (open_) callback();
  }
  void close() {
    const MutexLock lock(mutex_);
    open_ = false;
  }

 private:
  Mutex mutex_;
  bool open_ CULPRIT_GUARDED_BY(mutex_) = true;
};

}  // namespace culprit::ros2
