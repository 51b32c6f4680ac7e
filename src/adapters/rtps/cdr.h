// The wire encoding of every ROS 2 message: XCDR1, PLAIN_CDR (DDS-XTypes 1.3 §7.4, RTPS 2.3 §10).
//
// A payload begins with four bytes of encapsulation (00 00 big endian, 00 01 little endian, two
// bytes of options). The fields follow in order, each aligned to its own size, counted from after
// those four bytes.
//
// XCDR2 is read, too, as recorders and other DDS programs write it. There nothing is aligned to more than four bytes, and
// headers of four bytes stand before some parts (enter_struct(), enter_field(), enter_collection()). Its fields must be all
// there, and in the order of the definition.
//
// Why not Fast CDR: it throws, and it resizes a container before it checks that the bytes are
// there, so four hostile bytes can ask for gigabytes. This reader is a cursor over bytes that it
// does not own. It never throws, never reads outside, allocates no more than a small multiple of
// the bytes it was given, and its failure is sticky: after the first bad byte it reads zeros, and
// `ok` stays false.
//
// A message type describes itself once, for both directions:
//
//     struct Time {
//       std::int32_t sec = 0;
//       std::uint32_t nanosec = 0;
//       static void visit(auto& self, auto& each) { each(self.sec, self.nanosec); }
//     };
//
// Two liberties of peers are tolerated: bytes after the last field (Cyclone pads to a multiple of
// four), and the absence of the dummy byte that ROS puts in place of an empty struct.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace culprit::rtps {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

enum class Endianness : std::uint8_t { kBig = 0, kLittle = 1 };

inline constexpr std::size_t kEncapsulationSize = 4;

template <class T>
concept CdrPrimitive = std::is_arithmetic_v<T>;

class CdrReader {
 public:
  // `payload` starts with the encapsulation and must outlive the reader. Not ok() if it is neither
  // PLAIN_CDR nor of XCDR2.
  explicit CdrReader(ByteView payload);

  bool ok() const { return ok_; }
  void fail() { ok_ = false; }
  std::size_t left() const { return ok_ ? body_.size() - at_ : 0; }
  bool is_xcdr2() const { return form_ != Form::kPlain1; }

  // Pass over the header of XCDR2 before a struct, a field of a struct, and an array or sequence whose elements are no
  // primitives. Nothing in XCDR1.
  void enter_struct() {
    if (form_ >= Form::kDelimited2) read<std::uint32_t>();
  }
  void enter_field();
  void enter_collection() {
    if (is_xcdr2()) read<std::uint32_t>();
  }

  // Zero when the bytes are not there.
  template <CdrPrimitive T>
  T read();

  // Without the terminating NUL. Points into the payload.
  std::string_view read_string();

  // The element count of a sequence whose elements take at least `smallest_element` bytes (> 0)
  // each. Fails, and gives zero, when so many cannot be there.
  std::uint32_t read_count(std::size_t smallest_element);

  // `count` unaligned bytes; empty when they are not there.
  ByteView read_bytes(std::size_t count);

  // Passes over `count` primitives of `size` bytes (1, 2, 4 or 8).
  void skip(std::size_t size, std::uint64_t count);

  template <class... T>
  void operator()(T&... fields) {
    ((enter_field(), read_into(fields)), ...);
  }

 private:
  enum class Form : std::uint8_t {
    kPlain1,      // XCDR1
    kPlain2,      // XCDR2 of final types
    kDelimited2,  // of types that may be extended: each struct has its size before it
    kMembers2     // of mutable types: each field has its number before it, too
  };

  bool align(std::size_t size);

  template <CdrPrimitive T>
  void read_into(T& field) {
    field = read<T>();
  }
  void read_into(std::string& field) { field = read_string(); }
  template <class T, std::size_t N>
  void read_into(std::array<T, N>& field) {
    if constexpr (!CdrPrimitive<T>) enter_collection();
    for (T& element : field) read_into(element);
  }
  template <class T>
  void read_into(std::vector<T>& field);
  template <class T>
  requires std::is_class_v<T>
  void read_into(T& field);

  ByteView body_;
  std::size_t at_ = 0;
  Endianness endianness_ = Endianness::kLittle;
  Form form_ = Form::kPlain1;
  bool ok_ = false;
};

class CdrWriter {
 public:
  explicit CdrWriter(Endianness endianness = Endianness::kLittle);

  template <CdrPrimitive T>
  void write(T value);
  void write_string(std::string_view text);
  void write_bytes(ByteView bytes);

  template <class... T>
  void operator()(const T&... fields) {
    (write_from(fields), ...);
  }

  // The payload; the writer is empty afterwards.
  Bytes take() { return std::move(bytes_); }

