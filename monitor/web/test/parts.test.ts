// The parts of the page that need no browser.
import {PbfReader, PbfWriter} from 'pbf';
import {describe, expect, it} from 'vitest';

import {Fleet, type Robot, figuresKept} from '../src/fleet.ts';
import {EdgesKind, type FiguresPoint, type Frame, type FromPage, Phase, type ToPage, readFromPage, writeToPage} from '../src/live.js';
import {alarmsOf} from '../src/alarms.ts';
import {compact} from '../src/format.ts';
import {Playhead} from '../src/playhead.ts';
import {ProtocolError, decode, encode} from '../src/protocol.ts';
import {nearPairs} from '../src/relations.ts';
import {type View, filled, fitted, toMap, toPageX, toPageY, zoomed} from '../src/view.ts';

function frame(time: number, x: number[], y = x.map(() => 0), vx = x.map(() => 0)): Frame {
  const zeros = x.map(() => 0);
  return {
    time, x, y, vx, vy: zeros, phase: new Uint8Array(x.length), stage: new Uint8Array(x.length), waits_for: x.map(() => -1),
    decision_time: zeros, next_vx: zeros, next_vy: zeros, expiry: zeros, age: zeros, to_go: zeros, waiting: zeros, idle: zeros, yaw: [], silence: zeros, life: undefined,
  };
}

function pack(message: Partial<ToPage>): ArrayBuffer {
  const writer = new PbfWriter();
  writeToPage(message, writer);
  return new Uint8Array(writer.finish()).buffer;
}

const robot = (name: string): Robot => ({
  name, radius: 1, max_speed: 10, max_acceleration: 10, start_x: 0, start_y: 0, goal_x: 0, goal_y: 0, goal_tolerance: 1, mission: 1, footprint: [],
});

describe('protocol', () => {
  it('takes apart what the monitor says', () => {
    const {frame: read} = decode(pack({frame: frame(1.5, [1, 2], [3, 4])}));
    expect(read?.time).toBe(1.5);
    expect(read?.y).toEqual([3, 4]);
    expect(read?.waits_for).toEqual([-1, -1]);
  });

  it('tells a separation of nought from none', () => {
    const point = {time: 1, robots: 2} as FiguresPoint;
    const {figures} = decode(pack({figures: {points: [point, {...point, separation: 0}]}}));
    expect(figures?.points.map((p) => p._separation)).toEqual([undefined, 'separation']);
  });

  it('refuses what does not hold together', () => {
    const map = {id: 'm', width: 4, height: 4, resolution: 1, origin_x: 0, origin_y: 0, y_up: true, occupancy: new Uint8Array(2)};
    expect(decode(pack({map})).map?.width).toBe(4);
    const refused: Partial<ToPage>[] = [
      {frame: {...frame(1, [1, 2]), y: [1]}},
      {frame: {...frame(1, [1, 2]), phase: new Uint8Array(1)}},
      {frame: frame(Infinity, [1])},
      {frame: {...frame(1, [1, 2]), to_go: [1]}},
      {map: {...map, occupancy: new Uint8Array(1)}},
      {map: {...map, width: 1 << 20, height: 1 << 20}},
      {map: {...map, resolution: 0}},
      {edges: {kind: EdgesKind.INACTIVE, robot: 0, anew: false, points: [1, 2, 3]}},
      {path: {robot: 4_000_000, points: []}},
    ];
    for (const message of refused) expect(() => decode(pack(message))).toThrow(ProtocolError);
    expect(() => decode(Uint8Array.from([0x3a, 0xff, 0xff, 0xff, 0xff]).buffer)).toThrow(ProtocolError);
  });

  it('says a pause, and the beginning of time', () => {
    const said = (message: Partial<FromPage>) => readFromPage(new PbfReader(encode(message)));
    expect(said({playing: false})).toMatchObject({what: 'playing', playing: false});
    expect(said({seek: 0})).toMatchObject({what: 'seek', seek: 0});
  });
});

describe('playhead', () => {
  it('shows frames in their order, without standing still, at a short distance', () => {
    const head = new Playhead();
    const times: number[] = [];
    for (let k = 0; k < 120; ++k) {
      const now = k / 60;
      if (k % 3 === 0) head.on(frame(10 + now, [10 * now]), now);
      const shown = head.advance(now, 1 / 60)!;
      times.push(shown.time);
    }
    const steps = times.slice(60).map((time, k) => time - times[59 + k]);
    expect(Math.min(...steps)).toBeGreaterThan(0.01);
    expect(Math.max(...steps)).toBeLessThan(0.025);
    expect(10 + 119 / 60 - times[119]).toBeLessThan(0.12);
  });

  it('stands at the last frame when none comes', () => {
    const head = new Playhead();
    for (let k = 0; k < 5; ++k) head.on(frame(k / 20, [k]), k / 20);
    for (let k = 0; k < 100; ++k) head.advance(0.2 + k / 60, 1 / 60);
    const shown = head.advance(2, 1 / 60)!;
    expect(shown.time).toBe(0.2);
    expect(shown.share).toBe(1);
  });

  it('begins anew when time goes back', () => {
    const head = new Playhead();
    for (let k = 0; k < 5; ++k) head.on(frame(100 + k, [k]), k / 20);
    head.advance(0.2, 0.02);
    head.on(frame(3, [0]), 0.25);
    expect(head.advance(0.26, 0.01)?.time).toBe(3);
  });
});

