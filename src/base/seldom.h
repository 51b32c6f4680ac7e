// A part that is seldom there. Used as a std::optional is, and a value as that is; but where there
// is nothing, it takes the room of a pointer and not that of the part.
//
//     struct Component { Name name; Seldom<Name> host; };
//     if (component.host) connect(component.host->text);
#pragma once

#include <memory>
#include <optional>
#include <utility>

namespace culprit {

template <class T>
class Seldom {
 public:
  Seldom() = default;
  Seldom(std::nullopt_t) {}
  Seldom(T part) : part_(std::make_unique<T>(std::move(part))) {}
  Seldom(std::optional<T> part) : part_(part ? std::make_unique<T>(std::move(*part)) : nullptr) {}
  Seldom(const Seldom& other) : part_(other ? std::make_unique<T>(*other) : nullptr) {}
  Seldom(Seldom&&) noexcept = default;
  Seldom& operator=(const Seldom& other) {
    if (this != &other) *this = Seldom(other);
    return *this;
  }
  Seldom& operator=(Seldom&&) noexcept = default;
  ~Seldom() = default;

  bool has_value() const { return part_ != nullptr; }
  explicit operator bool() const { return has_value(); }

  // @pre has_value()
  T& operator*() { return *part_; }
  const T& operator*() const { return *part_; }
  T* operator->() { return part_.get(); }
  const T* operator->() const { return part_.get(); }

  T value_or(T otherwise) const { return part_ ? *part_ : std::move(otherwise); }

  bool operator==(const Seldom& other) const {
    return part_ && other.part_ ? *part_ == *other.part_ : part_ == other.part_;
  }

 private:
  std::unique_ptr<T> part_;
};

}  // namespace culprit
