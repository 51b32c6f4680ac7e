// Writes JSON straight into a text, where a document would be built only to be printed: on the way
// from a decision to its request each document costs some hundred small blocks of memory. The bytes
// are those of to_line().
//
//     std::string text;
//     JsonWriter json(text);
//     json.begin_object();
//     json.member("node", "/camera");
//     json.member("pids", [&] {
//       json.begin_array();
//       for (int pid : {42, 43}) json.value(pid);
//       json.end_array();
//     });
//     json.end_object();  // {"node":"/camera","pids":[42,43]}
#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

namespace culprit {

// The caller must end what it begins, and must write no member twice.
class JsonWriter {
 public:
  // Appends to `out`, which must outlive it.
  explicit JsonWriter(std::string& out) : out_(out) {}

  void begin_object() { begin('{'); }
  void end_object() { end('}'); }
  void begin_array() { begin('['); }
  void end_array() { end(']'); }

  void null();
  // Bytes that are no UTF-8 are replaced, and a value that is no number is null.
  template <class T>
  void value(const T& value) {
    if constexpr (std::same_as<T, bool>) {
      write(value);
    } else if constexpr (std::unsigned_integral<T>) {
      write(std::uint64_t{value});
    } else if constexpr (std::signed_integral<T>) {
      write(std::int64_t{value});
    } else if constexpr (std::floating_point<T>) {
      write(double{value});
    } else {
      write(std::string_view(value));
    }
  }

  // The next value is that of the member `name`.
  void key(std::string_view name);
  // `what` is a value, or writes one.
  template <class T>
  void member(std::string_view name, const T& what) {
    key(name);
    if constexpr (std::invocable<const T&>) {
      what();
    } else {
      value(what);
    }
  }

 private:
  void begin(char bracket);
  void end(char bracket);
  void separate();
  void write(bool value);
  void write(std::uint64_t value);
  void write(std::int64_t value);
  void write(double value);
  void write(std::string_view text);

  std::string& out_;
  bool is_first_ = true;  // of its object or array, or the value of a member
};

}  // namespace culprit
