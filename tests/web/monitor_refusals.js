// Checks what a monitor refuses, and that it goes on afterwards.
//
// node monitor_refusals.js URL
import assert from "node:assert/strict";
import net from "node:net";

import WebSocket from "ws";

const url = new URL(process.argv[2]);
const host = url.host;

/** The answer to these bytes as text; empty if the connection is closed without one. */
function ask(bytes) {
  return new Promise((done) => {
    const socket = net.connect(Number(url.port), url.hostname, () => socket.write(bytes));
    let answer = "";
    socket.on("data", (data) => (answer += data.toString("latin1")));
    socket.on("error", () => done(answer));
    socket.on("close", () => done(answer));
    socket.setTimeout(15_000, () => socket.destroy());
  });
}

async function status(bytes) {
  const answer = await ask(bytes);
  return Number(answer.split(" ")[1] ?? 0);
}

const get = (target, headers = `Host: ${host}\r\n`, method = "GET") =>
  `${method} ${target} HTTP/1.1\r\n${headers}Connection: close\r\n\r\n`;

/** The status with which the server refuses a WebSocket; 101 if it accepts. */
function upgrade(path, options, subprotocols = []) {
  return new Promise((done) => {
    const socket = new WebSocket(`ws://${host}${path}`, subprotocols, options);
    socket.on("open", () => (socket.close(), done(101)));
    socket.on("unexpected-response", (_, response) => (response.destroy(), done(response.statusCode)));
    socket.on("error", () => {});
  });
}

/** The code with which the server closes a WebSocket after this message. */
function closed(path, say, subprotocols = []) {
  return new Promise((done, fail) => {
    const socket = new WebSocket(`ws://${host}${path}`, subprotocols);
    socket.on("open", () => say(socket));
    socket.on("error", () => {});
    socket.on("close", (code) => done(code));
    setTimeout(() => fail(new Error(`${path}: still open`)), 10_000).unref();
  });
}

const foxglove = "foxglove.websocket.v1";

/** Which of these subprotocols the server speaks, and its first message. */
function greeting(subprotocols) {
  return new Promise((done, fail) => {
    const socket = new WebSocket(`ws://${host}/`, subprotocols);
    socket.on("message", (data) => (socket.close(), done({ protocol: socket.protocol, op: JSON.parse(data).op })));
    socket.on("error", fail);
  });
}
const alive = async () => assert.equal(await status(get("/healthz")), 200);

// Existing resources
const page = await ask(get("/"));
assert.match(page, /^HTTP\/1.1 200 /);
assert.match(page, /Content-Security-Policy: default-src 'self'; connect-src 'self'; img-src 'self' data:; style-src 'self'\r\n/);
assert.match(page, /X-Content-Type-Options: nosniff\r\n/);
assert.match(page, /<html/);
const head = await ask(get("/", undefined, "HEAD"));
assert.match(head, /^HTTP\/1.1 200 /);
assert.match(head, /Content-Length: [1-9]/);
assert.ok(head.endsWith("\r\n\r\n"), "no body");
await alive();

