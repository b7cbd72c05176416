// The names of phases and stages. Each phase has its own colour and sign (robots_layer.ts, index.html).
import {Phase} from './live.js';

/// What the page shows instead of the last phase of a robot that is not heard any more.
export const lost = 8;
export type Shown = Phase | typeof lost;

export const phaseNames: Readonly<Record<Shown, string>> = {
  [Phase.WAITING]: 'waiting',
  [Phase.PLANNING]: 'planning',
  [Phase.DRIVING]: 'driving',
  [Phase.ARRIVED]: 'arrived',
  [Phase.NO_PATH]: 'no path',
  [Phase.STOPPED]: 'stopped',
  [Phase.GAVE_UP]: 'gave up',
  [Phase.HALTED]: 'halted',
  [lost]: 'silent',
};

/// The order of phases in a table: robots that need attention come first.
export const phaseOrder: Readonly<Record<Shown, number>> = {
  [lost]: -1,
  [Phase.NO_PATH]: 0,
  [Phase.GAVE_UP]: 0,
  [Phase.HALTED]: 0,
  [Phase.WAITING]: 1,
  [Phase.PLANNING]: 2,
  [Phase.DRIVING]: 3,
  [Phase.ARRIVED]: 4,
  [Phase.STOPPED]: 5,
};

const phaseCount = 8;        // that robots report
export const shownCount = 9;  // with `lost`

export enum Stage {
  FREE = 0,
  WAITING = 1,
  EXECUTING = 2,
}

export const stageNames: Readonly<Record<Stage, string>> = {
  [Stage.FREE]: 'drives by itself',
  [Stage.WAITING]: 'waiting for a joint plan',
  [Stage.EXECUTING]: 'executing a joint plan',
};

export function asPhase(byte: number): Phase {
  return (byte < phaseCount ? byte : Phase.WAITING) as Phase;
}

/// The robot stands and wants to go nowhere, though it has not arrived.
export function hasNoWay(phase: Shown): boolean {
  return phase === Phase.NO_PATH || phase === Phase.GAVE_UP;
}
