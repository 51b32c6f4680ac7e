#include "rtps/receive_thread.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <deque>
#include <string>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>

#include "base/invariant.h"

namespace culprit::rtps {
namespace {

constexpr std::uint32_t kReadable = EPOLLIN;
constexpr std::uint64_t kToEnd = ~std::uint64_t{0};
// The most batches from one patient socket in one turn: a flood must not keep the others waiting
// for good.
constexpr int kMostBatches = 64;
// More datagrams than this within kWatched: they no longer wake the thread, which looks instead.
constexpr std::chrono::seconds kWatched{1};
constexpr std::size_t kMany = 20;
// Between two looks no more than this share of its buffer should arrive at a socket. The buffer has
// 416 KiB by default (net.core.rmem_max). For each datagram the kernel counts about kEach beside
// its content.
constexpr double kMuch = 0.5;
constexpr std::size_t kEach = 1024;

// Bytes as the kernel counts them: twice what was asked for.
std::size_t room_of(int descriptor) {
  int room = 0;
  socklen_t size = sizeof room;
  getsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &room, &size);
  return static_cast<std::size_t>(std::max(room, 1));
}

Error refused(const char* what) { return Error{std::string(what) + ": " + std::strerror(errno)}; }

}  // namespace

struct ReceiveThread::Socket {
  // `all_dropped`: of all sockets.
  Socket(int fd, const Place& place, OnDatagram callback, std::atomic<std::uint64_t>& all_dropped)
      : descriptor(fd),
        room(room_of(fd)),
        port(place.port),
        largest(std::min(place.largest, kLargest)),
        has_time(place.has_time),
        on_datagram(std::move(callback)),
        dropped(all_dropped),
        is_patient(place.haste == Haste::kSoon) {}
  ~Socket() { ::close(descriptor); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  const int descriptor;
  const std::size_t room;
  const std::uint16_t port;
  const std::uint32_t largest;
  const HasTime has_time;
  const OnDatagram on_datagram;
  std::atomic<std::uint64_t>& dropped;
  std::uint32_t dropped_here = 0;         // as the kernel counts, which begins anew after 2^32
  bool is_patient;                        // guarded by the mutex of the thread's owner
  Clock::time_point busy = Clock::now();  // when something came last that has no time
  bool is_calm = false;                   // something came since, and has

  // Taken, and not handed on yet. Used by the thread only.
  struct Kept {
    UdpAddress from;
    SystemTime received;
    std::uint32_t dropped;  // before it
    std::vector<std::uint8_t> bytes;
  };
  std::deque<Kept> kept;
  std::size_t kept_bytes = 0;  // with the overhead of each datagram, which may be empty

  static std::size_t bytes_of(const Kept& each) { return sizeof(Kept) + each.bytes.size(); }

  void hand_on(const Datagram& datagram, std::uint32_t dropped_before) {
    const std::uint32_t more = dropped_before - dropped_here;
    if (static_cast<std::int32_t>(more) > 0) {
      dropped += more;
      dropped_here = dropped_before;
    }
    on_datagram(datagram);
  }

  void look_at(std::span<const std::uint8_t> datagram) {
    if (!has_time) return;
    is_calm = has_time(datagram);
    if (!is_calm) busy = Clock::now();
  }
};

// The datagrams that were taken from a socket at once. Its memory is touched only as far as
// datagrams reach.
class ReceiveThread::Batch {
 public:
  Batch() : bytes_(std::make_unique_for_overwrite<std::uint8_t[]>(kBatch * kLargest)) {
    for (std::size_t i = 0; i < kBatch; ++i) {
      places_[i] = {bytes_.get() + i * kLargest, kLargest};
      messages_[i].msg_hdr = {};
      messages_[i].msg_hdr.msg_iov = &places_[i];
      messages_[i].msg_hdr.msg_iovlen = 1;
      messages_[i].msg_hdr.msg_name = &senders_[i];
    }
  }

