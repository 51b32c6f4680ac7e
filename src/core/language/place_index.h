// Finds entries of a table by what they are called, or by anything else that they have in them.
//
//     PlaceIndex by_name;
//     by_name.add(name_hash(entry.name), table.size());
//     table.push_back(entry);
//     const auto place = by_name.find(name_hash(name), [&](auto i) { return table[i].name == name; });
//
// It holds places in the table, and neither the entries nor copies of their names: a hash table of
// open addressing, at most half full, which takes one block of memory however many it finds.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace culprit {

class PlaceIndex {
 public:
  void reserve(std::size_t entries) {
    if (2 * entries > slots_.size()) rebuild(std::bit_ceil(2 * entries));
  }

  // The first place that was added with `hash` and that `is_it`; nothing if none is.
  template <class IsIt>
  std::optional<std::uint32_t> find(std::size_t hash, IsIt is_it) const {
    if (slots_.empty()) return std::nullopt;
    const std::uint32_t wanted = folded(hash);
    for (std::size_t at = wanted & mask();; at = (at + 1) & mask()) {
      const Slot& slot = slots_[at];
      if (slot.place == kFree) return std::nullopt;
      if (slot.hash == wanted && is_it(slot.place)) return slot.place;
    }
  }

  void add(std::size_t hash, std::size_t place) {
    reserve(std::max<std::size_t>(count_ + 1, 4));
    ++count_;
    put({folded(hash), static_cast<std::uint32_t>(place)});
  }

 private:
  static constexpr std::uint32_t kFree = 0xffffffff;
  struct Slot {
    std::uint32_t hash = 0;
    std::uint32_t place = kFree;
  };

  static std::uint32_t folded(std::size_t hash) {
    return static_cast<std::uint32_t>(hash ^ (hash >> 32));
  }
  std::size_t mask() const { return slots_.size() - 1; }

  void put(Slot slot) {
    std::size_t at = slot.hash & mask();
    while (slots_[at].place != kFree) at = (at + 1) & mask();
    slots_[at] = slot;
  }

  void rebuild(std::size_t size) {
    const std::vector<Slot> before = std::exchange(slots_, std::vector<Slot>(size));
    for (const Slot& slot : before) {
      if (slot.place != kFree) put(slot);
    }
  }

  std::vector<Slot> slots_;  // none, or a power of two of them
  std::size_t count_ = 0;
};

inline std::size_t name_hash(std::string_view name) { return std::hash<std::string_view>()(name); }

// The hash of two parts of a key.
inline std::size_t mixed_hash(std::size_t hash, std::size_t more) {
  hash = (hash ^ more) * 0x9E3779B97F4A7C15;
  return hash ^ (hash >> 29);
}

// The entry of `table` that is called so, where `by_name` has the names of its entries.
template <class Entry>
std::optional<std::uint32_t> place_of(std::string_view name, const std::vector<Entry>& table,
                                      const PlaceIndex& by_name) {
  return by_name.find(name_hash(name),
                      [&](std::uint32_t place) { return table[place].name == name; });
}

}  // namespace culprit
