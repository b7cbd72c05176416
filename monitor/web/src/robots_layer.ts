// The robots, and everything that changes with them. Drawn in every frame, so with one stroke per colour.
import type {Fleet, Robot} from './fleet.ts';
import {Labels} from './labels.ts';
import type {Layers} from './layers.ts';
import {type Frame, Phase} from './live.js';
import type {Palette} from './palette.ts';
import {type Shown as ShownPhase, Stage, asPhase, hasNoWay, lost, shownCount} from './phases.ts';
import type {Shown} from './playhead.ts';
import {nearPairs, stoppingDistance} from './relations.ts';
import {type View, toPageX, toPageY} from './view.ts';

type Context = CanvasRenderingContext2D;

const leastSize = 3;        // pixels: least radius of a drawn robot
const leastOnPhone = 8;     // the same where fingers are to hit it
const signSize = 3.5;       // pixels of radius from which on a sign fits
const forFingers = matchMedia('(pointer: coarse), (max-width: 760px)');  // as in style.css
const velocityAhead = 1;    // seconds: the line of a velocity ends where the robot will be then
const stageRing = 1.3;      // radii
const turningSpeed = 0.02;  // share of its greatest speed below which a robot keeps its heading
const circle = 2 * Math.PI;

export interface Marked {
  selected: number;  // index of a robot; -1: none
  hovered: number;
}

export class RobotsLayer {
  x = new Float32Array(0);  // of each robot, pixels of the page; NaN: not visible
  y = new Float32Array(0);
  named: number[] = [];  // robots whose names were drawn
  private size = new Float32Array(0);     // radius, pixels
  private heading = new Float32Array(0);  // on the page
  private groups: number[][] = Array.from({length: shownCount}, () => []);  // visible robots, by phase
  private seen: number[] = [];
  private old: number[] = [];  // visible robots of which nothing new has come for a while
  private readonly labels = new Labels();
  private pairs: number[] = [];
  private pairsOf: Frame | undefined;

  clear(): void {
    this.x = this.y = this.size = this.heading = new Float32Array(0);
    this.pairs = [];
    this.pairsOf = undefined;
  }

  /// Computes the positions of robots now. Call it before draw(), and before asking what is under the pointer.
  place(fleet: Fleet, shown: Shown, view: View): void {
    const robots = fleet.roster;
    const least = forFingers.matches ? leastOnPhone : leastSize;
    const count = Math.min(robots.length, shown.after.x.length);
    if (this.x.length !== count) this.resize(count);
    for (const group of this.groups) group.length = 0;
    this.seen.length = this.old.length = 0;
    const {before, after, share} = shown;
    for (let k = 0; k < count; ++k) {
      const known = k < before.x.length && before.x[k] === before.x[k];
      const x = known ? before.x[k] + (after.x[k] - before.x[k]) * share : after.x[k];
      const y = known ? before.y[k] + (after.y[k] - before.y[k]) * share : after.y[k];
      const px = (this.x[k] = toPageX(view, x));
      const py = (this.y[k] = toPageY(view, y));
      const size = (this.size[k] = Math.max(least, robots[k].radius * view.scale));
      const [vx, vy] = [after.vx[k], after.vy[k]];
      const turning = turningSpeed * robots[k].max_speed;
      const yaw = yawOf(before, after, k, share);
      if (yaw === yaw) this.heading[k] = view.up ? -yaw : yaw;
      else if (vx * vx + vy * vy > turning * turning) this.heading[k] = Math.atan2(view.up ? -vy : vy, vx);
      if (!(px > -size && px < view.width + size && py > -size && py < view.height + size)) continue;
      this.seen.push(k);
      this.groups[fleet.lost.has(k) ? lost : asPhase(after.phase![k])].push(k);
      if (fleet.isOld(k)) this.old.push(k);
    }
  }

  /// Radius, pixels.
  sizeOf(robot: number): number {
    return this.size[robot];
  }

  /// The robot whose disc is there, or close by; -1: none.
  at(pageX: number, pageY: number, slack: number): number {
    let best = -1;
    let least = Infinity;
    for (const k of this.seen) {
      const distance = Math.hypot(this.x[k] - pageX, this.y[k] - pageY);
      if (distance < Math.max(this.size[k], slack) && distance < least) {
        best = k;
        least = distance;
      }
    }
    return best;
  }

