#include "rtps/test_network.h"

#include <algorithm>
#include <arpa/inet.h>
#include <cstring>
#include <fcntl.h>
#include <linux/if_tun.h>
#include <poll.h>
#include <sched.h>
#include <stdexcept>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <net/if.h>

#include "base/live_clock.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;

constexpr const char* kDevice = "cable";
constexpr int kMtu = 65000;  // a message is one frame, as on a loopback
constexpr std::size_t kLongestFrame = 66000;

Error failed(const std::string& what) { return Error{what + ": " + std::strerror(errno)}; }

int own_space() { return ::open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC); }

// A request about a network device, in the namespace of the calling thread.
class DeviceRequest {
 public:
  explicit DeviceRequest(const char* device)
      : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    std::strncpy(request_.ifr_name, device, IFNAMSIZ - 1);
  }
  ~DeviceRequest() { ::close(socket_); }
  DeviceRequest(const DeviceRequest&) = delete;
  DeviceRequest& operator=(const DeviceRequest&) = delete;

  bool set_mtu(int mtu) {
    request_.ifr_mtu = mtu;
    return ioctl(socket_, SIOCSIFMTU, &request_) == 0;
  }
  bool set_address(const char* address, const char* mask) {
    return set_address(SIOCSIFADDR, address) && set_address(SIOCSIFNETMASK, mask);
  }
  bool bring_up() {
    if (ioctl(socket_, SIOCGIFFLAGS, &request_) != 0) return false;
    request_.ifr_flags = static_cast<short>(request_.ifr_flags | IFF_UP | IFF_MULTICAST);
    return ioctl(socket_, SIOCSIFFLAGS, &request_) == 0;
  }

 private:
  bool set_address(unsigned long what, const char* text) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    inet_pton(AF_INET, text, &address.sin_addr);
    std::memcpy(&request_.ifr_addr, &address, sizeof address);
    return ioctl(socket_, what, &request_) == 0;
  }

  int socket_;
  ifreq request_{};
};

// In the namespace of the calling thread. Gives the file that frames are read from and written to.
Expected<int> open_device(const char* address) {
  const int tap = ::open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (tap < 0) return failed("/dev/net/tun");
  ifreq request{};
  std::strncpy(request.ifr_name, kDevice, IFNAMSIZ - 1);
  request.ifr_flags = IFF_TAP | IFF_NO_PI;
  DeviceRequest device(kDevice);
  if (ioctl(tap, TUNSETIFF, &request) == 0 && device.set_mtu(kMtu) &&
      device.set_address(address, "255.255.255.0") && device.bring_up() &&
      DeviceRequest("lo").bring_up())
    return tap;
  const Error error = failed("cannot set up a network device");
  ::close(tap);
  return error;
}

}  // namespace

Expected<std::unique_ptr<TestNetwork>> TestNetwork::create() {
  std::unique_ptr<TestNetwork> network(new TestNetwork);
  for (const Computer computer : {kRobot, kDesk}) {
    if (auto opened = network->open(computer); !opened) return Error{opened.error()};
  }
  network->cable_ = std::thread([n = network.get()] { n->carry(); });
  return network;
}

TestNetwork::~TestNetwork() {
  is_over_ = true;
  if (cable_.joinable()) cable_.join();
  for (const End& end : ends_) {
    if (end.tap >= 0) ::close(end.tap);
    if (end.space >= 0) ::close(end.space);
  }
}

Expected<void> TestNetwork::open(Computer computer) {
  const int home = own_space();
  if (home < 0) return failed("/proc/thread-self/ns/net");
  if (unshare(CLONE_NEWNET) != 0) {
    const Error error = failed("no network namespace can be made");
    ::close(home);
    return error;
  }
  ends_[computer].space = own_space();
  auto device = open_device(computer == kRobot ? "10.77.0.1" : "10.77.0.2");
  const bool is_back = setns(home, CLONE_NEWNET) == 0;
  ::close(home);
  if (!is_back) throw std::runtime_error("cannot go back to the own network namespace");
  if (!device) return Error{device.error()};
  ends_[computer].tap = *device;
  return {};
}

void TestNetwork::set(const NetworkTrouble& trouble) {
  const MutexLock lock(mutex_);
  trouble_ = trouble;
}

void TestNetwork::carry() {
  while (!is_over_) {
    const Duration wait = deliver_due();
    std::array<pollfd, 2> files{{{ends_[0].tap, POLLIN, 0}, {ends_[1].tap, POLLIN, 0}}};
    const auto milliseconds = std::chrono::ceil<std::chrono::milliseconds>(wait).count();
    if (poll(files.data(), files.size(), static_cast<int>(milliseconds)) <= 0) continue;
    if ((files[0].revents & POLLIN) != 0) accept(ends_[0], ends_[1]);
    if ((files[1].revents & POLLIN) != 0) accept(ends_[1], ends_[0]);
  }
}

void TestNetwork::accept(const End& from, const End& to) {
  std::vector<char> bytes(kLongestFrame);
  const ssize_t size = read(from.tap, bytes.data(), bytes.size());
  if (size <= 0) return;
  bytes.resize(static_cast<std::size_t>(size));
  const MutexLock lock(mutex_);
  std::uniform_real_distribution<double> any(0, 1);
  if (trouble_.is_cut || any(random_) < trouble_.lost) return;
  const int times = any(random_) < trouble_.doubled ? 2 : 1;
  for (int i = 0; i < times; ++i) {
    const Duration delay = from_seconds(seconds(trouble_.delay) * (1 + any(random_)));
    under_way_.push_back({live_now() + delay, to.tap, bytes});
  }
}

// Gives how long nothing more is to be delivered.
Duration TestNetwork::deliver_due() {
  constexpr Duration kIdle = 50ms;
  const Time now = live_now();
  Duration wait = kIdle;
  const auto is_due = [&](const Frame& frame) {
    if (frame.due > now) {
      wait = std::min(wait, frame.due - now);
      return false;
    }
    if (write(frame.to, frame.bytes.data(), frame.bytes.size()) > 0) ++carried_;
    return true;
  };
  std::erase_if(under_way_, is_due);
  return wait;
}

TestNetwork::Visit::Visit(const TestNetwork& network, Computer computer) : home_(own_space()) {
  if (home_ < 0 || setns(network.ends_[computer].space, CLONE_NEWNET) != 0)
    throw std::runtime_error("cannot go to that computer");
}

TestNetwork::Visit::~Visit() {
  setns(home_, CLONE_NEWNET);
  ::close(home_);
}

}  // namespace culprit
