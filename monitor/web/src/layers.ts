// What can be shown on the map or left out.

export const layerNames = ['trees', 'roots', 'paths', 'ends', 'near', 'waits', 'reserved', 'names'] as const;
export type Layer = (typeof layerNames)[number];
export type Layers = Record<Layer, boolean>;

export const allLayers: Readonly<Layers> = {
  trees: true, roots: true, paths: true, ends: true, near: true, waits: true, reserved: true, names: true,
};
