// Checks that a monitor shows what the fleet drove. Foxglove's own client with the schemas that it is sent,
// and a page's client by idl/live.proto, are compared with the trajectory of the run.
//
// node monitor_fleet.js URL live.proto TRAJECTORY.csv TIME_SCALE
//
// Waits for the trajectory, which is written when the run ends. Prints the measurements. Exit code 1 if a
// check fails.
import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";

import protobuf from "protobufjs";
import descriptor from "protobufjs/ext/descriptor/index.js";
import WebSocket from "ws";

const { FoxgloveClient } = createRequire(import.meta.url)("@foxglove/ws-protocol");
const [url, liveProto, trajectoryFile, timeScale] = process.argv.slice(2);
const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
const socketUrl = url.replace("http", "ws");

/** All messages of each topic, decoded: {at (wall seconds), message}. */
function followFoxglove() {
  const socket = new WebSocket(socketUrl, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]);
  const client = new FoxgloveClient({ ws: socket });
  const seen = { topics: new Map(), complaints: [], close: () => client.close() };
  const decoders = new Map();
  client.on("error", (error) => seen.complaints.push(String(error)));
  client.on("status", (status) => seen.complaints.push(status.message));
  client.on("serverInfo", (info) => (seen.info = info));
  client.on("advertise", (channels) => {
    for (const channel of channels) {
      const files = descriptor.FileDescriptorSet.decode(Buffer.from(channel.schema, "base64"));
      const type = protobuf.Root.fromDescriptor(files).lookupType(channel.schemaName);
      const messages = [];
      seen.topics.set(channel.topic, { schema: channel.schemaName, messages });
      decoders.set(client.subscribe(channel.id), (data) => type.toObject(type.decode(data), { longs: Number }));
      decoders.get([...decoders.keys()].at(-1)).messages = messages;
    }
  });
  client.on("message", ({ subscriptionId, timestamp, data }) => {
    const decode = decoders.get(subscriptionId);
    const bytes = new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
    decode.messages.push({ at: Number(timestamp) / 1e9, message: decode(bytes) });
  });
  return seen;
}

/** All messages to a page, in order. */
async function followAsPage() {
  const type = (await protobuf.load(liveProto)).lookupType("coppice.live.ToPage");
  const messages = [];
  const socket = new WebSocket(`${socketUrl}live`, { origin: url.slice(0, -1) });
  socket.on("message", (data) => messages.push(type.decode(data)));
  return { messages, close: () => socket.close() };
}

/** For each robot: [time, x, y], sorted by time. */
function readTrajectory() {
  const robots = new Map();
  for (const line of readFileSync(trajectoryFile, "utf8").trim().split("\n").slice(1)) {
    const [time, robot, x, y] = line.split(",");
    if (!robots.has(robot)) robots.set(robot, []);
    robots.get(robot).push([Number(time), Number(x), Number(y)]);
  }
  return robots;
}

/** The position of the robot by its trajectory; undefined before and after that. */
function placeAt(points, time) {
  const next = points.findIndex((point) => point[0] >= time);
  if (next <= 0) return undefined;
  const [[t0, x0, y0], [t1, x1, y1]] = [points[next - 1], points[next]];
  const part = (time - t0) / (t1 - t0);
  return [x0 + part * (x1 - x0), y0 + part * (y1 - y0)];
}

/**
 * The distance between the shown and the driven positions in metres. A monitor follows the promises of robots. If the
 * machine is so busy that a promise ends before the next state arrives, the monitor is wrong by some metres. So the check
 * allows some outliers.
 */
function check(name, places, trajectory, least) {
  const errors = [];
  for (const { robot, time, x, y } of places) {
    const place = placeAt(trajectory.get(robot), time);
    if (place) errors.push(Math.hypot(place[0] - x, place[1] - y));
  }
  errors.sort((a, b) => a - b);
  const at = (share) => errors[Math.floor(share * (errors.length - 1))];
  console.log(`${name}: ${errors.length} places, error median ${at(0.5).toFixed(4)} m, 90 % ${at(0.9).toFixed(4)} m, 99 % ${at(0.99).toFixed(4)} m`);
  assert.ok(errors.length > least, `${name}: too few places`);
  assert.ok(at(0.5) < 0.05, `${name}: median error`);
  assert.ok(at(0.9) < 1, `${name}: 90 % error`);
}

function median(values) {
  return values.sort((a, b) => a - b)[Math.floor(values.length / 2)];
}

const foxglove = followFoxglove();
const page = await followAsPage();
const patience = Date.now() + 120_000;
while (!existsSync(trajectoryFile) && Date.now() < patience) await sleep(200);
await sleep(1000);
const metrics = await (await fetch(`${url}metrics`)).text();
const metric = (name) => Number(metrics.match(new RegExp(`^${name} (.*)$`, "m"))[1]);
foxglove.close();
page.close();
const trajectory = readTrajectory();
const robots = [...trajectory.keys()].sort();
const heard = (topic) => foxglove.topics.get(topic).messages;

