#include <algorithm>
#include <span>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "culprit_link/protocol.h"

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
          Trouble{"text"}};
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

}  // namespace
}  // namespace culprit_link
