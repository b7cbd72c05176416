// The parts of control that need no browser.
import {afterEach, describe, expect, it, vi} from 'vitest';

import {type Draft, type Situation, goalOf, hintOf, targetOf} from '../src/aim.ts';
import {Api, ApiError} from '../src/api.ts';
import {Commands} from '../src/commands.ts';
import {EventParser} from '../src/event_parser.ts';
import {ageOf, describe as words} from '../src/order_list.ts';
import {type KeyAim, onAimKey, tipOf} from '../src/key_aim.ts';
import {Labels} from '../src/labels.ts';
import {Notices} from '../src/notices.ts';
import {type Order, Orders} from '../src/orders.ts';
import type {Choice} from '../src/replace_dialog.ts';
import {SchemaError, read, readEvent} from '../src/schema.ts';
import {StopSwitch} from '../src/stop_switch.ts';
import type {Toasts} from '../src/toasts.ts';

const order = (id: string, values: object = {}) => ({
  id, action: 'go', state: 'under way', robot: 'r1', for: ['r1'], goals: [{x: 1, y: 2}], visited: 0, cancels: null, reason: null, priority: 0, by: null,
  deadline: null, accepted_at: 100, begun_at: null, ended_at: null, ...values,
});

const asOrder = (data: unknown): Order => read('Order', data);
const tell = (orders: Orders, kind: string, data: unknown) => {
  const event = readEvent(kind, data);
  if (event) orders.on(event);
};

describe('a stream of events', () => {
  it('is taken apart, wherever it is cut', () => {
    const text = ': hello\r\n\r\nevent: order\r\ndata: {"a":\ndata: 1}\n\ndata:x\n\nevent: halt\ndata: {';
    for (let cut = 0; cut < text.length; ++cut) {
      const parser = new EventParser();
      const events = [...parser.feed(text.slice(0, cut)), ...parser.feed(text.slice(cut))];
      expect(events).toEqual([{kind: 'order', data: '{"a":\n1}'}, {kind: 'message', data: 'x'}]);
    }
  });

  it('is refused if an event does not end', () => {
    const parser = new EventParser();
    expect(() => { for (let k = 0; k < 2000; ++k) parser.feed('data: ' + 'x'.repeat(1000) + '\n'); }).toThrow();
    expect(() => new EventParser().feed('x'.repeat(2_000_000))).toThrow();
  });
});

