#include "link/datagram_troubles.h"

#include <string>

#include "rtps/origins.h"

namespace culprit::link {

void DatagramTroubles::tell(Time now) {
  tell_of_refused();
  tell_of_foreign_sources(now);
  tell_of_dropped();
}

void DatagramTroubles::tell_of_refused() {
  const rtps::DatagramFilter::Refused refused = context_.participant().refused();
  if (!refused_.is_due(refused.count)) return;
  inbox_.put(LinkTrouble{
      (refused.count == 1 ? "1 datagram was" : std::to_string(refused.count) + " datagrams were") +
      std::string(" kept out so far: ") + refused.why +
      "; which program on this network sends them?"});
}

void DatagramTroubles::tell_of_dropped() {
  const std::uint64_t dropped = context_.participant().dropped_here();
  if (!dropped_.is_due(dropped)) return;
  const std::string whose = has_helper_ ? "the helper program's" : "culprit's own";
  inbox_.put(
      LinkTrouble{whose + " sockets were full and dropped " + std::to_string(dropped) +
                  " datagrams so far; loss() is unknown while they may be what is missing. Raise "
                  "net.core.rmem_max, or find the program that floods the network"});
}

void DatagramTroubles::tell_of_foreign_sources(Time now) {
  rtps::Origins& origins = context_.participant().origins();
  origins.check(now);
  for (const rtps::ForeignSource& source : origins.new_sources()) {
    std::string name = "a node";
    for (const ros2::Graph::NodeView& node : context_.graph().bare_nodes()) {
      if (node.participant == source.in_name_of) name = node.node.name;
    }
    const std::string owner =
        source.user ? ", a socket of user " + std::to_string(*source.user) : "";
    const std::string process =
        source.pid == 0 ? "" : " (process " + std::to_string(source.pid) + ")";
    inbox_.put(LinkTrouble{
        "datagrams from " + to_text(source.from) + owner + " speak for " + name + process +
        ", which does not send from there; they are dropped. Find the program that sends them"});
  }
}

}  // namespace culprit::link
