// Checks that a monitor's real answers fit docs/openapi.yaml, whose types the page is made of, and that the page can read
// all that it sends on /live.
//
// node answers_fit.mjs URL TOKEN     of a monitor with --control and a fleet of robots r1 to r4 that waits for orders
//
// Prints what was seen. Exit code 1 if a check fails.
import assert from 'node:assert/strict';

import protobuf from 'protobufjs';
import WebSocket from 'ws';

import {api, asker, fits, operations, root, seen} from './described_api.mjs';

const [url, token] = process.argv.slice(2);
const ask = asker(url, token);
const sleep = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));

async function within(check, what) {
  for (let k = 0; k < 300; ++k) {
    if (await check()) return;
    await sleep(100);
  }
  assert.fail(what);
}

/// Listens to the events until it is stopped.
function listen() {
  const controller = new AbortController();
  const kinds = new Map();
  const events = api.paths['/api/events'].get.responses['200'].content['text/event-stream']['x-events'];
  const reading = (async () => {
    const response = await fetch(new URL('api/events', url), {signal: controller.signal, headers: {Authorization: `Bearer ${token}`}});
    let rest = '';
    for await (const piece of response.body.pipeThrough(new TextDecoderStream())) {
      const parts = (rest + piece).split('\n\n');
      rest = parts.pop();
      for (const part of parts) {
        const [, kind, data] = /^event: (.*)\ndata: (.*)$/.exec(part) ?? [];
        if (!kind) continue;  // a comment
        assert(events[kind], `the description knows no event ${kind}`);
        fits(events[kind].$ref.slice(1), JSON.parse(data), `event ${kind}`);
        kinds.set(kind, [...(kinds.get(kind) ?? []), JSON.parse(data)]);
      }
    }
  })().catch((error) => { if (error.name !== 'AbortError') throw error; });
  return {kinds, stop: () => { controller.abort(); return reading; }};
}

/// Reads /live as the page does. Each message must be one that idl/live.proto describes, to the last byte.
async function watch() {
  const type = (await protobuf.load(new URL('idl/live.proto', root).pathname)).lookupType('coppice.live.ToPage');
  const kinds = new Map();
  const socket = new WebSocket(new URL('live', url.replace('http', 'ws')));
  let problem;
  socket.on('message', (bytes) => {
    const message = type.decode(bytes);
    const [kind] = Object.keys(message.toJSON());
    if (!kind || type.encode(message).finish().length !== bytes.length) problem ??= `a message that live.proto does not describe: ${kind} ${bytes.toString('base64')}`;
    kinds.set(kind, (kinds.get(kind) ?? 0) + 1);
  });
  return {kinds, stop: () => { socket.close(); assert.equal(problem, undefined); }};
}

const events = listen();
const live = await watch();
await within(async () => (await ask('GET', '/api/robots', {expected: 200})).robots.filter(({x}) => x !== null).length === 4, 'four robots are heard');

const goal = {x: 428, y: 300};
await ask('POST', '/api/orders', {body: {id: 'one', robot: 'r2', goal, by: 'a test', priority: 1, deadline: 600}, expected: 201});
await ask('POST', '/api/orders', {body: {id: 'one', robot: 'r2', goal}, expected: 200});
await ask('POST', '/api/orders', {body: {id: 'two', goals: [{x: 428, y: 360, wait: 1}, {...goal, yaw: null}]}, expected: 201});
await ask('POST', '/api/orders', {body: {goal: {x: 0.5, y: 0.5}}, expected: 422});
await ask('POST', '/api/orders', {body: {goal: 'there'}, expected: 400});
await ask('POST', '/api/orders', {body: {id: 'x'.repeat(70_000), goal}, expected: 413});
const order = (method, id, options) => ask(method, `/api/orders/${id}`, {described: '/api/orders/{id}', ...options});
await within(async () => (await order('GET', 'one', {expected: 200})).state === 'under way', 'it is under way');
await ask('GET', '/api/orders', {expected: 200});
await ask('GET', '/api/orders', {query: '?state=under+way', expected: 200});
await ask('GET', '/api/orders', {query: '?stat=done', expected: 400});
await order('GET', 'none', {expected: 404});
await order('GET', 'one', {query: '?a=b', expected: 400});
for (const path of ['/api/robots', '/api/alarms', '/api/events']) await ask('GET', path, {query: '?a=b', expected: 400});
await ask('GET', '/api/alarms', {expected: 200});

// One robot and all: this is what broke the page once.
await ask('POST', '/api/pause', {body: {robots: ['r3'], by: 'a test'}, expected: 200});
await within(() => events.kinds.get('halt')?.at(-1).robots.some(({name, halt}) => name === 'r3' && halt === 'paused'), 'r3 is paused');
await ask('POST', '/api/resume', {body: {robots: ['r3']}, expected: 200});
await ask('POST', '/api/stop', {expected: 200});
await within(() => events.kinds.get('halt').at(-1).everybody === 'stopped', 'all are stopped');
await ask('POST', '/api/release', {body: {robots: null}, expected: 200});
for (const what of ['stop', 'release', 'pause', 'resume']) {
  await ask('POST', `/api/${what}`, {body: {robots: ['r9']}, expected: 422});
  await ask('POST', `/api/${what}`, {body: {robot: 'r1'}, expected: 400});
  await ask('POST', `/api/${what}`, {query: '?robots=r1', expected: 400});
}

await order('DELETE', 'two', {query: '?by=anna&why=another+way', expected: 200});
await within(() => events.kinds.get('order').some(({id, reason}) => id === 'two' && reason === 'cancelled by anna: another way'), 'the event says who and why');
await order('DELETE', 'two', {expected: 409});
await order('DELETE', 'two', {query: '?reason=x', expected: 400});
await order('DELETE', 'none', {expected: 404});
await within(async () => (await order('GET', 'one', {expected: 200})).state === 'done', 'it is done');

const refused = async (headers, expected) => {
  for (const [method, path] of operations) await ask(method, path.replace('{id}', 'one'), {described: path, headers, expected});
};
await refused({}, 401);
await refused({Authorization: `Bearer ${token}`, Origin: 'https://evil.example'}, 403);
await refused({Authorization: `Bearer ${token}`, Host: 'evil.example'}, 421);
for (let k = 0; k < 10; ++k) await ask('GET', '/api/robots', {headers: {Authorization: 'Bearer wrong'}, expected: 401});
await refused({Authorization: 'Bearer wrong'}, 429);
await ask('POST', '/api/stop', {expected: 200});  // an address that has shown the token is heard all the same

await within(() => ['order', 'robot', 'halt', 'alarms'].every((kind) => events.kinds.has(kind)), 'all kinds of events came');
await within(() => ['begin', 'map', 'roster', 'path', 'statuses', 'frame', 'figures', 'alarms', 'beat'].every((kind) => live.kinds.has(kind)),
  `all kinds of messages came: ${[...live.kinds]}`);
await events.stop();
live.stop();

const described = operations.flatMap(([method, path]) =>
  Object.keys(api.paths[path][method.toLowerCase()].responses).map((status) => `${method} ${path} ${status}`));
console.log([...seen].map(([what, times]) => `${what}: ${times}`).join('\n'));
console.log(`not seen: ${described.filter((what) => !seen.has(what)).join(', ')}`);
process.exit(0);