describe('near pairs', () => {
  const robots = [robot('a'), robot('b'), robot('c')];

  it('are those that stand closer than half of either radius', () => {
    expect(nearPairs(robots, frame(0, [0, 2.9, 6]))).toEqual([0, 1]);
    expect(nearPairs(robots, frame(0, [0, 3.1, 7]))).toEqual([]);
  });

  it('are further apart the faster they drive', () => {
    expect(nearPairs(robots, frame(0, [0, 7.9, NaN], undefined, [10, 0, 0]))).toEqual([0, 1]);  // stops within 5 m
    expect(nearPairs(robots, frame(0, [0, 8.1, NaN], undefined, [10, 0, 0]))).toEqual([]);
  });

  it('are the same as by looking at all of them', () => {
    const many = Array.from({length: 60}, (_, k) => robot(`r${k}`));
    const at = (k: number) => ((k * 7919) % 97) / 2;
    const all = frame(0, many.map((_, k) => at(k)), many.map((_, k) => at(k + 31)), many.map((_, k) => k % 9));
    const expected = new Set<string>();
    for (let a = 0; a < 60; ++a)
      for (let b = a + 1; b < 60; ++b)
        if (Math.hypot(all.x[a] - all.x[b], all.y[a] - all.y[b]) < 3 + (all.vx[a] ** 2 + all.vx[b] ** 2) / 20) expected.add(`${a},${b}`);
    const pairs = nearPairs(many, all);
    const found = new Set<string>();
    for (let i = 0; i < pairs.length; i += 2) found.add([pairs[i], pairs[i + 1]].sort((a, b) => a - b).join());
    expect(expected.size).toBeGreaterThan(10);
    expect(found).toEqual(expected);
  });
});

describe('view', () => {
  const map = {id: 'm', width: 100, height: 50, resolution: 0.5, origin_x: -10, origin_y: 5, y_up: true, occupancy: undefined};

  it.each([true, false])('goes to the page and back (y up: %s)', (up) => {
    const view: View = {...fitted({...map, y_up: up}, 800, 600), up};
    const place = toMap(view, toPageX(view, 3), toPageY(view, 9));
    expect(place.x).toBeCloseTo(3);
    expect(place.y).toBeCloseTo(9);
    expect(toPageY(view, 10) < toPageY(view, 9)).toBe(up);
  });

  it('zooms about a place that stays', () => {
    const view = fitted(map, 800, 600);
    const before = toMap(view, 100, 200);
    const after = toMap(zoomed(view, 3, 100, 200), 100, 200);
    expect(after.x).toBeCloseTo(before.x);
    expect(after.y).toBeCloseTo(before.y);
  });
});

describe('a view that is filled', () => {
  const map = {id: 'm', width: 100, height: 50, resolution: 1, origin_x: 5e5, origin_y: 5.4e6, y_up: true, occupancy: undefined};
  const view: View = {x: 0, y: 0, scale: 20, up: true, width: 800, height: 600};  // 40 x 30 m

  it('shows nothing beside the map', () => {
    expect(filled({...view, x: 3, y: 48}, map)).toMatchObject({x: 20, y: 35});
    expect(filled({...view, x: 50, y: 25}, map)).toMatchObject({x: 50, y: 25});
  });

  it('has a smaller map in its middle', () => {
    expect(filled({...view, scale: 4, x: 3, y: 48}, map)).toMatchObject({x: 50, y: 25});
  });
});

describe('numbers in cells', () => {
  it.each([[0, 1, '0.0'], [12.34, 1, '12.3'], [1255.04, 1, '1255'], [-99.96, 1, '-100'], [99999.4, 1, '99999'], [125499, 1, '125k'],
    [2.5e6, 0, '3M'], [undefined, 1, '–'], [NaN, 0, '–']])('%s is shown whole', (value, digits, text) => {
    expect(compact(value, digits)).toBe(text);
    expect(text.length).toBeLessThanOrEqual(5);
  });
});

