// Where a press on the map sends a robot: to the place of the press. If the pointer is then dragged, the robot shall
// head that way.
import {fixed} from './format.ts';
import type {Goal, Halt} from './api_types.ts';

const leastDrag = 16;  // pixels: less is a click with an unsteady hand

export interface Point {
  x: number;
  y: number;
}

export interface Draft {
  place: Point;  // metres in the map frame
  from: Point;   // pixels of the page
  to: Point;
  up: boolean;   // y grows up the page
}

export function goalOf({place, from, to, up}: Draft): Goal {
  const [dx, dy] = [to.x - from.x, to.y - from.y];
  return Math.hypot(dx, dy) < leastDrag ? {...place} : {...place, yaw: Math.atan2(up ? -dy : dy, dx)};
}

/// What the page says about a press on the map.
export interface Situation {
  sends: boolean;         // the operator wants presses to send robots
  any: boolean;           // of any robot
  robot: string | undefined;  // that is selected
  queues: boolean;
  halt: Halt;     // of that robot
  touch: boolean;  // no mouse and no keyboard
  draft: Draft | undefined;
  byKeys: boolean;  // that keys move
}

/// Whom a press on the map sends. Null: any robot. Undefined: nobody; the press moves the map.
export function targetOf({sends, any, robot}: Situation): string | null | undefined {
  if (!sends) return undefined;
  return any ? null : robot;
}

/// One line about what a press does now.
export function hintOf(situation: Situation): string {
  const {sends, draft, touch} = situation;
  if (!sends) return 'Send is off: a press sends no robot. Drag moves the map.';
  const target = targetOf(situation);
  if (target === undefined) return 'Select a robot to send it. Drag moves the map.';
  const who = target ?? 'any robot';
  if (draft) {
    const {yaw} = goalOf(draft);
    const heading = yaw === undefined || yaw === null ? '' : `, heading ${fixed(yaw, 2, 'rad')}`;
    if (situation.byKeys) return `${fixed(draft.place.x, 2)}, ${fixed(draft.place.y, 2)}${heading}: Enter sends ${who}, Shift+Enter queues. Arrows move, R turns, Esc leaves.`;
    return `Let go to send ${who}${heading}. ${touch ? 'A second finger' : 'Esc'} ends this.`;
  }
  const when = target === null ? '' : whenFor(situation);
  const leave = touch ? 'Two fingers move the map.' : 'The right button moves the map; Esc leaves.';
  return `A press on the map sends ${who} there${when}; drag for a heading. ${leave}`;
}

function whenFor({halt, queues}: Situation): string {
  if (halt !== 'none') return `, once it is ${halt === 'paused' ? 'resumed' : 'released'}`;
  return queues ? ' after its other orders' : ' now';
}