  draw(context: Context, robots: readonly Robot[], frame: Frame, view: View, layers: Layers, marked: Marked, palette: Palette): void {
    context.lineCap = 'round';
    context.lineJoin = 'round';
    if (layers.reserved) this.drawReservations(context, robots, frame, view, palette);
    if (layers.near) this.drawNear(context, robots, frame, palette);
    for (let phase = 0; phase < shownCount; ++phase) this.drawDiscs(context, phase as ShownPhase, palette);
    this.drawOld(context, palette);
    this.drawFootprints(context, robots, view, palette);
    this.drawHeadings(context, frame, view, palette);
    this.drawStages(context, frame, palette);
    if (layers.waits) this.drawWaits(context, frame, palette);
    this.drawMarked(context, marked, palette);
    this.drawNames(context, robots, view, layers, marked, palette);
  }

  private resize(count: number): void {
    const grown = (old: Float32Array) => {
      const list = new Float32Array(count);
      list.set(old.subarray(0, count));
      return list;
    };
    this.x = grown(this.x);
    this.y = grown(this.y);
    this.size = grown(this.size);
    this.heading = grown(this.heading);
  }

  private discs(context: Context, robots: readonly number[], share: number): void {
    context.beginPath();
    for (const k of robots) {
      const size = this.size[k] * share;
      context.moveTo(this.x[k] + size, this.y[k]);
      context.arc(this.x[k], this.y[k], size, 0, circle);
    }
  }

  private drawDiscs(context: Context, phase: ShownPhase, palette: Palette): void {
    const robots = this.groups[phase];
    if (robots.length === 0) return;
    const colour = palette.phases[phase];
    const hollow = phase === Phase.WAITING || phase === Phase.PLANNING || phase === lost || hasNoWay(phase);
    this.discs(context, robots, hollow ? 0.86 : 1);
    context.fillStyle = hollow ? palette.floor : colour;
    context.fill();
    context.strokeStyle = hollow ? colour : palette.mark;  // contrasts with the paths
    context.lineWidth = hollow ? 2 : 1;
    context.setLineDash(phase === lost ? [3, 3] : []);
    context.stroke();
    context.setLineDash([]);
    this.drawSigns(context, phase, robots.filter((k) => this.size[k] >= signSize), hollow ? colour : palette.mark);
  }

  /// A ring of dashes around robots whose positions are old.
  private drawOld(context: Context, palette: Palette): void {
    if (this.old.length === 0) return;
    context.beginPath();
    for (const k of this.old) {
      context.moveTo(this.x[k] + this.size[k] + 2, this.y[k]);
      context.arc(this.x[k], this.y[k], this.size[k] + 2, 0, circle);
    }
    context.setLineDash([2, 3]);
    context.strokeStyle = palette.phases[lost];
    context.lineWidth = 1.5;
    context.stroke();
    context.setLineDash([]);
  }

  /// Signs, so that phases do not differ by colour alone.
  private drawSigns(context: Context, phase: ShownPhase, robots: readonly number[], colour: string): void {
    if (robots.length === 0 || phase === Phase.WAITING || phase === Phase.DRIVING) return;
    if (phase === Phase.PLANNING) {
      this.discs(context, robots, 0.35);
      context.fillStyle = colour;
      context.fill();
      return;
    }
    if (phase === lost) return this.drawQuestions(context, robots, colour);
    context.beginPath();
    for (const k of robots) {
      const [x, y, s] = [this.x[k], this.y[k], this.size[k] * 0.4];
      if (phase === Phase.ARRIVED) {  // a tick
        context.moveTo(x - s, y + 0.1 * s);
        context.lineTo(x - 0.25 * s, y + 0.8 * s);
        context.lineTo(x + s, y - 0.7 * s);
      } else if (hasNoWay(phase)) {  // a cross
        context.moveTo(x - s, y - s);
        context.lineTo(x + s, y + s);
        context.moveTo(x - s, y + s);
        context.lineTo(x + s, y - s);
      } else if (phase === Phase.HALTED) {  // two bars
        context.moveTo(x - 0.6 * s, y - 0.9 * s);
        context.lineTo(x - 0.6 * s, y + 0.9 * s);
        context.moveTo(x + 0.6 * s, y - 0.9 * s);
        context.lineTo(x + 0.6 * s, y + 0.9 * s);
      } else {  // a square
        context.rect(x - 0.8 * s, y - 0.8 * s, 1.6 * s, 1.6 * s);
      }
    }
    context.strokeStyle = colour;
    context.lineWidth = markWidth(this.size[robots[0]]);
    context.stroke();
  }

  private drawQuestions(context: Context, robots: readonly number[], colour: string): void {
    context.fillStyle = colour;
    context.textAlign = 'center';
    for (const k of robots) {
      context.font = `700 ${Math.min(16, 1.5 * this.size[k]).toFixed(1)}px ui-sans-serif, system-ui, "DejaVu Sans", sans-serif`;
      context.fillText('?', this.x[k], this.y[k] + Math.min(16, 1.5 * this.size[k]) * 0.36);
    }
  }