  // Gives whether there may be more.
  bool take(const Socket& socket) {
    for (std::size_t i = 0; i < kBatch; ++i) {
      places_[i].iov_len = socket.largest;
      messages_[i].msg_hdr.msg_namelen = sizeof(sockaddr_in);
      messages_[i].msg_hdr.msg_control = &notes_[i];
      messages_[i].msg_hdr.msg_controllen = sizeof(Note);
    }
    const int count = recvmmsg(socket.descriptor, messages_.data(), kBatch, MSG_DONTWAIT, nullptr);
    count_ = count < 0 ? 0 : static_cast<std::size_t>(count);
    taken_ = std::chrono::system_clock::now();
    return count_ == kBatch;
  }
  std::size_t count() const { return count_; }
  std::size_t room_taken() const {
    std::size_t room = count_ * kEach;
    for (std::size_t i = 0; i < count_; ++i) room += messages_[i].msg_len;
    return room;
  }
  void hand_to(Socket& socket) {
    for (std::size_t i = 0; i < count_; ++i) {
      socket.look_at(bytes(i));
      const Notes notes = notes_of(i);
      socket.hand_on({bytes(i), sender(i), notes.received}, notes.dropped);
    }
  }
  void keep_for(Socket& socket) {
    for (std::size_t i = 0; i < count_; ++i) {
      const auto all = bytes(i);
      socket.look_at(all);
      const Notes notes = notes_of(i);
      socket.kept.push_back({sender(i), notes.received, notes.dropped, {all.begin(), all.end()}});
      socket.kept_bytes += Socket::bytes_of(socket.kept.back());
    }
  }

 private:
  // Room for the notes of the kernel beside a datagram.
  struct Note {
    static constexpr std::size_t kSize =
        CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t));
    alignas(cmsghdr) std::array<std::uint8_t, kSize> bytes;
  };
  struct Notes {
    SystemTime received;        // for a socket that has time
    std::uint32_t dropped = 0;  // of this socket, before it
  };

  std::span<std::uint8_t> bytes(std::size_t i) {
    CULPRIT_ASSERT(i < count_ && messages_[i].msg_len <= kLargest);
    return {bytes_.get() + i * kLargest, messages_[i].msg_len};
  }
  UdpAddress sender(std::size_t i) const {
    UdpAddress from;
    std::memcpy(from.ip.data(), &senders_[i].sin_addr, from.ip.size());
    from.port = ntohs(senders_[i].sin_port);
    return from;
  }

  Notes notes_of(std::size_t i) {
    Notes notes{taken_};
    msghdr& head = messages_[i].msg_hdr;
    for (cmsghdr* each = CMSG_FIRSTHDR(&head); each != nullptr; each = CMSG_NXTHDR(&head, each)) {
      if (each->cmsg_level != SOL_SOCKET) continue;
      if (each->cmsg_type == SO_RXQ_OVFL)
        std::memcpy(&notes.dropped, CMSG_DATA(each), sizeof notes.dropped);
      if (each->cmsg_type != SCM_TIMESTAMPNS) continue;
      timespec when{};
      std::memcpy(&when, CMSG_DATA(each), sizeof when);
      notes.received =
          SystemTime(std::chrono::seconds(when.tv_sec) + std::chrono::nanoseconds(when.tv_nsec));
    }
    return notes;
  }

  const std::unique_ptr<std::uint8_t[]> bytes_;
  std::array<Note, kBatch> notes_{};
  SystemTime taken_{};
  std::array<sockaddr_in, kBatch> senders_{};
  std::array<iovec, kBatch> places_{};
  std::array<mmsghdr, kBatch> messages_{};
  std::size_t count_ = 0;
};

ReceiveThread::ReceiveThread() : wait_fd_(epoll_create1(EPOLL_CLOEXEC)) {
  epoll_event event{};
  event.events = kReadable;
  event.data.u64 = kToEnd;
  epoll_ctl(wait_fd_, EPOLL_CTL_ADD, end_.descriptor(), &event);
}

ReceiveThread::~ReceiveThread() {
  end_.wake();
  if (thread_.joinable()) thread_.join();
  ::close(wait_fd_);
}

