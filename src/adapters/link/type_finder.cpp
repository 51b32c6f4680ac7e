#include "link/type_finder.h"

#include <algorithm>
#include <iterator>
#include <system_error>

#include "base/environment.h"
#include "base/text_file.h"
#include "ros2/names.h"
#include "ros2/type_description.h"

namespace culprit::link {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostKept = 1000;  // files: the network decides how many types there are
constexpr std::size_t kMostTold = 1000;
// As text: the longest of one type, and of all that nodes described.
constexpr std::size_t kLongestDescription = std::size_t{256} << 10;
constexpr std::size_t kLongestTold = std::size_t{8} << 20;

bool is_what_it_says(ros2::MessageLibrary& library, const TypeFinder::Offer& offer) {
  const bool is_known_by_request = offer.hash.empty() && !offer.request_hash.empty();
  const auto hash = library.hash_of(is_known_by_request ? offer.type + "_Request" : offer.type);
  return hash && *hash == (is_known_by_request ? offer.request_hash : offer.hash);
}

bool has(ros2::MessageLibrary& library, const TypeFinder::Offer& offer) {
  if (!offer.is_service()) return library.find(offer.type).has_value();
  return library.find(offer.type + "_Request") && library.find(offer.type + "_Response");
}

bool is_hash(const std::string& text) {
  constexpr std::string_view kBegin = "RIHS01_";
  return text.size() == kBegin.size() + 64 && text.starts_with(kBegin) &&
         text.find_first_not_of("0123456789abcdef", kBegin.size()) == std::string::npos;
}

std::optional<ros2::MessageLibrary> kept(const fs::path& folder, const TypeFinder::Offer& offer) {
  std::error_code error;
  const fs::path file = folder / offer.hash;
  if (folder.empty() || !fs::is_regular_file(file, error)) return std::nullopt;
  const auto text = read_text(file);
  if (!text) return std::nullopt;
  ros2::MessageLibrary library;
  library.learn(offer.type, *text);
  if (!is_what_it_says(library, offer)) return std::nullopt;
  return library;
}

// Where that fails the node is asked again the next time.
void keep(const fs::path& folder, const TypeFinder::Offer& offer, const std::string& text) {
  std::error_code error;
  if (folder.empty()) return;
  fs::create_directories(folder, error);
  fs::directory_iterator files(folder, error);
  if (error || static_cast<std::size_t>(std::distance(files, {})) >= kMostKept) return;
  (void)write_text(folder / offer.hash, text);
}

Error unknown(const TypeFinder::Offer& offer, const std::string& why) {
  const bool is_service = offer.is_service();
  return Error{(is_service ? "the service type " : "the message type ") + printable(offer.type) +
               " is not known" + why + "; give the directory that holds " + printable(offer.type) +
               (is_service ? ".srv" : ".msg") + " with --message-path"};
}

// The files that the process was started with, below its own root directory. Empty for a process
// that is elsewhere, or may not be read; 0: it is not known.
ros2::MessageLibrary files_of_process(int pid) {
  const auto prefixes = pid == 0 ? std::nullopt : environment_of(pid, "AMENT_PREFIX_PATH");
  if (!prefixes) return ros2::MessageLibrary();
  return ros2::MessageLibrary(ros2::message_directories({}, *prefixes),
                              "/proc/" + std::to_string(pid) + "/root");
}

}  // namespace

TypeFinder::TypeFinder(ros2::Node& self, Options options)
    : self_(self), options_(std::move(options)), library_(options_.message_path) {}

void TypeFinder::find(const Offer& offer, Callback found) {
  if (!is_valid_type_name(offer.type))
    return found(Error{"'" + printable(offer.type) + "' is not the name of a type"});
  ros2::MessageLibrary files = files_of_process(offer.pid);
  if (ros2::MessageLibrary* library = among_files(offer, files)) return found(library);
  if (offer.hash.empty())
    return found(unknown(offer, offer.request_hash.empty() ? "" : " as its server means it"));
  if (!is_hash(offer.hash))
    return found(unknown(offer, ", and its hash is none that can be checked"));
  if (const auto told = told_.find(offer.hash);
      told != told_.end() && is_what_it_says(told->second, offer))
    return found(&told->second);
  if (auto library = kept(options_.kept_types, offer)) return found(&*library);
  ask(offer, std::move(found));
}

ros2::MessageLibrary* TypeFinder::among_files(const Offer& offer, ros2::MessageLibrary& files) {
  if (offer.hash.empty() && offer.request_hash.empty()) {
    if (has(files, offer)) return &files;
    return has(library_, offer) ? &library_ : nullptr;
  }
  if (is_what_it_says(library_, offer)) return &library_;
  return is_what_it_says(files, offer) ? &files : nullptr;
}

void TypeFinder::ask(const Offer& offer, Callback found) {
  std::erase_if(questions_, [](const auto& question) { return question.second.waiting.empty(); });
  const auto [place, is_new] = questions_.try_emplace(offer.node + ' ' + offer.hash, Question{});
  Question& question = place->second;
  question.waiting.push_back(std::move(found));
  if (!is_new) return;
  auto client =
      self_.create_client<ros2::srv::GetTypeDescription>(offer.node + "/get_type_description");
  if (!client) return answered(offer, {ros2::CallOutcome::kUnreachable, {}});
  question.client = std::move(*client);
  question.client->call(
      {offer.type, offer.hash, false}, ros2::Repeat::kUntilAnswered, kPatience,
      [this, offer](const GetTypeDescription::Answer& answer) { answered(offer, answer); });
}

// The hash proves that an answer is true, not which node gave it.
void TypeFinder::answered(const Offer& offer, const GetTypeDescription::Answer& answer) {
  Question& question = questions_.at(offer.node + ' ' + offer.hash);
  const std::vector<Callback> waiting = std::exchange(question.waiting, {});
  const auto tell = [&](const Expected<ros2::MessageLibrary*>& library) {
    for (const Callback& found : waiting) found(library);
  };
  if (!answer.response || !answer.response->successful)
    return tell(unknown(offer, ", and its node does not describe it"));
  const auto definitions = ros2::to_definitions(answer.response->type_description);
  ros2::MessageLibrary library;
  if (definitions) library.define(*definitions);
  // The hash may fit without the type itself: a library makes those of actions and services.
  if (!definitions || !definitions->contains(offer.type) || !is_what_it_says(library, offer))
    return tell(unknown(offer, ", and its node's description differs from the published type"));
  const std::string text = to_text(offer.type, *definitions);
  if (text.size() > kLongestDescription)
    return tell(unknown(offer, ", and its node's description is too long"));
  keep(options_.kept_types, offer, text);
  if (told_.size() >= kMostTold || told_bytes_ + text.size() > kLongestTold) {
    told_.clear();
    told_bytes_ = 0;
  }
  told_bytes_ += text.size();
  tell(&told_.insert_or_assign(offer.hash, std::move(library)).first->second);
}

}  // namespace culprit::link