  /// The outlines of robots that are no discs.
  private drawFootprints(context: Context, robots: readonly Robot[], view: View, palette: Palette): void {
    context.beginPath();
    for (const k of this.seen) {
      const corners = robots[k].footprint;
      if (!corners || corners.length < 6 || this.size[k] < signSize) continue;
      const [cos, sin] = [Math.cos(this.heading[k]) * view.scale, Math.sin(this.heading[k]) * view.scale];
      for (let i = 0; i < corners.length; i += 2) {
        const side = view.up ? -corners[i + 1] : corners[i + 1];
        const x = this.x[k] + cos * corners[i] - sin * side;
        const y = this.y[k] + sin * corners[i] + cos * side;
        if (i === 0) context.moveTo(x, y);
        else context.lineTo(x, y);
      }
      context.closePath();
    }
    context.strokeStyle = palette.mark;
    context.lineWidth = 1.5;
    context.stroke();
  }

  private drawHeadings(context: Context, frame: Frame, view: View, palette: Palette): void {
    const driving = this.groups[Phase.DRIVING];
    const drives = new Set(driving);
    context.beginPath();
    for (const k of driving) {
      const [vx, vy] = [frame.vx[k] * view.scale * velocityAhead, frame.vy[k] * view.scale * velocityAhead];
      context.moveTo(this.x[k], this.y[k]);
      context.lineTo(this.x[k] + vx, this.y[k] + (view.up ? -vy : vy));
    }
    context.strokeStyle = palette.phases[Phase.DRIVING];
    context.lineWidth = 1.5;
    context.stroke();
    context.beginPath();
    for (const k of this.seen) {
      const turns = Number.isFinite(frame.yaw?.[k] ?? NaN);  // others face where they drive
      if (this.size[k] < signSize || !(turns || drives.has(k))) continue;
      const [cos, sin] = [Math.cos(this.heading[k]), Math.sin(this.heading[k])];
      context.moveTo(this.x[k], this.y[k]);
      context.lineTo(this.x[k] + cos * this.size[k], this.y[k] + sin * this.size[k]);
    }
    context.strokeStyle = palette.mark;
    context.lineWidth = driving.length > 0 ? markWidth(this.size[driving[0]]) : 1;
    context.stroke();
  }

  /// A ring around robots in a joint plan: dashed while they wait for it, solid while they execute it.
  private drawStages(context: Context, frame: Frame, palette: Palette): void {
    for (const stage of [Stage.WAITING, Stage.EXECUTING]) {
      const robots = this.seen.filter((k) => frame.stage![k] === stage);
      if (robots.length === 0) continue;
      this.discs(context, robots, stageRing);
      context.setLineDash(stage === Stage.WAITING ? [3, 4] : []);
      context.strokeStyle = palette.waits;
      context.lineWidth = 1.25;
      context.stroke();
      context.setLineDash([]);
    }
  }

  /// The way that a robot has promised, and then its stopping distance, as wide as the robot.
  private drawReservations(context: Context, robots: readonly Robot[], frame: Frame, view: View, palette: Palette): void {
    const byWidth = new Map<number, number[]>();
    for (const k of this.seen) {
      const width = 2 * this.size[k];
      const group = byWidth.get(width);
      if (group) group.push(k);
      else byWidth.set(width, [k]);
    }
    context.strokeStyle = palette.reserved;
    for (const [width, group] of byWidth) {
      context.lineWidth = width;
      context.beginPath();
      for (const k of group) this.traceReservation(context, robots[k], frame, k, view);
      context.stroke();
    }
  }

  private traceReservation(context: Context, robot: Robot, frame: Frame, k: number, view: View): void {
    const rest = Math.max(0, frame.expiry[k] - frame.decision_time[k]);
    const speed = Math.hypot(frame.next_vx[k], frame.next_vy[k]);
    const ahead = frame.decision_time[k] > 0 ? frame.decision_time[k] : 0;
    const seconds = rest + (speed > 0 ? stoppingDistance(speed, robot.max_acceleration) / speed : 0);
    const [dx, dy] = [frame.vx[k] * ahead, frame.vy[k] * ahead];
    const [ex, ey] = [dx + frame.next_vx[k] * seconds, dy + frame.next_vy[k] * seconds];
    if (!(Math.abs(ex) + Math.abs(ey) > 0) || !Number.isFinite(ex + ey)) return;
    const up = view.up ? -view.scale : view.scale;
    context.moveTo(this.x[k], this.y[k]);
    context.lineTo(this.x[k] + dx * view.scale, this.y[k] + dy * up);
    context.lineTo(this.x[k] + ex * view.scale, this.y[k] + ey * up);
  }

