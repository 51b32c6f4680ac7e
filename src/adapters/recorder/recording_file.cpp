#include "recorder/recording_file.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

#include "base/environment.h"

namespace culprit::recorder {
namespace {

// rmw/types.h; RMW_DURATION_INFINITE is the greatest number of nanoseconds.
std::string rmw_time(Duration time) {
  const std::int64_t nanoseconds = time == rtps::kInfinite ? INT64_MAX : time.count();
  constexpr std::int64_t kSecond = 1'000'000'000;
  return "\n    sec: " + std::to_string(nanoseconds / kSecond) +
         "\n    nsec: " + std::to_string(nanoseconds % kSecond) + "\n";
}

std::string rmw_profile(const rtps::Qos& qos) {
  constexpr int kUnknownHistory = 3;  // it is not announced
  const int reliability = qos.reliability == rtps::Reliability::kReliable ? 1 : 2;
  const int durability = qos.durability == rtps::Durability::kTransientLocal ? 1 : 2;
  const int liveliness = qos.liveliness == rtps::Liveliness::kAutomatic ? 1 : 3;
  return "- history: " + std::to_string(kUnknownHistory) +
         "\n  depth: 0\n  reliability: " + std::to_string(reliability) +
         "\n  durability: " + std::to_string(durability) +
         "\n  deadline:" + rmw_time(qos.deadline) + "  lifespan:" + rmw_time(qos.lifespan) +
         "  liveliness: " + std::to_string(liveliness) +
         "\n  liveliness_lease_duration:" + rmw_time(qos.liveliness_lease) +
         "  avoid_ros_namespace_conventions: false\n";
}

std::string_view as_text(const rtps::Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

std::string offered_qos_profiles(const std::vector<rtps::Qos>& offers) {
  std::string all;
  for (const rtps::Qos& offer : offers) all += rmw_profile(offer);
  return all;
}

Expected<std::unique_ptr<RecordingFile>> RecordingFile::create(const RecordingFolder& folder,
                                                               const std::string& name,
                                                               const std::string& library) {
  if (const auto opened = folder.open(); !opened) return Error{opened.error()};
  const std::filesystem::path path = folder.path() / name;
  if (const auto room = folder.make_room(McapWriter::kChunkSize, path); !room)
    return Error{room.error()};
  constexpr mode_t kOfOwner = 0640;  // what a robot sees is not for everybody
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kOfOwner);
  if (descriptor < 0) return Error{path.string() + " cannot be made: " + std::strerror(errno)};
  std::unique_ptr<RecordingFile> file(new RecordingFile(folder, path, descriptor));
  file->writer_ = std::make_unique<McapWriter>(
      [f = file.get()](std::string_view bytes) { return f->write(bytes); }, "ros2", library);
  // Newer versions of rosbag2 take the numbers in "offered_qos_profiles" for what they are only where this is there
  // and empty (rosbag2_storage_mcap: metadata_.version); older ones know no others.
  file->writer_->add_metadata(
      "rosbag2", {{"serialized_metadata", ""}, {"ROS_DISTRO", environment("ROS_DISTRO")}});
  if (!file->trouble_.empty()) return Error{file->trouble_};
  return file;
}

RecordingFile::~RecordingFile() { close(descriptor_); }

// A piece that does not fit is taken back, so that the file ends with the last that does.
bool RecordingFile::write(std::string_view bytes) {
  if (const auto room = folder_.make_room(bytes.size(), path_); !room) {
    trouble_ = room.error();
    return false;
  }
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::write(descriptor_, bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      trouble_ = path_.string() + " cannot be written: " + std::strerror(errno);
      if (ftruncate(descriptor_, static_cast<off_t>(size_)) != 0)
        trouble_ += ", and its end is not whole";
      return false;
    }
    done += static_cast<std::size_t>(count);
  }
  size_ += bytes.size();
  return true;
}

std::uint16_t RecordingFile::channel_of(std::size_t topic, const RecordedTopic& about) {
  const auto [channel, is_new] = channels_.try_emplace(topic, std::uint16_t{0});
  if (!is_new) return channel->second;
  const auto [schema, is_new_type] =
      schemas_.try_emplace(about.type + ' ' + about.type_hash, std::uint16_t{0});
  if (is_new_type)
    schema->second = writer_->add_schema(
        {about.type, about.definition ? "ros2msg" : "", about.definition.value_or("")});
  if (schema->second == 0) return 0;
  channel->second =
      writer_->add_channel({schema->second,
                            about.name,
                            "cdr",
                            {{"offered_qos_profiles", offered_qos_profiles(about.offers)},
                             {"topic_type_hash", about.type_hash}}});
  return channel->second;
}

void RecordingFile::add(const RingMessage& message, const RecordedTopic& topic,
                        std::optional<std::int64_t> logged) {
  const std::uint16_t channel = channel_of(message.topic, topic);
  if (channel == 0) return;
  writer_->add({channel, message.sequence, logged.value_or(message.received), message.sent},
               as_text(message.payload));
}

void RecordingFile::end() {
  writer_->end();
  if (trouble_.empty() && fsync(descriptor_) != 0)
    trouble_ = path_.string() + " cannot be written: " + std::strerror(errno);
}

}  // namespace culprit::recorder