describe('orders', () => {
  it('are all known, listed with the newest first, and counted', () => {
    const orders = new Orders();
    for (let k = 0; k < 3000; ++k) tell(orders, 'order', order(`o${k}`, {accepted_at: k, state: 'accepted'}));
    expect(orders.newest(2).map(({id}) => id)).toEqual(['o2999', 'o2998']);
    expect([orders.openCount, orders.count, orders.openOf('r1').length]).toEqual([3000, 3000, 3000]);
  });

  it('are forgotten when they have ended long ago, and not before', () => {
    const orders = new Orders();
    for (let k = 0; k < 3000; ++k) tell(orders, 'order', order(`o${k}`, {accepted_at: k, ended_at: k, state: k === 0 ? 'accepted' : 'done'}));
    expect(orders.count).toBeLessThanOrEqual(1201);
    expect(orders.newest(1)[0].id).toBe('o2999');
    expect(orders.openOf('r1').map(({id}) => id), 'no open order is forgotten').toEqual(['o0']);
  });

  it('of the same moment keep their order', () => {
    const orders = new Orders();
    for (const id of ['a', 'b', 'c']) tell(orders, 'order', order(id));
    tell(orders, 'order', order('a', {state: 'done'}));
    expect(orders.newest(9).map(({id}) => id)).toEqual(['c', 'b', 'a']);
  });

  it('belong to the robot that has them, or else to the one that they name', () => {
    const orders = new Orders();
    tell(orders, 'order', order('any', {robot: null, for: [], state: 'accepted'}));
    tell(orders, 'order', order('assigned', {robot: 'r2', for: [], state: 'assigned'}));
    tell(orders, 'order', order('named', {robot: null, for: ['r2'], state: 'accepted'}));
    tell(orders, 'order', order('ended', {robot: 'r2', state: 'failed'}));
    tell(orders, 'order', order('stop', {action: 'stop', robot: null, for: ['r2'], state: 'accepted'}));
    expect(orders.openOf('r2').map(({id}) => id)).toEqual(['assigned', 'named']);
  });

  it('are refused if they do not hold together', () => {
    for (const wrong of [null, 3, order('a', {state: 'lost'}), order('a', {goals: [{x: 'a', y: 1}]}), order('a', {for: 'r1'})])
      expect(() => asOrder(wrong)).toThrow(SchemaError);
    expect(() => tell(new Orders(), 'halt', {everybody: 'asleep', robots: []})).toThrow(SchemaError);
    tell(new Orders(), 'weather', {});  // a later fleet may say more
  });

  it('are described in short', () => {
    expect(words(asOrder(order('a')))).toBe('r1 to 1.00, 2.00');
    expect(words(asOrder(order('a', {robot: null, for: []})))).toBe('any robot to 1.00, 2.00');
    const goals = [{x: 1, y: 2}, {x: 3, y: 4, yaw: 1}];
    expect(words(asOrder(order('a', {goals, visited: 1})))).toBe('r1 to 3.00, 4.00, 2 of 2');
    expect(words(asOrder(order('a', {goals, visited: 2})))).toBe('r1 to 3.00, 4.00, 2 of 2');
    expect(words(asOrder(order('a', {action: 'stop', robot: null, for: [], goals: []})))).toBe('stop all robots');
    expect(ageOf(asOrder(order('a')), 187)).toBe('1:27');
    expect(ageOf(asOrder(order('a')), 90), 'clocks differ').toBe('0:00');
  });
});

describe('halts', () => {
  it('hold for all robots but those that are named', () => {
    const orders = new Orders();
    expect(orders.allStopped, 'before it is known').toBe(false);
    tell(orders, 'halt', {everybody: 'stopped', robots: []});
    expect([orders.allStopped, orders.haltOf('r1')]).toEqual([true, 'stopped']);
    tell(orders, 'halt', {everybody: 'stopped', robots: [{name: 'r1', halt: 'none'}]});
    expect([orders.allStopped, orders.haltOf('r1'), orders.haltOf('r2')]).toEqual([false, 'none', 'stopped']);
    tell(orders, 'halt', {everybody: 'stopped', robots: []});
    orders.forgetHalt();
    expect(orders.allStopped, 'after the connection was lost').toBe(false);
    expect(() => tell(orders, 'halt', {everybody: 'none', robots: [{robot: 'r1', halt: 'paused'}]}), 'a field of another name').toThrow(/halt|name/i);
  });

  it('come with the reasons of robots', () => {
    const orders = new Orders();
    tell(orders, 'robot', {name: 'r1', phase: 'halted', x: 0, y: 0, yaw: null, order: null, halt: 'paused', why: 'an operator paused it', time_left: null, silent_since: null});
    expect(orders.dutyOf('r1')).toMatchObject({why: 'an operator paused it', time_left: null, silent_since: null});
  });
});

describe('the button that stops', () => {
  it('stops at each press while robots may drive', () => {
    const button = new StopSwitch();
    expect([button.press(0), button.press(50), button.press(100)]).toEqual(['stop', 'stop', 'stop']);
  });

  it('releases only after two calm presses', () => {
    const button = new StopSwitch();
    button.press(0);
    button.stopped = true;
    expect([300, 900, 1500, 2000].map((at) => button.press(at)), 'hasty presses').toEqual([undefined, undefined, undefined, undefined]);
    expect(button.label(2100)).toBe('RELEASE');
    expect(button.press(3100)).toBeUndefined();
    expect(button.label(3200)).toBe('RELEASE?');
    expect(button.press(3250), 'a double click').toBeUndefined();
    expect(button.press(4000)).toBe('release');
    expect(button.press(5000)).toBeUndefined();
    expect(button.press(8100), 'more than three seconds later').toBeUndefined();
    expect(button.press(9000)).toBe('release');
  });

  it('does not release what a key has just stopped', () => {
    const button = new StopSwitch();
    button.stopped = true;
    button.press(0);
    button.hurry(400);
    expect(button.press(900)).toBeUndefined();
  });
});

