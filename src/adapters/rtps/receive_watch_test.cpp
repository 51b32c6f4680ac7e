#include "rtps/receive_watch.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <gtest/gtest.h>

namespace culprit::rtps {
namespace {

Time at(int seconds) { return Time(std::chrono::seconds(seconds)); }

// A UDP socket at a port of its own, with which it also sends to itself.
struct BoundSocket {
  BoundSocket() {
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(descriptor, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size), 0);
  }
  ~BoundSocket() { close(descriptor); }
  BoundSocket(const BoundSocket&) = delete;

  void get(const char* text) const {
    sendto(descriptor, text, 1, 0, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  }
  void read() const {
    char byte = 0;
    EXPECT_EQ(recv(descriptor, &byte, 1, 0), 1);
  }

  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
};

TEST(ReceiveWatch, TellsSinceWhenADatagramLiesUnread) {
  const BoundSocket socket;
  ReceiveWatch watch;
  EXPECT_EQ(watch.attended(), kNever) << "nobody looked yet";
  watch.look({{socket.descriptor}}, at(1));
  EXPECT_EQ(watch.attended(), at(1));
  socket.get("a");
  watch.look({{socket.descriptor}}, at(2));
  EXPECT_EQ(watch.attended(), at(2)) << "it may have come this very moment";
  watch.look({{socket.descriptor}}, at(3));
  watch.look({{socket.descriptor}}, at(4));
  EXPECT_EQ(watch.attended(), at(2));
  socket.read();
  watch.look({{socket.descriptor}}, at(5));
  EXPECT_EQ(watch.attended(), at(5));
}

TEST(ReceiveWatch, KnowsThatAThreadWorksThatAlwaysHasMoreToRead) {
  const BoundSocket socket;
  ReceiveWatch watch;
  socket.get("a");
  watch.look({{socket.descriptor}}, at(1));
  socket.get("b");
  socket.read();
  watch.look({{socket.descriptor}}, at(2));
  EXPECT_EQ(watch.attended(), at(2));
  watch.look({{socket.descriptor}}, at(3));
  EXPECT_EQ(watch.attended(), at(2));
}

TEST(ReceiveWatch, TellsOfTheThreadThatHangsForLongest) {
  const BoundSocket one, other;
  ReceiveWatch watch;
  one.get("a");
  watch.look({{one.descriptor, other.descriptor}}, at(1));
  other.get("a");
  watch.look({{one.descriptor, other.descriptor}}, at(2));
  watch.look({{one.descriptor, other.descriptor}}, at(3));
  EXPECT_EQ(watch.attended(), at(1));
}

}  // namespace
}  // namespace culprit::rtps
