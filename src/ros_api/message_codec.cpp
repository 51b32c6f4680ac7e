#include "ros_api/message_codec.h"

#include <limits>

namespace culprit::ros_api {
namespace {

using ros2::FieldDefinition;
using ros2::MessageDefinition;
using ros2::MessageDefinitions;
using ros2::Primitive;
using ros2::Shape;

// Calls `use` with a value of the type that the primitive has in C++. Texts are not among them.
template <class Use>
auto with_type_of(Primitive primitive, Use use) {
  switch (primitive) {
    case Primitive::kBool:
      return use(bool{});
    case Primitive::kInt8:
      return use(std::int8_t{});
    case Primitive::kInt16:
      return use(std::int16_t{});
    case Primitive::kUint16:
      return use(std::uint16_t{});
    case Primitive::kInt32:
      return use(std::int32_t{});
    case Primitive::kUint32:
      return use(std::uint32_t{});
    case Primitive::kInt64:
      return use(std::int64_t{});
    case Primitive::kUint64:
      return use(std::uint64_t{});
    case Primitive::kFloat32:
      return use(float{});
    case Primitive::kFloat64:
      return use(double{});
    default:
      return use(std::uint8_t{});
  }
}

// Nothing: the document is no such number.
template <class T>
std::optional<T> number_in(const Json& document) {
  if constexpr (std::is_same_v<T, bool>) {
    return document.is_boolean() ? std::optional(document.get<bool>()) : std::nullopt;
  } else if constexpr (std::is_floating_point_v<T>) {
    if (document.is_null()) return std::numeric_limits<T>::quiet_NaN();
    return document.is_number() ? std::optional(document.get<T>()) : std::nullopt;
  } else {
    if (!document.is_number_integer()) return std::nullopt;
    if (document.is_number_unsigned()) {
      const auto value = document.get<std::uint64_t>();
      return std::in_range<T>(value) ? std::optional(static_cast<T>(value)) : std::nullopt;
    }
    const auto value = document.get<std::int64_t>();
    return std::in_range<T>(value) ? std::optional(static_cast<T>(value)) : std::nullopt;
  }
}

// Otherwise a reader of the text in Python gets an exception.
std::string mended(const std::string& text) {
  return parse_json(to_line(Json(text))).get<std::string>();
}

class Encoder {
 public:
  explicit Encoder(const MessageDefinitions& definitions) : definitions_(definitions) {}

  Expected<void> message(const Json& document, const std::string& type) {
    const MessageDefinition& definition = definitions_.at(type);
    static const Json kNone = Json::object();
    const Json& members = document.is_null() ? kNone : document;
    if (!members.is_object()) return Error{"is no document"};
    std::size_t used = 0;
    for (const FieldDefinition& each : definition.fields) {
      const auto found = members.find(each.name);
      if (found != members.end()) ++used;
      const auto written = found == members.end() ? absent(each) : field(*found, each);
      if (!written) return Error{each.name + " " + written.error()};
    }
    if (used != members.size()) return Error{"has a member that " + type + " has not"};
    if (definition.fields.empty()) writer_.write(std::uint8_t{0});
    return {};
  }
  rtps::Bytes take() { return writer_.take(); }

 private:
  Expected<void> field(const Json& document, const FieldDefinition& field) {
    if (field.shape == Shape::kSingle) return element(document, field);
    if (!document.is_array()) return Error{"is no list"};
    const bool is_bounded = field.shape == Shape::kSequence && field.count > 0;
    if (field.shape == Shape::kArray && document.size() != field.count)
      return Error{"has not as many elements as it has to"};
    if (is_bounded && document.size() > field.count) return Error{"has too many elements"};
    if (field.shape == Shape::kSequence) writer_.write(static_cast<std::uint32_t>(document.size()));
    for (const Json& each : document) {
      if (const auto written = element(each, field); !written) return written;
    }
    return {};
  }

  Expected<void> element(const Json& document, const FieldDefinition& field) {
    if (const auto* type = std::get_if<std::string>(&field.element))
      return message(document, *type);
    const Primitive primitive = std::get<Primitive>(field.element);
    if (primitive == Primitive::kString) {
      if (!document.is_string()) return Error{"is no text"};
      writer_.write_string(mended(document.get_ref<const std::string&>()));
      return {};
    }
    return with_type_of(primitive, [&](auto zero) -> Expected<void> {
      const auto value = number_in<decltype(zero)>(document);
      if (!value) return Error{"does not fit"};
      writer_.write(*value);
      return {};
    });
  }

  Expected<void> absent(const FieldDefinition& field) {
    if (field.shape == Shape::kSequence) {
      writer_.write(std::uint32_t{0});
      return {};
    }
    for (std::uint32_t i = 0; i < field.count; ++i) {
      if (const auto* type = std::get_if<std::string>(&field.element)) {
        if (const auto written = message(nullptr, *type); !written) return written;
      } else if (std::get<Primitive>(field.element) == Primitive::kString) {
        writer_.write_string("");
      } else {
        with_type_of(std::get<Primitive>(field.element), [&](auto zero) { writer_.write(zero); });
      }
    }
    return {};
  }

  const MessageDefinitions& definitions_;
  rtps::CdrWriter writer_;
};

class Decoder {
 public:
  Decoder(rtps::ByteView payload, const MessageDefinitions& definitions)
      : definitions_(definitions), reader_(payload) {}

  Json message(const std::string& type) {
    Json document = Json::object();
    const MessageDefinition& definition = definitions_.at(type);
    for (const FieldDefinition& each : definition.fields) document[each.name] = field(each);
    if (definition.fields.empty() && reader_.left() > 0) (void)reader_.read<std::uint8_t>();
    return document;
  }
  bool ok() const { return reader_.ok(); }
  bool is_text_mended() const { return is_text_mended_; }

 private:
  Json field(const FieldDefinition& field) {
    if (field.shape == Shape::kSingle) return element(field);
    const bool is_array = field.shape == Shape::kArray;
    const std::uint32_t count = is_array ? field.count : reader_.read_count(1);
    if (!is_array && field.count > 0 && count > field.count) reader_.fail();
    Json list = Json::array();
    for (std::uint32_t i = 0; i < count && reader_.ok(); ++i) list.push_back(element(field));
    return list;
  }

  Json element(const FieldDefinition& field) {
    if (const auto* type = std::get_if<std::string>(&field.element)) return message(*type);
    const Primitive primitive = std::get<Primitive>(field.element);
    if (primitive == Primitive::kString) {
      const std::string text(reader_.read_string());
      std::string fit = mended(text);
      is_text_mended_ |= fit != text;
      return fit;
    }
    return with_type_of(primitive,
                        [&](auto zero) -> Json { return reader_.read<decltype(zero)>(); });
  }

  const MessageDefinitions& definitions_;
  rtps::CdrReader reader_;
  bool is_text_mended_ = false;
};

}  // namespace

Expected<rtps::Bytes> encode(const Json& document, const MessageType& type) {
  Encoder encoder(type.definitions);
  if (const auto written = encoder.message(document, type.name); !written)
    return Error{type.name + ": " + written.error()};
  return encoder.take();
}

Expected<Json> decode(rtps::ByteView payload, const MessageType& type) {
  Decoder decoder(payload, type.definitions);
  Json document = decoder.message(type.name);
  if (!decoder.ok()) return Error{"what came is no " + type.name};
  if (decoder.is_text_mended()) return Error{"a text in it is no UTF-8"};
  return document;
}

}  // namespace culprit::ros_api
