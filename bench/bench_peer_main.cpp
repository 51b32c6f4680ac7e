// The other processes of the live benchmarks:
//
//   latencies TOPIC             reads std_msgs/Float64, prints "<number> <nanoseconds from write to callback>"
//   fleet INDEX NODES TOPICS    nodes with so many topics of 10 Hz each
//   robot INDEX OF NODES        nodes that read each other
//   images                      1080p pictures at 30 Hz on /bench/image
//   quiet                       publishes /quiet/value at 10 Hz, or, after a SIGUSR1, does not; after the next one it
//                               does again
//   bare-reader                 reads the pictures with nothing but Fast DDS
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "bare_reader.h"
#include "ros2/context.h"
#include "ros2/messages.h"
#include "ros2/node.h"
#include "ros2/timer.h"

namespace culprit::bench {
namespace {

using namespace std::chrono_literals;
using rtps::SystemTime;

struct Peer {
  Peer() {
    if (!executor.stop_on({SIGINT, SIGTERM})) std::abort();
    auto opened = ros2::Context::create(executor, *ros2::options_from_environment());
    if (!opened) std::abort();
    context = std::move(*opened);
  }
  std::unique_ptr<ros2::Node> node(const std::string& name) {
    return std::move(*ros2::Node::create(*context, {"/", name}));
  }

  ros2::Executor executor;
  std::unique_ptr<ros2::Context> context;
};

void latencies(const std::string& topic) {
  Peer peer;
  const auto node = peer.node("latencies");
  const auto reader = ros2::RawSubscription::create(
      node->entry(), topic, ros2::msg::Float64::kType, rtps::qos::kSensorData,
      ros2::PayloadUse::kWhole, [](const ros2::Sample& sample) {
        const SystemTime here = std::chrono::system_clock::now();
        std::printf("%lld %lld\n", static_cast<long long>(sample.sent.time_since_epoch().count()),
                    static_cast<long long>(here.time_since_epoch().count()));
      });
  peer.executor.run();
}

void fleet(int index, int nodes, int topics) {
  Peer peer;
  std::vector<std::unique_ptr<ros2::Node>> members;
  std::vector<ros2::Publisher<ros2::msg::Float64>> publishers;
  for (int n = 0; n < nodes; ++n) {
    const std::string name = "node_" + std::to_string(index * nodes + n);
    members.push_back(peer.node(name));
    for (int t = 0; t < topics; ++t)
      publishers.push_back(std::move(*members.back()->create_publisher<ros2::msg::Float64>(
          "/" + name + "/value_" + std::to_string(t))));
  }
  double value = 0;
  const ros2::Timer timer(peer.executor, 100ms, [&] {
    value += 0.001;
    for (auto& publisher : publishers) publisher.publish({value});
  });
  peer.executor.run();
}

// The part of a message of this type that the benchmark reads.
struct Imu {
  static constexpr std::string_view kType = "sensor_msgs/msg/Imu";
  ros2::msg::Header header;
  static void visit(auto& self, auto& each) { each(self.header); }
};

void robot(int index, int of, int nodes) {
  Peer peer;
  std::vector<std::unique_ptr<ros2::Node>> members;
  std::vector<ros2::Publisher<Imu>> publishers;
  std::vector<std::unique_ptr<ros2::Subscription>> subscriptions;
  for (int n = 0; n < nodes; ++n) {
    const int number = index * nodes + n;
    members.push_back(peer.node("node_" + std::to_string(number)));
    publishers.push_back(std::move(
        *members.back()->create_publisher<Imu>("/node_" + std::to_string(number) + "/imu")));
    subscriptions.push_back(std::move(*members.back()->create_subscription<Imu>(
        "/node_" + std::to_string((number + 1) % (of * nodes)) + "/imu", rtps::qos::kSensorData,
        [](const Imu&) {})));
  }
  const ros2::Timer timer(peer.executor, 100ms, [&] {
    const auto now = ros2::msg::to_time(std::chrono::system_clock::now());
    for (auto& publisher : publishers) publisher.publish({{now, "base"}});
  });
  peer.executor.run();
}

std::atomic<bool> speaks = true;

void quiet() {
  std::signal(SIGUSR1, [](int) { speaks = !speaks; });
  Peer peer;
  const auto node = peer.node("quiet");
  auto publisher = node->create_publisher<ros2::msg::Float64>("/quiet/value");
  const ros2::Timer timer(peer.executor, 100ms, [&] {
    if (speaks) publisher->publish({1.0});
  });
  peer.executor.run();
}

void images() {
  Peer peer;
  const auto node = peer.node("images");
  const auto publisher = ros2::RawPublisher::create(
      node->entry(), "/bench/image", ros2::msg::Image::kType, rtps::qos::kSensorData);
  ros2::msg::Image image;
  image.width = 1920;
  image.height = 1080;
  image.encoding = "rgb8";
  image.step = 3 * 1920;
  image.data.assign(std::size_t{1080} * 3 * 1920, 127);
  const rtps::Bytes payload = rtps::encode(image);
  const ros2::Timer timer(peer.executor, 33ms, [&] { (*publisher)->publish(payload); });
  peer.executor.run();
}

}  // namespace
}  // namespace culprit::bench

int main(int argc, char** argv) {
  using namespace culprit::bench;
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  setvbuf(stdout, nullptr, _IOLBF, 0);
  if (arguments.size() == 2 && arguments[0] == "latencies") {
    latencies(arguments[1]);
  } else if (arguments.size() == 4 && arguments[0] == "fleet") {
    fleet(std::stoi(arguments[1]), std::stoi(arguments[2]), std::stoi(arguments[3]));
  } else if (arguments.size() == 4 && arguments[0] == "robot") {
    robot(std::stoi(arguments[1]), std::stoi(arguments[2]), std::stoi(arguments[3]));
  } else if (arguments == std::vector<std::string>{"quiet"}) {
    quiet();
  } else if (arguments == std::vector<std::string>{"images"}) {
    images();
  } else if (arguments == std::vector<std::string>{"bare-reader"}) {
    read_bare();
  } else {
    std::fprintf(stderr, "culprit-bench-peer: see bench/bench_peer_main.cpp\n");
    return 2;
  }
  return 0;
}
