// The background on the page: an image somewhat larger than the view, drawn by a worker. While the user pans or zooms,
// the last image is moved and scaled. A new one is requested when it no longer fits, or when its content has changed.
import BackgroundWorker from './background_worker.ts?worker';
import type {Drawn, DrawRequest} from './background_worker.ts';
import type {SceneChange} from './fleet.ts';
import type {Layers} from './layers.ts';
import type {Palette} from './palette.ts';
import {type View, toPageX, toPageY} from './view.ts';

const margin = 0.2;      // of the view's size, on each side
const leastPause = 150;  // milliseconds between two images for changes of the fleet
const idleShare = 2;     // the pause is at least this many times the drawing time

export class Background {
  private readonly worker = new BackgroundWorker();
  private drawn: Drawn | undefined;
  private drawing = false;
  private changed = true;
  private urgent = true;
  private asked = 0;  // milliseconds
  private took = 0;

  constructor(private readonly onDrawn: () => void) {
    this.worker.onmessage = ({data}: MessageEvent<Drawn>) => {
      this.drawn?.image.close();
      this.drawn = data;
      this.drawing = false;
      this.took = performance.now() - this.asked;
      this.onDrawn();
    };
  }

  on(changes: SceneChange[]): void {
    if (changes.length === 0) return;
    this.worker.postMessage(changes);
    this.changed = true;
  }

  /// Layers or colours have changed: draw as soon as possible.
  invalidate(): void {
    this.changed = this.urgent = true;
  }

  /// Requests another image if one is due.
  keep(view: View, pixelRatio: number, layers: Layers, palette: Palette, selected: number, now: number): void {
    const due = !this.covers(view) || (this.changed && (this.urgent || now - this.asked > Math.max(leastPause, (1 + idleShare) * this.took)));
    if (this.drawing || !due) return;
    this.drawing = true;
    this.changed = this.urgent = false;
    this.asked = now;
    this.worker.postMessage({what: 'draw', view: larger(view), pixelRatio, layers, palette, selected} satisfies DrawRequest);
  }

  blit(context: CanvasRenderingContext2D, view: View, pixelRatio: number, palette: Palette): void {
    const place = this.drawn && placeOf(this.drawn.view, view);
    if (!place || !contains(place, view)) {
      context.fillStyle = palette.ground;
      context.fillRect(0, 0, view.width, view.height);
    }
    if (!this.drawn || !place) return;
    if (this.drawn.view.scale === view.scale) {  // pixel by pixel: fast, and sharp
      const left = Math.round(place.left * pixelRatio) / pixelRatio;
      const top = Math.round(place.top * pixelRatio) / pixelRatio;
      context.imageSmoothingEnabled = false;
      context.drawImage(this.drawn.image, left, top, this.drawn.image.width / pixelRatio, this.drawn.image.height / pixelRatio);
    } else {
      context.imageSmoothingEnabled = true;
      context.drawImage(this.drawn.image, place.left, place.top, place.width, place.height);
    }
  }

  private covers(view: View): boolean {
    if (!this.drawn || this.drawn.view.scale !== view.scale || this.drawn.view.up !== view.up) return false;
    const {width, height} = larger(view);
    return this.drawn.view.width === width && this.drawn.view.height === height && contains(placeOf(this.drawn.view, view), view);
  }
}

function larger(view: View): View {
  const grown = (size: number) => Math.ceil(size * (1 + 2 * margin));
  return {...view, width: grown(view.width), height: grown(view.height)};
}

interface Place {
  left: number;
  top: number;
  width: number;
  height: number;
}

/// The position on the page of an image that was drawn for another view.
function placeOf(image: View, view: View): Place {
  const scale = view.scale / image.scale;
  const width = image.width * scale;
  const height = image.height * scale;
  return {left: toPageX(view, image.x) - width / 2, top: toPageY(view, image.y) - height / 2, width, height};
}

function contains(place: Place, view: View): boolean {
  return place.left <= 0.5 && place.top <= 0.5 &&
    place.left + place.width >= view.width - 0.5 && place.top + place.height >= view.height - 0.5;
}
