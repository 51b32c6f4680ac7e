#include <algorithm>
#include <netinet/in.h>
#include <span>
#include <sys/socket.h>
#include <unistd.h>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "culprit_link/own_drops.h"
#include "culprit_link/protocol.h"
#include "culprit_link/turn.h"

namespace culprit_link {
namespace {

std::vector<Frame> one_of_each() {
  const Quality quality{false, true, true, true, 7, 1, 2, 3};
  const GraphSeen::Node node{"/front", "camera"};
  return {Join{1, "/", "culprit"},
          Subscribe{1, "/light", "std_msgs/msg/Float64", quality, 12},
          Advertise{2, "/light", "std_msgs/msg/Float64", quality},
          Use{3, "/camera/get_state", "lifecycle_msgs/srv/GetState", quality},
          Offer{4, "/culprit/pause", "std_srvs/srv/Trigger", quality},
          Remove{4},
          Publish{2, {0, 1, 0, 0}},
          Request{3, -5, {0, 1}},
          Respond{4, 6, {}},
          Echo{{1, 2, 3}},
          Welcome{1, "rmw_zenoh_cpp", {1, 2, 3}},
          Arrived{1, {9, 8}, 3, -1, 4, 1000, {5}},
          Reply{3, -5, {7}},
          Asked{4, 6, {8}},
          GraphSeen{{node},
                    {{true, "/light", "a/msg/B", "RIHS01_x", {4}, node, quality}},
                    {{true, "/s", "a/srv/B", node}}},
          Refused{1, "no type"},
          Trouble{"text"},
          Dropped{7}};
}

TEST(HelperProtocol, ReadsEveryFrameAsItWasWrittenHoweverItIsCut) {
  const std::vector<Frame> frames = one_of_each();
  ASSERT_EQ(frames.size(), std::variant_size_v<Frame>);
  Bytes stream;
  for (std::size_t kind = 0; kind < frames.size(); ++kind) {
    ASSERT_EQ(frames[kind].index(), kind);
    const Bytes bytes = encode(frames[kind]);
    stream.insert(stream.end(), bytes.begin(), bytes.end());
  }
  for (const std::size_t piece : {std::size_t{1}, std::size_t{3}, stream.size()}) {
    FrameReader reader;
    std::vector<Frame> read;
    for (std::size_t at = 0; at < stream.size(); at += piece) {
      reader.feed(std::span(stream).subspan(at, std::min(piece, stream.size() - at)));
      while (auto frame = reader.next()) read.push_back(std::move(*frame));
    }
    EXPECT_EQ(read, frames);
    EXPECT_FALSE(reader.has_failed());
  }
}

TEST(HelperProtocol, PassesOverFieldsThatALaterVersionAdds) {
  Bytes bytes = encode(Remove{4});
  bytes.push_back(99);
  ++bytes[0];
  FrameReader reader;
  reader.feed(bytes);
  EXPECT_EQ(reader.next(), Frame(Remove{4}));
}

TEST(HelperProtocol, FailsForGoodAtWhatIsNoFrame) {
  const Bytes too_long{1, 0, 0, 1, 9};
  const Bytes empty{0, 0, 0, 0};
  const Bytes unknown{1, 0, 0, 0, 99};
  const Bytes cut{3, 0, 0, 0, 5, 1, 2};
  Bytes false_count = encode(Frame(GraphSeen{}));
  false_count[kLengthSize + 1] = 0xff;  // 255 nodes, and none of them is there
  for (const Bytes& bytes : {too_long, empty, unknown, cut, false_count}) {
    FrameReader reader;
    reader.feed(bytes);
    EXPECT_FALSE(reader.next());
    EXPECT_TRUE(reader.has_failed());
    reader.feed(encode(Remove{4}));
    EXPECT_FALSE(reader.next());
  }
}

class UdpSocket {
 public:
  UdpSocket() {
    const int room = 4096;
    setsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), size);
    getsockname(descriptor_, reinterpret_cast<sockaddr*>(&address), &size);
    connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), size);  // to itself
  }
  ~UdpSocket() { close(descriptor_); }
  UdpSocket(const UdpSocket&) = delete;

  void send_to_itself(int datagrams) {
    const Bytes bytes(1000);
    for (int i = 0; i < datagrams; ++i) send(descriptor_, bytes.data(), bytes.size(), 0);
  }

 private:
  const int descriptor_ = socket(AF_INET, SOCK_DGRAM, 0);
};

TEST(OwnDrops, AreThoseOfAllFullSocketsOfTheProcess) {
  OwnDrops drops;
  const std::uint64_t before = drops.look();
  {
    UdpSocket first;
    UdpSocket second;
    first.send_to_itself(1);
    EXPECT_EQ(drops.look(), before) << "there is room";
    first.send_to_itself(100);
    const std::uint64_t of_first = drops.look();
    EXPECT_GT(of_first, before + 50);
    second.send_to_itself(100);
    EXPECT_GT(drops.look(), of_first + 50);
  }
  const std::uint64_t all = drops.look();
  UdpSocket third;
  third.send_to_itself(100);
  EXPECT_GT(drops.look(), all) << "with the number of a closed one";
}

TEST(Turn, OfAnEndpointWithoutEndLeavesOneToTheOthers) {
  int flood = 0;
  int left = 5;
  for (int round = 0; round < 2; ++round) {
    take_turn([&] { return ++flood > 0; });
    take_turn([&] { return left-- > 0; });
  }
  EXPECT_EQ(flood, 2 * kInTurn);
  EXPECT_EQ(left, -2) << "each round looks once more";
}

}  // namespace
}  // namespace culprit_link
