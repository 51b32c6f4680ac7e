// Reads one value out of a message, without decoding the rest of it.
//
// A path such as `pose.pose.position.x`, `ranges[3]` or `status[0].level` is compiled once, against
// the definition of the message type, into a flat plan: the fields to pass over, then those to
// read. An element may have a name for its index: `effort[elbow]` is that of the array `name` (or
// `names`, `joint_names`) before it; `status[lidar].level` is of the first message in the array whose
// `name` (or `child_frame_id`, `key`, `id`) is that. `min(ranges)` and `max(ranges)` are over an
// array, but for NaN. `delay(header.stamp)` is the time from a stamp until the message arrived, in
// seconds.
//
// Reading allocates no memory, except for a string. Payloads are hostile: reading one takes
// time proportional to its size, whatever it claims.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "base/expected.h"
#include "base/value.h"
#include "ros2/message_library.h"
#include "rtps/cdr.h"

namespace culprit::ros2 {

enum class FieldStatus : std::uint8_t {
  kRead,
  kAbsent,    // the array is too short for the index
  kMalformed  // the payload is not a message of that type
};

enum class PayloadFit : std::uint8_t {
  kFits,
  kMalformed,  // it ends too early, or is not in CDR
  kTooLong     // bytes follow the last field
};

class FieldReader {
 public:
  // A path ends at a primitive or a string. Errors list the existing fields.
  static Expected<FieldReader> compile(MessageLibrary& library, std::string_view type,
                                       std::string_view path);

  // Goes through all of a message, for fit(). Errors as above.
  static Expected<FieldReader> compile_whole(MessageLibrary& library, std::string_view type);

  // How the payload compares with the type. @pre compile_whole()
  PayloadFit fit(rtps::ByteView payload) const;

  // Whether read() gives numbers. @pre compile()
  bool reads_number() const;

  // Sets `value` if and only if kRead. Every integer type becomes int64 (uint64 saturates), both
  // floating-point types double. `arrival`: nanoseconds since 1970, for delay(); without it there is
  // none.
  FieldStatus read(rtps::ByteView payload, Value& value, std::int64_t arrival = 0) const;

 private:
  enum class Op : std::uint8_t {
    kSkip,           // `count` primitives of `size` bytes
    kSkipSequence,   // a count n, then n primitives of `size` bytes
    kSkipString,     // a string
    kRepeat,         // the next `length` steps, `count` times
    kRepeatCounted,  // a count n, then the next `length` steps, n times
    kBound,          // a count n; the field is absent unless n > `count`
    kRead,           // the value, a `primitive`
    kFind,           // a count n, then n strings: the place of key `count` among them
    kSkipFound,    // a count n, then as many primitives of `size` bytes as stand before that place
    kRepeatFound,  // a count n, then the next `length` steps for each element before that place
    kSearch,       // a count n: the next `length` steps pass over the key of an element, then
                   // `count` over all of it; what follows reads the element that has the key
    kMatch,        // a string, which may be key `count`
    kLeast,        // `count` primitives, or a count n and n of them if that is 0: the least
    kGreatest,     // likewise
    kDelay,        // a builtin_interfaces/msg/Time
    kStruct,       // the header of XCDR2 before a struct
    kField,        // likewise before a field
    kCollection    // likewise before an array or sequence of strings or messages
  };
  struct Step {
    Op op;
    Primitive primitive = Primitive::kBool;
    std::uint8_t size = 0;
    std::uint32_t length = 0;
    std::uint32_t count = 0;
  };
  class Compiler;

  // The state of a run of the plan.
  struct Run {
    const std::vector<Step>& plan;
    Value& value;
    std::int64_t arrival = 0;
    std::uint32_t found = 0;  // by kFind
    bool was_found = false;   // by kFind or kMatch
  };
  FieldStatus run(rtps::CdrReader& reader, std::size_t begin, std::size_t end, Run& state) const;
  bool search(rtps::CdrReader& reader, std::size_t at, Run& state) const;
  FieldStatus fold(rtps::CdrReader& reader, const Step& step, Run& state) const;

  const std::vector<Step>& plan_for(const rtps::CdrReader& reader) const;

  std::vector<Step> plan_;
  std::vector<Step> plan2_;  // the same for XCDR2; empty: it would be too long
  std::vector<std::string> keys_;
};

}  // namespace culprit::ros2
