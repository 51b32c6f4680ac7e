#include "ros2/field_reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "base/joined.h"
#include "ros2/names.h"

namespace culprit::ros2 {
namespace {

// A definition that nests itself, or multiplies, would never end. Real types stay far below both.
constexpr std::size_t kLongestPlan = 4096;
constexpr int kDeepestNesting = 32;

// On the wire; strings have none.
std::uint8_t size_of(Primitive primitive) {
  switch (primitive) {
    case Primitive::kBool:
    case Primitive::kByte:
    case Primitive::kChar:
    case Primitive::kInt8:
    case Primitive::kUint8:
      return 1;
    case Primitive::kInt16:
    case Primitive::kUint16:
      return 2;
    case Primitive::kInt32:
    case Primitive::kUint32:
    case Primitive::kFloat32:
      return 4;
    case Primitive::kInt64:
    case Primitive::kUint64:
    case Primitive::kFloat64:
      return 8;
    case Primitive::kString:
    case Primitive::kWString:
      return 0;
  }
  return 0;
}

Value read_value(rtps::CdrReader& reader, Primitive primitive) {
  const auto integer = [](auto i) { return static_cast<std::int64_t>(i); };
  switch (primitive) {
    case Primitive::kBool:
      return reader.read<bool>();
    case Primitive::kByte:
    case Primitive::kChar:
    case Primitive::kUint8:
      return integer(reader.read<std::uint8_t>());
    case Primitive::kInt8:
      return integer(reader.read<std::int8_t>());
    case Primitive::kInt16:
      return integer(reader.read<std::int16_t>());
    case Primitive::kUint16:
      return integer(reader.read<std::uint16_t>());
    case Primitive::kInt32:
      return integer(reader.read<std::int32_t>());
    case Primitive::kUint32:
      return integer(reader.read<std::uint32_t>());
    case Primitive::kInt64:
      return reader.read<std::int64_t>();
    case Primitive::kUint64: {
      constexpr std::uint64_t kMost = std::numeric_limits<std::int64_t>::max();
      return integer(std::min(reader.read<std::uint64_t>(), kMost));
    }
    case Primitive::kFloat32:
      return static_cast<double>(reader.read<float>());
    case Primitive::kFloat64:
      return reader.read<double>();
    case Primitive::kString:
    case Primitive::kWString:
      return std::string(reader.read_string());
  }
  return false;
}

std::string field_names(const MessageDefinition& definition) {
  const std::string names = joined(definition.fields, ", ", &FieldDefinition::name);
  return names.empty() ? "none" : names;
}

// One element of a path: a field name, perhaps with an index or the name of an element.
struct Hop {
  std::string_view name;
  std::optional<std::uint32_t> index;
  std::string_view key{};
};

// Fields with the names of elements: of the arrays beside it, and of messages in an array.
constexpr std::array<std::string_view, 3> kNamesOfElements = {"name", "names", "joint_names"};
constexpr std::array<std::string_view, 4> kNameOfElement = {"name", "child_frame_id", "key", "id"};

bool is_text(const FieldDefinition& field, Shape shape) {
  const auto* primitive = std::get_if<Primitive>(&field.element);
  return primitive != nullptr && *primitive == Primitive::kString && field.shape == shape;
}

const FieldDefinition* find_name(const MessageDefinition& definition,
                                 std::span<const std::string_view> names, Shape shape) {
  for (const std::string_view name : names) {
    for (const FieldDefinition& field : definition.fields) {
      if (field.name == name && is_text(field, shape)) return &field;
    }
  }
  return nullptr;
}

// "max(ranges)": the path in it, if `path` is of this function.
std::optional<std::string_view> argument_of(std::string_view path, std::string_view function) {
  if (!path.starts_with(function) || !path.ends_with(')')) return std::nullopt;
  path.remove_prefix(function.size());
  if (!path.starts_with('(')) return std::nullopt;
  return path.substr(1, path.size() - 2);
}

// Takes a hop off `path`; nothing when there is none.
std::optional<Hop> take_hop(std::string_view& path) {
  Hop hop{path.substr(0, path.find_first_of(".[")), std::nullopt};
  path.remove_prefix(hop.name.size());
  if (path.starts_with('[')) {
    const char* end = path.data() + path.size();
    std::uint32_t index = 0;
    const auto [rest, error] = std::from_chars(path.data() + 1, end, index);
    if (error == std::errc() && rest != end && *rest == ']') {
      hop.index = index;
      path.remove_prefix(static_cast<std::size_t>(rest - path.data()) + 1);
    } else {
      const std::size_t close = path.find(']');
      if (close == std::string_view::npos || close == 1) return std::nullopt;
      hop.key = path.substr(1, close - 1);
      path.remove_prefix(close + 1);
    }
  }
  if (path.starts_with('.') && path.size() > 1) {
    path.remove_prefix(1);
  } else if (!path.empty()) {
    return std::nullopt;
  }
  return hop;
}

}  // namespace

class FieldReader::Compiler {
 public:
  Compiler(MessageLibrary& library, bool is_xcdr2) : library_(library), is_xcdr2_(is_xcdr2) {}