// Hosts, methods, paths, sizes
for (const bad of ["evil.example", `evil.example:${url.port}`, "127.0.0.1.evil.example"]) {
  assert.equal(await status(get("/", `Host: ${bad}\r\n`)), 421, bad);
  assert.equal(await status(get("/metrics", `Host: ${bad}\r\n`)), 421, bad);
}
assert.equal(await status(get("/", "")), 421);
assert.equal(await status(get("/healthz", `Host: localhost:${url.port}\r\n`)), 200);
for (const method of ["POST", "PUT", "DELETE", "OPTIONS"]) assert.equal(await status(get("/", undefined, method)), 405, method);
for (const path of ["/../../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "//etc/passwd", "/index.html/..", "/dist/", "/.git/config", "/live"])
  assert.equal(await status(get(path)), 404, path);
assert.equal(await status(get("/", `Host: ${host}\r\nContent-Length: 100000\r\n`) + "x".repeat(1000)), 413);
const long = await ask(get(`/${"x".repeat(100_000)}`));
assert.ok(long === "" || long.startsWith("HTTP/1.1 431 "), "a long request is refused");
const crowded = await ask(get("/", `Host: ${host}\r\n${"A: b\r\n".repeat(20_000)}`));
assert.ok(crowded === "" || crowded.startsWith("HTTP/1.1 431 "), "many headers are refused");
for (const nonsense of ["\r\n\r\n\r\n\r\n", "GET\r\n\r\n", "\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", "GET / HTTP/9.9\r\n\r\n"]) {
  const answer = await status(nonsense);
  assert.ok(answer === 0 || answer === 400, JSON.stringify(nonsense));
}
await alive();

// Origins
assert.equal(await upgrade("/live", {}), 101);
assert.equal(await upgrade("/live", { origin: `http://${host}` }), 101);
for (const origin of ["http://evil.example", "null", "https://app.foxglove.dev", `http://localhost:${url.port}`])
  assert.equal(await upgrade("/live", { origin }), 403, origin);
assert.equal(await upgrade("/", { origin: "https://app.foxglove.dev" }, [foxglove]), 101);
assert.equal(await upgrade("/live", { origin: "http://evil.example" }, [foxglove]), 403);
for (const [offered, spoken] of [
  [["foxglove.sdk.v1"], "foxglove.sdk.v1"],
  [["foxglove.sdk.v2", "foxglove.sdk.v1", foxglove], "foxglove.sdk.v1"],
  [[foxglove], foxglove],
])
  assert.deepEqual(await greeting(offered), { protocol: spoken, op: "serverInfo" });
assert.equal(await upgrade("/live", { headers: { Host: "evil.example" } }), 421);
assert.equal(await upgrade("/elsewhere", {}), 404);

// Frames
assert.equal(await closed("/live", (socket) => socket.send("hello")), 1007);
assert.equal(await closed("/live", (socket) => socket.send(Buffer.from([255, 255, 255, 255]))), 1007);
assert.equal(await closed("/live", (socket) => socket.send(Buffer.alloc(0))), 1007);
assert.notEqual(await closed("/live", (socket) => socket.send(Buffer.alloc(100_000))), 1000);
assert.notEqual(await closed("/", (socket) => socket.send("x".repeat(100_000)), [foxglove]), 1000);
await closed("/live", (socket) => socket._socket.write(Buffer.alloc(20, 0xff)));
const seek = new WebSocket(`ws://${host}/live`);
await new Promise((open) => seek.on("open", open));
seek.send(Buffer.from([0x19, 0, 0, 0, 0, 0, 0, 0, 0x40])); // FromPage{seek: 2}: valid, and without effect here
await new Promise((heard) => setTimeout(heard, 300));
assert.equal(seek.readyState, WebSocket.OPEN);
seek.close();
const complained = await new Promise((heard) => {
  const socket = new WebSocket(`ws://${host}/`, [foxglove]);
  socket.on("open", () => socket.send('{"op":"setParameters","parameters":[]}'));
  socket.on("message", (data, binary) => {
    const message = binary ? {} : JSON.parse(data);
    if (message.op === "status") (socket.close(), heard(message));
  });
});
assert.equal(complained.level, 2);
await alive();

// Many connections at a time: some are refused, and when they are gone there is room again
const crowd = [];
for (let k = 0; k < 200; ++k) {
  const socket = net.connect(Number(url.port), url.hostname);
  socket.on("error", () => {});
  crowd.push(socket);
}
const stay = () => crowd.filter((socket) => !socket.closed && !socket.destroyed && socket.readyState === "open").length;
const isRefused = () => crowd.every((socket) => !socket.connecting) && stay() <= 64;
for (let k = 0; k < 100 && !isRefused(); ++k) await new Promise((done) => setTimeout(done, 200));
assert.ok(isRefused() && stay() > 0, `${stay()} of 200 connections stay`);
crowd.forEach((socket) => socket.destroy());
await new Promise((done) => setTimeout(done, 500));
await alive();
console.log("all refused as expected");