  private drawNear(context: Context, robots: readonly Robot[], frame: Frame, palette: Palette): void {
    if (this.pairsOf !== frame) {
      this.pairs = nearPairs(robots, frame);
      this.pairsOf = frame;
    }
    context.beginPath();
    for (let i = 0; i < this.pairs.length; i += 2) {
      const [a, b] = [this.pairs[i], this.pairs[i + 1]];
      context.moveTo(this.x[a], this.y[a]);
      context.lineTo(this.x[b], this.y[b]);
    }
    context.strokeStyle = palette.near;
    context.lineWidth = 1.5;
    context.stroke();
  }

  /// An arrow to the robot that goes first, from edge to edge.
  private drawWaits(context: Context, frame: Frame, palette: Palette): void {
    context.beginPath();
    for (let k = 0; k < this.x.length; ++k) {
      const other = frame.waits_for[k];
      if (other < 0 || other >= this.x.length || other === k) continue;
      const [dx, dy] = [this.x[other] - this.x[k], this.y[other] - this.y[k]];
      const length = Math.hypot(dx, dy);
      if (!(length > 0)) continue;
      const [ux, uy] = [dx / length, dy / length];
      const tip = Math.max(length - this.size[other], length / 2);
      const [tx, ty] = [this.x[k] + ux * tip, this.y[k] + uy * tip];
      const barb = Math.min(Math.max(4, Math.min(8, this.size[k])), 0.6 * tip);
      context.moveTo(this.x[k], this.y[k]);
      context.lineTo(tx, ty);
      context.moveTo(tx - barb * (ux - 0.5 * uy), ty - barb * (uy + 0.5 * ux));
      context.lineTo(tx, ty);
      context.lineTo(tx - barb * (ux + 0.5 * uy), ty - barb * (uy - 0.5 * ux));
    }
    context.strokeStyle = palette.waits;
    context.lineWidth = 1.75;
    context.stroke();
  }

  private drawMarked(context: Context, {selected, hovered}: Marked, palette: Palette): void {
    for (const k of new Set([hovered, selected])) {
      if (k < 0 || k >= this.x.length || this.x[k] !== this.x[k]) continue;
      context.beginPath();
      context.arc(this.x[k], this.y[k], this.size[k] + 4, 0, circle);
      context.strokeStyle = palette.selected;
      context.lineWidth = k === selected ? 2.5 : 1.25;
      context.stroke();
    }
  }

  /// Names find places where they cover neither robots nor each other. Of robots that stand close, some show none until the
  /// map is zoomed in.
  private drawNames(context: Context, robots: readonly Robot[], view: View, layers: Layers, {selected, hovered}: Marked, palette: Palette): void {
    const isMarked = (k: number) => k === selected || k === hovered;
    const wanted = layers.names ? [...this.seen].sort((a, b) => Number(isMarked(b)) - Number(isMarked(a)) || a - b) : this.seen.filter(isMarked);
    this.named = [];
    if (wanted.length === 0) return;
    context.font = '500 11px ui-sans-serif, system-ui, "DejaVu Sans", sans-serif';
    context.textAlign = 'left';
    context.fillStyle = palette.text;
    context.strokeStyle = palette.halo;
    context.lineWidth = 4;
    const body = (k: number) => ({x: this.x[k], y: this.y[k], size: this.size[k] * (isMarked(k) ? stageRing + 0.2 : 1)});
    const places = this.labels.place(wanted, this.seen, (k) => robots[k].name, body, (text) => context.measureText(text).width, isMarked, view);
    for (const {robot, x, y} of places) {
      if (isMarked(robot)) context.strokeText(robots[robot].name, x, y);
      context.fillText(robots[robot].name, x, y);
      this.named.push(robot);
    }
  }
}

/// Between two frames, the shorter way round; NaN: the robot has none.
function yawOf(before: Frame, after: Frame, k: number, share: number): number {
  const yaw = after.yaw?.[k] ?? NaN;
  const earlier = before.yaw?.[k] ?? NaN;
  if (earlier !== earlier) return yaw;
  const change = yaw - earlier;
  return earlier + share * (change - circle * Math.round(change / circle));
}

/// Line width of marks on robots. The first of the robots drawn together decides, as their sizes seldom differ.
function markWidth(size: number): number {
  return Math.max(1, Math.min(2.5, size * 0.28));
}