describe('figures that alarm', () => {
  const status = (values: object) => ({statuses: {statuses: [{robot: 0, reason: '', periods: 1000, missed_share: 0, state_age_p99: 0, rejected: 0, processor_share: 0.1, wait_cause: '', ...values}]}}) as unknown as ToPage;
  const about = (message: ToPage, at = frame(1, [0])) => {
    const fleet = new Fleet();
    fleet.on({roster: {robots: [robot('a'), robot('b')]}, frame: at} as ToPage);
    fleet.on(message);
    return alarmsOf(fleet, 0).join(' ');
  };

  it('say that processor time is lacking', () => {
    expect(about(status({missed_share: 0.15}))).toContain('for lack of processor time');
    expect(about(status({missed_share: 0.05}))).toBe('');
  });

  it('say what old states mean', () => {
    expect(about(status({state_age_p99: 1.3}))).toContain('1.3');
    expect(about(status({state_age_p99: 0.3}))).toBe('');
  });

  it('say for how long it waits, and why, and that it is not heard', () => {
    const waits = {...frame(30, [0]), waiting: [12], idle: [12], phase: new Uint8Array([2])};
    const cause = 'no odometry came';
    expect(about(status({wait_cause: cause}), waits)).toMatch(/^Has waited for 12\ss: no odometry came\.$/);
    expect(about(status({wait_cause: cause, reason: cause}), waits)).toMatch(/^Has waited for 12\ss: no odometry came\.$/);
    expect(about(status({wait_cause: cause}), {...waits, waiting: [4], idle: [4]})).toBe('');
    expect(about(status({}), {...waits, waiting: [0]})).toContain('no nearer');
    expect(about(status({}), {...frame(30, [0]), silence: [4], phase: new Uint8Array([2])})).toContain('Nothing has been heard');
    expect(about(status({}), {...frame(30, [0]), silence: [4], phase: new Uint8Array([3])}), 'of one that has arrived, too').toContain('Nothing has been heard');
    expect(about({alarms: {alarms: [{kind: 'robot_silent', robot: 0, since: 5, text: 'a is not heard'}]}} as ToPage)).toContain('Nothing has been heard');
    const ended = {...frame(30, [0]), silence: [4], life: {state: 3, heard: 0, robots: 2, arrived: 2, replayed: false}} as Frame;
    expect(about(status({}), ended), 'after the end of a run').toBe('');
  });

  it('do not wonder that a halted robot comes no nearer', () => {
    const halted = {...frame(30, [0]), idle: [12], phase: new Uint8Array([Phase.HALTED])};
    expect(about(status({reason: 'an operator stopped it'}), halted)).toBe('An operator stopped it.');
  });

  it('give the reason that the robot gives', () => {
    expect(about(status({reason: 'its goal is blocked'}))).toBe('Its goal is blocked.');
  });
});

describe('fleet', () => {
  it('knows places in the map frame to a millimetre, wherever that begins', () => {
    const fleet = new Fleet();
    fleet.on({map: {origin_x: 500000.25, origin_y: 5400000.5}} as ToPage);
    fleet.on({frame: frame(1, [Math.fround(12.345)], [Math.fround(6.789)])} as ToPage);
    expect(fleet.placeOf(0)?.x).toBeCloseTo(500012.595, 4);
    expect(fleet.placeOf(0)?.y).toBeCloseTo(5400007.289, 4);
  });

  it('knows no way to go without a path', () => {
    const fleet = new Fleet();
    fleet.on({frame: {...frame(1, [1, 2]), to_go: [NaN, 229.5]}} as ToPage);
    expect(fleet.toGo(0)).toBeUndefined();
    expect(fleet.toGo(1)).toBe(229.5);
  });

  it('knows why a robot waits, and for how long it has', () => {
    const fleet = new Fleet();
    fleet.on({frame: {...frame(20, [1, 2]), waiting: [0, 7.5]}} as ToPage);
    expect(fleet.waitOf(1), 'before its status has come').toBeUndefined();
    fleet.on({statuses: {statuses: [{robot: 0, wait_cause: ''}, {robot: 1, wait_cause: 'r7 is in the way'}]}} as unknown as ToPage);
    expect(fleet.waitOf(0)).toBeUndefined();
    expect(fleet.waitOf(1)).toEqual({seconds: 7.5, cause: 'r7 is in the way'});
  });

  it('keeps a bounded number of figures, the newest all', () => {
    const fleet = new Fleet();
    for (let time = 0; time < 3 * figuresKept; ++time) fleet.on({figures: {points: [{time} as FiguresPoint]}} as ToPage);
    expect(fleet.figures.length).toBeLessThanOrEqual(2 * figuresKept);
    expect(fleet.figures.at(-1)?.time).toBe(3 * figuresKept - 1);
    expect(fleet.figures.at(-2)?.time).toBe(3 * figuresKept - 2);
  });

  it('forgets all when another run begins', () => {
    const fleet = new Fleet();
    fleet.on({roster: {robots: [robot('a')]}} as ToPage);
    expect(fleet.indexOf('a')).toBe(0);
    fleet.on({begin: {version: '1', source: '', recorded: false}} as ToPage);
    expect(fleet.indexOf('a')).toBeUndefined();
    expect(fleet.roster).toEqual([]);
  });
});
