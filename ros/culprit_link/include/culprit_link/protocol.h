// The frames between culprit and its helper program, over one stream socket (docs/link-protocol.md).
//
// Both programs compile this file, and it uses the standard library only. A frame is its length (four bytes, without
// themselves), its kind (one byte: its place in `Frame`), and its fields in order: numbers little-endian, texts and
// lists with their length (four bytes) before them. A reader passes over bytes after the last field, so a field may be
// added at the end. Kinds are only added at the end.
//
// Bytes come from another process: decoding never throws, reads no byte outside, and allocates no more than a small
// multiple of the bytes that are there.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace culprit_link {

inline constexpr std::uint32_t kVersion = 2;
// Bytes of a frame, its length apart. A larger sample is sent without its payload.
inline constexpr std::size_t kLargestFrame = std::size_t{16} << 20;
// Bytes that may wait to be sent. Beyond, the helper drops samples; a peer that lets more of the rest wait is stuck.
inline constexpr std::size_t kLongestQueue = std::size_t{64} << 20;
inline constexpr std::uint32_t kWhole = UINT32_MAX;  // Subscribe::most

using Bytes = std::vector<std::uint8_t>;
using Gid = std::array<std::uint8_t, 16>;  // of an endpoint, as its middleware gives it

// Quality of service. Durations in nanoseconds; 0: not set.
struct Quality {
  bool is_reliable = true;
  bool is_transient_local = false;
  bool keeps_all = false;
  bool asserts_liveliness = false;  // manually, by topic
  std::uint32_t depth = 10;
  std::int64_t deadline = 0;
  std::int64_t lifespan = 0;
  std::int64_t lease = 0;
  bool operator==(const Quality&) const = default;
  static void visit(auto& self, auto&& each) {
    each(self.is_reliable, self.is_transient_local, self.keeps_all, self.asserts_liveliness,
         self.depth, self.deadline, self.lifespan, self.lease);
  }
};

// ---- from culprit

// The first frame. `name_space` and `name`: of the node that the helper makes.
struct Join {
  std::uint32_t version = kVersion;
  std::string name_space;
  std::string name;
  bool operator==(const Join&) const = default;
  static void visit(auto& self, auto&& each) { each(self.version, self.name_space, self.name); }
};

// Endpoints have ids that culprit chooses. Types as "package/msg/Type" and "package/srv/Type", names absolute.
struct Subscribe {
  std::uint32_t id = 0;
  std::string topic;
  std::string type;
  Quality quality;
  std::uint32_t most = kWhole;  // bytes of each payload that are sent
  bool operator==(const Subscribe&) const = default;
  static void visit(auto& self, auto&& each) {
    each(self.id, self.topic, self.type, self.quality, self.most);
  }
};

struct Advertise {
  std::uint32_t id = 0;
  std::string topic;
  std::string type;
  Quality quality;
  bool operator==(const Advertise&) const = default;
  static void visit(auto& self, auto&& each) { each(self.id, self.topic, self.type, self.quality); }
};

// A client of a service.
struct Use {
  std::uint32_t id = 0;
  std::string service;
  std::string type;
  Quality quality;
  bool operator==(const Use&) const = default;
  static void visit(auto& self, auto&& each) {
    each(self.id, self.service, self.type, self.quality);
  }
};

// A service that culprit offers.
struct Offer {
  std::uint32_t id = 0;
  std::string service;
  std::string type;
  Quality quality;
  bool operator==(const Offer&) const = default;
  static void visit(auto& self, auto&& each) {
    each(self.id, self.service, self.type, self.quality);
  }
};

struct Remove {
  std::uint32_t id = 0;
  bool operator==(const Remove&) const = default;
  static void visit(auto& self, auto&& each) { each(self.id); }
};

// Payloads are serialized messages (CDR), with their encapsulation.
struct Publish {
  std::uint32_t id = 0;
  Bytes payload;
  bool operator==(const Publish&) const = default;
  static void visit(auto& self, auto&& each) { each(self.id, self.payload); }
};

// `number`: culprit's own, which the reply carries. The helper sends it to the middleware once.
struct Request {
  std::uint32_t id = 0;
  std::int64_t number = 0;
  Bytes payload;
  bool operator==(const Request&) const = default;
  static void visit(auto& self, auto&& each) { each(self.id, self.number, self.payload); }
};

// To Asked of the same number.
struct Respond {
  std::uint32_t id = 0;
  std::int64_t number = 0;
  Bytes payload;
  bool operator==(const Respond&) const = default;
  static void visit(auto& self, auto&& each) { each(self.id, self.number, self.payload); }
};

// The helper's executor sends it back as it is.
struct Echo {
  Bytes payload;
  bool operator==(const Echo&) const = default;
  static void visit(auto& self, auto&& each) { each(self.payload); }
};

