// Mouse, touch and pen on the map: drag pans, wheel and pinch zoom, a click or tap selects a robot. While a press shall
// send a robot (aim.ts), the first finger or the main button aims instead.
import type {MapView} from './map_view.ts';

const clickSlack = 5;    // pixels that a click may move
const mouseSlack = 10;   // pixels beside a robot that still hit it
const touchSlack = 24;
const wheelStep = 0.0015;

interface Pointer {
  x: number;
  y: number;
}

export interface Aim {
  begin(at: Pointer): boolean;  // whether the press aims
  move(to: Pointer): void;
  drop(queue: boolean): void;   // let go on the map
  leave(): void;                // it was meant otherwise
}

export function listen(map: MapView, onPick: (robot: number) => void, aim: Aim): void {
  const {canvas} = map;
  const pointers = new Map<number, Pointer>();
  let travelled = 0;
  let pinched = false;
  let aiming = false;

  const place = (event: MouseEvent): Pointer => ({x: event.offsetX, y: event.offsetY});
  const robotAt = ({x, y}: Pointer, event: PointerEvent) =>
    map.robots.at(x, y, event.pointerType === 'mouse' ? mouseSlack : touchSlack);

  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    if (pointers.size === 0) {
      travelled = 0;
      pinched = false;
      aiming = event.button === 0 && aim.begin(place(event));
    } else if (aiming) {
      aiming = false;
      aim.leave();
    }
    pointers.set(event.pointerId, place(event));
  });

  canvas.addEventListener('pointermove', (event) => {
    const now = place(event);
    const before = pointers.get(event.pointerId);
    if (!before) return hover(robotAt(now, event));
    const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1];
    pointers.set(event.pointerId, now);
    if (other) {
      pinched = true;
      pinch(before, now, other);
      return;
    }
    travelled += Math.hypot(now.x - before.x, now.y - before.y);
    if (aiming) aim.move(now);
    else if (travelled > clickSlack) map.pan(now.x - before.x, now.y - before.y);
  });

  const release = (event: PointerEvent) => {
    const held = pointers.delete(event.pointerId);
    const at = place(event);
    const clicked = held && event.type === 'pointerup' && !pinched && travelled <= clickSlack;
    const robot = clicked ? robotAt(at, event) : -1;
    if (!held || !aiming) {
      if (clicked) onPick(robot);
      return;
    }
    aiming = false;
    const drops = event.type === 'pointerup' && robot < 0 && isWithin(canvas, at);
    if (drops) aim.drop(event.shiftKey);
    else aim.leave();
    if (robot >= 0) onPick(robot);
  };
  canvas.addEventListener('pointerup', release);
  canvas.addEventListener('pointercancel', release);
  canvas.addEventListener('pointerleave', () => hover(-1));
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    const pixels = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? event.deltaY * 16 : event.deltaY;
    map.zoom(Math.exp(-wheelStep * Math.max(-400, Math.min(400, pixels))), event.offsetX, event.offsetY);
  }, {passive: false});

  function hover(robot: number): void {
    if (robot === map.hovered) return;
    map.hovered = robot;
    canvas.classList.toggle('on-robot', robot >= 0);
    map.touch();
  }

  function pinch(before: Pointer, now: Pointer, other: Pointer): void {
    const factor = Math.hypot(now.x - other.x, now.y - other.y) / Math.max(1, Math.hypot(before.x - other.x, before.y - other.y));
    map.zoom(factor, (now.x + other.x) / 2, (now.y + other.y) / 2);
    map.pan((now.x - before.x) / 2, (now.y - before.y) / 2);
  }
}

function isWithin({clientWidth, clientHeight}: HTMLElement, {x, y}: Pointer): boolean {
  return x >= 0 && y >= 0 && x < clientWidth && y < clientHeight;
}
