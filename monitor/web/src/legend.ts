// The panel of the map's layers: a sign and a switch for each.
import {byId} from './dom.ts';
import {type Layer, type Layers, layerNames} from './layers.ts';

export class Legend {
  private readonly boxes = new Map<Layer, HTMLInputElement>();

  constructor(private readonly layers: Layers, private readonly onChange: () => void) {
    for (const layer of layerNames) {
      const box = byId<HTMLInputElement>(`layer-${layer}`);
      box.checked = layers[layer];
      box.addEventListener('change', () => this.set(layer, box.checked));
      this.boxes.set(layer, box);
    }
  }

  toggle(place: number): void {
    const layer = layerNames[place];
    if (layer) this.set(layer, !this.layers[layer]);
  }

  private set(layer: Layer, on: boolean): void {
    this.layers[layer] = on;
    this.boxes.get(layer)!.checked = on;
    this.onChange();
  }
}
