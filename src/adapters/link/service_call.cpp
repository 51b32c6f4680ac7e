#include "link/service_call.h"

#include <algorithm>
#include <limits>

#include <yaml-cpp/yaml.h>

#include "base/closest.h"
#include "ros2/names.h"

namespace culprit::link {
namespace {

// Turns YAML into a message, field by field.
class RequestWriter {
 public:
  explicit RequestWriter(ros2::MessageLibrary& library) : library_(library) {}

  Expected<rtps::Bytes> write(const std::string& type, const YAML::Node& text) {
    message(type, text, "");
    if (!error_.empty()) return Error{error_};
    return out_.take();
  }

 private:
  static constexpr int kDeepest = 30;  // definitions in others' files may be cyclic
  static constexpr std::size_t kMostElements = 100'000;

  void fail(const std::string& where, const std::string& what) {
    if (error_.empty()) error_ = (where.empty() ? "" : "'" + where + "': ") + what;
  }

  void message(const std::string& type, const YAML::Node& text, const std::string& where) {
    const auto definition = library_.find(type);
    if (!definition) return fail(where, definition.error());
    const bool is_left_out = !text.IsDefined() || text.IsNull();
    if (!is_left_out && !text.IsMap()) return fail(where, "write its fields, as {name: value}");
    const std::vector<ros2::FieldDefinition>& fields = (*definition)->fields;
    if (!is_left_out) refuse_others(fields, text, where, type);
    if (++depth_ > kDeepest) return fail(where, "the type goes too deep");
    if (fields.empty()) out_.write(std::uint8_t{0});
    for (const ros2::FieldDefinition& field : fields) {
      if (!error_.empty()) break;
      const std::string place = where.empty() ? field.name : where + "." + field.name;
      write_field(field, is_left_out ? YAML::Node(YAML::NodeType::Undefined) : text[field.name],
                  place);
    }
    --depth_;
  }

  void refuse_others(const std::vector<ros2::FieldDefinition>& fields, const YAML::Node& text,
                     const std::string& where, const std::string& type) {
    std::vector<std::string_view> names;
    std::string all;
    for (const ros2::FieldDefinition& field : fields) {
      names.push_back(field.name);
      all += (all.empty() ? "" : ", ") + field.name;
    }
    for (const auto& entry : text) {
      const std::string name = entry.first.IsScalar() ? entry.first.Scalar() : "?";
      if (std::find(names.begin(), names.end(), name) != names.end()) continue;
      const std::string near = closest(name, names);
      return fail(where, type + " has no field '" + printable(name) + "'" +
                             (!near.empty() ? "; did you mean '" + near + "'?"
                              : all.empty() ? "; it has none"
                                            : "; it has " + all));
    }
  }

  void write_field(const ros2::FieldDefinition& field, const YAML::Node& text,
                   const std::string& where) {
    if (field.shape == ros2::Shape::kSingle) return element(field, text, where);
    const bool is_left_out = !text.IsDefined() || text.IsNull();
    if (!is_left_out && !text.IsSequence()) return fail(where, "write a list, as [1, 2]");
    std::size_t count = is_left_out ? 0 : text.size();
    if (count > kMostElements) return fail(where, "the list is too long");
    if (field.shape == ros2::Shape::kArray) {
      if (!is_left_out && count != field.count)
        return fail(where, "it has " + std::to_string(field.count) + " elements");
      if (field.count > kMostElements) return fail(where, "the type goes too far");
      count = field.count;
    } else {
      if (field.count != 0 && count > field.count)
        return fail(where, "it has " + std::to_string(field.count) + " elements at most");
      out_.write(static_cast<std::uint32_t>(count));
    }
    for (std::size_t i = 0; i < count && error_.empty(); ++i)
      element(field, is_left_out ? YAML::Node(YAML::NodeType::Undefined) : text[i],
              where + "[" + std::to_string(i) + "]");
  }