  Expected<std::vector<Step>> compile_whole(const std::string& type) {
    const FieldDefinition whole{"", type};
    if (auto skipped = skip_element(whole, 0); !skipped) return Error{skipped.error()};
    return std::move(plan_);
  }

  Expected<std::vector<Step>> compile(std::string_view type, std::string_view path) {
    if (const auto array = argument_of(path, "min")) return go(type, *array, Op::kLeast);
    if (const auto array = argument_of(path, "max")) return go(type, *array, Op::kGreatest);
    if (const auto stamp = argument_of(path, "delay")) return go(type, *stamp, Op::kDelay);
    return go(type, path, Op::kRead);
  }

  std::vector<std::string> take_keys() { return std::move(keys_); }

 private:
  // `last`: what is done with what the path ends at.
  Expected<std::vector<Step>> go(std::string_view type, std::string_view path, Op last) {
    std::string_view rest = path;
    std::string current(type);
    while (true) {
      const auto definition = library_.find(current);
      if (!definition) return Error{definition.error()};
      mark(Op::kStruct);
      if (rest.empty() && last == Op::kDelay && current == "builtin_interfaces/msg/Time") {
        plan_.push_back({.op = Op::kDelay});
        return std::move(plan_);
      }
      const auto hop = take_hop(rest);
      if (!hop || hop->name.empty()) {
        return Error{"'" + printable(path) +
                     "' is not a path to a field; write one like pose.position.x or ranges[0]"};
      }
      const auto field = reach(**definition, *hop);
      if (!field) return Error{field.error()};
      const bool is_array = (*field)->shape != Shape::kSingle;
      const bool is_folded = rest.empty() && (last == Op::kLeast || last == Op::kGreatest);
      if (is_folded && is_array && !hop->index && hop->key.empty()) return fold(**field, last);
      if (is_folded) return Error{"'" + printable(path) + "' is not an array"};
      if (auto entered = enter(**field, *hop); !entered) return Error{entered.error()};
      if (const auto* primitive = std::get_if<Primitive>(&(*field)->element)) {
        if (last != Op::kRead) return Error{"'" + printable(path) + "' is not a time stamp"};
        return finish(**field, *primitive, rest);
      }
      current = std::get<std::string>((*field)->element);
      if (rest.empty() && last != Op::kDelay) {
        return Error{"'" + printable(path) + "' is a whole " + current +
                     "; go on to one of its fields"};
      }
    }
  }

  // Passes over what stands before the field. Where an element of it has a name, the names may be there.
  Expected<const FieldDefinition*> reach(const MessageDefinition& definition, const Hop& hop) {
    const FieldDefinition* names =
        hop.key.empty() ? nullptr : find_name(definition, kNamesOfElements, Shape::kSequence);
    for (const FieldDefinition& candidate : definition.fields) {
      mark(Op::kField);
      if (candidate.name == hop.name) return &candidate;
      if (&candidate == names) {
        mark(Op::kCollection);
        plan_.push_back({.op = Op::kFind, .count = key_of(hop.key)});
        has_found_ = true;
        continue;
      }
      if (auto skipped = skip_field(candidate, 0); !skipped) return Error{skipped.error()};
    }
    return Error{definition.type + " has no field '" + printable(hop.name) + "'; its fields are " +
                 field_names(definition)};
  }

  std::uint32_t key_of(std::string_view key) {
    keys_.emplace_back(key);
    return static_cast<std::uint32_t>(keys_.size() - 1);
  }

  Expected<std::vector<Step>> fold(const FieldDefinition& field, Op op) {
    const auto* primitive = std::get_if<Primitive>(&field.element);
    if (primitive == nullptr || size_of(*primitive) == 0 || *primitive == Primitive::kBool)
      return Error{"'" + field.name + "' is not an array of numbers"};
    plan_.push_back({.op = op,
                     .primitive = *primitive,
                     .size = size_of(*primitive),
                     .count = field.shape == Shape::kArray ? field.count : 0});
    return std::move(plan_);
  }