describe('a press on the map', () => {
  const draft: Draft = {place: {x: 7, y: 8}, from: {x: 100, y: 100}, to: {x: 100, y: 60}, up: true};
  const situation: Situation = {sends: true, any: false, robot: 'r2', queues: false, draft: undefined, halt: 'none', touch: false, byKeys: false};

  it('gives a heading if it is dragged far enough', () => {
    expect(goalOf(draft)).toEqual({x: 7, y: 8, yaw: Math.PI / 2});
    expect(goalOf({...draft, up: false}).yaw).toBeCloseTo(-Math.PI / 2);
    expect(goalOf({...draft, to: {x: 110, y: 100}})).toEqual({x: 7, y: 8});
  });

  it('sends the selected robot, any, or none', () => {
    expect(targetOf(situation)).toBe('r2');
    expect(targetOf({...situation, any: true})).toBeNull();
    expect(targetOf({...situation, robot: undefined})).toBeUndefined();
    expect(targetOf({...situation, sends: false, any: true})).toBeUndefined();
  });

  it('is explained', () => {
    expect(hintOf(situation)).toContain('sends r2 there now');
    expect(hintOf({...situation, queues: true})).toContain('after its other orders');
    expect(hintOf({...situation, halt: 'stopped'})).toContain('once it is released');
    expect(hintOf({...situation, any: true, halt: 'stopped'})).toContain('sends any robot there;');
    expect(hintOf({...situation, draft})).toMatch(/^Let go to send r2, heading 1\.57\srad\. Esc/);
    expect(hintOf({...situation, draft, byKeys: true})).toMatch(/^7\.00, 8\.00, heading 1\.57\srad: Enter sends r2/);
    expect(hintOf({...situation, robot: undefined})).toContain('Drag moves the map');
    expect(hintOf({...situation, sends: false})).toContain('Drag moves the map');
  });
});

describe('the keyboard on the map', () => {
  const aim: KeyAim = {at: {x: 100, y: 50}, heading: undefined};
  const press = (key: string, shiftKey = false) => onAimKey({key, shiftKey}, aim);

  it('moves the mark, by much or by little', () => {
    expect(press('ArrowLeft')).toEqual({aim: {at: {x: 80, y: 50}, heading: undefined}});
    expect(press('ArrowDown', true)).toEqual({aim: {at: {x: 100, y: 52}, heading: undefined}});
  });

  it('turns the heading, which an arrow shows', () => {
    const turned = (press('r') as {aim: KeyAim}).aim;
    expect(tipOf(turned)).toEqual({x: 148, y: 50});
    expect(onAimKey({key: 'r', shiftKey: false}, turned)).toMatchObject({aim: {heading: Math.PI / 12}});
    expect(tipOf(aim)).toEqual(aim.at);
  });

  it('sends or queues', () => {
    expect([press('Enter'), press('Enter', true), press('x')]).toEqual(['send', 'queue', undefined]);
  });
});

