// A monitor with a made-up fleet, for work on the page and for its tests. It serves monitor/web/dist under
// the real Content-Security-Policy, and sends on /live what idl/live.proto allows. Its robots neither plan
// nor give way.
//
// node mock-monitor.mjs [--robots 20] [--port 8080] [--recorded] [--hz 20] [--control]    (control: the token is "mock")

import {readFile} from 'node:fs/promises';
import {createServer} from 'node:http';
import {createRequire} from 'node:module';
import {extname} from 'node:path';
import {fileURLToPath} from 'node:url';

import {MockApi} from './mock-api.mjs';

const web = new URL('../../../monitor/web/', import.meta.url);
const need = createRequire(new URL('package.json', web));
const {WebSocketServer} = need('ws');
const {PbfReader, PbfWriter} = await import(new URL('node_modules/pbf/index.js', web));
const {EdgesKind, LifeState, Phase, readFromPage, writeToPage} = await import(new URL('src/live.js', web));

export {LifeState};

const policy = "default-src 'self'; connect-src 'self'; img-src 'self' data:; style-src 'self'";
const types = {'.html': 'text/html; charset=utf-8', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml'};

const rooms = {across: 8, down: 6, cells: 50};  // the walls of each room are two cells thick
const door = 14;  // cells

/// The same numbers each time (mulberry32).
function random(seed) {
  return () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
  };
}

function makeMap([origin_x, origin_y]) {
  const [width, height] = [rooms.across * rooms.cells, rooms.down * rooms.cells];
  const occupancy = new Uint8Array(Math.ceil((width * height) / 8));
  const block = (i, j) => { occupancy[(i + j * width) >> 3] |= 1 << ((i + j * width) & 7); };
  const middle = (n) => Math.abs((n % rooms.cells) - rooms.cells / 2) < door / 2;
  for (let j = 0; j < height; ++j)
    for (let i = 0; i < width; ++i) {
      const edge = i < 2 || j < 2 || i >= width - 2 || j >= height - 2;
      const upright = i % rooms.cells < 2 && !middle(j);
      const level = j % rooms.cells < 2 && !middle(i);
      if (edge || upright || level) block(i, j);
    }
  return {id: 'mock', width, height, resolution: 1, origin_x, origin_y, y_up: true, occupancy};
}

const centre = (room) => [(room % rooms.across + 0.5) * rooms.cells, (Math.floor(room / rooms.across) + 0.5) * rooms.cells];

function wayBetween(from, to, draw) {
  const way = [from];
  let [a, b] = [from % rooms.across, Math.floor(from / rooms.across)];
  const [c, d] = [to % rooms.across, Math.floor(to / rooms.across)];
  while (a !== c || b !== d) {
    if (a !== c && (b === d || draw() < 0.5)) a += Math.sign(c - a);
    else b += Math.sign(d - b);
    way.push(a + b * rooms.across);
  }
  return way.flatMap((room) => centre(room).map((v) => v + (draw() - 0.5) * 8));
}

function makeRobot(index, draw) {
  const count = rooms.across * rooms.down;
  const from = Math.floor(draw() * count);
  const path = wayBetween(from, (from + 1 + Math.floor(draw() * (count - 1))) % count, draw);
  const lengths = [0];
  for (let k = 2; k < path.length; k += 2)
    lengths.push(lengths.at(-1) + Math.hypot(path[k] - path[k - 2], path[k + 1] - path[k - 1]));
  const phase = index % 17 === 5 ? Phase.NO_PATH : index % 13 === 7 ? Phase.PLANNING : index % 11 === 6 ? Phase.ARRIVED
    : index % 23 === 9 ? Phase.WAITING : Phase.DRIVING;
  return {name: `r${index + 1}`, path, lengths, phase, speed: 6 + 6 * draw(), offset: draw() * 100};
}

const hasPath = ({phase}) => phase === Phase.DRIVING || phase === Phase.ARRIVED;

