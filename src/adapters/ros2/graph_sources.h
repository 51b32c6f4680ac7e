// How much of the graph's tables each source of participants takes, and whether it may take more.
//
// Half of each table is kept free for sources that are known: this machine, and those that hold a component. One
// source gets at most half of the other half. So a stranger that makes up participants does not keep the robot's
// from being discovered.
#pragma once

#include <cstddef>
#include <map>
#include <string>

namespace culprit::ros2 {

// A source is the address that datagrams of its participants come from; empty: this machine.
class GraphSources {
 public:
  // The entries of one source.
  struct Entries {
    std::size_t participants = 0;
    std::size_t names = 0;      // that they claim
    std::size_t endpoints = 0;  // discovered
    std::size_t components = 0;
  };

  Entries& operator[](const std::string& source) { return sources_[source]; }
  void forget(const std::string& source) { sources_.erase(source); }

  // Whether `source` may have one more in a table of `limit` entries, beside `more`.
  bool has_room(const std::string& source, std::size_t Entries::*what, std::size_t limit,
                std::size_t more = 0) const;

 private:
  std::map<std::string, Entries> sources_;
};

}  // namespace culprit::ros2
