// Draws the background in a worker: a large forest takes long, and the robots must keep moving meanwhile.
import {BackgroundScene} from './background_scene.ts';
import type {SceneChange} from './fleet.ts';
import type {Layers} from './layers.ts';
import type {Palette} from './palette.ts';
import type {View} from './view.ts';

export interface DrawRequest {
  what: 'draw';
  view: View;
  pixelRatio: number;
  layers: Layers;
  palette: Palette;
  selected: number;
}

export interface Drawn {
  image: ImageBitmap;
  view: View;
}

declare const self: DedicatedWorkerGlobalScope;

const scene = new BackgroundScene();
const canvas = new OffscreenCanvas(1, 1);

function draw({view, pixelRatio, layers, palette, selected}: DrawRequest): Drawn {
  canvas.width = Math.max(1, Math.round(view.width * pixelRatio));
  canvas.height = Math.max(1, Math.round(view.height * pixelRatio));
  const context = canvas.getContext('2d', {alpha: false}) as OffscreenCanvasRenderingContext2D;
  context.setTransform(canvas.width / view.width, 0, 0, canvas.height / view.height, 0, 0);
  scene.draw(context, view, layers, palette, selected);
  return {image: canvas.transferToImageBitmap(), view};
}

self.onmessage = ({data}: MessageEvent<DrawRequest | SceneChange[]>) => {
  if (Array.isArray(data)) {
    for (const change of data) scene.on(change);
  } else {
    const drawn = draw(data);
    self.postMessage(drawn, [drawn.image]);
  }
};
