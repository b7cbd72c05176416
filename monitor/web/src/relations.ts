// What robots have to do with each other, by a frame: who is near whom.
import type {Robot} from './fleet.ts';
import type {Frame} from './live.js';

/// Metres that a robot needs to come to a stand: v^2 / 2a.
export function stoppingDistance(speed: number, maxAcceleration: number): number {
  return maxAcceleration > 0 ? (speed * speed) / (2 * maxAcceleration) : 0;
}

/// Pairs so near that one must heed the other: the gap between them is below the sum of both stopping distances and of
/// half of either radius. Indices of robots, two a pair. By a sweep from left to right.
export function nearPairs(robots: readonly Robot[], frame: Frame): number[] {
  const reach: number[] = [];  // from a robot's centre, so that circles of these radii meet
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