describe('names on the map', () => {
  const place = (bodies: {x: number; y: number; size: number}[], marked = -1) => {
    const all = bodies.map((_, k) => k);
    return new Labels().place(all, all, (k) => `robot ${k}`, (k) => bodies[k], (text) => 6 * text.length, (k) => k === marked, {width: 400, height: 300});
  };
  const boxes = (labels: ReturnType<typeof place>) => labels.map(({x, y}) => ({left: x, right: x + 42, top: y - 11, bottom: y + 2}));

  it('cover neither each other nor robots', () => {
    const bodies = Array.from({length: 60}, (_, k) => ({x: 20 + 45 * (k % 8), y: 30 + 30 * Math.floor(k / 8), size: 4}));
    const labels = place(bodies);
    expect(labels.length).toBeGreaterThan(20);
    const taken = boxes(labels);
    for (const [k, a] of taken.entries()) {
      for (const b of taken.slice(k + 1)) expect(a.left >= b.right || b.left >= a.right || a.top >= b.bottom || b.top >= a.bottom).toBe(true);
      const own = labels[k].robot;
      for (const [j, {x, y, size}] of bodies.entries())
        expect(j === own || x + size <= a.left || x - size >= a.right || y + size <= a.top || y - size >= a.bottom, `${own} covers ${j}`).toBe(true);
    }
  });

  it('stay at their side, and the selected robot always has its name', () => {
    expect(place([{x: 100, y: 100, size: 4}, {x: 300, y: 200, size: 4}]).map(({robot}) => robot)).toEqual([0, 1]);
    const crowd = Array.from({length: 30}, () => ({x: 100, y: 100, size: 30}));
    expect(place(crowd, 7).some(({robot}) => robot === 7)).toBe(true);
  });
});

describe('a robot that is sent while it has orders', () => {
  const begin = (answers: Choice[], onAsk = (_orders: Orders) => {}) => {
    const orders = new Orders();
    tell(orders, 'halt', {everybody: 'none', robots: []});
    const go = vi.fn(async () => asOrder(order('new')));
    const asked: string[][] = [];
    const ask = async (_robot: string, earlier: readonly Order[]) => {
      asked.push(earlier.map(({id}) => id));
      onAsk(orders);
      return answers.shift();
    };
    const toasts = {succeed() {}, fail(_topic: string, text: string) { throw new Error(text); }} as unknown as Toasts;
    return {orders, go, asked, commands: new Commands({go} as unknown as Api, orders, toasts, ask, () => {})};
  };
  const goal = {x: 1, y: 2};

  it('loses none of them without a question', async () => {
    const {orders, go, asked, commands} = begin(['replace']);
    await commands.send('r1', goal, false);
    expect(go).toHaveBeenLastCalledWith('r1', goal, false);
    tell(orders, 'order', order('a'));
    await commands.send('r1', {x: 2, y: 2}, true);
    expect(go).toHaveBeenLastCalledWith('r1', {x: 2, y: 2}, false);
    expect(asked).toEqual([]);
    await commands.send('r1', {x: 3, y: 2}, false);
    expect(go).toHaveBeenLastCalledWith('r1', {x: 3, y: 2}, true);
    expect(asked).toEqual([['a']]);
  });

  it('keeps them, or is not sent, as the operator likes', async () => {
    const {orders, go, commands} = begin(['add', undefined]);
    tell(orders, 'order', order('a'));
    await commands.send('r1', goal, false);
    expect(go).toHaveBeenLastCalledWith('r1', goal, false);
    await commands.send('r1', {x: 2, y: 2}, false);
    expect(go).toHaveBeenCalledTimes(1);
  });

  it('is asked about again if others gave it more meanwhile', async () => {
    const {orders, go, asked, commands} = begin(['replace', 'replace'], (orders) => tell(orders, 'order', order('b')));
    tell(orders, 'order', order('a'));
    await commands.send('r1', goal, false);
    expect(asked).toEqual([['a'], ['a', 'b']]);
    expect(go).toHaveBeenLastCalledWith('r1', goal, true);
  });
});

