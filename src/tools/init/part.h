// What a draft is made of, so that it can be brought up to a robot that changed part by part.
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
  };
  Kind kind = Kind::kComment;
  // What it is about: of a component and a rule the node, of a level how rules call the status, of a
  // limit that and the key, of a use the template and the node, or all that stands behind USE. Empty: nothing
  // in particular.
  std::string subject{};
  std::string text{};  // whole lines
  std::string pack{};  // of a USE: "lidars"
  std::string node{};  // of a USE: one whose loss it sees; empty: it is about no particular one
};

// The subject of a part of which a draft has one.
inline constexpr const char* kAll = "all";

}  // namespace culprit::init
