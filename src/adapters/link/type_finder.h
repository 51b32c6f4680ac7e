// Finds out what a topic's messages look like, for types of which no file was given.
//
// From Iron on every endpoint announces the hash of its type (type_description.h), and only a
// definition with that hash is used: what our files say, what was kept from an earlier run, what
// the files of the publisher's process say, and what the publisher's node tells when asked
// (~/get_type_description, Jazzy). Before Iron there is no hash: the files that the publisher's process
// was started with (AMENT_PREFIX_PATH, below its own root directory) go before ours.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "ros2/message_library.h"
#include "ros2/node.h"
#include "ros2/services.h"

namespace culprit::ros2 {

// The files that the process was started with (AMENT_PREFIX_PATH), below its own root directory. None
// of a process that is elsewhere, or may not be looked at; 0: it is not known.
MessageLibrary files_of_process(int pid);

// On the executor's thread.
class TypeFinder {
 public:
  struct Options {
    std::vector<std::filesystem::path> message_path;  // where to find .msg files
    // Where types that nodes told of are kept, by hash; what is there proves itself by it. Empty:
    // nowhere.
    std::filesystem::path kept_types;
  };
  // A publisher of a topic, as it announces itself.
  struct Publication {
    std::string node;
    std::string type;  // "package/msg/Type"
    std::string hash;  // empty before Iron
    int pid = 0;       // on this machine; 0 where it is not known
  };
  // What has the type as this publisher means it, while the callback runs. Errors: why there is
  // nothing, and what to do.
  using Callback = std::function<void(Expected<MessageLibrary*>)>;

  // Others may be asked for so long.
  static constexpr Duration kPatience = std::chrono::seconds(3);

  // `self` outlives the finder.
  TypeFinder(Node& self, Options options);

  // At once, or when the node has answered; not after the finder is gone.
  void find(const Publication& publication, Callback found);

 private:
  using GetTypeDescription = Client<srv::GetTypeDescription>;
  struct Question {
    std::unique_ptr<GetTypeDescription> client;
    std::vector<Callback> waiting;  // none once it is answered
  };

  // Nothing: neither what we have nor what the process has is what is published.
  MessageLibrary* among_files(const Publication& publication, MessageLibrary& files);
  void ask(const Publication& publication, Callback found);
  void answered(const Publication& publication, const GetTypeDescription::Answer& answer);

  Node& self_;
  const Options options_;
  MessageLibrary library_;                      // of our files
  std::map<std::string, MessageLibrary> told_;  // by nodes, by hash
  std::map<std::string, Question> questions_;   // by node and hash
};

}  // namespace culprit::ros2
