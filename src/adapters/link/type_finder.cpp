#include "link/type_finder.h"

#include <algorithm>
#include <iterator>
#include <system_error>

#include "base/environment.h"
#include "base/text_file.h"
#include "ros2/names.h"
#include "ros2/type_description.h"

namespace culprit::ros2 {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostKept = 1000;  // files: the network decides how many types there are
constexpr std::size_t kMostTold = 1000;

bool is_what_it_says(MessageLibrary& library, const TypeFinder::Publication& publication) {
  const auto hash = library.hash_of(publication.type);
  return hash && *hash == publication.hash;
}

bool is_hash(const std::string& text) {
  constexpr std::string_view kBegin = "RIHS01_";
  return text.size() == kBegin.size() + 64 && text.starts_with(kBegin) &&
         text.find_first_not_of("0123456789abcdef", kBegin.size()) == std::string::npos;
}

std::optional<MessageLibrary> kept(const fs::path& folder,
                                   const TypeFinder::Publication& publication) {
  std::error_code error;
  const fs::path file = folder / publication.hash;
  if (folder.empty() || !fs::is_regular_file(file, error)) return std::nullopt;
  const auto text = read_text(file);
  if (!text) return std::nullopt;
  MessageLibrary library;
  library.learn(publication.type, *text);
  if (!is_what_it_says(library, publication)) return std::nullopt;
  return library;
}

// Where that fails the node is asked again the next time.
void keep(const fs::path& folder, const TypeFinder::Publication& publication,
          const MessageDefinitions& definitions) {
  std::error_code error;
  if (folder.empty()) return;
  fs::create_directories(folder, error);
  fs::directory_iterator files(folder, error);
  if (error || static_cast<std::size_t>(std::distance(files, {})) >= kMostKept) return;
  (void)write_text(folder / publication.hash, to_text(publication.type, definitions));
}

Error unknown(const TypeFinder::Publication& publication, const std::string& why) {
  return Error{"the message type " + printable(publication.type) + " is not known" + why +
               "; give the directory that holds " + printable(publication.type) +
               ".msg with --message-path"};
}

}  // namespace

MessageLibrary files_of_process(int pid) {
  const auto prefixes = pid == 0 ? std::nullopt : environment_of(pid, "AMENT_PREFIX_PATH");
  if (!prefixes) return MessageLibrary();
  return MessageLibrary(message_directories({}, *prefixes),
                        "/proc/" + std::to_string(pid) + "/root");
}

TypeFinder::TypeFinder(Node& self, Options options)
    : self_(self), options_(std::move(options)), library_(options_.message_path) {}

void TypeFinder::find(const Publication& publication, Callback found) {
  if (!is_valid_type_name(publication.type))
    return found(Error{"'" + printable(publication.type) + "' is not the name of a type"});
  MessageLibrary files = files_of_process(publication.pid);
  if (MessageLibrary* library = among_files(publication, files)) return found(library);
  if (publication.hash.empty()) return found(unknown(publication, ""));
  if (!is_hash(publication.hash))
    return found(unknown(publication, ", and its hash is none that can be checked"));
  if (const auto told = told_.find(publication.hash);
      told != told_.end() && is_what_it_says(told->second, publication))
    return found(&told->second);
  if (auto library = kept(options_.kept_types, publication)) return found(&*library);
  ask(publication, std::move(found));
}

MessageLibrary* TypeFinder::among_files(const Publication& publication, MessageLibrary& files) {
  if (publication.hash.empty()) {
    if (files.find(publication.type)) return &files;
    return library_.find(publication.type) ? &library_ : nullptr;
  }
  if (is_what_it_says(library_, publication)) return &library_;
  return is_what_it_says(files, publication) ? &files : nullptr;
}

void TypeFinder::ask(const Publication& publication, Callback found) {
  std::erase_if(questions_, [](const auto& question) { return question.second.waiting.empty(); });
  const auto [place, is_new] =
      questions_.try_emplace(publication.node + ' ' + publication.hash, Question{});
  Question& question = place->second;
  question.waiting.push_back(std::move(found));
  if (!is_new) return;
  auto client =
      self_.create_client<srv::GetTypeDescription>(publication.node + "/get_type_description");
  if (!client) return answered(publication, {CallOutcome::kUnreachable, {}});
  question.client = std::move(*client);
  question.client->call({publication.type, publication.hash, false}, Repeat::kUntilAnswered,
                        kPatience, [this, publication](const GetTypeDescription::Answer& answer) {
                          answered(publication, answer);
                        });
}

// The hash says whether an answer is true, not who gave it.
void TypeFinder::answered(const Publication& publication,
                          const GetTypeDescription::Answer& answer) {
  Question& question = questions_.at(publication.node + ' ' + publication.hash);
  const std::vector<Callback> waiting = std::exchange(question.waiting, {});
  const auto tell = [&](const Expected<MessageLibrary*>& library) {
    for (const Callback& found : waiting) found(library);
  };
  if (!answer.response || !answer.response->successful)
    return tell(unknown(publication, ", and its node does not tell it"));
  const auto definitions = to_definitions(answer.response->type_description);
  MessageLibrary library;
  if (definitions) library.define(*definitions);
  if (!definitions || !is_what_it_says(library, publication))
    return tell(unknown(publication, ", and what its node tells of it is not what is published"));
  keep(options_.kept_types, publication, *definitions);
  if (told_.size() >= kMostTold) told_.clear();
  tell(&told_.insert_or_assign(publication.hash, std::move(library)).first->second);
}

}  // namespace culprit::ros2