  Expected<std::vector<Step>> finish(const FieldDefinition& field, Primitive primitive,
                                     std::string_view rest) {
    if (!rest.empty())
      return Error{"'" + field.name + "' is a value and has no field '" + printable(rest) + "'"};
    if (primitive == Primitive::kWString) return wide_string(field);
    plan_.push_back({.op = Op::kRead, .primitive = primitive});
    if (plan_.size() > kLongestPlan) return too_big();
    return std::move(plan_);
  }

  // From the start of `field` to the start of the element that has this name.
  Expected<void> enter_named(const FieldDefinition& field, const Hop& hop) {
    if (field.shape != Shape::kSequence)
      return Error{"'" + field.name + "' has no elements with names"};
    if (std::exchange(has_found_, false)) {
      const auto* primitive = std::get_if<Primitive>(&field.element);
      if (primitive != nullptr && size_of(*primitive) > 0) {
        plan_.push_back({.op = Op::kSkipFound, .size = size_of(*primitive)});
        return {};
      }
      mark(Op::kCollection);
      return skip_repeatedly({.op = Op::kRepeatFound}, field, 0);
    }
    const auto* type = std::get_if<std::string>(&field.element);
    const auto element =
        type == nullptr ? Expected<const MessageDefinition*>(Error{""}) : library_.find(*type);
    const FieldDefinition* name =
        element ? find_name(**element, kNameOfElement, Shape::kSingle) : nullptr;
    if (name == nullptr)
      return Error{"the elements of '" + field.name + "' have no names; write " + field.name +
                   "[0] for its first element"};
    mark(Op::kCollection);
    const std::size_t at = plan_.size();
    plan_.push_back({.op = Op::kSearch});
    mark(Op::kStruct);
    for (const FieldDefinition& each : (*element)->fields) {
      mark(Op::kField);
      if (&each == name) break;
      if (auto skipped = skip_field(each, 0); !skipped) return skipped;
    }
    plan_.push_back({.op = Op::kMatch, .count = key_of(hop.key)});
    const std::size_t whole = plan_.size();
    plan_[at].length = static_cast<std::uint32_t>(whole - at - 1);
    if (auto skipped = skip_element(field, 0); !skipped) return skipped;
    plan_[at].count = static_cast<std::uint32_t>(plan_.size() - whole);
    return {};
  }

  // From the start of `field` to the start of the element that `hop` means.
  Expected<void> enter(const FieldDefinition& field, const Hop& hop) {
    if (!hop.key.empty()) return enter_named(field, hop);
    if (field.shape == Shape::kSingle) {
      if (hop.index) return Error{"'" + field.name + "' is not an array"};
      return {};
    }
    if (!hop.index) {
      return Error{"'" + field.name + "' is an array; write " + field.name +
                   "[0] for its first element"};
    }
    if (field.shape == Shape::kArray && *hop.index >= field.count) {
      return Error{"'" + field.name + "' has " + std::to_string(field.count) +
                   " elements, the last is " + field.name + "[" + std::to_string(field.count - 1) +
                   "]"};
    }
    mark_collection(field);
    if (field.shape == Shape::kSequence) plan_.push_back({.op = Op::kBound, .count = *hop.index});
    return skip_elements(field, *hop.index, 0);
  }

  Expected<void> skip_field(const FieldDefinition& field, int depth) {
    mark_collection(field);
    if (field.shape != Shape::kSequence) return skip_elements(field, field.count, depth);
    if (const auto* primitive = std::get_if<Primitive>(&field.element);
        primitive && size_of(*primitive) > 0) {
      plan_.push_back({.op = Op::kSkipSequence, .size = size_of(*primitive)});
      return {};
    }
    return skip_repeatedly({.op = Op::kRepeatCounted}, field, depth);
  }

  Expected<void> skip_elements(const FieldDefinition& field, std::uint32_t count, int depth) {
    if (count == 0) return {};
    if (const auto* primitive = std::get_if<Primitive>(&field.element);
        primitive && size_of(*primitive) > 0) {
      plan_.push_back({.op = Op::kSkip, .size = size_of(*primitive), .count = count});
      return {};
    }
    if (count == 1) return skip_element(field, depth);
    return skip_repeatedly({.op = Op::kRepeat, .count = count}, field, depth);
  }

  Expected<void> skip_repeatedly(Step repeat, const FieldDefinition& field, int depth) {
    const std::size_t at = plan_.size();
    plan_.push_back(repeat);
    if (auto skipped = skip_element(field, depth); !skipped) return skipped;
    plan_[at].length = static_cast<std::uint32_t>(plan_.size() - at - 1);
    return {};
  }