// Foxglove
assert.deepEqual(foxglove.complaints, []);
assert.equal(foxglove.info.name, "Coppice");
assert.deepEqual(
  [...foxglove.topics].map(([topic, { schema }]) => `${topic} ${schema}`),
  [
    "/map foxglove.Grid",
    "/robots foxglove.SceneUpdate",
    "/poses foxglove.PosesInFrame",
    "/tf foxglove.FrameTransforms",
    "/paths foxglove.SceneUpdate",
    "/trees foxglove.SceneUpdate",
    "/root_trees foxglove.SceneUpdate",
    "/log foxglove.Log",
    "/fleet coppice.live.Figures.Point",
  ],
);
const points = heard("/fleet").filter(({ message }) => message.time > 0);
const epoch = median(points.map(({ at, message }) => at - message.time / timeScale));
const fleetTime = (wall) => (wall - epoch) * timeScale;
const ofTransforms = heard("/tf").flatMap(({ at, message }) =>
  (message.transforms ?? []).map((t) => ({ robot: t.child_frame_id, time: fleetTime(at), x: t.translation.x, y: -t.translation.y })),
);
check("/tf", ofTransforms, trajectory, 300);
const ofScenes = heard("/robots").flatMap(({ at, message }) =>
  (message.entities ?? []).map((e) => {
    const place = e.cylinders[0].pose.position;
    return { robot: e.id, time: fleetTime(at), x: place.x, y: -place.y };
  }),
);
check("/robots", ofScenes, trajectory, 300);
// The channels were subscribed one after the other, so that the first may have a frame of its own. The last
// frame may be under way.
const timesOfTransforms = new Set(heard("/tf").map(({ at }) => at));
const bothSince = heard("/poses").find(({ at }) => timesOfTransforms.has(at)).at;
const [poses, transforms] = ["/poses", "/tf"].map((topic) => heard(topic).filter(({ at }) => at >= bothSince));
assert.ok(Math.abs(poses.length - transforms.length) <= 1 && poses.length > 100, "poses and transforms come together");
poses.slice(0, transforms.length).forEach(({ at, message }, k) => {
  assert.equal(transforms[k].at, at);
  assert.deepEqual(
    (message.poses ?? []).map((p) => p.position),
    (transforms[k].message.transforms ?? []).map((t) => t.translation),
  );
});
const pathsOf = new Map(heard("/paths").flatMap(({ message }) => (message.entities ?? []).map((e) => [e.id, e.lines[0].points])));
assert.deepEqual([...pathsOf.keys()].sort(), robots);
for (const [robot, line] of pathsOf) {
  const [, x, y] = trajectory.get(robot).at(-1);
  assert.ok(Math.hypot(line.at(-1).x - x, -line.at(-1).y - y) < 5, `the path of ${robot} leads to where it arrived`);
}
assert.ok(heard("/trees").some(({ message }) => (message.entities ?? []).length > 0), "trees are shown");
assert.equal(heard("/map").length, 1);
const grid = heard("/map")[0].message;
assert.equal(grid.data.length, grid.row_stride * Math.round(-grid.pose.position.y / grid.cell_size.y));
const arrivals = heard("/log").filter(({ message }) => /^has arrived|at its goal$/.test(message.message));
assert.deepEqual([...new Set(arrivals.map(({ message }) => message.name))].sort(), robots);

// The page
const kinds = page.messages.map((message) => message.what);
const runBegins = kinds.lastIndexOf("begin");
const run = page.messages.slice(runBegins);
assert.equal(kinds[0], "begin");
const first = (kind) => run.findIndex((message) => message.what === kind);
assert.ok(first("roster") > 0 && first("frame") > first("roster"), "the roster is before the frames");
assert.ok(run.some((message) => message.what === "map"));
let roster = [];
const places = [];
for (const message of run) {
  if (message.roster) roster = message.roster.robots.map((robot) => robot.name);
  if (!message.frame) continue;
  assert.equal(message.frame.x.length, roster.length);
  roster.forEach((robot, k) => {
    if (!Number.isNaN(message.frame.x[k]) && message.frame.time > 0)
      places.push({ robot, time: message.frame.time, x: message.frame.x[k], y: message.frame.y[k] });
  });
}
assert.deepEqual([...roster].sort(), robots);
check("/live", places, trajectory, 300);
const statuses = run.flatMap((message) => message.statuses?.statuses ?? []);
for (let k = 0; k < roster.length; ++k)
  assert.ok(statuses.filter((status) => status.robot === k).at(-1).arrivalTime > 0, `${roster[k]} is shown as arrived`);
assert.ok(run.some((message) => message.edges), "trees are shown");
const seconds = points.at(-1).at - points[0].at;
const rate = run.filter((message) => message.frame && message.frame.time > 0).length / seconds;
console.log(`${rate.toFixed(1)} frames a second, ${seconds.toFixed(1)} s`);
console.log(`${metric("coppice_monitor_messages_total")} messages; ${metric("process_cpu_seconds_total")} s of processor time`);
assert.ok(rate > 10 && rate < 22, "frames come at 20 Hz, or fewer on a busy machine");
