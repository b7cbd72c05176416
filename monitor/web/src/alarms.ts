// Explains a figure that looks bad, and its remedy. Each text can be understood by itself.
import type {Fleet} from './fleet.ts';
import {fixed, percent} from './format.ts';
import {Phase} from './live.js';

const lateShare = 0.1;      // of the control periods of a second or two: a single late period does not matter
const busyShare = 0.8;      // of one core: from here on the agent itself uses up the time
const oldStates = 1;        // seconds
const longWait = 10;        // seconds

/// The recent share of missed control periods.
export function missedShare({statuses}: Fleet, robot: number): number | undefined {
  const status = statuses[robot];
  return status && status.periods > 0 ? status.missed_share : undefined;
}

/// Explains a lack of processor time. Empty if there was none.
export function whyMissed(fleet: Fleet, robot: number): string {
  const share = missedShare(fleet, robot) ?? 0;
  if (share < lateShare) return '';
  const used = fleet.statuses[robot]?.processor_share ?? -1;
  const taken = used < 0 ? '' : used > busyShare ? `; its agent uses a whole core (${percent(used)})` : `; its agent got ${percent(used)} of a core, other processes the rest`;
  return `Late for ${percent(share, 1)} of its last control periods, for lack of processor time${taken}. A robot that is late brakes. `
    + 'Use fewer robots on this machine, more processors, or a smaller --time-scale.';
}

export function whyOld({statuses}: Fleet, robot: number): string {
  const age = statuses[robot]?.state_age_p99 ?? 0;
  if (age < oldStates) return '';
  return `States of other robots were up to ${fixed(age, 1, 's')} old when it used them (99 of 100 were newer). `
    + 'It avoids all positions that those robots can have reached since, and so drives more slowly. Old states of distant robots are normal: they send seldom.';
}

export function whySilent(fleet: Fleet, robot: number): string {
  const isLost = fleet.lost.has(robot);
  if (!isLost && !fleet.isOld(robot)) return '';
  return `Nothing has been heard from it for ${fixed(fleet.silenceOf(robot), 1, 's')}${isLost ? ': its agent has ended, hangs, or cannot be reached' : ''}.`;
}

function whyNoProgress(fleet: Fleet, robot: number): string {
  const idle = fleet.frame?.idle[robot] ?? 0;
  const wait = fleet.waitOf(robot);
  if (wait && wait.seconds > longWait) return `Has waited for ${fixed(wait.seconds, 0, 's')}: ${wait.cause}.`;
  const halted = fleet.frame?.phase?.[robot] === Phase.HALTED;
  return idle > longWait && !halted ? `Has come no nearer to its goal for ${fixed(idle, 0, 's')}.` : '';
}

function whyRejected({statuses}: Fleet, robot: number): string {
  const rejected = statuses[robot]?.rejected ?? 0;
  return rejected > 0 ? `Dropped ${rejected} messages as invalid: its agent's log lists them with the reasons.` : '';
}

/// If an agent gives the same text as its reason and as the cause of its wait, the wait says it.
function whyInItsWords({statuses}: Fleet, robot: number): string {
  const {reason, wait_cause} = statuses[robot] ?? {reason: '', wait_cause: ''};
  return reason && reason !== wait_cause ? `${reason[0].toUpperCase()}${reason.slice(1)}.` : '';
}

/// All alarms of a robot now.
export function alarmsOf(fleet: Fleet, robot: number): string[] {
  return [whyInItsWords, whySilent, whyNoProgress, whyMissed, whyOld, whyRejected].map((why) => why(fleet, robot)).filter((text) => text !== '');
}
