// Draws where robots are sent: the goals that the selected robot has yet to visit, in their order, and the goal that the
// pointer aims at.
import type {Draft, Point} from './aim.ts';
import {goalOf} from './aim.ts';
import type {Order} from './orders.ts';
import type {Palette} from './palette.ts';

type Context = CanvasRenderingContext2D;

const size = 9;           // pixels: radius of a goal
const leastArrow = 34;    // pixels
const barb = 9;
const circle = 2 * Math.PI;

/// The goals yet to visit; `toPage` gives pixels of a place in the map frame.
export function drawGoals(context: Context, from: Point | undefined, orders: readonly Order[], toPage: (at: Point) => Point, palette: Palette): void {
  const places = orders.flatMap(({goals, visited}) => goals.slice(visited).map(toPage));
  if (places.length === 0) return;
  context.beginPath();
  for (const {x, y} of from ? [from, ...places] : places) context.lineTo(x, y);
  context.setLineDash([2, 6]);
  context.strokeStyle = palette.selected;
  context.lineWidth = 1.5;
  context.stroke();
  context.setLineDash([]);
  context.font = '600 11px ui-sans-serif, system-ui, "DejaVu Sans", sans-serif';
  context.textAlign = 'center';
  places.forEach(({x, y}, k) => {
    context.beginPath();
    context.arc(x, y, size, 0, circle);
    context.fillStyle = palette.selected;
    context.fill();
    context.fillStyle = palette.mark;
    context.fillText(String(k + 1), x, y + 4);
  });
}

export function drawDraft(context: Context, draft: Draft, palette: Palette): void {
  const {from: {x, y}, to} = draft;
  context.beginPath();
  context.arc(x, y, size, 0, circle);
  context.moveTo(x - 2 * size, y);
  context.lineTo(x + 2 * size, y);
  context.moveTo(x, y - 2 * size);
  context.lineTo(x, y + 2 * size);
  if (goalOf(draft).yaw !== undefined) {
    const angle = Math.atan2(to.y - y, to.x - x);
    const length = Math.max(leastArrow, Math.hypot(to.x - x, to.y - y));
    const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    const [tx, ty] = [x + length * cos, y + length * sin];
    context.moveTo(x, y);
    context.lineTo(tx, ty);
    context.moveTo(tx - barb * (cos - 0.6 * sin), ty - barb * (sin + 0.6 * cos));
    context.lineTo(tx, ty);
    context.lineTo(tx - barb * (cos + 0.6 * sin), ty - barb * (sin - 0.6 * cos));
  }
  for (const [colour, width] of [[palette.halo, 6], [palette.aim, 3]] as const) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.stroke();
  }
}
