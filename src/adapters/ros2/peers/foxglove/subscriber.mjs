// An independent peer for tests, which shares no code with any DDS in C or C++: subscribes to /diagnostics on this
// machine and prints a line for each status:
//
//     status <level> <name> <key>=<value> ...
//
// usage: node subscriber.mjs <domain>
import { CdrReader } from "@foxglove/cdr";
import rtps from "@foxglove/rtps";
import nodejs from "@foxglove/rtps/nodejs";

const LOOPBACK = "127.0.0.1";

// The library would join the multicast group on the default interface; the tests stay on the loopback one.
async function createSocket(options) {
  const socket = await nodejs.UdpSocketNode.Create(options);
  const join = socket.addMembership.bind(socket);
  const bind = socket.bind.bind(socket);
  socket.addMembership = (group) => join(group, LOOPBACK);
  socket.bind = async (where) => {
    await bind(where);
    await socket.setMulticastInterface(LOOPBACK);
  };
  return socket;
}

function readStatus(reader) {
  const level = reader.uint8();
  const name = reader.string();
  reader.string(); // message
  reader.string(); // hardware_id
  const values = [];
  for (let n = reader.sequenceLength(); n > 0; --n) values.push(`${reader.string()}=${reader.string()}`);
  return ["status", level, name, ...values].join(" ");
}

function printDiagnostics(payload) {
  const reader = new CdrReader(payload);
  reader.int32(); // stamp
  reader.uint32();
  reader.string(); // frame_id
  for (let n = reader.sequenceLength(); n > 0; --n) console.log(readStatus(reader));
}

const participant = new rtps.Participant({
  name: "/",
  addresses: [LOOPBACK],
  domainId: Number(process.argv[2]),
  udpSocketCreate: createSocket,
});
participant.on("error", (error) => console.error(String(error)));
participant.on("userData", ({ serializedData }) => printDiagnostics(serializedData));
await participant.start();
participant.subscribe({
  topicName: "rt/diagnostics",
  typeName: "diagnostic_msgs::msg::dds_::DiagnosticArray_",
  durability: rtps.Durability.Volatile,
  reliability: { kind: rtps.Reliability.Reliable, maxBlockingTime: { sec: 0, nsec: 100000000 } },
  history: { kind: rtps.HistoryKind.KeepLast, depth: 10 },
});
