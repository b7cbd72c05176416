// The positions of robots between two frames. The shown time follows the newest frame at a short, even distance, so
// that uneven arrival does not cause uneven motion.
import type {Frame} from './live.js';

const kept = 16;               // frames
const lag = 1.5;               // intervals between frames by which the shown time is behind the newest
const longestLag = 0.3;        // wall seconds
const correction = 4;          // share of the deviation that is corrected per second
const jump = 1;                // wall seconds: with a larger deviation, the time jumps
const silence = 1;             // wall seconds after which the rate is measured anew

export interface Shown {
  before: Frame;
  after: Frame;
  share: number;  // of the way from `before` to `after`
  time: number;
}

export class Playhead {
  private frames: {frame: Frame; came: number}[] = [];
  private at = NaN;

  /// `now` in seconds.
  on(frame: Frame, now: number): void {
    const newest = this.frames.at(-1);
    if (newest && (frame.time < newest.frame.time || now - newest.came > silence)) this.clear();
    if (this.frames.at(-1)?.frame.time === frame.time) this.frames.pop();
    this.frames.push({frame, came: now});
    if (this.frames.length > kept) this.frames.shift();
  }

  clear(): void {
    this.frames = [];
    this.at = NaN;
  }

  /// `elapsed`: seconds since the last call.
  advance(now: number, elapsed: number): Shown | undefined {
    const first = this.frames[0];
    const last = this.frames.at(-1);
    if (!first || !last) return undefined;
    const intervals = this.frames.length - 1;
    const span = last.came - first.came;
    const rate = span > 0 ? (last.frame.time - first.frame.time) / span : 0;
    const distance = intervals > 0 ? Math.min(longestLag, (lag * span) / intervals) : 0;
    const target = last.frame.time + (now - last.came - distance) * rate;
    this.at += elapsed * rate;
    if (!(Math.abs(target - this.at) <= jump * rate)) this.at = target;
    this.at += (target - this.at) * Math.min(1, correction * elapsed);
    this.at = Math.max(first.frame.time, Math.min(last.frame.time, this.at));
    return this.between();
  }

  private between(): Shown {
    let k = this.frames.length - 1;
    while (k > 0 && this.frames[k - 1].frame.time >= this.at) --k;
    const after = this.frames[k].frame;
    const before = k > 0 ? this.frames[k - 1].frame : after;
    const step = after.time - before.time;
    return {before, after, share: step > 0 ? (this.at - before.time) / step : 1, time: this.at};
  }
}