/// Back and forth along the path for ever, unless it is halted.
function along(robot, time) {
  if (robot.halted) return {...robot.halted, vx: 0, vy: 0};
  const length = robot.lengths.at(-1);
  if (robot.phase !== Phase.DRIVING) {
    const k = robot.phase === Phase.ARRIVED ? robot.path.length - 2 : 0;
    return {x: robot.path[k], y: robot.path[k + 1], vx: 0, vy: 0, driven: robot.phase === Phase.ARRIVED ? length : 0};
  }
  const travelled = (robot.offset + robot.speed * time) % (2 * length);
  const back = travelled > length;
  const s = back ? 2 * length - travelled : travelled;
  let k = 1;
  while (k < robot.lengths.length - 1 && robot.lengths[k] < s) ++k;
  const step = robot.lengths[k] - robot.lengths[k - 1];
  const share = (s - robot.lengths[k - 1]) / step;
  const [x0, y0, x1, y1] = robot.path.slice(2 * k - 2, 2 * k + 2);
  const pace = ((back ? -1 : 1) * robot.speed) / step;
  return {x: x0 + share * (x1 - x0), y: y0 + share * (y1 - y0), vx: (x1 - x0) * pace, vy: (y1 - y0) * pace, driven: s};
}

function growTree(x, y, nodes, reach, draw) {
  const places = [[x, y]];
  const points = [];
  while (places.length < nodes) {
    const [px, py] = places[Math.floor(draw() ** 0.5 * places.length)];
    const angle = draw() * 2 * Math.PI;
    const [qx, qy] = [px + 4 * Math.cos(angle), py + 4 * Math.sin(angle)];
    if (Math.abs(qx - x) > reach || Math.abs(qy - y) > reach) continue;
    places.push([qx, qy]);
    points.push(px, py, qx, qy);
  }
  return points;
}

/// Positions of robots, paths and trees are relative to the map's origin, as in the messages.
export function makeFleet(count, origin = [0, 0]) {
  const draw = random(1);
  const robots = Array.from({length: count}, (_, k) => makeRobot(k, draw));
  const trees = Array.from({length: rooms.across * rooms.down}, (_, room) => growTree(...centre(room), 120, rooms.cells / 2 - 3, draw));
  const roots = robots.map(({path}) => [growTree(path[0], path[1], 30, 14, draw), growTree(path.at(-2), path.at(-1), 30, 14, draw)]);
  return {map: makeMap(origin), robots, trees, roots};
}

function known(fleet) {
  const messages = [{map: fleet.map}, {
    roster: {
      robots: fleet.robots.map(({name, path}) => ({
        name, radius: 2, max_speed: 12, max_acceleration: 24, start_x: fleet.map.origin_x + path[0], start_y: fleet.map.origin_y + path[1],
        goal_x: fleet.map.origin_x + path.at(-2), goal_y: fleet.map.origin_y + path.at(-1), goal_tolerance: 1, mission: 1,
      })),
    },
  }];
  fleet.trees.forEach((points, k) => messages.push({
    edges: {kind: k % 9 === 4 ? EdgesKind.ACTIVE : EdgesKind.INACTIVE, robot: 0, anew: false, points},
  }));
  fleet.roots.forEach(([start, goal], robot) => messages.push(
    {edges: {kind: EdgesKind.ROOT_START, robot, anew: true, points: start}},
    {edges: {kind: EdgesKind.ROOT_GOAL, robot, anew: true, points: goal}},
  ));
  fleet.robots.forEach(({path, phase}, robot) => {
    if (hasPath({phase})) messages.push({path: {robot, points: path}});
  });
  return messages;
}

/// What a page is told of the whole fleet: it drives, unless the mock is told otherwise.
function lifeOf(fleet, life) {
  const arrived = fleet.robots.filter(({phase}) => phase === Phase.ARRIVED).length;
  return {state: LifeState.ALIVE, heard: 0, robots: fleet.robots.length, arrived, replayed: false, ...life};
}