 private:
  template <CdrPrimitive T>
  void write_from(const T& field) {
    write(field);
  }
  void write_from(const std::string& field) { write_string(field); }
  template <class T, std::size_t N>
  void write_from(const std::array<T, N>& field) {
    for (const T& element : field) write_from(element);
  }
  template <class T>
  void write_from(const std::vector<T>& field);
  template <class T>
  requires std::is_class_v<T>
  void write_from(const T& field);

  Bytes bytes_;
  Endianness endianness_;
};

template <class Message>
Bytes encode(const Message& message, Endianness endianness = Endianness::kLittle) {
  CdrWriter writer(endianness);
  writer(message);
  return writer.take();
}

// Gives nothing if `payload` is not a whole `Message`.
template <class Message>
std::optional<Message> decode(ByteView payload) {
  CdrReader reader(payload);
  std::optional<Message> message(std::in_place);
  reader(*message);
  if (!reader.ok()) message.reset();
  return message;
}

namespace detail {

inline constexpr Endianness kNative =
    std::endian::native == std::endian::little ? Endianness::kLittle : Endianness::kBig;

template <CdrPrimitive T>
std::array<std::uint8_t, sizeof(T)> swapped(std::array<std::uint8_t, sizeof(T)> bytes) {
  std::array<std::uint8_t, sizeof(T)> out{};
  for (std::size_t i = 0; i < sizeof(T); ++i) out[i] = bytes[sizeof(T) - 1 - i];
  return out;
}

}  // namespace detail

template <CdrPrimitive T>
T CdrReader::read() {
  if (!align(sizeof(T)) || left() < sizeof(T)) {
    fail();
    return T{};
  }
  std::array<std::uint8_t, sizeof(T)> bytes;
  std::memcpy(bytes.data(), body_.data() + at_, sizeof(T));
  at_ += sizeof(T);
  if constexpr (std::same_as<T, bool>) {
    return bytes[0] != 0;  // anything but 0 and 1 in a bool would be undefined behaviour
  } else {
    if (endianness_ != detail::kNative) bytes = detail::swapped<T>(bytes);
    return std::bit_cast<T>(bytes);
  }
}

template <class T>
void CdrReader::read_into(std::vector<T>& field) {
  field.clear();
  if constexpr (CdrPrimitive<T> && !std::same_as<T, bool>) {
    // A sequence without elements does not align for them.
    if (const std::uint32_t count = read_count(sizeof(T)); count > 0) {
      if (!align(sizeof(T)) || left() / sizeof(T) < count) return fail();
      field.resize(count);
      if (endianness_ == detail::kNative || sizeof(T) == 1) {  // an image is a million of these
        std::memcpy(field.data(), body_.data() + at_, count * sizeof(T));
        at_ += count * sizeof(T);
      } else {
        for (T& element : field) element = read<T>();
      }
    }
  } else {
    if constexpr (!CdrPrimitive<T>) enter_collection();
    // Grows as elements prove to be there: a count is only a claim.
    for (std::uint32_t count = read_count(1); count > 0 && ok_; --count) {
      T element{};
      read_into(element);
      if (ok_) field.push_back(std::move(element));
    }
  }
}

template <class T>
requires std::is_class_v<T>
void CdrReader::read_into(T& field) {
  enter_struct();
  if constexpr (std::is_empty_v<T>) {
    if (left() > 0) ++at_;
  } else {
    T::visit(field, *this);
  }
}

template <CdrPrimitive T>
void CdrWriter::write(T value) {
  const std::size_t offset = bytes_.size() - kEncapsulationSize;
  const std::size_t padding = (sizeof(T) - offset % sizeof(T)) % sizeof(T);
  auto bytes = std::bit_cast<std::array<std::uint8_t, sizeof(T)>>(value);
  if (endianness_ != detail::kNative) bytes = detail::swapped<T>(bytes);
  bytes_.resize(bytes_.size() + padding + sizeof(T));
  std::memcpy(bytes_.data() + bytes_.size() - sizeof(T), bytes.data(), sizeof(T));
}

template <class T>
void CdrWriter::write_from(const std::vector<T>& field) {
  write(static_cast<std::uint32_t>(field.size()));
  if constexpr (sizeof(T) == 1 && CdrPrimitive<T> && !std::same_as<T, bool>) {
    write_bytes({reinterpret_cast<const std::uint8_t*>(field.data()), field.size()});
  } else {
    for (const T& element : field) write_from(element);
  }
}

template <class T>
requires std::is_class_v<T>
void CdrWriter::write_from(const T& field) {
  if constexpr (std::is_empty_v<T>) {
    write(std::uint8_t{0});
  } else {
    T::visit(field, *this);
  }
}

}  // namespace culprit::rtps