Expected<void> ReceiveThread::open(const Place& place, OnDatagram on_datagram) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return refused("no socket");
  const int wanted = 1;
  const int buffer = static_cast<int>(place.buffer);
  if (buffer > 0) setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer);
  auto made = std::make_shared<Socket>(descriptor, place, std::move(on_datagram), dropped_);
  setsockopt(descriptor, SOL_SOCKET, SO_RXQ_OVFL, &wanted, sizeof wanted);
  if (place.haste == Haste::kSoon)
    setsockopt(descriptor, SOL_SOCKET, SO_TIMESTAMPNS, &wanted, sizeof wanted);
  if (place.is_shared) setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &wanted, sizeof wanted);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr = place.ip;
  address.sin_port = htons(place.port);
  if (bind(descriptor, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0)
    return refused("cannot listen there");
  const MutexLock lock(mutex_);
  epoll_event event{};
  event.events = !made->is_patient || is_armed_ ? kReadable : 0;
  event.data.u64 = static_cast<std::uint64_t>(descriptor);
  if (epoll_ctl(wait_fd_, EPOLL_CTL_ADD, descriptor, &event) != 0)
    return refused("cannot wait for what comes there");
  sockets_.push_back(std::move(made));
  if (!thread_.joinable()) {
    thread_ = std::thread([this] { run(); });
    pthread_setname_np(thread_.native_handle(), kName);
  }
  return {};
}

void ReceiveThread::close(std::uint16_t port) {
  Sockets closed;  // for good, when no round uses them any more
  MutexLock lock(mutex_);
  for (auto& each : sockets_) {
    if (each->port != port) continue;
    epoll_ctl(wait_fd_, EPOLL_CTL_DEL, each->descriptor, nullptr);
    closed.push_back(std::move(each));
  }
  std::erase(sockets_, nullptr);
  const std::uint64_t round = rounds_;
  if (round % 2 == 1)
    round_ended_.wait(lock, [&]() CULPRIT_REQUIRES(mutex_) { return rounds_ != round; });
}

bool ReceiveThread::is_open(std::uint16_t port) const {
  const MutexLock lock(mutex_);
  return std::ranges::any_of(sockets_, [&](const auto& each) { return each->port == port; });
}

void ReceiveThread::join(std::uint16_t port, in_addr group, in_addr interface) {
  const MutexLock lock(mutex_);
  for (const auto& each : sockets_) {
    const ip_mreq wanted{group, interface};
    if (each->port == port)
      setsockopt(each->descriptor, IPPROTO_IP, IP_ADD_MEMBERSHIP, &wanted, sizeof wanted);
  }
}

void ReceiveThread::begin_hurry() {
  const MutexLock lock(mutex_);
  ++hurried_;
  if (!is_armed_) arm(true);
}

void ReceiveThread::end_hurry() {
  const MutexLock lock(mutex_);
  CULPRIT_ASSERT(hurried_ > 0);
  --hurried_;
}

void ReceiveThread::on_round(std::function<void()> on_round) {
  const MutexLock lock(mutex_);
  on_round_ = std::make_shared<const std::function<void()>>(std::move(on_round));
}

void ReceiveThread::look_at_sockets(
    const std::function<void(std::span<const int> descriptors)>& look) const {
  const MutexLock lock(mutex_);
  std::vector<int> descriptors;
  for (const auto& each : sockets_) descriptors.push_back(each->descriptor);
  look(descriptors);
}

// ---- the thread

