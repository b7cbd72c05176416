// Which part of the map is seen: between metres from the map's origin, as frames, paths and edges have them, and pixels
// of the page (CSS pixels, from the canvas's upper left corner).
import type {Map as GridMap} from './live.js';

export interface View {
  x: number;  // metres, in the middle
  y: number;
  scale: number;  // pixels a metre
  up: boolean;    // y grows up the page
  width: number;  // pixels
  height: number;
}

export interface Bounds {
  left: number;
  right: number;
  low: number;
  high: number;
}

const closest = 12;  // how much of the map fills the page at least: cells

export function bounds(map: GridMap): Bounds {
  return {left: 0, right: map.width * map.resolution, low: 0, high: map.height * map.resolution};
}

export function toPageX(view: View, x: number): number {
  return (x - view.x) * view.scale + view.width / 2;
}
export function toPageY(view: View, y: number): number {
  return (view.up ? view.y - y : y - view.y) * view.scale + view.height / 2;
}
export function toMap(view: View, pageX: number, pageY: number): {x: number; y: number} {
  const dy = (pageY - view.height / 2) / view.scale;
  return {x: view.x + (pageX - view.width / 2) / view.scale, y: view.up ? view.y - dy : view.y + dy};
}

export function fitted(map: GridMap, width: number, height: number): View {
  const b = bounds(map);
  const margin = Math.min(24, width / 10);
  const scale = Math.min((width - 2 * margin) / (b.right - b.left), (height - 2 * margin) / (b.high - b.low));
  return {x: (b.left + b.right) / 2, y: (b.low + b.high) / 2, scale: Math.max(scale, 1e-6), up: map.y_up, width, height};
}

export function panned(view: View, dx: number, dy: number): View {
  return {...view, x: view.x - dx / view.scale, y: view.y + (view.up ? dy : -dy) / view.scale};
}

/// Zoomed about a place on the page, which stays where it is.
export function zoomed(view: View, factor: number, pageX: number, pageY: number): View {
  const place = toMap(view, pageX, pageY);
  const scaled = {...view, scale: view.scale * factor};
  const there = toMap(scaled, pageX, pageY);
  return {...scaled, x: view.x + place.x - there.x, y: view.y + place.y - there.y};
}

/// Moved so that as much of the map is in sight as can be, and no more beside it than need be.
export function filled(view: View, map: GridMap): View {
  const b = bounds(map);
  const inside = (middle: number, low: number, high: number, seen: number) =>
    high - low <= seen ? (low + high) / 2 : Math.max(low + seen / 2, Math.min(high - seen / 2, middle));
  return {
    ...view,
    x: inside(view.x, b.left, b.right, view.width / view.scale),
    y: inside(view.y, b.low, b.high, view.height / view.scale),
  };
}

/// Not further out than half of what fits, nor further in than a few cells; and some of the map stays in sight.
export function within(view: View, map: GridMap): View {
  const b = bounds(map);
  const least = fitted(map, view.width, view.height).scale / 2;
  const most = Math.max(least, Math.min(view.width, view.height) / (closest * map.resolution));
  return {
    ...view,
    scale: Math.max(least, Math.min(most, view.scale)),
    x: Math.max(b.left, Math.min(b.right, view.x)),
    y: Math.max(b.low, Math.min(b.high, view.y)),
  };
}
