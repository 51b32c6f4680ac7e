// The parameters of a node, with the semantics of rclcpp (Humble) as its parameter services show
// them: declared parameters only, statically typed, read-only and ranges respected, callbacks that
// may refuse.
//
// A pure data structure; node.h gives it its services and events.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/expected.h"
#include "base/invariant.h"
#include "base/value.h"
#include "ros2/messages.h"

namespace culprit::ros2 {

// Between a rule's value and a parameter's. Arrays and "not set" have no Value.
std::optional<Value> to_value(const msg::ParameterValue& value);
msg::ParameterValue to_parameter_value(const Value& value);

class ParameterStore {
 public:
  // Sees what is about to be set, together; an error refuses all of it, its message being the
  // reason. Also called with the initial value when a parameter is declared after the callback was
  // added.
  using OnSet = std::function<Expected<void>(std::span<const msg::Parameter>)>;

  // Receives each event: declared (new), set (changed). The stamp is left to the receiver.
  using OnEvent = std::function<void(msg::ParameterEvent)>;

  // `node` is the full name that events carry.
  explicit ParameterStore(std::string node, OnEvent on_event = {});

  // `descriptor` may leave name and type empty: the type is that of `value`, for good. An error
  // when there is such a parameter already, or the value does not comply.
  Expected<void> declare(const std::string& name, msg::ParameterValue value,
                         msg::ParameterDescriptor descriptor = {});
  Expected<void> declare(const std::string& name, const Value& value,
                         msg::ParameterDescriptor descriptor = {});

  void on_set(OnSet callback) { callbacks_.push_back(std::move(callback)); }

  // All or nothing.
  msg::SetParametersResult set(std::span<const msg::Parameter> parameters);

  // Null when it is not declared.
  const msg::ParameterValue* find(std::string_view name) const;

  // The scalar that was declared under this name. @pre declared as a T: bool, int64_t, double or
  // std::string
  template <class T>
  T get(std::string_view name) const {
    const msg::ParameterValue* value = find(name);
    CULPRIT_ASSERT(value != nullptr);
    return std::get<T>(*to_value(*value));
  }

  // As the services of the same names answer. With any undeclared name, nothing is answered for all
  // of them.
  std::vector<msg::ParameterValue> get_parameters(std::span<const std::string> names) const;
  std::vector<std::uint8_t> get_types(std::span<const std::string> names) const;
  std::vector<msg::ParameterDescriptor> describe(std::span<const std::string> names) const;

  struct Listing {
    std::vector<std::string> names;
    std::vector<std::string> prefixes;
  };
  // `depth` counts levels separated by dots below the prefixes; 0 is without limit.
  Listing list(std::span<const std::string> prefixes, std::uint64_t depth) const;

 private:
  struct Entry {
    msg::ParameterValue value;
    msg::ParameterDescriptor descriptor;
  };

  bool knows_all(std::span<const std::string> names) const;
  Expected<void> check(const msg::Parameter& parameter) const;
  Expected<void> ask_callbacks(std::span<const msg::Parameter> parameters) const;
  void tell(msg::ParameterEvent event) const;

  const std::string node_;
  const OnEvent on_event_;
  std::vector<OnSet> callbacks_;
  std::map<std::string, Entry, std::less<>> entries_;
};

}  // namespace culprit::ros2
