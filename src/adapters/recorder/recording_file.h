// One recording on the disk, as rosbag2 and Foxglove read it: MCAP of the profile "ros2", CDR in every channel, the
// definitions of types as ros2msg, the offered quality of service as rosbag2 writes it.
//
// All channels have one encoding: rosbag2 opens no file with two ("All topics must have the same
// serialization format"). So culprit's own messages are CDR, too: JSON in a std_msgs/msg/String. A
// type that is not known has a schema without an encoding, as the specification wants it; rosbag2
// opens no channel without a schema.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/expected.h"
#include "recorder/mcap_writer.h"
#include "recorder/message_ring.h"
#include "recorder/recording_folder.h"
#include "rtps/qos.h"

namespace culprit::recorder {

// The text of "offered_qos_profiles" in rosbag2's channels: a list in YAML, with the numbers of
// rmw/types.h.
std::string offered_qos_profiles(const std::vector<rtps::Qos>& offers);

struct RecordedTopic {
  std::string name;
  std::string type;                       // "sensor_msgs/msg/Image"
  std::string type_hash;                  // empty before Iron
  std::optional<std::string> definition;  // as ros2msg; nothing: it is not known
  std::vector<rtps::Qos> offers;          // of its publishers, as they were seen last
};

// One thread.
class RecordingFile {
 public:
  // Errors: it cannot be made, or there is no room. The folder must outlive the file.
  static Expected<std::unique_ptr<RecordingFile>> create(const RecordingFolder& folder,
                                                         const std::string& name,
                                                         const std::string& library);
  ~RecordingFile();
  RecordingFile(const RecordingFile&) = delete;

  // `topic` is what message.topic means. `logged`: the time at which it counts as received; by
  // default, when it was.
  void add(const RingMessage& message, const RecordedTopic& topic,
           std::optional<std::int64_t> logged = {});
  // Writes what is there so far; from now on a crash loses none of it.
  void flush() { writer_->flush(); }
  // The rest, and to the disk.
  void end();

  const std::filesystem::path& path() const { return path_; }
  // Why it cannot go on; empty: it can. The messages up to then can be read.
  const std::string& trouble() const { return trouble_; }
  std::uint64_t messages() const { return writer_->messages(); }

 private:
  RecordingFile(const RecordingFolder& folder, std::filesystem::path path, int descriptor)
      : folder_(folder), path_(std::move(path)), descriptor_(descriptor) {}
  bool write(std::string_view bytes);
  std::uint16_t channel_of(std::size_t topic, const RecordedTopic& about);

  const RecordingFolder& folder_;
  const std::filesystem::path path_;
  const int descriptor_;
  std::unique_ptr<McapWriter> writer_;
  std::uint64_t size_ = 0;
  std::string trouble_;
  std::unordered_map<std::size_t, std::uint16_t> channels_;  // by topic
  std::unordered_map<std::string, std::uint16_t> schemas_;   // by type and hash
};

}  // namespace culprit::recorder
