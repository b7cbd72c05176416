// Aims on the map with the keyboard: arrow keys move a mark that begins at the selected robot, Enter sends the robot there.
import type {Point} from './aim.ts';

const step = 20;      // pixels
const fineStep = 2;   // with Shift
const turn = Math.PI / 12;
const arrow = 48;     // pixels: length of the heading

/// Of a draft that keys move.
export interface KeyAim {
  at: Point;             // pixels of the map's canvas
  heading: number | undefined;  // radians on the page, clockwise; undefined: any
}

export type KeyOutcome = {aim: KeyAim} | 'send' | 'queue' | undefined;

/// What a key does to it. Undefined: the key means nothing here.
export function onAimKey({key, shiftKey}: {key: string; shiftKey: boolean}, {at, heading}: KeyAim): KeyOutcome {
  const pixels = shiftKey ? fineStep : step;
  const moves: Record<string, Point> = {ArrowLeft: {x: -pixels, y: 0}, ArrowRight: {x: pixels, y: 0}, ArrowUp: {x: 0, y: -pixels}, ArrowDown: {x: 0, y: pixels}};
  if (key in moves) return {aim: {at: {x: at.x + moves[key].x, y: at.y + moves[key].y}, heading}};
  if (key === 'Enter') return shiftKey ? 'queue' : 'send';
  if (key === 'r' || key === 'R') return {aim: {at, heading: heading === undefined ? 0 : heading + (key === 'r' ? turn : -turn)}};
  return undefined;
}

/// Where a pointer would be dragged to for this heading.
export function tipOf({at, heading}: KeyAim): Point {
  if (heading === undefined) return at;
  return {x: at.x + arrow * Math.cos(heading), y: at.y + arrow * Math.sin(heading)};
}