// ---- from the helper

// The answer to Join. `middleware`: "rmw_fastrtps_cpp"; `own`: the gid of one of its publishers.
struct Welcome {
  std::uint32_t version = kVersion;
  std::string middleware;
  Gid own{};
  bool operator==(const Welcome&) const = default;
  static void visit(auto& self, auto&& each) { each(self.version, self.middleware, self.own); }
};

// A sample of a subscription. Times in nanoseconds since 1970; 0: not known. `number` counts the writer's samples;
// 0: the middleware does not count them.
struct Arrived {
  std::uint32_t id = 0;
  Gid writer{};
  std::int64_t number = 0;
  std::int64_t sent = 0;
  std::int64_t received = 0;
  std::uint32_t size = 0;  // of the whole payload
  Bytes payload;
  bool operator==(const Arrived&) const = default;
  static void visit(auto& self, auto&& each) {
    each(self.id, self.writer, self.number, self.sent, self.received, self.size, self.payload);
  }
};

struct Reply {
  std::uint32_t id = 0;
  std::int64_t number = 0;
  Bytes payload;
  bool operator==(const Reply&) const = default;
  static void visit(auto& self, auto&& each) { each(self.id, self.number, self.payload); }
};

struct Asked {
  std::uint32_t id = 0;
  std::int64_t number = 0;  // the helper's
  Bytes payload;
  bool operator==(const Asked&) const = default;
  static void visit(auto& self, auto&& each) { each(self.id, self.number, self.payload); }
};

// The whole graph, after each change.
struct GraphSeen {
  struct Node {
    std::string name_space;
    std::string name;
    bool operator==(const Node&) const = default;
    static void visit(auto& self, auto&& each) { each(self.name_space, self.name); }
  };
  struct Endpoint {
    bool is_publisher = false;
    std::string topic;
    std::string type;
    std::string type_hash;  // "RIHS01_...", empty before Iron
    Gid gid{};
    Node node;
    Quality quality;
    bool operator==(const Endpoint&) const = default;
    static void visit(auto& self, auto&& each) {
      each(self.is_publisher, self.topic, self.type, self.type_hash, self.gid, self.node,
           self.quality);
    }
  };
  // Middlewares give services and clients by the node's name alone.
  struct Service {
    bool is_server = false;
    std::string name;
    std::string type;
    Node node;
    bool operator==(const Service&) const = default;
    static void visit(auto& self, auto&& each) {
      each(self.is_server, self.name, self.type, self.node);
    }
  };
  std::vector<Node> nodes;
  std::vector<Endpoint> endpoints;
  std::vector<Service> services;
  bool operator==(const GraphSeen&) const = default;
  static void visit(auto& self, auto&& each) { each(self.nodes, self.endpoints, self.services); }
};

// An endpoint cannot be made; the rest goes on without it.
struct Refused {
  std::uint32_t id = 0;
  std::string why;
  bool operator==(const Refused&) const = default;
  static void visit(auto& self, auto&& each) { each(self.id, self.why); }
};

struct Trouble {
  std::string text;
  bool operator==(const Trouble&) const = default;
  static void visit(auto& self, auto&& each) { each(self.text); }
};

// Datagrams that the helper's own full sockets dropped since it began. It comes before a sample that follows missing
// ones, if the number has changed: those may be among them.
struct Dropped {
  std::uint64_t datagrams = 0;
  bool operator==(const Dropped&) const = default;
  static void visit(auto& self, auto&& each) { each(self.datagrams); }
};

using Frame =
    std::variant<Join, Subscribe, Advertise, Use, Offer, Remove, Publish, Request, Respond, Echo,
                 Welcome, Arrived, Reply, Asked, GraphSeen, Refused, Trouble, Dropped>;

// ---- coding

namespace coding {

template <class T>
concept Described = requires(T& t) {
  T::visit(t, [](auto&...) {});
};

class Writer {
 public:
  explicit Writer(Bytes& out) : out_(out) {}

  void operator()(const auto&... fields) { (write(fields), ...); }

 private:
  template <class T>
  void write(const T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      out_.push_back(value ? 1 : 0);
    } else if constexpr (std::is_integral_v<T>) {
      auto rest = static_cast<std::make_unsigned_t<T>>(value);
      for (std::size_t i = 0; i < sizeof(T); ++i) {
        out_.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(rest) >> (8 * i)));
      }
    } else if constexpr (std::is_same_v<T, Gid>) {
      out_.insert(out_.end(), value.begin(), value.end());
    } else if constexpr (Described<const T>) {
      T::visit(value, *this);
    } else {  // a text, bytes or a list
      write(static_cast<std::uint32_t>(value.size()));
      if constexpr (sizeof(typename T::value_type) == 1) {
        out_.insert(out_.end(), value.begin(), value.end());
      } else {
        for (const auto& each : value) write(each);
      }
    }
  }

  Bytes& out_;
};

