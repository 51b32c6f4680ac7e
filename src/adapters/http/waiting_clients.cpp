#include "http/waiting_clients.h"

#include <algorithm>
#include <sys/socket.h>
#include <tuple>

namespace culprit::http {

WaitingClients::Connection::Connection(WaitingClients& all, int socket)
    : all_(all), socket_(socket) {
  const MutexLock lock(all_.mutex_);
  all_.waits_[socket_] = {For::kRequest, Clock::now()};
}

WaitingClients::Connection::~Connection() {
  const MutexLock lock(all_.mutex_);
  all_.waits_.erase(socket_);
}

void WaitingClients::Connection::waits(For what, Clock::time_point since) {
  const MutexLock lock(all_.mutex_);
  Wait& own = all_.waits_[socket_];
  own.what = what;
  own.since = since;
}

void WaitingClients::Connection::spare() {
  const MutexLock lock(all_.mutex_);
  all_.waits_[socket_].is_spared = true;
}

void WaitingClients::Connection::begin_request() {
  const MutexLock lock(all_.mutex_);
  Wait& own = all_.waits_[socket_];
  own.what = For::kRequest;
  own.since = Clock::now();
  own.is_spared = false;
}

bool WaitingClients::end_one(Clock::time_point now) {
  const MutexLock lock(mutex_);
  const auto may_end = [&](const Wait& wait) {
    if (wait.is_spared || wait.is_ended) return false;
    return wait.what == For::kRequest ||
           (wait.what == For::kAnswer && now - wait.since >= kAnswerPatience);
  };
  const auto rank = [&](const Wait& wait) {
    return std::tuple(!may_end(wait), wait.what, wait.since);
  };
  const auto first =
      std::ranges::min_element(waits_, {}, [&](const auto& each) { return rank(each.second); });
  if (first == waits_.end() || !may_end(first->second)) return false;
  first->second.is_ended = true;
  shutdown(first->first, SHUT_RDWR);
  return true;
}

}  // namespace culprit::http
