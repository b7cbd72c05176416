// What a figure that looks bad means, and what to do about it. Each in a sentence that stands by itself.
import type {Fleet} from './fleet.ts';
import {fixed, percent} from './format.ts';
import {Phase} from './live.js';
import {asPhase} from './phases.ts';

const lateShare = 0.1;      // of the control periods of a second or two: one that is late now and then is no matter
const busyShare = 0.8;      // of one core, from which on the agent itself is what takes the time
const oldStates = 1;        // seconds
const silence = 1.5;        // seconds; robots that stand speak five times a second
const longWait = 10;        // seconds

/// Of late.
export function missedShare({statuses}: Fleet, robot: number): number | undefined {
  const status = statuses[robot];
  return status && status.periods > 0 ? status.missed_share : undefined;
}

/// Processor time was lacking: empty if it was not.
export function whyMissed(fleet: Fleet, robot: number): string {
  const share = missedShare(fleet, robot) ?? 0;
  if (share < lateShare) return '';
  const used = fleet.statuses[robot]?.processor_share ?? -1;
  const taken = used < 0 ? '' : used > busyShare ? `; it takes a whole core (${percent(used)})` : `; it got ${percent(used)} of a core, other processes had the rest`;
  return `Late for ${percent(share, 1)} of its last control periods, for lack of processor time${taken}. A robot that is late brakes. `
    + 'Fewer robots on this machine, more processors, or a smaller --time-scale help.';
}

export function whyOld({statuses}: Fleet, robot: number): string {
  const age = statuses[robot]?.state_age_p99 ?? 0;
  if (age < oldStates) return '';
  return `States of others were up to ${fixed(age, 1, 's')} old when it decided by them (99 of 100 were newer). `
    + 'It keeps clear of wherever those could have got to since, and so drives more slowly. Robots far away speak seldom, which is no fault.';
}

function whySilent({frame, life, begin}: Fleet, robot: number): string {
  const age = frame?.age[robot] ?? 0;
  const goes = frame && asPhase(frame.phase![robot]) !== Phase.STOPPED && asPhase(frame.phase![robot]) !== Phase.ARRIVED;
  if (!goes || !(age > silence) || (begin?.recorded && !life)) return '';
  return `Nothing has been heard of it for ${fixed(age, 1, 's')}: its agent has ended, hangs, or cannot be reached.`;
}

function whyNoProgress({frame, roster}: Fleet, robot: number): string {
  const [waiting, idle] = [frame?.waiting[robot] ?? 0, frame?.idle[robot] ?? 0];
  const leader = roster[frame?.waits_for[robot] ?? -1]?.name;
  if (waiting > longWait) return `Has waited for ${fixed(waiting, 0, 's')}: ${leader ? `lets ${leader} go first` : 'stands until there is a joint plan'}.`;
  return idle > longWait ? `Has come no nearer to its goal for ${fixed(idle, 0, 's')}.` : '';
}

function whyRejected({statuses}: Fleet, robot: number): string {
  const rejected = statuses[robot]?.rejected ?? 0;
  return rejected > 0 ? `Dropped ${rejected} messages as invalid: its agent's log says which, and why.` : '';
}

/// All that is to be said of a robot now.
export function alarmsOf(fleet: Fleet, robot: number): string[] {
  const reason = fleet.statuses[robot]?.reason ?? '';
  return [reason && `${reason[0].toUpperCase()}${reason.slice(1)}.`, ...[whySilent, whyNoProgress, whyMissed, whyOld, whyRejected].map((why) => why(fleet, robot))]
    .filter((text) => text !== '');
}
