// The parts of a draft, so that it can be updated part by part when the robot has changed.
#pragma once

#include <cstdint>
#include <string>

namespace culprit::init {

struct Part {
  enum class Kind : std::uint8_t {
    kHead,       // what stands in front
    kComponent,  // one line
    kUse,        // a paragraph each, and so on
    kRule,
    kLevel,      // a rule that reports a diagnostic
    kComment,    // a proposal of its own
    kLimit,      // proposals likewise: limits of a key of a diagnostic,
    kInterlock,  // and all interlocks together
    kLeftOut,    // what was left out, with the reasons
    kValues,     // rules that report values of a topic; last, since marks hold the number
  };
  Kind kind = Kind::kComment;
  // The subject: the node of a component or a rule; the topic of values; the rules' name of the status for a level; that and the key for a limit. For a use it is the template and
  // the node, or the whole text after USE. Empty: none.
  std::string subject{};
  std::string text{};  // whole lines
  std::string pack{};  // of a USE: "lidars"
  std::string node{};  // of a USE: one whose loss it sees; empty: it is about no particular one
};

// The subject of a part of which a draft has one.
inline constexpr const char* kAll = "all";

}  // namespace culprit::init
