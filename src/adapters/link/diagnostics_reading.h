// Picks the rules' signals out of diagnostic messages.
//
// A declared signal names a status, by its name or its hardware id, and a key. An undeclared signal
// is looked for as a key of its name, or as "<hardware id>_<key>" or "<status name>_<key>" (the
// convention of the SUNSET exemplar's blackboard). Until all of them are found, the names that
// arrive instead are reported, so that a misspelled one can be found.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "language/rule_set.h"
#include "robot/observation.h"
#include "ros2/messages.h"

namespace culprit::link {

class DiagnosticsReading {
 public:
  // Limits of that report: strangers choose how much there is.
  static constexpr std::size_t kMostStatuses = 256;
  static constexpr std::size_t kMostKeys = 64;
  static constexpr std::size_t kLongestName = 256;

  explicit DiagnosticsReading(const RuleSet& rules);

  // Whether the rules read any diagnostic.
  bool is_wanted() const { return !signals_.empty() || !levels_.empty(); }

  std::function<void(SignalId, const std::string& text)> on_signal;
  std::function<void(DiagnosticId, std::uint8_t level)> on_level;

  std::function<void(StatusHeard)> on_status;  // each status once

  // Whether the message's publisher may report `status`, as the rules name it
  // (signal_publishers.h); with `publisher`: to a signal that is declared FROM that one.
  using MaySay =
      std::function<bool(const std::string& status, std::optional<ComponentId> publisher)>;
  // Calls the three above for what the rules want of `message`.
  void read(const ros2::msg::DiagnosticArray& message, const MaySay& may_say = {});

 private:
  template <class Id>
  struct Wanted {
    Id id;
    std::string status;
    std::optional<ComponentId> publisher{};
    bool was_found = false;
  };

  void read(const ros2::msg::DiagnosticStatus& status, const MaySay& may_say);
  void read_named(const std::string& name, const ros2::msg::DiagnosticStatus& status,
                  const MaySay& may_say);
  void read(const std::string& name, const std::string& text, const MaySay& may_say);
  void tell_name(const ros2::msg::DiagnosticStatus& status);
  template <class Id>
  void note_found(Wanted<Id>& wanted);

  // By "status\nkey", or the bare name.
  std::unordered_map<std::string, std::vector<Wanted<SignalId>>> signals_;
  std::unordered_map<std::string, Wanted<DiagnosticId>> levels_;  // by name or hardware id
  std::size_t longest_ = 0;  // bytes of a name in either: longer ones are never put together
  std::size_t missing_ = 0;  // of both
  std::unordered_set<std::string> told_;  // "name\nhardware id" of statuses
};

}  // namespace culprit::link
