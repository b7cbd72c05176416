// Pausing and continuing. A recording follows the page (play, pause, speed, seek). A live fleet does not: a pause holds
// back its messages, and "live" takes them all in and continues at the present.
import {byId, setText} from './dom.ts';
import type {Fleet} from './fleet.ts';
import {clock} from './format.ts';
import type {FromPage, ToPage} from './live.js';

const speeds = [0.25, 0.5, 1, 2, 4, 8, 16];
const seekPause = 100;         // milliseconds between two seeks while the handle is dragged
const heldMost = 50_000;       // messages; beyond that, continuing means to connect again
const skip = 5;                // seconds

export class TimeControl {
  private pausedAt: number | undefined;  // milliseconds: since when a live fleet is paused
  private held: ToPage[] = [];
  private heldFrame: ToPage | undefined;
  private overflowed = false;
  private seeking = false;
  private sought = 0;
  private readonly play = byId<HTMLButtonElement>('play');
  private readonly live = byId<HTMLButtonElement>('live');
  private readonly speed = byId<HTMLSelectElement>('speed');
  private readonly scrubber = byId<HTMLInputElement>('scrubber');
  private readonly at = byId('at');

  constructor(
    private readonly fleet: Fleet,
    private readonly send: (message: Partial<FromPage>) => void,
    private readonly take: (message: ToPage) => void,
    private readonly connectAnew: () => void,
  ) {
    for (const speed of speeds) this.speed.add(new Option(`${speed}×`, String(speed), speed === 1, speed === 1));
    this.play.addEventListener('click', () => this.toggle());
    this.live.addEventListener('click', () => this.goOn());
    this.speed.addEventListener('change', () => this.send({speed: Number(this.speed.value)}));
    this.scrubber.addEventListener('input', () => this.drag(false));
    this.scrubber.addEventListener('change', () => this.drag(true));
  }

  get recorded(): boolean {
    return this.fleet.begin?.recorded ?? false;
  }
  get frozen(): boolean {
    return this.pausedAt !== undefined;
  }
  get playing(): boolean {
    return this.recorded ? (this.fleet.playback?.playing ?? false) : !this.frozen;
  }

  /// Whether the message waits until the page continues.
  holdsBack(message: ToPage): boolean {
    if (!this.frozen) return false;
    if (message.begin) this.held = [];
    if (message.frame) this.heldFrame = message;
    else if (this.held.length < heldMost) this.held.push(message);
    else this.overflowed = true;
    return true;
  }

  /// A new connection begins: the messages that are held back are obsolete.
  reset(): void {
    this.pausedAt = undefined;
    this.held = [];
    this.heldFrame = undefined;
    this.overflowed = false;
    this.seeking = false;
  }

  toggle(): void {
    if (this.recorded) this.send({playing: !this.playing});
    else if (this.frozen) this.goOn();
    else this.pausedAt = performance.now();
    this.update();
  }

  skip(direction: number): void {
    const playback = this.fleet.playback;
    if (!this.recorded || !playback) return;
    this.send({seek: Math.max(playback.from, Math.min(playback.until, playback.at + direction * skip * playback.speed))});
  }

  faster(direction: number): void {
    const next = speeds[speeds.indexOf(Number(this.speed.value)) + direction];
    if (!this.recorded || next === undefined) return;
    this.speed.value = String(next);
    this.send({speed: next});
  }

  goOn(): void {
    const {held, heldFrame, overflowed} = this;
    this.reset();
    if (overflowed) return this.connectAnew();
    for (const message of held) this.take(message);
    if (heldFrame) this.take(heldFrame);
    this.update();
  }

  update(): void {
    const {recorded, playing} = this;
    const label = playing ? 'Pause' : 'Play';
    if (this.play.ariaLabel !== label) {
      this.play.ariaLabel = this.play.title = label;
      this.play.classList.toggle('paused', !playing);
    }
    document.body.classList.toggle('recorded', recorded);
    this.live.hidden = recorded || !this.frozen;
    this.play.disabled = !this.fleet.begin;
    if (recorded) this.updateRecorded();
    else setText(this.at, this.frozen ? `held for ${clock((performance.now() - this.pausedAt!) / 1000)}` : '');
  }

  private updateRecorded(): void {
    const playback = this.fleet.playback;
    if (!playback) return;
    const length = Math.max(0, playback.until - playback.from);
    const {scrubber} = this;
    if (Number(scrubber.max) !== length) scrubber.max = String(length);
    if (!this.seeking) scrubber.value = String(playback.at - playback.from);
    const at = clock(Number(scrubber.value));
    scrubber.setAttribute('aria-valuetext', `${at} of ${clock(length)}`);
    setText(this.at, `${at} / ${clock(length)}`);
    if (document.activeElement !== this.speed && speeds.includes(playback.speed)) this.speed.value = String(playback.speed);
  }

  private drag(last: boolean): void {
    const playback = this.fleet.playback;
    if (!playback) return;
    this.seeking = !last;
    const now = performance.now();
    if (!last && now - this.sought < seekPause) return;
    this.sought = now;
    this.send({seek: playback.from + Number(this.scrubber.value)});
    this.updateRecorded();
  }
}
