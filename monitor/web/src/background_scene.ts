// The content beneath the robots that seldom changes: map, trees, paths, starts and goals. Drawn as a whole for a view.
import type {Robot, SceneChange} from './fleet.ts';
import {EdgesKind, type Map as GridMap} from './live.js';
import type {Layers} from './layers.ts';
import type {Palette} from './palette.ts';
import {type Bounds, type View, bounds, toMap, toPageX, toPageY} from './view.ts';

type Context = OffscreenCanvasRenderingContext2D;

const edgesAtOnce = 4_000;        // in one stroke: the cost grows faster than the number of edges
const largestRaster = 4_096;      // pixels per side; larger maps are drawn with larger cells, blocked where any cell is
const crowd = 40;                 // from this number of paths on they are drawn thinner
const floatsKept = 40_000_000;    // of all edges

interface RootTrees {
  start: Float32Array[];
  goal: Float32Array[];
}

export class BackgroundScene {
  private map: GridMap | undefined;
  private raster: OffscreenCanvas | undefined;
  private rasterColours = '';
  private robots: Robot[] = [];
  private inactive: Float32Array[] = [];
  private active: Float32Array[] = [];
  private roots = new Map<number, RootTrees>();
  private paths = new Map<number, Float32Array>();
  private floats = 0;

  on(change: SceneChange): void {
    if (change.what === 'forget') this.forget();
    else if (change.what === 'roster') this.robots = change.robots;
    else if (change.what === 'path') this.paths.set(change.robot, change.points);
    else if (change.what === 'edges') this.takeEdges(change);
    else {
      this.map = change.map;
      this.raster = undefined;
    }
  }

  /// Highlights the selected robot's plan (-1: none).
  draw(context: Context, view: View, layers: Layers, palette: Palette, selected: number): void {
    context.fillStyle = palette.ground;
    context.fillRect(0, 0, view.width, view.height);
    if (!this.map) return;
    this.drawMap(context, this.map, view, palette);
    if (layers.trees) {
      strokeEdges(context, this.inactive, view, palette.treeInactive);
      strokeEdges(context, this.active, view, palette.treeActive);
    }
    if (layers.roots) this.drawRoots(context, view, palette, selected);
    if (layers.ends) this.drawEnds(context, view, palette, selected);
    if (layers.paths) this.drawPaths(context, view, palette, selected);
  }

  private forget(): void {
    this.map = this.raster = undefined;
    this.robots = [];
    this.inactive = [];
    this.active = [];
    this.roots.clear();
    this.paths.clear();
    this.floats = 0;
  }

  private takeEdges(change: SceneChange & {what: 'edges'}): void {
    const lists = this.listsOf(change.kind, change.robot);
    if (change.anew) {
      for (const list of lists) this.floats -= list.length;
      lists.length = 0;
    }
    if (this.floats + change.points.length > floatsKept) return;  // with more edges, single trees cannot be distinguished
    this.floats += change.points.length;
    lists.push(change.points);
  }

  private listsOf(kind: EdgesKind, robot: number): Float32Array[] {
    if (kind === EdgesKind.INACTIVE) return this.inactive;
    if (kind === EdgesKind.ACTIVE) return this.active;
    let trees = this.roots.get(robot);
    if (!trees) this.roots.set(robot, (trees = {start: [], goal: []}));
    return kind === EdgesKind.ROOT_START ? trees.start : trees.goal;
  }

  private drawMap(context: Context, map: GridMap, view: View, palette: Palette): void {
    const colours = palette.wall + palette.floor;
    if (!this.raster || this.rasterColours !== colours) {
      this.raster = rasterOf(map, palette);
      this.rasterColours = colours;
    }
    const b = bounds(map);
    const left = toPageX(view, b.left);
    const top = toPageY(view, view.up ? b.high : b.low);
    const width = (b.right - b.left) * view.scale;
    const height = (b.high - b.low) * view.scale;
    context.imageSmoothingEnabled = width < this.raster.width;
    context.imageSmoothingQuality = 'medium';
    context.drawImage(this.raster, left, top, width, height);
  }

  private drawRoots(context: Context, view: View, palette: Palette, selected: number): void {
    for (const [robot, trees] of this.roots) {
      context.globalAlpha = 0.6 * weight(robot, selected);
      const colour = palette.robots[robot % palette.robots.length];
      strokeEdges(context, trees.start, view, colour);
      strokeEdges(context, trees.goal, view, colour);
    }
    context.globalAlpha = 1;
  }

