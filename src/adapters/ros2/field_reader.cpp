#include "ros2/field_reader.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>
#include <string>

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

Value read_value(CdrReader& reader, Primitive primitive) {
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
  std::string names;
  for (const FieldDefinition& field : definition.fields) {
    names += (names.empty() ? "" : ", ") + field.name;
  }
  return names.empty() ? "none" : names;
}

// One element of a path: a field name, perhaps with an index.
struct Hop {
  std::string_view name;
  std::optional<std::uint32_t> index;
};

// Takes a hop off `path`; nothing when there is none.
std::optional<Hop> take_hop(std::string_view& path) {
  Hop hop{path.substr(0, path.find_first_of(".[")), std::nullopt};
  path.remove_prefix(hop.name.size());
  if (path.starts_with('[')) {
    const char* end = path.data() + path.size();
    std::uint32_t index = 0;
    const auto [rest, error] = std::from_chars(path.data() + 1, end, index);
    if (error != std::errc() || rest == end || *rest != ']') return std::nullopt;
    hop.index = index;
    path.remove_prefix(static_cast<std::size_t>(rest - path.data()) + 1);
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
  explicit Compiler(MessageLibrary& library) : library_(library) {}

  Expected<std::vector<Step>> compile_whole(const std::string& type) {
    const FieldDefinition whole{"", type};
    if (auto skipped = skip_element(whole, 0); !skipped) return Error{skipped.error()};
    return std::move(plan_);
  }

  Expected<std::vector<Step>> compile(std::string_view type, std::string_view path) {
    std::string_view rest = path;
    std::string current(type);
    while (true) {
      const auto definition = library_.find(current);
      if (!definition) return Error{definition.error()};
      const auto hop = take_hop(rest);
      if (!hop || hop->name.empty()) {
        return Error{"'" + printable(path) +
                     "' is not a path to a field; write one like pose.position.x or ranges[0]"};
      }
      const FieldDefinition* field = nullptr;
      for (const FieldDefinition& candidate : (*definition)->fields) {
        if (candidate.name == hop->name) {
          field = &candidate;
          break;
        }
        if (auto skipped = skip_field(candidate, 0); !skipped) return Error{skipped.error()};
      }
      if (field == nullptr) {
        return Error{current + " has no field '" + printable(hop->name) + "'; its fields are " +
                     field_names(**definition)};
      }
      if (auto entered = enter(*field, *hop); !entered) return Error{entered.error()};
      if (const auto* primitive = std::get_if<Primitive>(&field->element)) {
        return finish(*field, *primitive, rest);
      }
      current = std::get<std::string>(field->element);
      if (rest.empty()) {
        return Error{"'" + printable(path) + "' is a whole " + current +
                     "; go on to one of its fields"};
      }
    }
  }

 private:
  Expected<std::vector<Step>> finish(const FieldDefinition& field, Primitive primitive,
                                     std::string_view rest) {
    if (!rest.empty())
      return Error{"'" + field.name + "' is a value and has no field '" + printable(rest) + "'"};
    if (primitive == Primitive::kWString) return wide_string(field);
    plan_.push_back({.op = Op::kRead, .primitive = primitive});
    if (plan_.size() > kLongestPlan) return too_big();
    return std::move(plan_);
  }

  // From the start of `field` to the start of the element that `hop` means.
  Expected<void> enter(const FieldDefinition& field, const Hop& hop) {
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
    if (field.shape == Shape::kSequence) plan_.push_back({.op = Op::kBound, .count = *hop.index});
    return skip_elements(field, *hop.index, 0);
  }

  Expected<void> skip_field(const FieldDefinition& field, int depth) {
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
    if ((*definition)->fields.empty()) plan_.push_back({.op = Op::kSkip, .size = 1, .count = 1});
    for (const FieldDefinition& inner : (*definition)->fields) {
      if (auto skipped = skip_field(inner, depth + 1); !skipped) return skipped;
    }
    return {};
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
  std::vector<Step> plan_;
};

Expected<FieldReader> FieldReader::compile(MessageLibrary& library, std::string_view type,
                                           std::string_view path) {
  auto plan = Compiler(library).compile(type, path);
  if (!plan) return Error{plan.error()};
  FieldReader reader;
  reader.plan_ = std::move(*plan);
  return reader;
}

Expected<FieldReader> FieldReader::compile_whole(MessageLibrary& library, std::string_view type) {
  auto plan = Compiler(library).compile_whole(std::string(type));
  if (!plan) return Error{plan.error()};
  FieldReader reader;
  reader.plan_ = std::move(*plan);
  return reader;
}

PayloadFit FieldReader::fit(ByteView payload) const {
  constexpr std::size_t kPadding = 3;  // bytes at most: some writers fill up to a multiple of four
  CdrReader reader(payload);
  Value none;
  const FieldStatus status = run(reader, 0, plan_.size(), none);
  if (status != FieldStatus::kRead || !reader.ok()) return PayloadFit::kMalformed;
  return reader.left() <= kPadding ? PayloadFit::kFits : PayloadFit::kTooLong;
}

bool FieldReader::reads_number() const {
  const Primitive primitive = plan_.back().primitive;
  return primitive != Primitive::kBool && primitive != Primitive::kString &&
         primitive != Primitive::kWString;
}

FieldStatus FieldReader::read(ByteView payload, Value& value) const {
  CdrReader reader(payload);
  return run(reader, 0, plan_.size(), value);
}

// kMalformed from a nested run means that; kAbsent and kRead can only come from the outermost,
// where kBound and kRead stand. A run that ends without either has passed over its bytes.
FieldStatus FieldReader::run(CdrReader& reader, std::size_t begin, std::size_t end,
                             Value& value) const {
  for (std::size_t at = begin; at < end; ++at) {
    const Step& step = plan_[at];
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
          run(reader, at + 1, at + 1 + step.length, value);
        }
        at += step.length;
        break;
      }
      case Op::kBound:
        if (const auto count = reader.read<std::uint32_t>(); reader.ok() && count <= step.count) {
          return FieldStatus::kAbsent;
        }
        break;
      case Op::kRead:
        if (Value read = read_value(reader, step.primitive); reader.ok()) {
          value = std::move(read);
          return FieldStatus::kRead;
        }
        break;
    }
    if (!reader.ok()) return FieldStatus::kMalformed;
  }
  return FieldStatus::kRead;
}

}  // namespace culprit::ros2
