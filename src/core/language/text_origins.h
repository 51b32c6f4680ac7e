// Where the parts of a text were written that was put together from several files and templates
// (reuse/expansion.h).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace culprit {

// Bytes [begin, end) of a Source's text.
struct Span {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  bool operator==(const Span&) const = default;
};

// A span of one of the files.
struct Place {
  std::uint32_t file = 0;  // 0 is the one that was asked for
  Span span;
  bool operator==(const Place&) const = default;
};

// The statement that brought a part of the text to where it is.
struct Step {
  enum class Kind : std::uint8_t { kInclude, kUse };
  static constexpr std::uint32_t kNone = 0xffffffff;
  Kind kind = Kind::kInclude;
  Place statement;
  std::uint32_t by = kNone;  // the step that brought this statement
};

// A part of the text that was written in one go. It reaches up to the next one.
struct Piece {
  std::uint32_t begin = 0;  // in the text
  Place written;
  bool is_verbatim = true;  // byte for byte as written; else it stands for all of `written`
  std::uint32_t step = Step::kNone;
  // The argument that a USE gives for the parameter at `written`, and the step that brought that
  // USE.
  std::optional<Place> argument{};
  bool is_argument_verbatim = true;
  std::uint32_t argument_step = Step::kNone;
};

// The origin of a part of the text, for messages to a person.
struct Origin {
  Place place;                   // where to look first, and what to change
  bool is_exact = true;          // the part stands there byte for byte
  std::optional<Place> goes_in;  // `place` is an argument: where the template has the parameter
  std::vector<Step> steps;       // that brought `place` to where it is, the nearest first
};

// The origin of [span.begin, span.end) in a text of `pieces`, which are not empty and ascending;
// `size`: the text's.
Origin origin_of(Span span, const std::vector<Piece>& pieces, const std::vector<Step>& steps,
                 std::uint32_t size);

}  // namespace culprit
