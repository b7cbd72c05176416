// The parts of control that need no browser.
import {afterEach, describe, expect, it, vi} from 'vitest';

import {type Draft, type Situation, goalOf, hintOf, targetOf} from '../src/aim.ts';
import {Api, ApiError} from '../src/api.ts';
import {EventParser} from '../src/event_parser.ts';
import {ageOf, describe as words} from '../src/order_list.ts';
import {EventError, Orders, asOrder, ordersShown} from '../src/orders.ts';
import {StopSwitch} from '../src/stop_switch.ts';

const order = (id: string, values: object = {}) => ({
  id, action: 'go', state: 'under way', robot: 'r1', for: ['r1'], goals: [{x: 1, y: 2}], visited: 0, cancels: null, reason: null, priority: 0, by: null,
  deadline: null, accepted_at: 100, begun_at: null, ended_at: null, ...values,
});

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
  it('are listed with the newest first, and at most so many', () => {
    const orders = new Orders();
    for (let k = 0; k < 3 * ordersShown; ++k) orders.on('order', order(`o${k}`, {accepted_at: k, state: k === 0 ? 'accepted' : 'done'}));
    const listed = orders.newest();
    expect(listed.length).toBe(ordersShown);
    expect(listed[0].id).toBe(`o${3 * ordersShown - 1}`);
    expect(orders.openOf('r1').map(({id}) => id), 'no open order is forgotten').toEqual(['o0']);
  });

  it('of the same moment keep their order', () => {
    const orders = new Orders();
    for (const id of ['a', 'b', 'c']) orders.on('order', order(id));
    orders.on('order', order('a', {state: 'done'}));
    expect(orders.newest().map(({id}) => id)).toEqual(['c', 'b', 'a']);
  });

  it('belong to the robot that has them, or else to the one that they name', () => {
    const orders = new Orders();
    orders.on('order', order('any', {robot: null, for: [], state: 'accepted'}));
    orders.on('order', order('assigned', {robot: 'r2', for: [], state: 'assigned'}));
    orders.on('order', order('named', {robot: null, for: ['r2'], state: 'accepted'}));
    orders.on('order', order('ended', {robot: 'r2', state: 'failed'}));
    orders.on('order', order('stop', {action: 'stop', robot: null, for: ['r2'], state: 'accepted'}));
    expect(orders.openOf('r2').map(({id}) => id)).toEqual(['assigned', 'named']);
  });

  it('are refused if they do not hold together', () => {
    for (const wrong of [null, 3, order('a', {state: 'lost'}), order('a', {goals: [{x: 'a', y: 1}]}), order('a', {for: 'r1'})])
      expect(() => asOrder(wrong)).toThrow(EventError);
    expect(() => new Orders().on('halt', {everybody: 'asleep', robots: []})).toThrow(EventError);
    new Orders().on('weather', {});  // a later fleet may say more
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
    orders.on('halt', {everybody: 'stopped', robots: []});
    expect([orders.allStopped, orders.haltOf('r1')]).toEqual([true, 'stopped']);
    orders.on('halt', {everybody: 'stopped', robots: [{robot: 'r1', halt: 'none'}]});
    expect([orders.allStopped, orders.haltOf('r1'), orders.haltOf('r2')]).toEqual([false, 'none', 'stopped']);
    orders.on('halt', {everybody: 'stopped', robots: []});
    orders.forgetHalt();
    expect(orders.allStopped, 'after the connection was lost').toBe(false);
  });

  it('come with the reasons of robots', () => {
    const orders = new Orders();
    orders.on('robot', {name: 'r1', phase: 'halted', x: 0, y: 0, yaw: null, order: null, halt: 'paused', why: 'an operator paused it', time_left: null});
    expect(orders.dutyOf('r1')).toMatchObject({why: 'an operator paused it', time_left: null});
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
  const situation: Situation = {sends: true, any: false, robot: 'r2', queues: false, draft: undefined, halt: 'none', touch: false};

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
    expect(hintOf({...situation, robot: undefined})).toContain('Drag moves the map');
    expect(hintOf({...situation, sends: false})).toContain('Drag moves the map');
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
    expect((await api.go(null, {x: 1, y: 2})).id).toBe('a');
    const [url, {method, headers, body}] = fetch.mock.calls[0];
    expect([url.href, method, body]).toEqual(['http://monitor/page/api/orders', 'POST', '{"robot":null,"goal":{"x":1,"y":2},"by":"page"}']);
    expect(headers).toMatchObject({Authorization: 'Bearer oak'});
    answer(204, '').mockImplementation(async () => new Response(null, {status: 204}));
    await api.halt('stop');
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