void ReceiveThread::run() {
  Batch batch;
  Batch patient_batch;
  std::array<epoll_event, 16> events{};
  bool has_kept = false;
  while (true) {
    bool looks = false;
    {
      const MutexLock lock(mutex_);
      looks = !is_armed_;
    }
    const int patience = has_kept ? 0 : looks ? static_cast<int>(next_look_.count()) : -1;
    const int count =
        epoll_wait(wait_fd_, events.data(), static_cast<int>(events.size()), patience);
    Sockets urgent;
    Sockets patient;
    std::shared_ptr<const std::function<void()>> on_round;
    {
      const MutexLock lock(mutex_);
      for (int i = 0; i < count; ++i) {
        const std::uint64_t which = events[static_cast<std::size_t>(i)].data.u64;
        if (which == kToEnd) return;
        const auto ready = std::ranges::find_if(sockets_, [&](const auto& each) {
          return static_cast<std::uint64_t>(each->descriptor) == which;
        });
        if (ready == sockets_.end()) continue;
        const bool has_turn = !(*ready)->kept.empty();  // in any case
        if (!(*ready)->is_patient && !has_turn) urgent.push_back(*ready);
      }
      std::ranges::copy_if(sockets_, std::back_inserter(urgent),
                           [](const auto& each) { return !each->kept.empty(); });
      std::ranges::copy_if(sockets_, std::back_inserter(patient),
                           [](const auto& each) { return each->is_patient; });
      watch_patient(Clock::now());
      on_round = on_round_;
      ++rounds_;
    }
    if (urgent.empty()) take_patient(patient, patient_batch);
    has_kept = false;
    for (const auto& each : urgent) {
      take_urgent(*each, batch, patient, patient_batch);
      has_kept = has_kept || !each->kept.empty();
    }
    urgent.clear();
    patient.clear();
    if (on_round) (*on_round)();
    {
      const MutexLock lock(mutex_);
      ++rounds_;
      CULPRIT_ASSERT(rounds_ % 2 == 0);  // close() would take a socket that is in use
      calm(Clock::now());
    }
    round_ended_.notify_all();
  }
}

void ReceiveThread::take_urgent(Socket& socket, Batch& batch, const Sockets& patient,
                                Batch& patient_batch) {
  bool has_more = batch.take(socket);
  if (!has_more && socket.kept.empty()) {
    take_patient(patient, patient_batch);
    batch.hand_to(socket);
    return;
  }
  batch.keep_for(socket);
  while (has_more && socket.kept_bytes < kMostKept) {
    has_more = batch.take(socket);
    batch.keep_for(socket);
  }
  take_patient(patient, patient_batch);
  for (std::size_t i = 0; i < kBatch && !socket.kept.empty(); ++i) {
    Socket::Kept first = std::move(socket.kept.front());
    socket.kept.pop_front();
    CULPRIT_ASSERT(Socket::bytes_of(first) <= socket.kept_bytes);
    socket.kept_bytes -= Socket::bytes_of(first);
    socket.hand_on({first.bytes, first.from, first.received}, first.dropped);
  }
}

// All that came to them so far.
void ReceiveThread::take_patient(const Sockets& patient, Batch& batch) {
  double most = 0;
  for (const auto& each : patient) {
    std::size_t room = 0;
    bool has_more = true;
    for (int i = 0; has_more && i < kMostBatches; ++i) {
      has_more = batch.take(*each);
      batch.hand_to(*each);
      room += batch.room_taken();
      came_ += batch.count();
    }
    most = std::max(most, static_cast<double>(room) / static_cast<double>(each->room));
  }
  share_taken_ += most;
  next_look_ = most > kMuch ? kSoonest : often_;
}

void ReceiveThread::watch_patient(Clock::time_point now) {
  if (came_ > kMany && is_armed_ && hurried_ == 0) {
    next_look_ = often_ = kSoonest;
    arm(false);
  }
  const Clock::duration since = now - watched_;
  if (since < kWatched) return;
  if (came_ <= kMany && !is_armed_) arm(true);
  const auto until_much = since * (kMuch / std::max(share_taken_, kMuch));
  often_ = std::clamp(std::chrono::duration_cast<std::chrono::milliseconds>(until_much), kSoonest,
                      kSoon);
  watched_ = now;
  came_ = 0;
  share_taken_ = 0;
}

void ReceiveThread::arm(bool is_armed) {
  is_armed_ = is_armed;
  for (const auto& each : sockets_) {
    if (each->is_patient) wake_for(*each);
  }
}

void ReceiveThread::wake_for(const Socket& socket) {
  epoll_event event{};
  event.events = !socket.is_patient || is_armed_ ? kReadable : 0;
  event.data.u64 = static_cast<std::uint64_t>(socket.descriptor);
  epoll_ctl(wait_fd_, EPOLL_CTL_MOD, socket.descriptor, &event);
}

void ReceiveThread::calm(Clock::time_point now) {
  for (const auto& each : sockets_) {
    if (!each->has_time) continue;
    const bool has_time = each->is_calm && now - each->busy >= kCalm && each->kept.empty();
    if (std::exchange(each->is_patient, has_time) != has_time) wake_for(*each);
  }
}

}  // namespace culprit::rtps
