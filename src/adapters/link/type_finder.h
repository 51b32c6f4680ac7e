// Finds the definition of a topic's messages, or a service's, for types of which no file was given.
//
// From Iron on every endpoint announces the hash of its type (type_description.h), and only a
// definition with that hash is used: our files, those kept from an earlier run, the files of the
// node's process, and the node's answer (~/get_type_description, Jazzy). Before Iron there is no
// hash: the files that the node's process was started with (AMENT_PREFIX_PATH, below its own root
// directory) go before ours.
//
// A node announces a service with the hash of the service itself only from Lyrical on
// ("sertypehash"). From Iron to Kilted only the hashes of its two messages are announced: files are
// compared with that of the request, and the node cannot be asked.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "ros2/message_library.h"
#include "ros2/node.h"
#include "ros2/services.h"

namespace culprit::link {

// On the executor's thread.
class TypeFinder {
 public:
  struct Options {
    std::vector<std::filesystem::path> message_path;  // where to find .msg and .srv files
    // Where types that nodes described are kept, by hash; the hash proves each file. Empty:
    // nowhere.
    std::filesystem::path kept_types;
  };
  // A topic that a node publishes, or a service, as it announces that.
  struct Offer {
    std::string node;
    std::string type;            // "package/msg/Type", "package/srv/Type"
    std::string hash;            // of the type; empty before Iron, of a service before Lyrical
    int pid = 0;                 // on this machine; 0 where it is not known
    std::string request_hash{};  // of a service: of "package/srv/Type_Request"; empty before Iron

    bool is_service() const { return type.find("/srv/") != std::string::npos; }
  };
  // A library with the type as this node means it (of a service both its messages), while the
  // callback runs. Errors: why there is nothing, and what to do.
  using Callback = std::function<void(Expected<ros2::MessageLibrary*>)>;

  // How long nodes may take to answer.
  static constexpr Duration kPatience = std::chrono::seconds(3);

  // `self` outlives the finder.
  TypeFinder(ros2::Node& self, Options options);

  // At once, or when the node has answered; not after the finder is destroyed.
  void find(const Offer& offer, Callback found);

 private:
  using GetTypeDescription = ros2::Client<ros2::srv::GetTypeDescription>;
  struct Question {
    std::unique_ptr<GetTypeDescription> client;
    std::vector<Callback> waiting;  // none once it is answered
  };

  // Nothing: neither what we have nor what the process has is what is offered.
  ros2::MessageLibrary* among_files(const Offer& offer, ros2::MessageLibrary& files);
  void ask(const Offer& offer, Callback found);
  void answered(const Offer& offer, const GetTypeDescription::Answer& answer);

  ros2::Node& self_;
  const Options options_;
  ros2::MessageLibrary library_;                      // of our files
  std::map<std::string, ros2::MessageLibrary> told_;  // by nodes, by hash
  std::size_t told_bytes_ = 0;                        // of their texts
  std::map<std::string, Question> questions_;         // by node and hash
};

}  // namespace culprit::link
