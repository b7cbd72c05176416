// Reads a recording with the reference reader of MCAP, whole and by its index, and compares it with the
// trajectory of the same run: node read_recording.mjs RECORDING TRAJECTORY. Prints the number of messages of
// each channel.
//
// The reader checks the checksums of chunks. This script checks those of the data section and of the summary.
import assert from "node:assert/strict";
import {readFileSync} from "node:fs";
import {McapIndexedReader, McapStreamReader} from "@mcap/core";
import {decompress} from "fzstd";
import protobuf from "protobufjs";
import descriptor from "protobufjs/ext/descriptor/index.js";

const file = new Uint8Array(readFileSync(process.argv[2]));
const decompressHandlers = {zstd: (bytes, size) => decompress(bytes, new Uint8Array(Number(size)))};

function crc32(bytes) {
  let crc = ~0;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; ++bit) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc >>> 0;
}

// --- from the beginning to the end ---

const records = {};
const streamed = {};
const channels = new Map();
let dataEnd;
let footer;
const stream = new McapStreamReader({includeChunks: true, decompressHandlers, validateCrcs: true});
stream.append(file);
for (let record = stream.nextRecord(); record; record = stream.nextRecord()) {
  records[record.type] = (records[record.type] ?? 0) + 1;
  if (record.type === "Channel") channels.set(record.id, record.topic);
  if (record.type === "DataEnd") dataEnd = record;
  if (record.type === "Footer") footer = record;
  if (record.type === "Message") {
    const topic = channels.get(record.channelId);
    streamed[topic] = (streamed[topic] ?? 0) + 1;
  }
}
const view = new DataView(file.buffer, file.byteOffset, file.length);
const summaryStart = Number(footer.summaryStart);
const dataEndRecord = 9 + 4;
const crcs = {
  data: dataEnd.dataSectionCrc === crc32(file.subarray(0, summaryStart - dataEndRecord)),
  summary: footer.summaryCrc === crc32(file.subarray(summaryStart, file.length - 8 - 4)) &&
      footer.summaryCrc === view.getUint32(file.length - 8 - 4, true),
};

// --- by the index ---

const reader = await McapIndexedReader.Initialize({
  readable: {
    size: async () => BigInt(file.length),
    read: async (offset, size) => file.subarray(Number(offset), Number(offset + size)),
  },
  decompressHandlers,
});
const types = new Map();
for (const [id, schema] of reader.schemasById) {
  const root = protobuf.Root.fromDescriptor(descriptor.FileDescriptorSet.decode(schema.data));
  types.set(id, root.lookupType(schema.name));
}
const indexed = {};
const track = {};
let ordered = true;
let latest = 0n;
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  indexed[channel.topic] = (indexed[channel.topic] ?? 0) + 1;
  ordered &&= message.logTime >= latest;
  latest = message.logTime;
  const decoded = types.get(channel.schemaId).decode(message.data);
  if (channel.topic === "/coppice/track")
    for (const p of decoded.points)
      (track[decoded.robot] ??= []).push(
        [p.time, p.position.x, p.position.y, p.velocity.x, p.velocity.y, p.yaw, p.angular_velocity]);
}

// --- a part ---

const statistics = Object.fromEntries([...reader.statistics.channelMessageCounts].map(
    ([id, count]) => [reader.channelsById.get(id).topic, Number(count)]));
const middle = (reader.statistics.messageStartTime + reader.statistics.messageEndTime) / 2n;
const part = {messages: 0, early: 0};
for await (const message of reader.readMessages({startTime: middle, topics: ["/coppice/robot_state"]})) {
  ++part.messages;
  part.early += message.logTime < middle;
}

// --- results ---

// Each row of the trajectory is a point of the robot's track, within the precision of its digits.
const rows = readFileSync(process.argv[3], "utf8").trim().split("\n").slice(1).map((line) => line.split(","));
const points = new Set();
for (const [robot, all] of Object.entries(track))
  for (const numbers of all) points.add([robot, ...numbers.map((x) => x.toFixed(6).replace(/^-(0\.0+)$/, "$1"))].join());
const missing = rows.filter(([time, robot, ...rest]) =>
    !points.has([robot, time, ...rest.map((x) => x.replace(/^-(0\.0+)$/, "$1"))].join()));

assert.deepEqual(streamed, indexed);
assert.deepEqual(statistics, indexed);
assert.deepEqual(crcs, {data: true, summary: true});
assert.ok(ordered, "in the order of time");
assert.ok(part.messages > 0 && part.early === 0, "a part by time and topic");
assert.ok(records.Chunk > 1 && records.MessageIndex >= records.Chunk && records.ChunkIndex === records.Chunk);
assert.equal(records.SummaryOffset, 4);
assert.ok(rows.length > 100, "a trajectory");
assert.equal(missing.length, 0, `rows that are no point of a track: ${missing.slice(0, 3).join("  ")}`);
for (const [topic, count] of Object.entries(indexed).sort()) console.log(topic, count);
