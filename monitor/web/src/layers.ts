// Contents of the map that can be shown or hidden.

export const layerNames = ['trees', 'roots', 'paths', 'ends', 'near', 'waits', 'reserved', 'names'] as const;
export type Layer = (typeof layerNames)[number];
export type Layers = Record<Layer, boolean>;

export const allLayers: Readonly<Layers> = {
  trees: true, roots: true, paths: true, ends: true, near: true, waits: true, reserved: true, names: true,
};
