// The map on the page: its visible part, and the loop that draws it.
import {Background} from './background.ts';
import type {Fleet, SceneChange} from './fleet.ts';
import {type Layers, allLayers} from './layers.ts';
import {type Palette, readPalette} from './palette.ts';
import type {Playhead, Shown} from './playhead.ts';
import {RobotsLayer} from './robots_layer.ts';
import {type View, filled, fitted, panned, toMap, toPageX, toPageY, within, zoomed} from './view.ts';

export class MapView {
  layers: Layers = {...allLayers};
  selected = -1;
  hovered = -1;
  following = false;
  drawn = 0;  // frames
  readonly robots = new RobotsLayer();
  above: ((context: CanvasRenderingContext2D, view: View, palette: Palette) => void) | undefined;  // draws above the robots
  private view: View | undefined;
  private fits = true;  // also fits again when the page's size changes
  private mapFrame = '';  // identifies the map of the view
  private shown: Shown | undefined;
  private stale = true;
  private palette: Palette = readPalette();
  private pixelRatio = 1;
  private last = 0;
  private recent: number[] = [];  // times of the frames in the last second
  private readonly background: Background;
  private readonly context: CanvasRenderingContext2D;

  constructor(
    readonly canvas: HTMLCanvasElement,
    private readonly fleet: Fleet,
    private readonly playhead: Playhead,
    private readonly isFrozen: () => boolean,
  ) {
    this.context = canvas.getContext('2d', {alpha: false})!;
    this.background = new Background(() => (this.stale = true));
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
    requestAnimationFrame((now) => this.tick(now));
  }

  get time(): number | undefined {
    return this.shown?.time;
  }
  get scale(): number | undefined {
    return this.view?.scale;
  }
  /// Pixels of the canvas.
  get origin(): {x: number; y: number} | undefined {
    return this.view && {x: toPageX(this.view, 0), y: toPageY(this.view, 0)};
  }
  /// The place in the map frame that is under a pixel of the canvas. Without a map there is none.
  placeAt(pageX: number, pageY: number): {x: number; y: number} | undefined {
    const {map} = this.fleet;
    if (!this.view || !map) return undefined;
    const {x, y} = toMap(this.view, pageX, pageY);
    return {x: map.origin_x + x, y: map.origin_y + y};
  }
  get up(): boolean {
    return this.view?.up ?? true;
  }
  fps(now: number): number {
    return this.recent.filter((at) => now - at < 1000).length;
  }

  change(changes: SceneChange[]): void {
    this.background.on(changes);
    for (const {what} of changes) {
      if (what === 'forget') this.forget();
      else if (what === 'map') this.takeMap();
    }
    if (changes.length > 0) this.stale = true;
  }

  /// Call it when something has changed that is drawn and no part of the fleet.
  restyle(): void {
    this.palette = readPalette();
    this.background.invalidate();
    this.stale = true;
  }

  touch(): void {
    this.stale = true;
  }

  fit(): void {
    this.fits = true;
    this.following = false;
    if (this.fleet.map) this.view = fitted(this.fleet.map, this.canvas.clientWidth, this.canvas.clientHeight);
    this.stale = true;
  }

  pan(dx: number, dy: number): void {
    this.following = false;
    this.move((view) => panned(view, dx, dy));
  }

  zoom(factor: number, pageX = this.canvas.clientWidth / 2, pageY = this.canvas.clientHeight / 2): void {
    this.move((view) => zoomed(view, factor, pageX, pageY));
  }

  select(robot: number): void {
    if (robot !== this.selected) this.background.invalidate();
    this.selected = robot;
    if (robot < 0) this.following = false;
    this.stale = true;
  }

  /// Moves a robot near the middle, large enough to be visible. The view does not extend beyond the map.
  centre(robot: number): void {
    const frame = this.shown?.after;
    const {map, roster} = this.fleet;
    if (!frame || !map || !(robot in roster) || !Number.isFinite(frame.x[robot])) return;
    const legible = 8 / Math.max(roster[robot].radius, 1e-6);  // pixels a metre
    const at = {x: frame.x[robot], y: frame.y[robot]};
    this.move((view) => filled(within({...view, ...at, scale: Math.max(view.scale, legible)}, map), map));
  }

  private move(change: (view: View) => View): void {
    if (!this.view || !this.fleet.map) return;
    this.view = within(change(this.view), this.fleet.map);
    this.fits = false;
    this.stale = true;
  }

  private forget(): void {
    this.robots.clear();
    this.shown = undefined;
    this.selected = this.hovered = -1;
    this.following = false;
  }

  /// After a jump back, a recording sends the same map again. The view then stays.
  private takeMap(): void {
    const {occupancy: _, ...frame} = this.fleet.map!;
    const mapFrame = JSON.stringify(frame);
    if (mapFrame !== this.mapFrame) this.fit();
    this.mapFrame = mapFrame;
  }

  private resize(): void {
    this.pixelRatio = devicePixelRatio;
    const {clientWidth: width, clientHeight: height} = this.canvas;
    this.canvas.width = Math.max(1, Math.round(width * this.pixelRatio));
    this.canvas.height = Math.max(1, Math.round(height * this.pixelRatio));
    if (this.fits) this.fit();
    else if (this.view) this.view = {...this.view, width, height};
    this.background.invalidate();
    this.stale = true;
  }

  private tick(now: number): void {
    requestAnimationFrame((next) => this.tick(next));
    const elapsed = Math.min(1, Math.max(0, (now - this.last) / 1000));
    this.last = now;
    if (!this.isFrozen()) this.advance(now / 1000, elapsed);
    if (this.view) this.background.keep(this.view, this.pixelRatio, this.layers, this.palette, this.selected, now);
    if (!this.stale) return;
    this.stale = false;
    this.draw();
    ++this.drawn;
    this.recent = this.recent.filter((at) => now - at < 1000);
    this.recent.push(now);
  }

  private advance(now: number, elapsed: number): void {
    const before = this.shown?.time;
    this.shown = this.playhead.advance(now, elapsed);
    if (this.shown?.time !== before) this.stale = true;
  }

  private follow(): void {
    const robot = this.selected;
    if (!this.following || !this.shown || !this.view || !this.fleet.map) return;
    const {before, after, share} = this.shown;
    const [x0, y0] = [before.x[robot] ?? after.x[robot], before.y[robot] ?? after.y[robot]];
    const [x, y] = [x0 + (after.x[robot] - x0) * share, y0 + (after.y[robot] - y0) * share];
    if (Number.isFinite(x) && Number.isFinite(y)) this.view = filled({...this.view, x, y}, this.fleet.map);
  }

  private draw(): void {
    const {context} = this;
    context.setTransform(this.pixelRatio, 0, 0, this.pixelRatio, 0, 0);
    if (!this.view) {
      context.fillStyle = this.palette.ground;
      context.fillRect(0, 0, this.canvas.clientWidth, this.canvas.clientHeight);
      return;
    }
    this.follow();
    this.background.blit(context, this.view, this.pixelRatio, this.palette);
    if (!this.shown) return;
    this.robots.place(this.fleet, this.shown, this.view);
    this.robots.draw(context, this.fleet.roster, this.shown.after, this.view, this.layers, this, this.palette);
    this.above?.(context, this.view, this.palette);
  }
}
