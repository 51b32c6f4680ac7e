// For tests: writes recordings of a made-up robot, message by message, as MCAP.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "bag/test_mcap.h"
#include "rtps/cdr.h"

namespace culprit::bag_doctor::test {

inline constexpr std::int64_t kBegin = 1'700'000'000'000'000'000;  // 2023-11-14 22:13:20 UTC

inline std::int64_t at(double seconds) {
  return kBegin + static_cast<std::int64_t>(std::llround(seconds * 1e9));
}

// A payload, field by field.
class Payload {
 public:
  Payload& header(double stamp, const std::string& frame = "base") {
    const std::int64_t time = at(stamp);
    writer_.write(static_cast<std::int32_t>(time / 1'000'000'000));
    writer_.write(static_cast<std::uint32_t>(time % 1'000'000'000));
    writer_.write_string(frame);
    return *this;
  }
  template <class T>
  Payload& put(T value) {
    writer_.write(value);
    return *this;
  }
  Payload& put_text(const std::string& text) {
    writer_.write_string(text);
    return *this;
  }
  Payload& put_doubles(std::initializer_list<double> values) {
    for (const double each : values) writer_.write(each);
    return *this;
  }
  Payload& put_zeros(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) writer_.write(0.0);
    return *this;
  }
  std::string bytes() {
    const rtps::Bytes taken = writer_.take();
    return {taken.begin(), taken.end()};
  }

 private:
  rtps::CdrWriter writer_;
};

// A number that changes with each message, the same in each run: deterministic noise around 0.
inline double noise(std::uint64_t seed) {
  seed = (seed + 0x9e3779b97f4a7c15) * 0xbf58476d1ce4e5b9;
  seed ^= seed >> 29;
  seed *= 0x94d049bb133111eb;
  return static_cast<double>(seed >> 40) / static_cast<double>(1 << 24) - 0.5;
}

// Messages of some types, with `value` as their measured number.
inline std::string imu(double stamp, double value) {
  return Payload()
      .header(stamp, "imu")
      .put_doubles({0, 0, 0, 1})
      .put_zeros(9)
      .put_doubles({value, value / 2, value / 3})
      .put_zeros(9)
      .put_doubles({value * 2, value * 3, 9.81 + value})
      .put_zeros(9)
      .bytes();
}
inline std::string scan(double stamp, double value) {
  Payload payload;
  payload.header(stamp, "laser");
  for (int i = 0; i < 7; ++i) payload.put(static_cast<float>(i + 1));
  payload.put(std::uint32_t{8});
  for (int i = 0; i < 8; ++i) payload.put(static_cast<float>(2 + value + i));
  payload.put(std::uint32_t{0});
  return payload.bytes();
}
inline std::string odometry(double stamp, double value) {
  return Payload()
      .header(stamp, "odom")
      .put_text("base")
      .put_doubles({value, value * 2, 0, 0, 0, 0, 1})
      .put_zeros(36)
      .put_doubles({value, 0, 0, 0, 0, value / 2})
      .put_zeros(36)
      .bytes();
}
inline std::string pose(double stamp, double value) {
  return Payload().header(stamp, "map").put_doubles({value, value * 2, 0, 0, 0, 0, 1}).bytes();
}
inline std::string twist(double, double value) {
  return Payload().put_doubles({value, 0, 0, 0, 0, value / 2}).bytes();
}
inline std::string number(double, double value) { return Payload().put(value).bytes(); }
inline std::string log(double stamp, std::uint8_t level, const std::string& name,
                       const std::string& text) {
  const std::int64_t time = at(stamp);
  return Payload()
      .put(static_cast<std::int32_t>(time / 1'000'000'000))
      .put(static_cast<std::uint32_t>(time % 1'000'000'000))
      .put(level)
      .put_text(name)
      .put_text(text)
      .put_text("main.cpp")
      .put_text("main")
      .put(std::uint32_t{1})
      .bytes();
}
inline std::string transition(const std::string& from, const std::string& to) {
  return Payload()
      .put(std::uint64_t{0})
      .put(std::uint8_t{0})
      .put_text("")
      .put(std::uint8_t{0})
      .put_text(from)
      .put(std::uint8_t{0})
      .put_text(to)
      .bytes();
}
inline std::string diagnostic(double stamp, std::uint8_t level, const std::string& name,
                              const std::string& text) {
  return Payload()
      .header(stamp, "")
      .put(std::uint32_t{1})
      .put(level)
      .put_text(name)
      .put_text(text)
      .put_text("")
      .put(std::uint32_t{0})
      .bytes();
}
inline std::string transform(double stamp, const std::string& parent, const std::string& child) {
  return Payload()
      .put(std::uint32_t{1})
      .header(stamp, parent)
      .put_text(child)
      .put_doubles({0, 0, 0, 0, 0, 0, 1})
      .bytes();
}

class Recording {
 public:
  // The text of a type that is no standard one.
  void define(const std::string& type, const std::string& text) { definitions_[type] = text; }
  // The QoS that the publishers of a topic offered, as the recorder writes it down.
  void offer(const std::string& topic, const std::string& yaml) { offers_[topic] = yaml; }
  void announce(const std::string& topic, const std::string& type) {
    topics_.try_emplace(topic, type);
  }
  void add(const std::string& topic, const std::string& type, double seconds, std::string payload) {
    announce(topic, type);
    messages_.push_back({at(seconds), topic, std::move(payload)});
  }

  // As one chunk, in the order of time.
  std::filesystem::path write(const std::filesystem::path& path) const {
    using namespace bag::test;
    std::string data;
    std::map<std::string, std::uint16_t> channels;
    for (const auto& [topic, type] : topics_) {
      const auto id = static_cast<std::uint16_t>(channels.size() + 1);
      channels[topic] = id;
      // Without a definition, as where the recorder had none: the standard types are known.
      const auto text = definitions_.find(type);
      const bool is_defined = text != definitions_.end();
      data += record(0x03, little(id, 2) + bag::test::text(type) +
                               bag::test::text(is_defined ? "ros2msg" : "") +
                               bag::test::text(is_defined ? text->second : ""));
      const auto offer = offers_.find(topic);
      const std::string metadata =
          offer == offers_.end()
              ? ""
              : bag::test::text("offered_qos_profiles") + bag::test::text(offer->second);
      data += record(0x04, little(id, 2) + little(id, 2) + bag::test::text(topic) +
                               bag::test::text("cdr") + bag::test::text(metadata));
    }
    std::vector<const Message*> sorted;
    for (const Message& each : messages_) sorted.push_back(&each);
    std::ranges::stable_sort(sorted, {}, [](const Message* m) { return m->at; });
    for (const Message* each : sorted)
      data +=
          message(channels.at(each->topic), static_cast<std::uint64_t>(each->at), each->payload);
    std::ofstream(path, std::ios::binary) << mcap(data, messages_.size());
    return path;
  }

 private:
  struct Message {
    std::int64_t at;
    std::string topic;
    std::string payload;
  };
  std::map<std::string, std::string> topics_, definitions_, offers_;
  std::vector<Message> messages_;
};

}  // namespace culprit::bag_doctor::test
