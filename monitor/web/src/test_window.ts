// For tests: `window.coppice`, read only.
import type {Fleet} from './fleet.ts';
import type {MapView} from './map_view.ts';
import type {TimeControl} from './time_control.ts';

export interface TestWindow {
  readonly ready: boolean;      // a map and robots have arrived
  readonly robots: number;
  readonly frames: number;      // drawn so far
  readonly fps: number;         // frames drawn in the last second
  readonly time: number | null;  // fleet time that is shown
  readonly following: string | null;
  readonly selected: string | null;
  readonly playing: boolean;
  readonly scale: number | null;  // pixels per metre
  positionOf(name: string): {x: number; y: number} | null;  // pixels of the page
  readonly named: string[];  // robots whose names are on the map
  sizeOf(name: string): number | null;  // pixels: diameter on the map
  readonly origin: {x: number; y: number} | null;  // pixels of the page, where the map's lower corner lies
  placeOf(name: string): {x: number; y: number} | null;  // metres in the map frame, in the newest frame
}

export function exposeToTests(fleet: Fleet, map: MapView, time: TimeControl): void {
  const selected = () => fleet.roster[map.selected]?.name ?? null;
  const view: TestWindow = {
    get ready() { return fleet.map !== undefined && fleet.roster.length > 0 && map.robots.x.length > 0; },
    get robots() { return fleet.roster.length; },
    get frames() { return map.drawn; },
    get fps() { return map.fps(performance.now()); },
    get time() { return map.time ?? null; },
    get following() { return map.following ? selected() : null; },
    get selected() { return selected(); },
    get playing() { return time.playing; },
    get scale() { return map.scale ?? null; },
    get origin() {
      const [at, {left, top}] = [map.origin, map.canvas.getBoundingClientRect()];
      return at ? {x: left + at.x, y: top + at.y} : null;
    },
    get named() { return map.robots.named.map((robot) => fleet.roster[robot].name); },
    sizeOf(name) {
      const robot = fleet.indexOf(name);
      return robot === undefined ? null : 2 * map.robots.sizeOf(robot);
    },
    positionOf(name) {
      const robot = fleet.indexOf(name);
      if (robot === undefined || !Number.isFinite(map.robots.x[robot])) return null;
      const {left, top} = map.canvas.getBoundingClientRect();
      return {x: left + map.robots.x[robot], y: top + map.robots.y[robot]};
    },
    placeOf(name) {
      const robot = fleet.indexOf(name);
      return (robot !== undefined && fleet.placeOf(robot)) || null;
    },
  };
  Object.defineProperty(window, 'coppice', {value: Object.freeze(view)});
}