  // One string or message.
  Expected<void> skip_element(const FieldDefinition& field, int depth) {
    if (plan_.size() > kLongestPlan || depth > kDeepestNesting) return too_big();
    if (const auto* primitive = std::get_if<Primitive>(&field.element)) {
      if (*primitive == Primitive::kWString) return wide_string(field);
      plan_.push_back({.op = Op::kSkipString});
      return {};
    }
    const auto definition = library_.find(std::get<std::string>(field.element));
    if (!definition) return Error{definition.error()};
    mark(Op::kStruct);
    if ((*definition)->fields.empty()) plan_.push_back({.op = Op::kSkip, .size = 1, .count = 1});
    for (const FieldDefinition& inner : (*definition)->fields) {
      mark(Op::kField);
      if (auto skipped = skip_field(inner, depth + 1); !skipped) return skipped;
    }
    return {};
  }

  void mark(Op header) {
    if (is_xcdr2_) plan_.push_back({.op = header});
  }
  void mark_collection(const FieldDefinition& field) {
    const auto* primitive = std::get_if<Primitive>(&field.element);
    const bool is_of_primitives = primitive != nullptr && size_of(*primitive) > 0;
    if (field.shape != Shape::kSingle && !is_of_primitives) mark(Op::kCollection);
  }

  static Error wide_string(const FieldDefinition& field) {
    return Error{"'" + field.name +
                 "' is a wstring, which every DDS encodes in its own way; fields after it and it "
                 "itself cannot be read"};
  }

  static Error too_big() {
    return Error{"the message type nests too deep, or is defined by itself"};
  }

