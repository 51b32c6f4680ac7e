// An independent peer for tests: ROS 2 over Cyclone DDS by hand, with the service mapping of
// rmw_cyclonedds.
//
//     ros2_peer_cyclone <domain> tick <topic>         publishes std_msgs/Float64 until killed
//     ros2_peer_cyclone <domain> echo <topic>         prints "value <number>" for each Float64
//     ros2_peer_cyclone <domain> diagnostics          prints "status <level> <name> <key>=<value> ..."
//     ros2_peer_cyclone <domain> serve <node>         is a node with ~/get_state, ~/change_state;
//                                                     prints "change <id>" for each request
//     ros2_peer_cyclone <domain> call <node> <id>...  prints "state <id> <label>", then "change <id>
//                                                     <success>" for each transition, or "lost";
//                                                     ends without leaving the domain
//
// A call is made as rmw_cyclonedds makes it: once, as soon as both endpoints have matched here.
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

#include <dds/dds.h>

#include "ros2.h"

namespace {

using namespace std::chrono_literals;
using GetStateRequest = lifecycle_msgs_srv_dds__GetState_Request_;
using GetStateResponse = lifecycle_msgs_srv_dds__GetState_Response_;
using ChangeStateRequest = lifecycle_msgs_srv_dds__ChangeState_Request_;
using ChangeStateResponse = lifecycle_msgs_srv_dds__ChangeState_Response_;

dds_entity_t check(dds_entity_t entity, const char* what) {
  if (entity < 0) {
    std::fprintf(stderr, "ros2_peer_cyclone: %s: %s\n", what, dds_strretcode(entity));
    std::exit(1);
  }
  return entity;
}

void say(const std::string& line) {
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

enum class Durability { kVolatile, kTransientLocal };

class Qos {
 public:
  explicit Qos(Durability durability, const std::string& user_data = {}) : qos_(dds_create_qos()) {
    dds_qset_reliability(qos_, DDS_RELIABILITY_RELIABLE, DDS_INFINITY);
    dds_qset_history(qos_, DDS_HISTORY_KEEP_LAST, 10);
    dds_qset_durability(qos_, durability == Durability::kVolatile ? DDS_DURABILITY_VOLATILE
                                                                  : DDS_DURABILITY_TRANSIENT_LOCAL);
    if (!user_data.empty()) dds_qset_userdata(qos_, user_data.data(), user_data.size());
  }
  ~Qos() { dds_delete_qos(qos_); }
  const dds_qos_t* get() const { return qos_; }

 private:
  dds_qos_t* qos_;
};

class Peer {
 public:
  explicit Peer(dds_domainid_t domain) {
    const Qos qos(Durability::kVolatile, "enclave=/;");
    participant_ = check(dds_create_participant(domain, qos.get(), nullptr), "participant");
  }

  dds_entity_t reader(const dds_topic_descriptor_t& type, const std::string& topic,
                      const Qos& qos) {
    return check(dds_create_reader(participant_, this->topic(type, topic), qos.get(), nullptr),
                 "reader");
  }
  dds_entity_t writer(const dds_topic_descriptor_t& type, const std::string& topic,
                      const Qos& qos) {
    return check(dds_create_writer(participant_, this->topic(type, topic), qos.get(), nullptr),
                 "writer");
  }
  dds_entity_t participant() const { return participant_; }

 private:
  dds_entity_t topic(const dds_topic_descriptor_t& type, const std::string& name) {
    return check(dds_create_topic(participant_, &type, name.c_str(), nullptr, nullptr), "topic");
  }

  dds_entity_t participant_;
};

// Takes what has come and hands it to `handle`; whether there was anything.
template <class Message, class Handler>
bool take(dds_entity_t reader, Handler handle) {
  void* sample = nullptr;
  dds_sample_info_t info;
  bool any = false;
  while (dds_take(reader, &sample, &info, 1, 1) > 0) {
    if (info.valid_data) handle(*static_cast<const Message*>(sample)), any = true;
    dds_return_loan(reader, &sample, 1);
  }
  return any;
}

// Sleeps until one of the readers has something, or 100 ms.
void wait_for_any(const Peer& peer, const std::vector<dds_entity_t>& readers) {
  const dds_entity_t waitset = check(dds_create_waitset(peer.participant()), "waitset");
  for (const dds_entity_t reader : readers) {
    const dds_entity_t condition =
        check(dds_create_readcondition(reader, DDS_ANY_STATE), "condition");
    dds_waitset_attach(waitset, condition, 0);
  }
  dds_waitset_wait(waitset, nullptr, 0, DDS_MSECS(100));
  dds_delete(waitset);
}

bool has_matched(dds_entity_t writer, dds_entity_t reader) {
  return dds_get_matched_subscriptions(writer, nullptr, 0) > 0 &&
         dds_get_matched_publications(reader, nullptr, 0) > 0;
}

std::string unique_id(const char* key) {
  return std::string(key) + "=1." + std::to_string(getpid()) + ";";
}

// Sends one request, and waits for the reply that carries its number.
template <class Request, class Response, class Handler>
void call(const Peer& peer, dds_entity_t writer, dds_entity_t reader, Request request,
          Handler handle) {
  static std::int64_t number = 0;
  while (!has_matched(writer, reader)) std::this_thread::sleep_for(1ms);
  request.client = static_cast<std::uint64_t>(getpid());
  request.number = ++number;
  check(dds_write(writer, &request), "write");
  bool answered = false;
  const auto deadline = std::chrono::steady_clock::now() + 20s;
  while (!answered && std::chrono::steady_clock::now() < deadline) {
    take<Response>(reader, [&](const Response& response) {
      if (response.client != request.client || response.number != request.number) return;
      answered = true;
      handle(response);
    });
    if (!answered) wait_for_any(peer, {reader});
  }
  if (!answered) say("lost");
}

[[noreturn]] void run_tick(Peer& peer, const std::string& topic) {
  const dds_entity_t writer =
      peer.writer(std_msgs_msg_dds__Float64__desc, "rt" + topic, Qos(Durability::kVolatile));
  for (std_msgs_msg_dds__Float64_ message{0};; ++message.data) {
    dds_write(writer, &message);
    std::this_thread::sleep_for(20ms);
  }
}

[[noreturn]] void run_echo(Peer& peer, const std::string& topic) {
  using Message = std_msgs_msg_dds__Float64_;
  const dds_entity_t reader =
      peer.reader(std_msgs_msg_dds__Float64__desc, "rt" + topic, Qos(Durability::kVolatile));
  while (true) {
    wait_for_any(peer, {reader});
    take<Message>(reader,
                  [](const Message& message) { say("value " + std::to_string(message.data)); });
  }
}

[[noreturn]] void run_diagnostics(Peer& peer) {
  using Message = diagnostic_msgs_msg_dds__DiagnosticArray_;
  const dds_entity_t reader = peer.reader(diagnostic_msgs_msg_dds__DiagnosticArray__desc,
                                          "rt/diagnostics", Qos(Durability::kVolatile));
  while (true) {
    wait_for_any(peer, {reader});
    take<Message>(reader, [](const Message& message) {
      for (std::uint32_t i = 0; i < message.status._length; ++i) {
        const auto& status = message.status._buffer[i];
        std::string line = "status " + std::to_string(status.level) + " " + status.name;
        for (std::uint32_t j = 0; j < status.values._length; ++j) {
          line += std::string(" ") + status.values._buffer[j].key + "=" +
                  status.values._buffer[j].value;
        }
        say(line);
      }
    });
  }
}

void announce(Peer& peer, const std::string& node, const std::vector<dds_entity_t>& readers,
              const std::vector<dds_entity_t>& writers) {
  using Gid = rmw_dds_common_msg_dds__Gid_;
  const auto gid_of = [](dds_entity_t entity) {
    dds_guid_t guid;
    check(dds_get_guid(entity, &guid), "guid");
    Gid gid{};
    std::copy(std::begin(guid.v), std::end(guid.v), gid.data);
    return gid;
  };
  std::vector<Gid> reader_gids, writer_gids;
  for (const dds_entity_t reader : readers) reader_gids.push_back(gid_of(reader));
  for (const dds_entity_t writer : writers) writer_gids.push_back(gid_of(writer));
  std::string name_space = "/", name = node.substr(1);
  rmw_dds_common_msg_dds__NodeEntitiesInfo_ entities{};
  entities.node_namespace = name_space.data();
  entities.node_name = name.data();
  entities.reader_gids._length = static_cast<std::uint32_t>(reader_gids.size());
  entities.reader_gids._buffer = reader_gids.data();
  entities.writer_gids._length = static_cast<std::uint32_t>(writer_gids.size());
  entities.writer_gids._buffer = writer_gids.data();
  rmw_dds_common_msg_dds__ParticipantEntitiesInfo_ info{};
  info.gid = gid_of(peer.participant());
  info.nodes._length = 1;
  info.nodes._buffer = &entities;
  const dds_entity_t writer = peer.writer(rmw_dds_common_msg_dds__ParticipantEntitiesInfo__desc,
                                          "ros_discovery_info", Qos(Durability::kTransientLocal));
  check(dds_write(writer, &info), "write");
}

[[noreturn]] void run_serve(Peer& peer, const std::string& node) {
  const Qos get_qos(Durability::kVolatile, unique_id("serviceid")),
      change_qos(Durability::kVolatile, unique_id("serviceid"));
  const dds_entity_t get_reader = peer.reader(lifecycle_msgs_srv_dds__GetState_Request__desc,
                                              "rq" + node + "/get_stateRequest", get_qos);
  const dds_entity_t get_writer = peer.writer(lifecycle_msgs_srv_dds__GetState_Response__desc,
                                              "rr" + node + "/get_stateReply", get_qos);
  const dds_entity_t change_reader = peer.reader(lifecycle_msgs_srv_dds__ChangeState_Request__desc,
                                                 "rq" + node + "/change_stateRequest", change_qos);
  const dds_entity_t change_writer = peer.writer(lifecycle_msgs_srv_dds__ChangeState_Response__desc,
                                                 "rr" + node + "/change_stateReply", change_qos);
  announce(peer, node, {get_reader, change_reader}, {get_writer, change_writer});
  std::string label = "unconfigured";
  while (true) {
    wait_for_any(peer, {get_reader, change_reader});
    take<GetStateRequest>(get_reader, [&](const GetStateRequest& request) {
      GetStateResponse response{request.client, request.number, {1, label.data()}};
      dds_write(get_writer, &response);
    });
    take<ChangeStateRequest>(change_reader, [&](const ChangeStateRequest& request) {
      say("change " + std::to_string(request.transition.id));
      ChangeStateResponse response{request.client, request.number, true};
      dds_write(change_writer, &response);
    });
  }
}

[[noreturn]] void run_call(Peer& peer, const std::string& node,
                           const std::vector<std::uint8_t>& transitions) {
  const Qos get_qos(Durability::kVolatile, unique_id("clientid")),
      change_qos(Durability::kVolatile, unique_id("clientid"));
  const dds_entity_t get_writer = peer.writer(lifecycle_msgs_srv_dds__GetState_Request__desc,
                                              "rq" + node + "/get_stateRequest", get_qos);
  const dds_entity_t get_reader = peer.reader(lifecycle_msgs_srv_dds__GetState_Response__desc,
                                              "rr" + node + "/get_stateReply", get_qos);
  call<GetStateRequest, GetStateResponse>(
      peer, get_writer, get_reader, GetStateRequest{}, [](const auto& response) {
        say("state " + std::to_string(response.state.id) + " " + response.state.label);
      });
  const dds_entity_t change_writer = peer.writer(lifecycle_msgs_srv_dds__ChangeState_Request__desc,
                                                 "rq" + node + "/change_stateRequest", change_qos);
  const dds_entity_t change_reader = peer.reader(lifecycle_msgs_srv_dds__ChangeState_Response__desc,
                                                 "rr" + node + "/change_stateReply", change_qos);
  std::string no_label;
  for (const std::uint8_t id : transitions) {
    ChangeStateRequest request{};
    request.transition = {id, no_label.data()};
    call<ChangeStateRequest, ChangeStateResponse>(
        peer, change_writer, change_reader, request, [id](const auto& response) {
          say("change " + std::to_string(id) + " " + std::to_string(response.success));
        });
  }
  _exit(0);  // like a killed process: without a goodbye
}

int usage() {
  std::fprintf(stderr,
               "usage: ros2_peer_cyclone <domain> tick|echo <topic> | diagnostics | serve <node> | "
               "call <node> <id>...\n");
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> args(argv + 1, argv + argc);
  if (args.size() < 2) return usage();
  // As rmw_cyclonedds with ROS_LOCALHOST_ONLY=1, on a loopback interface without multicast.
  setenv("CYCLONEDDS_URI",
         "<General><Interfaces><NetworkInterface address=\"127.0.0.1\"/></Interfaces>"
         "<AllowMulticast>false</AllowMulticast></General>"
         "<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</"
         "MaxAutoParticipantIndex>"
         "<Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery>",
         1);
  dds_domainid_t domain = 0;
  std::from_chars(args[0].data(), args[0].data() + args[0].size(), domain);
  Peer peer(domain);
  const std::string& command = args[1];
  if (command == "diagnostics") run_diagnostics(peer);
  if (args.size() < 3) return usage();
  if (command == "tick") run_tick(peer, args[2]);
  if (command == "echo") run_echo(peer, args[2]);
  if (command == "serve") run_serve(peer, args[2]);
  if (command != "call") return usage();
  std::vector<std::uint8_t> transitions;
  for (std::size_t i = 3; i < args.size(); ++i)
    transitions.push_back(static_cast<std::uint8_t>(std::atoi(args[i].c_str())));
  run_call(peer, args[2], transitions);
}
