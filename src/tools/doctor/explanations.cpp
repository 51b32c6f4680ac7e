#include "doctor/explanations.h"

#include <algorithm>
#include <cctype>

#include "doctor/recording_explanations.h"

namespace culprit::doctor {
namespace {

std::vector<Explanation> of_connections() {
  return {
      {"D001", "a publisher offers less than a subscription requests",
       "Quality of service is a contract: a subscription says what it needs, a publisher what it "
       "gives, and if that is less, DDS does not connect them. Both are in `ros2 topic info`, and "
       "nothing arrives. A node is notified only if it asks for the event of incompatible QoS.",
       "The doctor compares each publisher with each subscription, as discovery announces them: "
       "reliability, durability, deadline, liveliness and its lease, ownership, and keys. For "
       "services, it compares the requests. History depth is not announced and not part of the "
       "contract. A node that publishes to itself is not reported.",
       "Let the subscription ask for less or the publisher offer more. For sensors `best effort` "
       "on "
       "the reading side fits all publishers (rclcpp::SensorDataQoS, qos_profile_sensor_data); for "
       "maps and descriptions both need `transient local`."},
      {"D002", "a topic or service is used with different types",
       "The name is the same, but the types are not: DDS does not connect endpoints whose types "
       "have different names.",
       "From the type names that discovery announces.",
       "Give both the same type, or one of them another name."},
      {"D003",
       "a topic or service without a counterpart, and an unused one with nearly the same name",
       "Where a node was started in another namespace, a remapping was forgotten or a letter is "
       "wrong, one side publishes without a subscription, and the other waits without a publisher.",
       "A subscription (or client) without any publisher (or server), and a topic (or service) of "
       "the same type that is unused, with a typing mistake between their names or the same own "
       "name in another namespace. An input that merely has no publisher is not reported, nor are "
       "the services that each node has.",
       "Remap one of them (`--ros-args -r scan:=front/scan`), or start both in one namespace."},
      {"D004", "one of several similar topics lacks a publisher or subscription",
       "Three of four cameras are read, or two of three wheels are driven: the difference is "
       "seldom intended.",
       "Three topics or more of one type whose names differ in numbers or in one namespace only; "
       "all "
       "but one have publishers and subscriptions, and that one has only one of both. Topics of "
       "ROS "
       "itself and of actions are not compared.",
       "Start the missing node, or find the name to which it was remapped."},
      {"D005", "one type name, two definitions",
       "Both sides call their type the same and mean different fields: a package was built in two "
       "versions. DDS connects them, and messages are misread or refused as broken.",
       "From the type hashes that endpoints announce, which ROS 2 does since Iron. Humble and "
       "older do not announce them.",
       "Build both with the same version of the message package."},
      {"D006", "a latched message was published before its volatile subscription",
       "A map or a robot description is published once, and kept for late joiners (transient "
       "local). A volatile subscription receives only later messages: whether it receives the map "
       "depends on the order of the starts.",
       "All publishers of the topic latch, the subscription is volatile, and its process was "
       "started after the newest message was published. Only if both processes are on this "
       "machine, since clocks differ. A node that started later than its process is not detected.",
       "Let the subscription request transient local."},
      {"D007", "a service is called over two middlewares",
       "rmw_fastrtps and rmw_cyclonedds share topics, but pair the answers of services in ways of "
       "their own: the client finds its server and waits for ever. Parameters and lifecycle are "
       "services, too.",
       "From the vendors of a client and of its server. Nodes that speak both, as culprit's do, "
       "say so "
       "and are not reported.",
       "Set RMW_IMPLEMENTATION to the same for all nodes."},
      {"D008", "no partition in common",
       "A partition is a second name of a topic, unknown to ROS 2: XML profiles of the middleware "
       "set it. Endpoints without a common one do not connect, and no tool of ROS 2 shows why.",
       "From the partitions that endpoints announce, with the wildcards of DDS.",
       "Take the partition out of the profile, or give it to both."},
      {"D009", "endpoints were announced and did not come",
       "A participant lists the endpoints of its nodes, and the endpoints announce themselves. A "
       "listed one without an announcement is not discovered, at least by the doctor. Large "
       "announcements that are cut into pieces and lost do this, on Wi-Fi above all.",
       "From what was announced in `ros_discovery_info` and what came by the end of the look, of "
       "nodes that are there for three seconds at least. Whether two other nodes have discovered "
       "each other is not observable from outside.",
       "Start the node again; see whether large datagrams get through (MTU, firewall, Wi-Fi); try "
       "a "
       "discovery server."},
  };
}

std::vector<Explanation> of_nodes() {
  return {
      {"D010", "several nodes have one name",
       "Both publish and both answer: a parameter set on one is unknown to the other, and the "
       "lifecycle of one is out of reach. Mostly an earlier launch is left over.",
       "From the graph. Processes that are known to have ended do not count.",
       "End one of them, or give it another name."},
      {"D011", "a node is gone without a good-bye",
       "Its process has ended or was killed, and until its lease runs out (20 s) others assume "
       "that it is alive: clients wait for it, and liveliness reports no change.",
       "Of this machine: its process has ended, and it is still in the graph. Of other machines: "
       "its "
       "lease ran out while the doctor looked. The doctor reports neither nodes that were gone "
       "before it came "
       "nor nodes that said good-bye.",
       "Start it again; its log (~/.ros/log), journalctl or dmesg (out of memory) say why it "
       "ended."},
      {"D012", "a node does not answer",
       "It is in the graph and its process runs, but the thread that should run its callbacks does "
       "something else: it waits in a driver, for a lock, or works for too long.",
       "Each node that serves parameters is asked for `use_sim_time`, and has half of the look to "
       "answer. The doctor reports no node that it did not reach, and no process that is stopped "
       "as a "
       "whole: "
       "a newcomer does not see it.",
       "See where its threads are (`gdb -p PID`, `py-spy dump --pid PID`), and start it again."},
      {"D013", "a node was restarted during the look",
       "It was started again, by a launch file with respawn or by systemd. Once may be a repaired "
       "accident. Repeated restarts repair nothing, and each one costs all other nodes discovery.",
       "A node left, or its process ended, and one of the same name came. Counted over the time of "
       "the "
       "look, or ten minutes with --watch; an error from the second time on.",
       "Its log says why it ended. Stop its launcher, and start it by hand."},
      {"D014", "a process is left over from an earlier launch",
       "Its launcher was killed and could not end it. If it ends, it stays down. The next launch "
       "makes a second one beside it. Its output has "
       "no reader any more, so printing may end it.",
       "The process has been handed to the first process of the machine, and its standard output "
       "is a pipe without a reader. A process that was started with nohup or by systemd is none. "
       "Only processes of this machine that the doctor may look into.",
       "End it (`kill PID`), and launch the robot anew."},
      {"D015", "a lifecycle node is stuck in a state",
       "It is in a state in which it publishes nothing, other lifecycle nodes are active, and no "
       "manager can change that: its lifecycle manager has exited or does not know it.",
       "Asked twice, it is inactive, unconfigured or finalized both times; another node subscribes "
       "to a topic that only this one publishes; no node, not even culprit, has a client of its "
       "change_state.",
       "`ros2 lifecycle set /node configure`, then `activate`; see why its manager gave up."},
      {"D016", "a node is stuck in a transition",
       "Until its work in on_configure or on_activate ends, it neither works nor takes another "
       "order.",
       "Asked twice, it is in the same transition state both times. A node that answers nothing "
       "meanwhile, as those with one thread, is D012.",
       "See where its threads are, and start it again."},
      {"D017", "a process leaks memory",
       "Its memory only grows, and what this machine has left will be gone within hours. Then "
       "Linux ends "
       "a process of its choice.",
       "In five samples or more, each quarter ends at a new maximum. The process grew by at least "
       "10 MB and 5 %, and at that rate no memory is left within six hours. Not in the first "
       "minute of a process. Slow leaks need a longer look (--for 10m) or a baseline (D107).",
       "Find what it keeps (heaptrack, tracemalloc), and restart it in time."},
      {"D018", "a process uses a whole core",
       "One of its threads never waits: it spins, or has more to do than one thread can.",
       "A thread used 95 % of a core or more between any two samples of a look, for four seconds "
       "at "
       "least.",
       "See what it does (`perf top -p PID`, `py-spy top --pid PID`)."},
      {"D019", "parameters are not what the process was started with",
       "They were set since. A restart of the node sets them back.",
       "Compared with `-p` and `--params-file` of its command line, for processes of this machine. "
       "Parameters that a node changes by itself are reported, too.",
       "Write them into the parameter file, or set them back."},
  };
}

std::vector<Explanation> of_diagnostics() {
  return {
      {"D020", "a diagnostic status is at ERROR, or STALE",
       "A node, or an aggregator of others, says itself that something does not work.",
       "From the last report of each status on /diagnostics while the doctor looked. WARN is not "
       "reported.",
       "Look at its values: `ros2 topic echo /diagnostics`, rqt_robot_monitor."},
      {"D021", "a diagnostic status is not reported any more",
       "It was reported regularly and has stopped: its node hangs or has exited. Displays still "
       "show its last report.",
       "A status that was received three times or more, over two seconds or more, and then not for "
       "five of its periods and five seconds. Needs a look that is long enough (--for, --watch).",
       "Find the publishers of /diagnostics: `ros2 topic info -v /diagnostics`."},
  };
}

std::vector<Explanation> of_reach() {
  return {
      {"D030", "no node was discovered",
       "There is nothing to examine: the robot is off, on another domain, or hidden by the way in "
       "which "
       "it or the doctor was started.",
       "No node was discovered. The finding names domains that processes of this machine are on.",
       "Start the doctor with the robot's ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY and discovery server."},
      {"D031", "processes of one launch are on different domains",
       "Processes of one launch file do not discover each other: one has another ROS_DOMAIN_ID.",
       "Two processes of this machine have one launcher (`ros2 launch`) and wait on different "
       "domains. "
       "The doctor does not report a bridge, which is on both.",
       "Give both the same ROS_DOMAIN_ID."},
      {"D032", "a node can be reached from its own computer only",
       "It was started with ROS_LOCALHOST_ONLY=1, or ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST, and "
       "others "
       "of the robot are on other computers.",
       "All addresses that it announces are loopback addresses, and nodes of another host are in "
       "the "
       "graph.",
       "Start it without, or all on one computer."},
      {"D033", "some participants are secured, and some are not",
       "Participants with keys (SROS2) and without do not connect, unless the governance of the "
       "keys admits unauthenticated ones.",
       "From the identity that participants announce. Participants of the doctor's own kind are "
       "seen whole, of the others only that they exist.",
       "Start all with ROS_SECURITY_ENABLE=true and keys of one keystore, or none."},
      {"D034", "distributions that do not understand each other are on one domain",
       "Up to Humble and from Iron on, processes announce the names of their nodes in different "
       "forms. Neither reads the other's, so nodes are missing in the graph, and some crash on "
       "such messages.",
       "From the form in which each participant names its nodes.",
       "Give one side another ROS_DOMAIN_ID, and bridge what both need."},
      {"D035", "shared memory that is not shared",
       "Fast DDS sends through /dev/shm to all participants on the same machine. In containers "
       "that share the network but not the memory, nodes discover each other and receive nothing.",
       "Two participants announce shared memory and take each other to be on one machine, and "
       "their "
       "processes see different file systems there. Only processes that the doctor may look into.",
       "Start the containers with `--ipc=host`, or switch shared memory off "
       "(FASTDDS_BUILTIN_TRANSPORTS=UDPv4, or an XML profile)."},
  };
}

std::vector<Explanation> of_data() {
  return {
      {"D040", "messages are later than a subscription's deadline",
       "A subscription requests a deadline, and the publisher offered it, but does not keep it.",
       "At least 5 %, and two, of the pauses between messages are longer than the deadline; or no "
       "message comes at all. Received best effort: a message that is lost on the way counts as "
       "late.",
       "See what keeps the publisher, or ask for what it can keep."},
      {"D041", "a sensor is silent",
       "A sensor's topic has a publisher and a subscription, but no messages: the driver runs, and "
       "the device, its cable or its input has failed.",
       "No message for four seconds on a topic of images, scans, point clouds, IMU, satellite, "
       "range, pressure, magnetic field or odometry that a node of the robot reads. Nodes that are "
       "not active, or do not answer, have findings of their own; topics without a subscription "
       "are ignored.",
       "See the driver's log, and whether the device is there (lsusb, ping)."},
      {"D042", "time stamps are old",
       "Messages are stamped long before they are sent: a node that looks up the transform of that "
       "moment, or waits for messages of one time, is too late.",
       "The median of the differences between a header's stamp and the time at which its sender "
       "sent it is more than a second, by the sender's clock. Not for latched topics, nor in "
       "simulated time.",
       "See what delays them (a queue, a slow device), or set the clock of the computer that "
       "stamps them."},
      {"D043", "time stamps are in the future",
       "tf has no transform for that time yet: a node waits for it, or drops the message.",
       "As D042, more than two seconds ahead.",
       "Set the clock of the device or computer that stamps them (chrony, PTP)."},
      {"D044", "time jumps back",
       "Stamps of one sender and frame, or /clock, went back by more than 20 ms. tf drops its "
       "history, "
       "and filters start anew.",
       "From the order in which messages came.",
       "Do not set clocks in steps while the robot runs; let one only publish a topic, and one "
       "only "
       "/clock."},
      {"D045", "a node with use_sim_time stamps with the real clock",
       "Its messages are far off for all who use simulated time.",
       "The node's parameter use_sim_time is true, and the stamps of its messages are within ten "
       "seconds "
       "of the real clock and further than that from /clock.",
       "Let it stamp with its node's clock: node->now(), get_clock().now()."},
      {"D046", "simulated time stands still",
       "Nodes use simulated time, and /clock has no publisher, or it does not move. Their time "
       "stands still: timers do not fire.",
       "From the parameter use_sim_time of each node and what came on /clock.",
       "Start the simulator, let it or the bag run, or set use_sim_time to false."},
      {"D047", "some nodes use simulated time, and some do not",
       "Each takes the other's messages for far off.",
       "/clock runs, some nodes have use_sim_time, and others that publish stamped messages have "
       "not.",
       "Set use_sim_time for all nodes, or for none."},
      {"D048", "messages are lost on the way",
       "Messages were sent and did not arrive. Best-effort readers miss them, too, and reliable "
       "ones wait until they are repeated. The network or a host is at fault, not the node that "
       "publishes.",
       "From the sequence numbers of each publisher, received best effort. Of at least fifty "
       "messages, at least 2 %, and three, are missing between the received ones. Without any "
       "message, the loss is unknown.",
       "See the link between the computers (ping, the strength of the Wi-Fi), and whether the "
       "receive buffers are too small for large messages (net.core.rmem_max)."},
      {"D050", "messages are measured in a frame that tf does not know",
       "They cannot be placed on the robot.",
       "A header names a frame, the robot publishes transforms, and none of them has it. Observed "
       "for at least three seconds; standard types only.",
       "Publish its transform, or name the frame that is meant."},
      {"D051", "a transform is stale",
       "It was published regularly and has stopped, or has old stamps. Nodes that ask for it wait "
       "or get an error.",
       "No message for ten of its periods and three seconds; or its newest stamp was a second old "
       "when it was sent (not in simulated time). A transform that stopped before the doctor came "
       "shows as a gap (D054) or against a baseline (D108).",
       "See the log of its publisher."},
      {"D052", "a frame has two parents",
       "tf keeps the latest parent, so the tree changes all the time.",
       "Two transforms to one frame from different parents, both of whose publishers are there.",
       "Switch one of them off (publish_tf), or rename a frame."},
      {"D053", "two nodes publish one transform",
       "If they differ, the frame jumps between the two.",
       "From the publishers on /tf. Two that publish the same on /tf_static are not reported.",
       "Switch one of them off (publish_tf), or end the second node."},
      {"D054", "the frames make several trees", "A measurement in one cannot be placed in another.",
       "There is more than one frame without a parent. Trees of several robots, with different "
       "prefixes "
       "(robot1/odom), are not compared.",
       "Start the publisher of the transform between them: localization (map → odom), or "
       "robot_state_publisher with a model."},
      {"D060", "a disk is full, or soon will be",
       "Data that cannot be written is lost: bags, logs, maps. Some programs exit then.",
       "On the disks of the robot's processes and their logs: less than 100 MB or 0.5 % free "
       "(error); less than 2 GB and 5 % free; or less than 10 % free and, at the observed rate, "
       "full within an hour.",
       "Remove old logs and bags (`du -sh ~/.ros/log`), or record elsewhere."},
  };
}

std::vector<Explanation> of_baselines() {
  const std::string remedy =
      "Repair it, or if it is intended, save a new baseline: culprit doctor --save healthy.json.";
  return {
      {"D100", "a node of the healthy robot is missing", "Its function is missing.",
       "Against a baseline (--against).", remedy},
      {"D101", "unexpected node (not in the baseline)",
       "It may duplicate another node, and uses memory and network.",
       "Against a baseline. Tools are not compared.", remedy},
      {"D102", "a node lacks a topic or service that it had",
       "It is configured differently, or has not started completely.", "Against a baseline.",
       remedy},
      {"D103", "a type or a quality of service has changed", "Its connections may be lost.",
       "Against a baseline.", remedy},
      {"D104", "a topic is slower than it was, or silent",
       "Its subscribers are late, or receive less data than they need.",
       "Against a baseline, of topics that had ten messages then: less than two thirds of the "
       "rate; or no message for ten of its periods and three seconds.",
       remedy},
      {"D105", "parameters are not as they were", "The node does not behave as it did.",
       "Against a baseline; also those that are new or missing.", remedy},
      {"D106", "a lifecycle node is in another state", "Its function depends on its state.",
       "Against a baseline.", remedy},
      {"D107", "a process has much more memory than it had",
       "It leaks, or does more. If it keeps growing, Linux kills a process of its choice.",
       "Against a baseline: more than twice as much, and 100 MB more.", remedy},
      {"D108", "a transform is missing", "Nodes that ask for it wait or get an error.",
       "Against a baseline.", remedy},
      {"D109", "a diagnostic status is missing",
       "Its node has exited, or has stopped reporting it.", "Against a baseline.", remedy},
  };
}

std::vector<Explanation> all_explanations() {
  std::vector<Explanation> all;
  for (auto part : {of_connections(), of_nodes(), of_diagnostics(), of_reach(), of_data(),
                    of_baselines(), recording_explanations()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

std::string upper(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return out;
}

std::string wrapped(std::string_view text) {
  constexpr std::size_t kWidth = 80;
  std::string out;
  std::size_t column = 0;
  while (!text.empty()) {
    const auto end = std::min(text.find(' '), text.size());
    const bool fits = column > 0 && column + 1 + end <= kWidth;
    if (column > 0) out += fits ? ' ' : '\n';
    column = fits ? column + 1 + end : end;
    out += text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

}  // namespace

const std::vector<Explanation>& explanations() {
  static const std::vector<Explanation> all = all_explanations();
  return all;
}

const Explanation* find_explanation(std::string_view code) {
  const auto& all = explanations();
  const auto found = std::ranges::find(all, upper(code), &Explanation::code);
  return found == all.end() ? nullptr : &*found;
}

std::string page(const Explanation& e) {
  return e.code + ": " + e.title + "\n\n" + wrapped(e.why) + "\n\nFound:\n\n" + wrapped(e.found) +
         "\n\nTo do:\n\n" + wrapped(e.remedy) + "\n";
}

std::string findings_as_markdown() {
  std::string out =
      "# Findings\n\n"
      "The findings of `culprit doctor` ([doctor.md](doctor.md)), by code. A code never changes "
      "its "
      "meaning. "
      "`culprit explain D001`\nshows one of these pages, and `culprit explain --markdown doctor` "
      "writes "
      "them all.\n\n"
      "| code | meaning |\n| --- | --- |\n";
  for (const Explanation& e : explanations()) {
    std::string anchor = e.code;
    anchor[0] = 'd';
    out += "| [" + e.code + "](#" + anchor + ") | " + e.title + " |\n";
  }
  for (const Explanation& e : explanations())
    out += "\n## " + e.code + "\n\n**" + e.title + ".** " + e.why + "\n\n*Found:* " + e.found +
           "\n\n*To do:* " + e.remedy + "\n";
  return out;
}

}  // namespace culprit::doctor
