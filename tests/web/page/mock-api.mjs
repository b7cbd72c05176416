// The HTTP interface of a made-up fleet (docs/monitor.md, "Control"). It keeps orders and halts; no robot drives by them.
//
// A goal with x < 0 is refused. A robot has at most one order under way; the others wait.

const json = (response, status, body) => response.writeHead(status, {'Content-Type': 'application/json'}).end(JSON.stringify(body));
const problem = (response, status, title, detail) =>
  response.writeHead(status, {'Content-Type': 'application/problem+json'}).end(JSON.stringify({title, status, detail}));
const now = () => Date.now() / 1000;
const ended = ({state}) => ['done', 'cancelled', 'failed'].includes(state);

async function bodyOf(request) {
  const pieces = [];
  for await (const piece of request) pieces.push(piece);
  return pieces.length > 0 ? JSON.parse(Buffer.concat(pieces)) : {};
}

export class MockApi {
  orders = new Map();
  everybody = 'none';
  halted = new Map();
  asked = [];         // "POST /api/stop", and so on
  broken = undefined;  // a text: orders and halts fail with it
  hangs = false;       // nothing is answered
  #listeners = new Set();

  constructor(robots, token, onHalt) {
    this.robots = robots;  // names
    this.token = token;
    this.onHalt = onHalt;  // is told the names of robots that stand
  }

  get listeners() { return this.#listeners.size; }
  haltOf(robot) { return this.halted.get(robot) ?? this.everybody; }

  async answer(request, response) {
    const {pathname: path, searchParams} = new URL(request.url, 'http://mock');
    if (this.hangs) return undefined;
    if (request.headers.authorization !== `Bearer ${this.token}`) return problem(response, 401, 'Unauthorized', 'no such token');
    this.asked.push(`${request.method} ${path}`);
    if (path === '/api/events') return this.#stream(response);
    if (path === '/api/alarms') return json(response, 200, {alarms: []});
    if (path === '/api/robots') return json(response, 200, {robots: this.robots.map((name) => this.#robot(name))});
    if (this.broken) return problem(response, 503, 'Service Unavailable', this.broken);
    if (path === '/api/orders' && request.method === 'POST') return this.#take(await bodyOf(request), response);
    if (path === '/api/orders') return json(response, 200, {orders: [...this.orders.values()]});
    const [, id] = /^\/api\/orders\/(.+)$/.exec(path) ?? [];
    if (id) return this.#cancel(this.orders.get(id), searchParams, response);
    const [, what] = /^\/api\/(stop|release|pause|resume)$/.exec(path) ?? [];
    if (!what) return problem(response, 404, 'Not Found', `no ${path}`);
    const {robots, by = null} = await bodyOf(request);
    this.halt(what, robots);
    const order = this.#order({action: what, for: robots ?? [], by, state: 'done', ended_at: now()});
    this.#say('order', order);
    return json(response, 200, order);
  }

  /// Changes an order, as the fleet would.
  change(id, changes) {
    Object.assign(this.orders.get(id), changes);
    this.#say('order', this.orders.get(id));
  }
  /// What another operator does.
  order(fields) {
    const order = this.#order(fields);
    this.orders.set(order.id, order);
    this.#say('order', order);
    return order;
  }
  cancel(id, by, why) { this.#end(this.orders.get(id), by, why); }
  halt(what, robots) {
    const halt = {stop: 'stopped', pause: 'paused', release: 'none', resume: 'none'}[what];
    if (robots) for (const robot of robots) this.halted.set(robot, halt);
    else {
      this.everybody = halt;
      this.halted.clear();
    }
    this.#say('halt', this.#halts());
    this.onHalt(this.robots.filter((name) => this.haltOf(name) !== 'none'));
  }
  tell(robot, changes) { this.#say('robot', {...this.#robot(robot), ...changes}); }
  endStreams() { for (const response of this.#listeners) response.destroy(); }

  #say(kind, data) {
    for (const response of this.#listeners) response.write(`event: ${kind}\ndata: ${JSON.stringify(data)}\n\n`);
  }

  #robot(name) {
    const order = [...this.orders.values()].find((each) => each.robot === name && !ended(each));
    return {name, phase: 'driving', x: 0, y: 0, yaw: null, order: order?.id ?? null, halt: this.haltOf(name), why: null, time_left: null, silent_since: null};
  }

  #halts() { return {everybody: this.everybody, robots: [...this.halted].map(([name, halt]) => ({name, halt}))}; }

  #stream(response) {
    response.writeHead(200, {'Content-Type': 'text/event-stream'});
    response.write(': hello\n\n');
    this.#listeners.add(response);
    response.on('close', () => this.#listeners.delete(response));
    const only = (kind, data) => response.write(`event: ${kind}\r\ndata: ${JSON.stringify(data)}\r\n\r\n`);
    only('halt', this.#halts());
    only('alarms', {alarms: []});
    for (const name of this.robots) only('robot', this.#robot(name));
    for (const order of this.orders.values()) only('order', order);
  }

  #take({robot = null, goal, goals = [goal], by = null, replace = false}, response) {
    if (goals.some(({x}) => x < 0)) return problem(response, 422, 'Unprocessable Content', 'the goal is blocked by an obstacle');
    const replaced = replace ? [...this.orders.values()].filter((each) => each.robot === robot && !ended(each)) : [];
    for (const each of replaced) Object.assign(each, {state: 'cancelled', ended_at: now()});
    const busy = [...this.orders.values()].some((each) => each.robot === robot && !ended(each));
    const free = robot !== null && !busy;
    const order = this.#order({
      action: 'go', state: free ? 'under way' : 'accepted', robot, for: robot ? [robot] : [], goals, by,
      reason: free ? null : robot ? `waits for ${robot} to be free` : 'waits for a robot to be free',
    });
    this.orders.set(order.id, order);
    this.#say('order', order);
    for (const {id} of replaced) this.change(id, {reason: `replaced by order ${order.id} by ${by}`});
    json(response, 201, order);
  }

  #order(fields) {
    return {
      id: `o${++this.#count}`, action: 'go', state: 'accepted', robot: null, for: [], goals: [], visited: 0, cancels: null, reason: null, priority: 0, by: null,
      deadline: null, accepted_at: now(), begun_at: null, ended_at: null, ...fields,
    };
  }
  #count = 0;

  #cancel(order, query, response) {
    if (!order) return problem(response, 404, 'Not Found', 'no such order');
    if (ended(order)) return problem(response, 409, 'Conflict', `it is ${order.state}`);
    this.#end(order, query.get('by'), query.get('why'));
    json(response, 200, order);
  }

  #end(order, by, why) {
    this.change(order.id, {state: 'cancelled', reason: `cancelled by ${by}${why ? `: ${why}` : ''}`, ended_at: now()});
    this.#say('order', this.#order({action: 'cancel', cancels: order.id, by, state: 'done', ended_at: now()}));
    const next = [...this.orders.values()].find((each) => each.robot === order.robot && each.state === 'accepted');
    if (next && order.robot) this.change(next.id, {state: 'under way', reason: null});
  }
}
