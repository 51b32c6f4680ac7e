// The faults that a drill has injected and not undone yet, in a file that outlives it.
//
// A fault is written here, on the disk, before it is injected. The next drill of the robot undoes what it finds: it
// continues a stopped process and sets a parameter back. If the file cannot be written (a full disk), nothing is
// injected. The file is sealed and only its user may write it; still nothing in it is believed more than needed:
//   - A process counts only if its number, its start and the boot of the machine are those of the file.
//   - A parameter is set back only if it still has the value that the drill set.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/expected.h"
#include "drill/fault.h"

namespace culprit::drill {

// One process of one boot.
struct ProcessId {
  int pid = 0;
  std::int64_t ticks = 0;  // its start, as the kernel counts
  bool operator==(const ProcessId&) const = default;
};

struct Injected {
  Fault fault;
  std::string node{};             // of the component, by full name
  ProcessId process{};            // of faults of a process
  std::optional<Value> before{};  // of a parameter
  bool operator==(const Injected&) const = default;
};

struct InjectedRecord {
  std::string boot;     // of the machine
  ProcessId manager{};  // the culprit that the drill started
  std::vector<Injected> faults{};
  bool operator==(const InjectedRecord&) const = default;
};

// On the disk when this returns. Errors name the file.
Expected<void> write_injected(const std::filesystem::path& path, const InjectedRecord& record);
// Nothing: there is no file. Errors, with the path: it cannot be read, is damaged, or does not say what a drill writes.
Expected<std::optional<InjectedRecord>> read_injected(const std::filesystem::path& path);

// Removes the file once all is undone. Gives the reason if it cannot be removed; undoing twice harms nothing.
Expected<void> forget_injected(const std::filesystem::path& path);

}  // namespace culprit::drill
