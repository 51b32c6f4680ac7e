#include "ros2/message_library.h"

#include <algorithm>
#include <array>
#include <fcntl.h>
#include <linux/openat2.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "ros2/names.h"
#include "ros2/standard_messages.h"
#include "ros2/type_description.h"

namespace culprit::ros2 {
namespace {

constexpr off_t kMaxFileSize = 1 << 20;  // bytes; no .msg file has more
constexpr std::size_t kMaxParts = 1000;

// Opens `path` as somebody would whose root directory is `root`: links that are absolute, or lead
// upwards, stay below it. Negative if that is impossible.
int open_below(const std::filesystem::path& root, const std::filesystem::path& path) {
  constexpr int kFlags = O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY;
  if (root == "/") return open(path.c_str(), kFlags);
  const int base = open(root.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC);
  if (base < 0) return -1;
  open_how how{};
  how.flags = kFlags;
  how.resolve = RESOLVE_IN_ROOT | RESOLVE_NO_MAGICLINKS;
  const long file = syscall(SYS_openat2, base, path.c_str(), &how, sizeof how);
  close(base);
  return static_cast<int>(file);
}

std::optional<std::string> read_whole(int file) {
  struct stat about {};
  if (fstat(file, &about) != 0 || !S_ISREG(about.st_mode) || about.st_size > kMaxFileSize)
    return std::nullopt;
  std::string text(static_cast<std::size_t>(about.st_size), '\0');
  const ssize_t size = ::read(file, text.data(), text.size());
  if (size < 0) return std::nullopt;
  text.resize(static_cast<std::size_t>(size));
  return text;
}

// Where a type is defined: a file below a search directory, and which part of it, counted from 0.
struct Place {
  std::filesystem::path file;
  std::optional<std::size_t> part{};  // nothing: the whole
};

// Messages that stand in one file.
struct PartSuffix {
  std::string_view kind;    // "/srv/"
  std::string_view suffix;  // "_Request"
  std::string_view extension;
  std::size_t part;
};
constexpr auto kPartSuffixes = std::to_array<PartSuffix>({{"/srv/", "_Request", ".srv", 0},
                                                          {"/srv/", "_Response", ".srv", 1},
                                                          {"/action/", "_Goal", ".action", 0},
                                                          {"/action/", "_Result", ".action", 1},
                                                          {"/action/", "_Feedback", ".action", 2}});

bool is_of_kind(std::string_view type, std::string_view kind) {
  return type.find(kind) != std::string_view::npos;
}

Place place_of(std::string_view type) {
  for (const PartSuffix& each : kPartSuffixes) {
    if (!is_of_kind(type, each.kind) || !type.ends_with(each.suffix)) continue;
    const std::string whole(type.substr(0, type.size() - each.suffix.size()));
    return {whole + std::string(each.extension), each.part};
  }
  return {std::string(type) + ".msg"};
}

// A service as a type of its own, by whose hash it is known (rosidl, from Iron on): the request,
// the response, and the event of a call where calls are introspected.
std::optional<std::string> service_text(std::string_view type) {
  constexpr std::string_view kEvent = "_Event";
  const bool is_event = type.ends_with(kEvent);
  const std::string service(type.substr(0, type.size() - (is_event ? kEvent.size() : 0)));
  const bool is_of_action = is_of_kind(type, "/action/") &&
                            (service.ends_with("_SendGoal") || service.ends_with("_GetResult"));
  if (!is_of_action && !is_of_kind(type, "/srv/")) return std::nullopt;
  if (service.ends_with("_Request") || service.ends_with("_Response")) return std::nullopt;
  if (!is_event)
    return service + "_Request request_message\n" + service + "_Response response_message\n" +
           service + "_Event event_message\n";
  return "service_msgs/ServiceEventInfo info\n" + service + "_Request[<=1] request\n" + service +
         "_Response[<=1] response\n";
}

// The messages of an action around its own three (rosidl_parser, "implicit" types).
std::optional<std::string> action_text(std::string_view type) {
  if (!is_of_kind(type, "/action/")) return std::nullopt;
  const auto action_before = [&](std::string_view suffix) -> std::optional<std::string> {
    if (!type.ends_with(suffix)) return std::nullopt;
    return std::string(type.substr(0, type.size() - suffix.size()));
  };
  const std::string id = "unique_identifier_msgs/UUID goal_id\n";
  if (const auto action = action_before("_SendGoal_Request")) return id + *action + "_Goal goal\n";
  if (action_before("_SendGoal_Response")) return "bool accepted\nbuiltin_interfaces/Time stamp\n";
  if (action_before("_GetResult_Request")) return id;
  if (const auto action = action_before("_GetResult_Response"))
    return "int8 status\n" + *action + "_Result result\n";
  if (const auto action = action_before("_FeedbackMessage"))
    return id + *action + "_Feedback feedback\n";
  return std::nullopt;
}

// The service or action that `type` is made for: of "package/srv/Type_Event" that without "_Event". Or `type`, if it is one.
std::string_view interface_of(std::string_view type) {
  constexpr auto kSuffixes =
      std::to_array<std::string_view>({"_Event", "_Request", "_Response", "_SendGoal", "_GetResult",
                                       "_FeedbackMessage", "_Goal", "_Result", "_Feedback"});
  const auto suffix = [&] {
    return std::ranges::find_if(kSuffixes,
                                [&](std::string_view each) { return type.ends_with(each); });
  };
  for (auto found = suffix(); found != kSuffixes.end(); found = suffix())
    type.remove_suffix(found->size());
  return type;
}

// A line of three hyphens stands between two parts.
std::string part_of(std::string_view text, std::optional<std::size_t> part) {
  if (!part) return std::string(text);
  std::string found;
  std::size_t number = 0;
  while (!text.empty() && number <= *part) {
    const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
    if (text.starts_with("---")) {
      ++number;
    } else if (number == *part) {
      found += text.substr(0, end);
    }
    text.remove_prefix(end);
  }
  return found;
}

}  // namespace

MessageLibrary::MessageLibrary(std::vector<std::filesystem::path> directories,
                               std::filesystem::path root)
    : directories_(std::move(directories)), root_(std::move(root)) {}

void MessageLibrary::learn(std::string_view type, std::string_view text) {
  static const std::string kSeparator = '\n' + std::string(80, '=') + '\n';
  constexpr auto kNames = std::to_array<std::string_view>({"MSG: ", "SRV: ", "ACTION: "});
  std::string name(type);
  while (true) {
    const std::size_t end = std::min(text.find(kSeparator), text.size());
    learn_one(name, text.substr(0, end));
    if (end == text.size()) return;
    text.remove_prefix(end + kSeparator.size());
    const std::size_t line = text.find('\n');
    const auto kind =
        std::ranges::find_if(kNames, [&](std::string_view each) { return text.starts_with(each); });
    if (kind == kNames.end() || line == std::string_view::npos) return;
    name = text.substr(kind->size(), line - kind->size());
    const std::size_t slash = name.find('/');
    if (slash != std::string::npos && name.find('/', slash + 1) == std::string::npos)
      name.insert(slash, "/msg");
    text.remove_prefix(line);  // The end of the line may begin the next separator.
  }
}

// The text of a .srv or .action file is that of all its parts; types that are made of them follow.
void MessageLibrary::learn_one(std::string_view type, std::string_view text) {
  const bool has_parts = text.starts_with("---") || text.find("\n---") != std::string_view::npos;
  const std::string interface(interface_of(type));
  bool is_interface = false;
  for (const PartSuffix& each : kPartSuffixes) {
    if (!has_parts || !is_of_kind(type, each.kind)) continue;
    learned_.try_emplace(interface + std::string(each.suffix), part_of(text, each.part));
    is_interface = true;
  }
  if (!is_interface) learned_.try_emplace(std::string(type), text);
}

Expected<const MessageDefinition*> MessageLibrary::find(std::string_view type) {
  if (const auto known = known_.find(type); known != known_.end()) return &known->second;
  // The name may come from the network, and becomes part of a path.
  if (!is_valid_type_name(type))
    return Error{"'" + printable(type) + "' is not the name of a type"};
  auto loaded = load(type);
  if (!loaded) return Error{loaded.error()};
  return &known_.emplace(type, std::move(*loaded)).first->second;
}

Expected<MessageDefinition> MessageLibrary::load(std::string_view type) const {
  if (const auto learned = learned_.find(type); learned != learned_.end())
    return parse_message_definition(learned->second, type, type);
  if (const auto text = service_text(type)) return parse_message_definition(*text, type, type);
  if (const auto text = action_text(type)) return parse_message_definition(*text, type, type);
  const auto& [below, part] = place_of(type);
  for (const auto& directory : directories_) {
    for (const auto& path : {directory / below, directory / "share" / below}) {
      if (const auto text = read(path))
        return parse_message_definition(part_of(*text, part), type, path.string());
    }
  }
  if (const auto text = standard_message(type)) {
    return parse_message_definition(*text, type, type);
  }
  return Error{"the message type " + std::string(type) +
               " is not known; give the directory that holds " + below.string() +
               " with --message-path"};
}

// A path that is no file, or a very large file, is passed over: others may control the folder's
// content.
std::optional<std::string> MessageLibrary::read(const std::filesystem::path& path) const {
  const int file = open_below(root_, path);
  if (file < 0) return std::nullopt;
  auto text = read_whole(file);
  close(file);
  return text;
}

Expected<MessageDefinitions> MessageLibrary::with_parts(std::string_view type) {
  MessageDefinitions parts;
  std::vector<std::string> open = {std::string(type)};
  while (!open.empty()) {
    const std::string name = std::move(open.back());
    open.pop_back();
    if (parts.contains(name)) continue;
    if (parts.size() >= kMaxParts)
      return Error{std::string(type) + " has more than " + std::to_string(kMaxParts) +
                   " types in it"};
    const auto definition = find(name);
    if (!definition) return Error{definition.error()};
    for (const FieldDefinition& field : (*definition)->fields) {
      if (const auto* part = std::get_if<std::string>(&field.element)) open.push_back(*part);
    }
    parts.emplace(name, **definition);
  }
  return parts;
}

Expected<std::string> MessageLibrary::hash_of(std::string_view type) {
  auto parts = with_parts(type);
  if (!parts) return Error{parts.error()};
  return type_hash(type, *parts);
}

void MessageLibrary::define(const MessageDefinitions& definitions) {
  for (const auto& [type, definition] : definitions) known_.insert_or_assign(type, definition);
}

std::vector<std::filesystem::path> message_directories(std::vector<std::filesystem::path> first,
                                                       std::string_view ament_prefix_path) {
  while (!ament_prefix_path.empty()) {
    const auto end = std::min(ament_prefix_path.find(':'), ament_prefix_path.size());
    if (end > 0) first.emplace_back(ament_prefix_path.substr(0, end));
    ament_prefix_path.remove_prefix(std::min(end + 1, ament_prefix_path.size()));
  }
  return first;
}

}  // namespace culprit::ros2
