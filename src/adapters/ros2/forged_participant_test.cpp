// A participant that announces, beside its own port, that of another process, and claims to hold
// that process's node: as anybody on an unsecured domain can.
#include <csignal>
#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ros2/live_test.h"
#include "ros2/process_finder.h"
#include "ros2/test_forger.h"
#include "rtps/test_sockets.h"

namespace culprit::ros2 {
namespace {

using testing::Contains;

// Another process, with a port of its own.
class Victim {
 public:
  Victim() {
    const Bound socket = bound();
    port_ = socket.port;
    pid_ = rtps::fork_or_abort();
    while (pid_ == 0) pause();
    close(socket.descriptor);
  }
  ~Victim() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  int pid() const { return pid_; }
  std::uint16_t port() const { return port_; }

 private:
  int pid_ = 0;
  std::uint16_t port_ = 0;
};

// ROS 2 has no partitions, nor have our nodes; the middleware's profiles have.
TEST(Discovery, TellsThePartitionsOfAnEndpoint) {
  fast_dds::fastrtps::WriterProxyData writer(4, 1);
  writer.m_qos.m_partition.push_back("left");
  writer.m_qos.m_partition.push_back("right*");
  EXPECT_THAT(fast_dds::to_info(writer).partitions, testing::ElementsAre("left", "right*"));
}

TEST(ForgedParticipant, DoesNotChooseWhichProcessANodeIs) {
  const Victim victim;
  const TestDomain domain;
  Graph::Options graph;
  graph.find_process = [](const ParticipantInfo& info) { return ProcessFinder().find(info); };
  LiveContext watcher(domain.options(), graph);
  Forger forger(domain.options(), victim.port());
  forger.says_that_it_holds({"/", "camera", {}, {}});
  ASSERT_TRUE(watcher.sees_node("/camera"));
  watcher.run([&] {
    const ParticipantInfo* info = watcher->graph().participant(forger.prefix());
    ASSERT_NE(info, nullptr);
    EXPECT_THAT(info->metatraffic, Contains(rtps::UdpAddress{{127, 0, 0, 1}, victim.port()}))
        << "it announces that port";
    ASSERT_EQ(watcher->graph().nodes().size(), 1u);
    EXPECT_EQ(watcher->graph().nodes()[0].node.pid, 0) << "the victim is " << victim.pid();
  });
  EXPECT_TRUE(watcher.changes().wait_for_one([](const GraphChange& change) {
    const auto* trouble = std::get_if<GraphTrouble>(&change);
    return trouble != nullptr &&
           trouble->text.find("the process of /camera is not proven") != std::string::npos;
  }));
}

}  // namespace
}  // namespace culprit::ros2
