// The visible part of the map. Converts between metres from the map's origin, as in frames, paths and edges, and pixels
// of the page (CSS pixels, from the canvas's upper left corner).
import type {Map as GridMap} from './live.js';

export interface View {
  x: number;  // metres, of the middle
  y: number;
  scale: number;  // pixels per metre
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

const closest = 12;  // cells: the least part of the map that fills the page

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

/// Zooms about a point on the page, which stays in place.
export function zoomed(view: View, factor: number, pageX: number, pageY: number): View {
  const place = toMap(view, pageX, pageY);
  const scaled = {...view, scale: view.scale * factor};
  const there = toMap(scaled, pageX, pageY);
  return {...scaled, x: view.x + place.x - there.x, y: view.y + place.y - there.y};
}

/// Moves the view so that it shows as much of the map, and as little beside it, as possible.
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

/// Limits the view: no further out than half of the fitting scale, no closer than a few cells, and with some of the map
/// in sight.
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
