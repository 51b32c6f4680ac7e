// A mistake that a check found in a rule file: one diagnostic each.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/closest.h"
#include "language/source.h"

namespace culprit {

// Stable: a code never changes its meaning, and the number of a retired one is not used again.
enum class Code : std::uint16_t {
  // Syntax
  kUnknownStatement = 1,
  kSyntax = 2,
  kBadToken = 3,
  kExtraText = 4,
  kOutOfPlace = 5,
  kIncomplete = 6,
  kTooDeep = 7,
  kPlaceholder = 8,
  kSettingInRule = 9,
  // Names
  kDuplicateName = 10,
  kUnknownName = 11,
  kUndeclared = 12,
  kUnknownFunction = 13,
  kUnknownAdaptation = 14,
  kUnknownPolicy = 15,
  kReservedWord = 16,
  kBadRosName = 17,
  kUnused = 18,
  // Types and values
  kTypeMismatch = 20,
  kUnknownType = 21,
  kArguments = 22,
  kNotConstant = 23,
  kNoValue = 24,
  // Ranges
  kProbabilityRange = 30,
  kConfidenceRange = 31,
  kImpactRange = 32,
  kPolicyRange = 33,
  kEmptyRange = 34,
  kShortImpact = 35,
  kShortWindow = 36,
  kLongWindow = 37,
  kLateLastResort = 38,
  // Rules that cannot work
  kContradiction = 40,
  kNoLaunch = 41,
  kNeverValid = 42,
  kStopsRequired = 43,
  kTwoOwners = 44,
  kTrueWhenWell = 45,
  kNoShell = 46,
  kBadGroup = 47,
  kAdaptsEffect = 48,
  kMovesInterlock = 49,
  kAlwaysTrue = 50,
  kNeverTrue = 51,
  kOscillation = 52,
  kCircularDependency = 53,
  kAlwaysTrueInRange = 54,
  kNeverTrueInRange = 55,
  kCovered = 56,
  kWhenNeverTrue = 57,
  kWhenContradictsTrigger = 58,
  kNoLastResort = 59,
  // Names that do not exist on the robot at hand
  kNoSuchNode = 60,
  kNoSuchTopic = 61,
  kNoSuchParameter = 62,
  kNoSuchDiagnostic = 63,
  kNoSuchService = 64,
  kNoSuchUnit = 65,
  kCannotLaunch = 66,
  kNoSuchField = 67,
  kSeveralNodes = 68,
  kNoSuchHost = 69,
  kBadRequest = 70,
  kRunsOtherwise = 71,
  // How components are started
  kBadCommand = 72,
  kNoContainer = 73,
  // Reuse
  kCannotInclude = 80,
  kUnknownTemplate = 81,
  kTemplateArguments = 82,
  kUnknownParameter = 83,
  kEndlessTemplate = 84,
};

// "R011"
std::string to_string(Code code);

enum class Severity : std::uint8_t { kError, kWarning };

// `text` instead of what stands at `span`; an empty span is the place of an insertion.
struct Edit {
  Span span;
  std::string text;
  bool operator==(const Edit&) const = default;
};

struct Diagnostic {
  Code code;
  Severity severity = Severity::kError;
  Span span;
  std::string cause;   // one line: the mistake
  std::string remedy;  // one line: the action; may be empty where the cause implies it
  // The remedy for programs: after this edit the diagnostic is gone. Only where it is one exact
  // edit, and where no other one is as likely to be meant.
  std::optional<Edit> fix = std::nullopt;
  bool operator==(const Diagnostic&) const = default;
};

// A diagnostic as the file has it that it is about: what that is in, and what else to look at.
struct LocatedDiagnostic {
  struct Note {
    Place place;
    std::string text;  // "included here"
  };
  Place place;
  std::vector<Note> notes;
  std::optional<Edit> fix;  // of that file; nothing also where the edit is not of one place
};
LocatedDiagnostic located(const Diagnostic& diagnostic, const Source& source);
// For a text that was put together from one file: the same diagnostics, with the places of that
// file.
std::vector<Diagnostic> as_written(std::vector<Diagnostic> diagnostics, const Source& source);

// The edit in words, for people who choose it: "change 'robot' to 'ROBOT'".
std::string title_of(const Edit& edit, const Source& source);

enum class Colour : std::uint8_t { kOff, kOn };

// As a compiler shows it: place and cause, the line with carets under the span, the remedy; then the
// notes.
std::string render(const Diagnostic& diagnostic, const Source& source,
                   Colour colour = Colour::kOff);

// All of them, one behind the other; of very many the first ones, errors before warnings, and how
// many more there are.
inline constexpr std::size_t kMostShown = 50;
std::string render(const std::vector<Diagnostic>& diagnostics, const Source& source,
                   Colour colour = Colour::kOff);

// The edit that puts the name found by closest() in its place; nothing if none was found.
std::optional<Edit> replacement(Span span, const std::string& near);

}  // namespace culprit
