// A ROS 2 participant: a DDS participant, the live graph that it sees, and the nodes of this
// process that it announces.
//
// Discovery and `ros_discovery_info` are brought to the executor's thread, in order; there the
// graph is updated and its listener called, so a listener may create and destroy what it likes. The
// graph belongs to that thread.
//
// Own nodes are announced after each change, once for all changes made in one go. With which size
// of gid: as the options set, or as the first peer does; 24 bytes if no peer shows it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "base/expected.h"
#include "base/mutex.h"
#include "ros2/discovery_info.h"
#include "ros2/executor.h"
#include "ros2/graph.h"
#include "ros2/names.h"
#include "ros2/options.h"
#include "ros2/participant.h"

namespace culprit::ros2 {

class NodeEntry;

class Context {
 public:
  // The executor outlives the context.
  static Expected<std::unique_ptr<Context>> create(Executor& executor,
                                                   const ParticipantOptions& options,
                                                   Graph::Options graph = {});
  ~Context();  // @pre no NodeEntry left

  Executor& executor() { return executor_; }
  Participant& participant() { return *participant_; }
  // On the executor's thread only.
  const Graph& graph() const { return graph_; }

  // Receives each event after the graph did, on the executor's thread. Before the executor runs.
  void on_discovery(DiscoveryCallback listener) { discovery_listener_ = std::move(listener); }

  // A text that no other has: Cyclone's services find the two endpoints of a client by it.
  std::string unique_id();

  // A process of this machine has ended. Its nodes leave the graph now, not when their leases end.
  // From any thread.
  void forget_process(int pid);
  // The same for each process that has ended and claims a name that others claim too.
  void forget_ended_namesakes();
  // As those of the graph. From any thread.
  void believe_left(const std::string& node);
  void note_proven_here(const std::string& node);
  void look_at_unproven();

  // Calls `on_left` on the executor's thread whenever a server of `service` leaves the graph,
  // before the graph's listener, until unwatch_servers(). `on_left` must not call back into the
  // context.
  void watch_servers(const void* owner, std::string service, std::function<void()> on_left);
  void unwatch_servers(const void* owner);

 private:
  friend class NodeEntry;

  struct ServerWatch {
    std::string service;
    std::function<void()> on_left;
  };

  Context(Executor& executor, Graph::Options graph);
  Graph::Options with_context(Graph::Options options);
  std::string source_of(const ParticipantInfo& info) const;
  FoundProcess find_process(const Graph::FindProcess& find, ParticipantInfo info);
  Expected<void> open(const ParticipantOptions& options);
  Expected<void> listen_to_infos();

  // From a participant: the announcement of its nodes, as it came.
  struct RawInfo {
    rtps::Bytes payload;
    rtps::GuidPrefix sender;
  };
  using Heard = std::variant<DiscoveryEvent, RawInfo>;
  // From any thread, in the order in which it is to be taken in.
  void hear(Heard heard);

  // On the executor's thread.
  void take_in();
  void discovered(const DiscoveryEvent& event);
  void note_return(const DiscoveryEvent& event);
  void on_info(const rtps::Bytes& payload, const rtps::GuidPrefix& sender);
  void decide(GidSize size);
  void announce();
  void on_server_left(const std::string& service);

  // From any thread.
  void schedule_announcement();

  Executor& executor_;
  Graph graph_;
  std::optional<GidSize> gid_size_;
  bool is_deciding_ = false;
  bool has_server_ = false;
  bool has_helper_ = false;
  std::set<rtps::GuidPrefix> lost_;  // participants whose leases ran out
  bool is_listening_anew_ = false;
  DiscoveryCallback discovery_listener_;  // may be empty
  // Recent proofs. So a process of many nodes is looked up once, not for each of them.
  struct Proof {
    ParticipantInfo of;
    FoundProcess found;
    Time until;
  };
  std::map<rtps::GuidPrefix, Proof> proofs_;

  Mutex mutex_;
  bool is_open_ CULPRIT_GUARDED_BY(mutex_) =
      false;  // the members below are set, and stay as they are
  std::set<NodeEntry*> nodes_ CULPRIT_GUARDED_BY(mutex_);
  std::map<const void*, ServerWatch> watches_ CULPRIT_GUARDED_BY(mutex_);
  bool is_scheduled_ CULPRIT_GUARDED_BY(mutex_) = false;
  std::uint32_t next_id_ CULPRIT_GUARDED_BY(mutex_) = 1;
  std::vector<Heard> heard_ CULPRIT_GUARDED_BY(mutex_);  // and not taken in yet

  TaskGroup tasks_;  // outlives those that post to it
  std::unique_ptr<Participant> participant_;
  std::unique_ptr<Writer> info_writer_;
  std::unique_ptr<Reader> info_reader_;
};

// One of our nodes, as others see it: a name, and the endpoints that are its. Thread-safe.
class NodeEntry {
 public:
  NodeEntry(Context& context, NodeName name);
  ~NodeEntry();
  NodeEntry(const NodeEntry&) = delete;
  NodeEntry& operator=(const NodeEntry&) = delete;

  Context& context() const { return context_; }
  const NodeName& name() const { return name_; }

  void add(const rtps::Guid& endpoint);
  void remove(const rtps::Guid& endpoint);

 private:
  friend class Context;

  Context& context_;
  const NodeName name_;
  std::set<rtps::Guid> endpoints_;  // guarded by the context's mutex
};

}  // namespace culprit::ros2