  void element(const ros2::FieldDefinition& field, const YAML::Node& text,
               const std::string& where) {
    if (const auto* type = std::get_if<std::string>(&field.element))
      return message(*type, text, where);
    switch (std::get<ros2::Primitive>(field.element)) {
      case ros2::Primitive::kBool:
        return value<bool>(text, where, "true or false");
      case ros2::Primitive::kByte:
      case ros2::Primitive::kChar:
      case ros2::Primitive::kUint8:
        return whole<std::uint8_t>(text, where);
      case ros2::Primitive::kInt8:
        return whole<std::int8_t>(text, where);
      case ros2::Primitive::kInt16:
        return whole<std::int16_t>(text, where);
      case ros2::Primitive::kUint16:
        return whole<std::uint16_t>(text, where);
      case ros2::Primitive::kInt32:
        return whole<std::int32_t>(text, where);
      case ros2::Primitive::kUint32:
        return whole<std::uint32_t>(text, where);
      case ros2::Primitive::kInt64:
        return value<std::int64_t>(text, where, "a whole number");
      case ros2::Primitive::kUint64:
        return value<std::uint64_t>(text, where, "a whole number that is not negative");
      case ros2::Primitive::kFloat32:
        return value<float>(text, where, "a number");
      case ros2::Primitive::kFloat64:
        return value<double>(text, where, "a number");
      case ros2::Primitive::kString:
        return words(field, text, where);
      case ros2::Primitive::kWString:
        return fail(where, "texts of wide characters cannot be sent");
    }
  }

  template <class T>
  void value(const YAML::Node& text, const std::string& where, const char* what) {
    T read{};
    if (text.IsDefined() && !text.IsNull() && !YAML::convert<T>::decode(text, read))
      return fail(where, std::string("write ") + what);
    out_.write(read);
  }

  template <class T>
  void whole(const YAML::Node& text, const std::string& where) {
    std::int64_t read = 0;
    const bool is_there = text.IsDefined() && !text.IsNull();
    const bool fits = !is_there || (YAML::convert<std::int64_t>::decode(text, read) &&
                                    read >= std::numeric_limits<T>::min() &&
                                    read <= std::numeric_limits<T>::max());
    if (!fits)
      return fail(where, "write a whole number from " +
                             std::to_string(std::numeric_limits<T>::min()) + " to " +
                             std::to_string(std::numeric_limits<T>::max()));
    out_.write(static_cast<T>(read));
  }

  void words(const ros2::FieldDefinition& field, const YAML::Node& text, const std::string& where) {
    const bool is_left_out = !text.IsDefined() || text.IsNull();
    if (!is_left_out && !text.IsScalar()) return fail(where, "write a text");
    const std::string read = is_left_out ? "" : text.Scalar();
    if (field.text_bound != 0 && read.size() > field.text_bound)
      return fail(where, "it has " + std::to_string(field.text_bound) + " characters at most");
    out_.write_string(read);
  }

  ros2::MessageLibrary& library_;
  rtps::CdrWriter out_;
  std::string error_;
  int depth_ = 0;
};

Expected<rtps::Bytes> payload_of(ros2::MessageLibrary& library, const std::string& type,
                                 const std::string& request) {
  try {
    return RequestWriter(library).write(type, YAML::Load(request));
  } catch (const YAML::Exception& e) {
    return Error{std::string("this is no YAML: ") + e.what()};
  }
}

std::optional<ros2::FieldReader> first_of(ros2::MessageLibrary& library, const std::string& type,
                                          std::initializer_list<const char*> paths) {
  for (const char* path : paths) {
    auto reader = ros2::FieldReader::compile(library, type, path);
    if (reader) return std::move(*reader);
  }
  return std::nullopt;
}

}  // namespace

Expected<ServiceCall> ServiceCall::prepare(const std::string& type, const std::string& request,
                                           ros2::MessageLibrary& library) {
  if (!is_valid_type_name(type)) return Error{"'" + printable(type) + "' is no type of a service"};
  const std::string asked = type + "_Request";
  const std::string answered = type + "_Response";
  if (const auto known = library.find(asked); !known) return Error{known.error()};
  auto payload = payload_of(library, asked, request);
  if (!payload) return Error{type + ": " + payload.error()};
  ServiceCall call;
  call.request_ = std::move(*payload);
  call.success_ = first_of(library, answered, {"success", "ok", "successful", "result.successful"});
  call.text_ = first_of(library, answered,
                        {"message", "reason", "result.reason", "error_message", "status_message"});
  return call;
}

std::optional<ServiceCall::Verdict> ServiceCall::judge(rtps::ByteView answer) const {
  const auto read = [&](const std::optional<ros2::FieldReader>& field) -> std::optional<Value> {
    Value value;
    if (!field || field->read(answer, value) != ros2::FieldStatus::kRead) return std::nullopt;
    return value;
  };
  Verdict verdict{true, ""};
  if (success_) {
    const auto said = read(success_);
    if (!said) return std::nullopt;
    if (const auto* is_done = std::get_if<bool>(&*said)) verdict.is_done = *is_done;
  }
  if (const auto said = read(text_)) {
    if (const auto* text = std::get_if<std::string>(&*said)) verdict.text = *text;
  }
  return verdict;
}

}  // namespace culprit::link