class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : left_(bytes) {}

  bool ok() const { return ok_; }
  void operator()(auto&... fields) { (read(fields), ...); }

 private:
  std::span<const std::uint8_t> take(std::size_t count) {
    if (!ok_ || count > left_.size()) {
      ok_ = false;
      return {};
    }
    const auto taken = left_.first(count);
    left_ = left_.subspan(count);
    return taken;
  }

  template <class T>
  void read(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      const auto byte = take(1);
      value = !byte.empty() && byte[0] != 0;
    } else if constexpr (std::is_integral_v<T>) {
      std::uint64_t all = 0;
      const auto bytes = take(sizeof(T));
      for (std::size_t i = 0; i < bytes.size(); ++i) all |= std::uint64_t{bytes[i]} << (8 * i);
      value = static_cast<T>(all);
    } else if constexpr (std::is_same_v<T, Gid>) {
      const auto bytes = take(value.size());
      if (!bytes.empty()) std::memcpy(value.data(), bytes.data(), bytes.size());
    } else if constexpr (Described<T>) {
      T::visit(value, *this);
    } else {
      std::uint32_t count = 0;
      read(count);
      if constexpr (sizeof(typename T::value_type) == 1) {
        const auto bytes = take(count);
        value.assign(bytes.begin(), bytes.end());
      } else {
        value.clear();
        // Each takes at least one byte, and the list grows only as they are read.
        for (std::uint32_t i = 0; i < count && ok_; ++i) read(value.emplace_back());
      }
    }
  }

  std::span<const std::uint8_t> left_;
  bool ok_ = true;
};

template <std::size_t kKind = 0>
std::optional<Frame> decode(std::size_t kind, std::span<const std::uint8_t> fields) {
  if constexpr (kKind == std::variant_size_v<Frame>) {
    return std::nullopt;
  } else {
    if (kind != kKind) return decode<kKind + 1>(kind, fields);
    std::variant_alternative_t<kKind, Frame> frame;
    Reader reader(fields);
    frame.visit(frame, reader);
    return reader.ok() ? std::optional<Frame>(std::move(frame)) : std::nullopt;
  }
}

}  // namespace coding

inline constexpr std::size_t kLengthSize = sizeof(std::uint32_t);

// With its length before it. @pre its fields fit into kLargestFrame.
inline Bytes encode(const Frame& frame) {
  Bytes bytes(kLengthSize + 1);
  bytes.back() = static_cast<std::uint8_t>(frame.index());
  coding::Writer writer(bytes);
  std::visit([&](const auto& each) { each.visit(each, writer); }, frame);
  const std::size_t length = bytes.size() - kLengthSize;
  for (std::size_t i = 0; i < kLengthSize; ++i) {
    bytes[i] = static_cast<std::uint8_t>(length >> (8 * i));
  }
  return bytes;
}

// Cuts a stream of bytes into frames. Its failure is final: after a length out of bounds, an unknown kind or fields
// that are cut off, the rest of the stream means nothing.
class FrameReader {
 public:
  void feed(std::span<const std::uint8_t> bytes) {
    if (begin_ > 0 && begin_ == buffer_.size()) buffer_.clear(), begin_ = 0;
    if (begin_ > kCompacts) {
      buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(begin_));
      begin_ = 0;
    }
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  }

  // Nothing: more bytes are needed, or it has failed.
  std::optional<Frame> next() {
    const std::size_t there = buffer_.size() - begin_;
    if (has_failed_ || there < kLengthSize) return std::nullopt;
    std::size_t length = 0;
    for (std::size_t i = 0; i < kLengthSize; ++i) {
      length |= std::size_t{buffer_[begin_ + i]} << (8 * i);
    }
    if (length == 0 || length > kLargestFrame) {
      has_failed_ = true;
      return std::nullopt;
    }
    if (there - kLengthSize < length) return std::nullopt;
    const std::span<const std::uint8_t> bytes =
        std::span<const std::uint8_t>(buffer_).subspan(begin_ + kLengthSize, length);
    auto frame = coding::decode(bytes[0], bytes.subspan(1));
    has_failed_ = !frame;
    begin_ += kLengthSize + length;
    return frame;
  }

  bool has_failed() const { return has_failed_; }

 private:
  static constexpr std::size_t kCompacts = std::size_t{1} << 20;

  Bytes buffer_;
  std::size_t begin_ = 0;  // of what was not read yet
  bool has_failed_ = false;
};

}  // namespace culprit_link