  MessageLibrary& library_;
  const bool is_xcdr2_;  // the plan has the headers of XCDR2
  std::vector<Step> plan_;
  std::vector<std::string> keys_;
  bool has_found_ = false;  // the plan has a kFind whose place is not used yet
};

Expected<FieldReader> FieldReader::compile(MessageLibrary& library, std::string_view type,
                                           std::string_view path) {
  Compiler compiler(library, false);
  auto plan = compiler.compile(type, path);
  if (!plan) return Error{plan.error()};
  FieldReader reader;
  reader.plan_ = std::move(*plan);
  reader.keys_ = compiler.take_keys();
  if (auto plan2 = Compiler(library, true).compile(type, path)) reader.plan2_ = std::move(*plan2);
  return reader;
}

Expected<FieldReader> FieldReader::compile_whole(MessageLibrary& library, std::string_view type) {
  auto plan = Compiler(library, false).compile_whole(std::string(type));
  if (!plan) return Error{plan.error()};
  FieldReader reader;
  reader.plan_ = std::move(*plan);
  if (auto plan2 = Compiler(library, true).compile_whole(std::string(type)))
    reader.plan2_ = std::move(*plan2);
  return reader;
}

PayloadFit FieldReader::fit(rtps::ByteView payload) const {
  constexpr std::size_t kPadding = 3;  // bytes at most: some writers fill up to a multiple of four
  rtps::CdrReader reader(payload);
  Value none;
  Run state{plan_for(reader), none};
  const FieldStatus status = run(reader, 0, state.plan.size(), state);
  if (status != FieldStatus::kRead || !reader.ok() || state.plan.empty())
    return PayloadFit::kMalformed;
  return reader.left() <= kPadding ? PayloadFit::kFits : PayloadFit::kTooLong;
}

bool FieldReader::reads_number() const {
  if (plan_.back().op != Op::kRead) return true;
  const Primitive primitive = plan_.back().primitive;
  return primitive != Primitive::kBool && primitive != Primitive::kString &&
         primitive != Primitive::kWString;
}

FieldStatus FieldReader::read(rtps::ByteView payload, Value& value, std::int64_t arrival) const {
  rtps::CdrReader reader(payload);
  Run state{plan_for(reader), value, arrival};
  return state.plan.empty() ? FieldStatus::kMalformed : run(reader, 0, state.plan.size(), state);
}

const std::vector<FieldReader::Step>& FieldReader::plan_for(const rtps::CdrReader& reader) const {
  return reader.is_xcdr2() ? plan2_ : plan_;
}

// Whether there is an element with the key; the reader is at its beginning then.
bool FieldReader::search(rtps::CdrReader& reader, std::size_t at, Run& state) const {
  const Step& step = state.plan[at];
  const std::size_t whole = at + 1 + step.length;
  const std::uint32_t count = reader.read_count(1);
  for (std::uint32_t i = 0; i < count && reader.ok(); ++i) {
    rtps::CdrReader ahead = reader;
    state.was_found = false;
    run(ahead, at + 1, whole, state);
    if (ahead.ok() && state.was_found) return true;
    run(reader, whole, whole + step.count, state);
  }
  return false;
}

FieldStatus FieldReader::fold(rtps::CdrReader& reader, const Step& step, Run& state) const {
  const std::uint32_t count = step.count > 0 ? step.count : reader.read_count(step.size);
  std::optional<double> extreme;
  for (std::uint32_t i = 0; i < count && reader.ok(); ++i) {
    const Value read = read_value(reader, step.primitive);
    const auto* whole = std::get_if<std::int64_t>(&read);
    const double number = whole != nullptr ? static_cast<double>(*whole) : std::get<double>(read);
    const bool is_beaten = !extreme || std::isnan(*extreme) ||
                           (step.op == Op::kLeast ? number < *extreme : number > *extreme);
    if (is_beaten) extreme = number;
  }
  if (!reader.ok()) return FieldStatus::kMalformed;
  if (!extreme) return FieldStatus::kAbsent;
  state.value = *extreme;
  return FieldStatus::kRead;
}

// kMalformed from a nested run means that; kAbsent and kRead can only come from the outermost,
// where kBound and kRead stand. A run that ends without either has passed over its bytes.
FieldStatus FieldReader::run(rtps::CdrReader& reader, std::size_t begin, std::size_t end,
                             Run& state) const {
  for (std::size_t at = begin; at < end; ++at) {
    const Step& step = state.plan[at];
    switch (step.op) {
      case Op::kSkip:
        reader.skip(step.size, step.count);
        break;
      case Op::kSkipSequence:
        reader.skip(step.size, reader.read_count(step.size));
        break;
      case Op::kSkipString:
        reader.read_string();
        break;
      case Op::kRepeat:
      case Op::kRepeatCounted: {
        // Each round takes at least a byte, so a false count ends with the payload.
        const std::uint32_t rounds = step.op == Op::kRepeat ? step.count : reader.read_count(1);
        for (std::uint32_t i = 0; i < rounds && reader.ok(); ++i) {
          run(reader, at + 1, at + 1 + step.length, state);
        }
        at += step.length;
        break;
      }
      case Op::kBound:
        if (const auto count = reader.read<std::uint32_t>(); reader.ok() && count <= step.count) {
          return FieldStatus::kAbsent;
        }
        break;
      case Op::kFind: {
        const std::uint32_t count = reader.read_count(1);
        state.was_found = false;
        for (std::uint32_t i = 0; i < count && reader.ok(); ++i) {
          const bool is_it = reader.read_string() == keys_[step.count];
          if (is_it && !std::exchange(state.was_found, true)) state.found = i;
        }
        if (reader.ok() && !state.was_found) return FieldStatus::kAbsent;
        break;
      }
      case Op::kSkipFound:
      case Op::kRepeatFound: {
        const auto count = reader.read<std::uint32_t>();
        if (reader.ok() && count <= state.found) return FieldStatus::kAbsent;
        if (step.op == Op::kSkipFound) {
          reader.skip(step.size, state.found);
          break;
        }
        const std::uint32_t before = state.found;
        for (std::uint32_t i = 0; i < before && reader.ok(); ++i)
          run(reader, at + 1, at + 1 + step.length, state);
        at += step.length;
        break;
      }
      case Op::kSearch:
        if (!search(reader, at, state))
          return reader.ok() ? FieldStatus::kAbsent : FieldStatus::kMalformed;
        at += step.length + step.count;
        break;
      case Op::kMatch:
        state.was_found = reader.read_string() == keys_[step.count];
        break;
      case Op::kLeast:
      case Op::kGreatest:
        return fold(reader, step, state);
      case Op::kDelay: {
        reader.enter_field();
        const auto whole = reader.read<std::int32_t>();
        reader.enter_field();
        const auto rest = reader.read<std::uint32_t>();
        if (!reader.ok()) return FieldStatus::kMalformed;
        const std::int64_t stamp = std::int64_t{whole} * 1'000'000'000 + rest;
        if (stamp == 0 || state.arrival == 0) return FieldStatus::kAbsent;
        state.value = static_cast<double>(state.arrival - stamp) / 1e9;
        return FieldStatus::kRead;
      }
      case Op::kStruct:
        reader.enter_struct();
        break;
      case Op::kField:
        reader.enter_field();
        break;
      case Op::kCollection:
        reader.enter_collection();
        break;
      case Op::kRead:
        if (Value read = read_value(reader, step.primitive); reader.ok()) {
          state.value = std::move(read);
          return FieldStatus::kRead;
        }
        break;
    }
    if (!reader.ok()) return FieldStatus::kMalformed;
  }
  return FieldStatus::kRead;
}

}  // namespace culprit::ros2
