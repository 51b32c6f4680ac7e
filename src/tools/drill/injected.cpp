#include "drill/injected.h"

#include "journal/json.h"
#include "journal/sealed_file.h"

namespace culprit::drill {
namespace {

constexpr std::size_t kMostFaults = 16;

Json process_to_json(const ProcessId& process) {
  return {{"pid", process.pid}, {"ticks", process.ticks}};
}

// A number of no process stands for none: 0 would mean our own group, and below that everything.
ProcessId process_from(const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end()) return {};
  const std::int64_t pid = journal::integer_of(*found, "pid");
  const std::int64_t ticks = journal::integer_of(*found, "ticks");
  constexpr std::int64_t kInit = 1;
  constexpr std::int64_t kMostPid = 1 << 22;  // proc(5): pid_max
  if (pid <= kInit || pid > kMostPid || ticks <= 0) return {};
  return {static_cast<int>(pid), ticks};
}

std::optional<Injected> injected_from(const Json& json) {
  const auto fault =
      json.is_object() && json.contains("fault") ? fault_from(json["fault"]) : std::nullopt;
  if (!fault) return std::nullopt;
  Injected out{*fault, journal::text_of(json, "node"), process_from(json, "process"), {}};
  if (json.contains("before")) out.before = value_from(json["before"]);
  return out;
}

}  // namespace

Expected<void> write_injected(const std::filesystem::path& path, const InjectedRecord& record) {
  Json json{{"boot", record.boot},
            {"manager", process_to_json(record.manager)},
            {"faults", Json::array()}};
  for (const Injected& each : record.faults) {
    Json one{{"fault", to_json(each.fault)},
             {"node", each.node},
             {"process", process_to_json(each.process)}};
    if (each.before) one["before"] = value_to_json(*each.before);
    json["faults"].push_back(std::move(one));
  }
  return journal::write_sealed(path, to_line(json) + "\n");
}

Expected<std::optional<InjectedRecord>> read_injected(const std::filesystem::path& path) {
  const auto text = journal::read_sealed(path);
  if (!text) return Error{text.error()};
  if (!*text) return std::optional<InjectedRecord>();
  const Error strange{"'" + path.string() + "' is no record of a drill"};
  const Json json = parse_strict_json(**text);
  if (!json.is_object() || !json.contains("faults") || !json["faults"].is_array() ||
      json["faults"].size() > kMostFaults)
    return strange;
  InjectedRecord record{journal::text_of(json, "boot"), process_from(json, "manager"), {}};
  for (const Json& each : json["faults"]) {
    auto injected = injected_from(each);
    if (!injected) return strange;
    record.faults.push_back(std::move(*injected));
  }
  return std::optional(std::move(record));
}

Expected<void> forget_injected(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::remove(path, error);
  if (error) return Error{"cannot remove '" + path.string() + "': " + error.message()};
  return {};
}

}  // namespace culprit::drill