function frameAt(fleet, time, life) {
  const at = fleet.robots.map((robot) => along(robot, time));
  const each = (value) => fleet.robots.map((robot, k) => value(at[k], k, robot));
  return {
    time, x: each((p) => p.x), y: each((p) => p.y), vx: each((p) => p.vx), vy: each((p) => p.vy),
    phase: Uint8Array.from(fleet.robots, ({phase, halted}) => (halted ? Phase.HALTED : phase)),
    stage: Uint8Array.from(fleet.robots, (_, k) => (k % 19 === 3 ? 1 : k % 19 === 4 ? 2 : 0)),
    waits_for: each((p, k) => (k % 3 === 2 ? at.findIndex((q, j) => j !== k && Math.hypot(q.x - p.x, q.y - p.y) < 20) : -1)),
    decision_time: each(() => 0.05), next_vx: each((p) => p.vx), next_vy: each((p) => p.vy), expiry: each(() => 0.1), age: each(() => 0.02),
    to_go: each((p, k, robot) => (hasPath(robot) ? fleet.longest ?? robot.lengths.at(-1) - p.driven : NaN)), waiting: each((p, k) => (k % 3 === 2 ? fleet.waiting : 0)), idle: each(() => 0.1),
    silence: each((p, k, robot) => robot.silence ?? 0.02),
    life: lifeOf(fleet, life),
  };
}

function statusesAt(fleet, time) {
  return fleet.robots.map((robot, k) => ({
    robot: k, phase: robot.halted ? Phase.HALTED : robot.phase, reason: robot.halted ? 'an operator halted it' : robot.phase === Phase.NO_PATH ? 'no way leads from its start to its goal' : '',
    plan_seconds: 0.1 + (k % 7) / 20, arrival_time: robot.phase === Phase.ARRIVED ? 12.5 : 0,
    driven_length: along(robot, time).driven, path_length: hasPath(robot) ? robot.lengths.at(-1) : 0, nodes_valid: 300 + k, nodes_invalid: 120 + k,
    trees_received: 48, trees_grafted: k % 5, rejected: 0, periods: Math.floor(time * 20), periods_missed: Math.floor(time * 10 * (k % 3) * fleet.late),
    state_age_p50: 0.02 + (k % 4) / 200, state_age_p99: 0.06 + (k % 9) / 100, state_age_max: 0.21, processor_share: 0.02 + (k % 10) / 100,
    missions_fulfilled: Math.floor(time / 60), missed_share: (k % 3) * fleet.late / 2,
    wait_cause: k % 3 === 2 ? 'it waits for r1, which goes first by the joint plan' : '', waited: k % 3 === 2 ? 31.5 : 0,
  }));
}

function figuresAt(fleet, time) {
  const count = fleet.robots.length;
  const grown = 1 - Math.exp(-time / 20);
  return {
    time, robots: count, planned: Math.round(count * 0.92 * Math.min(1, time / 6)), arrived: Math.round(count * 0.6 * grown), missions: 0,
    trees_published: Math.round(48 * Math.min(1, time / 10)), trees_grafted: Math.round(2.5 * count * grown),
    ...(count > 1 && {separation: 1.6 + Math.sin(time / 3) + 0.3 * Math.sin(time)}),
    state_age_p50: 0.022 + 0.004 * Math.sin(time / 5), state_age_p99: 0.09 + 0.03 * Math.sin(time / 2), processors: 1.3 + 0.2 * Math.sin(time / 7),
    periods_missed: 0.2 * fleet.late * (1 + Math.sin(time / 4)),
  };
}

function pack(message) {
  const writer = new PbfWriter();
  writeToPage(message, writer);
  return writer.finish();
}

