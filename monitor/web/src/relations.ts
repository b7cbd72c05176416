// Relations between robots in a frame: which ones are near each other.
import type {Robot} from './fleet.ts';
import type {Frame} from './live.js';

/// The distance in which a robot comes to a stand, metres: v^2 / 2a.
export function stoppingDistance(speed: number, maxAcceleration: number): number {
  return maxAcceleration > 0 ? (speed * speed) / (2 * maxAcceleration) : 0;
}

/// Pairs so near that they must avoid each other: the gap between them is less than the sum of both stopping distances
/// and of half of either radius. Returns indices of robots, two per pair. Sweeps from left to right.
export function nearPairs(robots: readonly Robot[], frame: Frame): number[] {
  const reach: number[] = [];  // radius of a circle around a robot; near robots have overlapping circles
  let longest = 0;
  const order: number[] = [];
  for (let k = 0; k < Math.min(robots.length, frame.x.length); ++k) {
    const {radius, max_acceleration} = robots[k];
    reach[k] = 1.5 * radius + stoppingDistance(Math.hypot(frame.vx[k], frame.vy[k]), max_acceleration);
    longest = Math.max(longest, reach[k]);
    if (frame.x[k] === frame.x[k]) order.push(k);
  }
  order.sort((a, b) => frame.x[a] - frame.x[b]);
  const pairs: number[] = [];
  for (let i = 0; i < order.length; ++i) {
    const a = order[i];
    for (let j = i + 1; j < order.length; ++j) {
      const b = order[j];
      const dx = frame.x[b] - frame.x[a];
      if (dx > reach[a] + longest) break;
      const dy = frame.y[b] - frame.y[a];
      const sum = reach[a] + reach[b];
      if (dx * dx + dy * dy < sum * sum) pairs.push(a, b);
    }
  }
  return pairs;
}
