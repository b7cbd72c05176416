// The colours of the map, from the page's style sheet, which defines them once for both themes.
import {shownCount} from './phases.ts';

export const hues = 10;  // number of robot colours, assigned in turn

export interface Palette {
  ground: string;
  floor: string;
  wall: string;
  treeInactive: string;
  treeActive: string;
  near: string;
  waits: string;
  reserved: string;
  mark: string;      // on robots
  text: string;
  halo: string;      // around text
  aim: string;       // where a robot is sent
  selected: string;
  phases: string[];
  robots: string[];
}

export function readPalette(): Palette {
  const style = getComputedStyle(document.documentElement);
  const colour = (name: string) => style.getPropertyValue(`--${name}`).trim();
  return {
    ground: colour('map-ground'),
    floor: colour('map-floor'),
    wall: colour('map-wall'),
    treeInactive: colour('tree-inactive'),
    treeActive: colour('tree-active'),
    near: colour('near'),
    waits: colour('waits'),
    reserved: colour('reserved'),
    mark: colour('mark'),
    text: colour('text'),
    halo: colour('map-halo'),
    aim: colour('accent'),
    selected: colour('selected'),
    phases: Array.from({length: shownCount}, (_, k) => colour(`phase-${k}`)),
    robots: Array.from({length: hues}, (_, k) => colour(`robot-${k}`)),
  };
}