/// Serves one page: by wall time, or as a recording that the page may control.
function serve(socket, fleet, {recorded, controlled, hz, history, seconds}, control) {
  const say = (message) => { if (socket.bufferedAmount < 1 << 20) socket.send(pack(message)); };
  let playing = true, speed = 1, at = history, last = performance.now();
  const begin = () => {
    say({begin: {version: '0', source: recorded ? 'mock.rec' : 'domain 0', recorded, controlled}});
    known(fleet).forEach(say);
    say({statuses: {statuses: statusesAt(fleet, at)}});
    say({figures: {points: Array.from({length: Math.ceil(2 * at)}, (_, k) => figuresAt(fleet, k / 2))}});
  };
  const playback = () => recorded && say({playback: {playing, speed, from: 1.7e9, until: 1.7e9 + seconds, at: 1.7e9 + at}});
  begin();
  playback();
  let beats = 0;
  let alarms = '';
  const timer = setInterval(() => {
    const now = performance.now();
    if (control.hangs) return;
    if (JSON.stringify(control.alarms) !== alarms) {
      alarms = JSON.stringify(control.alarms);
      say({alarms: {alarms: control.alarms}});
    }
    if (playing) at += ((now - last) / 1000) * speed;
    last = now;
    if (recorded && at >= seconds) { at = seconds; playing = false; }
    for (const robot of fleet.robots) robot.halted = robot.stands ? robot.halted ?? along(robot, at) : undefined;
    if (playing || beats % hz === 0) say({frame: frameAt(fleet, at, control.life)});
    if (++beats % Math.ceil(hz / 4) === 0) {
      say({beat: {at: Date.now() / 1000}});
      say({statuses: {statuses: statusesAt(fleet, at)}});
      playback();
    }
    if (beats % Math.ceil(hz / 2) === 0) say({figures: {points: [figuresAt(fleet, at)]}});
  }, 1000 / hz);
  socket.on('close', () => clearInterval(timer));
  socket.on('message', (bytes) => {
    const heard = readFromPage(new PbfReader(bytes));
    if (!recorded) return;
    if (heard.what === 'playing') playing = heard.playing;
    if (heard.what === 'speed') speed = heard.speed;
    if (heard.what === 'seek') {
      const back = heard.seek - 1.7e9 < at;
      at = heard.seek - 1.7e9;
      if (back) begin();
      say({frame: frameAt(fleet, at, control.life)});
    }
    playback();
  });
}

async function answer(request, response, api) {
  const path = new URL(request.url, 'http://mock').pathname;
  if (api && path.startsWith('/api/')) return api.answer(request, response);
  const name = path === '/' ? 'index.html' : path.slice(1);
  if (!/^[a-z]+\.[a-z]+$/.test(name)) return response.writeHead(404).end();
  try {
    const body = await readFile(new URL(`dist/${name}`, web));
    response.writeHead(200, {'Content-Type': types[extname(name)], 'Content-Security-Policy': policy}).end(body);
  } catch {
    response.writeHead(404).end();
  }
}

export async function startMock({robots = 20, port = 0, recorded = false, hz = 20, history = 30, seconds = 120, silent = false, origin = [0, 0], longest, late = 0.01, waiting = 4, token} = {}) {
  const fleet = makeFleet(robots, origin);
  fleet.late = late;  // share of control periods that some robots miss
  fleet.waiting = waiting;  // seconds for which every third robot has waited
  fleet.longest = longest;  // metres that each robot has to go, for table cells that must hold them
  const control = {life: {}, alarms: [], hangs: false};
  const stand = (names) => { for (const robot of fleet.robots) robot.stands = names.includes(robot.name); };
  const api = token === undefined ? undefined : new MockApi(fleet.robots.map(({name}) => name), token, stand);
  const server = createServer((request, response) => answer(request, response, api));
  const sockets = new WebSocketServer({server, path: '/live'});
  sockets.on('connection', (socket) => { if (!silent) serve(socket, fleet, {recorded, controlled: api !== undefined, hz, history, seconds}, control); });
  await new Promise((resolve) => server.listen(port, '127.0.0.1', resolve));
  return {
    url: `http://127.0.0.1:${server.address().port}/`,
    port: server.address().port,
    api,
    /// Says and answers nothing, like a process that is stopped.
    hang: (hangs) => { control.hangs = hangs; if (api) api.hangs = hangs; },
    /// In the form of idl/live.proto; a robot that is silent is not heard any more.
    alarm: (alarms) => { control.alarms = alarms; },
    robots: fleet.robots,
    tell: (life) => { control.life = life; },  // in the form of lifeOf
    say: (bytes) => { for (const socket of sockets.clients) socket.send(bytes); },
    close: () => new Promise((resolve) => {
      for (const socket of sockets.clients) socket.terminate();
      server.closeAllConnections();
      server.close(resolve);
    }),
  };
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const option = (name, otherwise) => {
    const place = process.argv.indexOf(`--${name}`);
    return place < 0 ? otherwise : Number(process.argv[place + 1]);
  };
  const mock = await startMock({
    robots: option('robots', 20), longest: process.argv.includes('--longest') ? 1255.04 : undefined,
    origin: process.argv.includes('--utm') ? [500000, 5400000] : [0, 0], port: option('port', 8080), hz: option('hz', 20), recorded: process.argv.includes('--recorded'),
    token: process.argv.includes('--control') ? 'mock' : undefined,
  });
  console.log(mock.url);
}