describe('what others did', () => {
  const begin = () => {
    const orders = new Orders();
    const notices: string[] = [];
    const said = new Notices(orders, {notice: (_topic: string, text: string) => notices.push(text)} as unknown as Toasts, () => 'anna');
    const on = (data: object) => {
      const event = readEvent('order', data);
      if (event?.kind === 'order') said.on(event.data, orders.on(event));
    };
    said.begin(50);
    return {on, notices};
  };

  it('is told with its reason', () => {
    const {on, notices} = begin();
    on(order('a'));
    on(order('a', {state: 'cancelled', reason: 'cancelled by bob: the pallet is gone'}));
    on(order('c', {action: 'cancel', cancels: 'a', by: 'bob', state: 'done'}));
    on(order('d', {action: 'pause', for: ['r1'], by: 'bob', state: 'done'}));
    on(order('e', {action: 'stop', for: [], by: 'anna', state: 'done'}));
    expect(notices).toEqual(['bob cancelled the order r1 to 1.00, 2.00: the pallet is gone', 'bob paused r1']);
  });

  it('is told once of orders that one order replaces', () => {
    const {on, notices} = begin();
    for (const id of ['a', 'b', 'c']) on(order(id));
    for (const id of ['a', 'b']) on(order(id, {state: 'cancelled', reason: 'replaced by order 9 by bob'}));
    on(order('c', {state: 'cancelled', reason: 'replaced by order 10 by anna'}));
    on(order('old', {state: 'cancelled', reason: 'replaced by order 8 by bob'}));
    expect(notices.at(-1)).toBe('bob replaced 2 orders of r1');
    expect(notices).toHaveLength(2);  // the second takes the place of the first
  });
});

describe('requests', () => {
  afterEach(() => vi.unstubAllGlobals());
  const answer = (status: number, body: string) => {
    const fetch = vi.fn(async (_url: URL, _options: RequestInit) => new Response(body, {status, statusText: 'Odd'}));
    vi.stubGlobal('fetch', fetch);
    vi.stubGlobal('location', {href: 'http://monitor/page/'});
    return fetch;
  };

  it('say the token and what is wanted', async () => {
    const fetch = answer(201, JSON.stringify(order('a')));
    const api = new Api();
    api.token = 'oak';
    api.by = 'anna';
    expect((await api.go(null, {x: 1, y: 2})).id).toBe('a');
    const [url, {method, headers, body}] = fetch.mock.calls[0];
    expect([url.href, method, body]).toEqual(['http://monitor/page/api/orders', 'POST', '{"robot":null,"goal":{"x":1,"y":2},"by":"anna","replace":false}']);
    expect(headers).toMatchObject({Authorization: 'Bearer oak'});
    answer(204, '').mockImplementation(async () => new Response(null, {status: 204}));
    await api.halt('stop');
    const cancel = answer(204, '').mockImplementation(async () => new Response(null, {status: 204}));
    await api.cancel('a b');
    expect(cancel.mock.calls[0][0].href).toBe('http://monitor/page/api/orders/a%20b?by=anna');
  });

  it('are answered in the form of the description of the API', async () => {
    answer(201, JSON.stringify({...order('a'), state: 'asleep'}));
    await expect(new Api().go(null, {x: 1, y: 2})).rejects.toThrow('Order.state: "asleep", expected one of accepted');
  });

  it('fail with the detail of the answer', async () => {
    const failure = (status: number, body: string) => {
      answer(status, body);
      return new Api().halt('stop').catch((error) => [error instanceof ApiError, error.status, error.message]);
    };
    expect(await failure(422, '{"title": "Refused", "detail": "its goal is blocked"}')).toEqual([true, 422, 'its goal is blocked']);
    expect(await failure(500, '{"title": "Broken"}')).toEqual([true, 500, 'Broken']);
    expect(await failure(502, '<html>')).toEqual([true, 502, '502 Odd']);
    vi.stubGlobal('fetch', async () => { throw new TypeError('Failed to fetch'); });
    await expect(new Api().probe()).rejects.toMatchObject({status: 0, message: 'the monitor cannot be reached'});
  });
});