  /// A start is a square, and a goal is a ring as large as the robot, with a cross-hair.
  private drawEnds(context: Context, view: View, palette: Palette, selected: number): void {
    const {origin_x, origin_y} = this.map!;
    context.lineWidth = 1.25;
    for (const [index, robot] of this.robots.entries()) {
      if (robot.mission === 0) continue;
      context.globalAlpha = Math.min(1, weight(index, selected));
      context.strokeStyle = palette.robots[index % palette.robots.length];
      const size = Math.max(3, robot.radius * view.scale);
      const [sx, sy] = [toPageX(view, robot.start_x - origin_x), toPageY(view, robot.start_y - origin_y)];
      const [gx, gy] = [toPageX(view, robot.goal_x - origin_x), toPageY(view, robot.goal_y - origin_y)];
      context.beginPath();
      context.rect(sx - size / 2.5, sy - size / 2.5, size / 1.25, size / 1.25);
      context.moveTo(gx + size, gy);
      context.arc(gx, gy, size, 0, 2 * Math.PI);
      for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
        context.moveTo(gx + dx * size * 0.55, gy + dy * size * 0.55);
        context.lineTo(gx + dx * size * 1.3, gy + dy * size * 1.3);
      }
      context.stroke();
    }
    context.globalAlpha = 1;
  }

  private drawPaths(context: Context, view: View, palette: Palette, selected: number): void {
    context.lineJoin = 'round';
    const width = this.paths.size > crowd ? 1.25 : 1.75;
    for (const [robot, points] of this.paths) {
      context.globalAlpha = Math.min(1, 0.75 * weight(robot, selected));
      context.lineWidth = robot === selected ? 3 : width;
      context.strokeStyle = palette.robots[robot % palette.robots.length];
      context.beginPath();
      for (let k = 0; k < points.length; k += 2) context.lineTo(toPageX(view, points[k]), toPageY(view, points[k + 1]));
      context.stroke();
    }
    context.globalAlpha = 1;
  }
}

/// The opacity of a robot's plan: with a selected robot, the other plans are fainter.
function weight(robot: number, selected: number): number {
  return selected < 0 ? 1 : robot === selected ? 1.33 : 0.4;
}

function strokeEdges(context: Context, lists: Float32Array[], view: View, colour: string): void {
  context.strokeStyle = colour;
  context.lineWidth = 1;
  const seen = seenBounds(view);
  let edges = 0;
  context.beginPath();
  for (const list of lists) {
    for (let k = 0; k < list.length; k += 4) {
      const x0 = list[k], y0 = list[k + 1], x1 = list[k + 2], y1 = list[k + 3];
      if ((x0 < seen.left && x1 < seen.left) || (x0 > seen.right && x1 > seen.right)) continue;
      if ((y0 < seen.low && y1 < seen.low) || (y0 > seen.high && y1 > seen.high)) continue;
      context.moveTo(toPageX(view, x0), toPageY(view, y0));
      context.lineTo(toPageX(view, x1), toPageY(view, y1));
      if (++edges % edgesAtOnce === 0) {
        context.stroke();
        context.beginPath();
      }
    }
  }
  context.stroke();
}

function seenBounds(view: View): Bounds {
  const a = toMap(view, 0, 0);
  const b = toMap(view, view.width, view.height);
  return {left: a.x, right: b.x, low: Math.min(a.y, b.y), high: Math.max(a.y, b.y)};
}

/// One pixel per cell, in the orientation on the page.
function rasterOf(map: GridMap, palette: Palette): OffscreenCanvas {
  const coarse = Math.ceil(Math.max(map.width, map.height) / largestRaster);
  const width = Math.ceil(map.width / coarse);
  const height = Math.ceil(map.height / coarse);
  const raster = new OffscreenCanvas(width, height);
  const context = raster.getContext('2d') as Context;
  context.fillStyle = palette.floor;
  context.fillRect(0, 0, width, height);
  context.fillStyle = palette.wall;
  const occupancy = map.occupancy as Uint8Array;
  for (let j = 0; j < map.height; ++j) {
    const row = Math.floor((map.y_up ? map.height - 1 - j : j) / coarse);
    let from = -1;
    for (let i = 0; i <= map.width; ++i) {
      const bit = i + j * map.width;
      const blocked = i < map.width && (occupancy[bit >> 3] >> (bit & 7)) & 1;
      if (blocked && from < 0) from = i;
      if (blocked || from < 0) continue;
      const first = Math.floor(from / coarse);
      context.fillRect(first, row, Math.floor((i - 1) / coarse) - first + 1, 1);
      from = -1;
    }
  }
  return raster;
}
