// The line at the top, and the notice on the map while there is nothing to see.
import type {ConnectionState} from './connection.ts';
import {byId, setText} from './dom.ts';
import type {Fleet} from './fleet.ts';
import {clock, fixed, metres, timeOfDay} from './format.ts';
import {LifeState} from './live.js';
import {lostAfter, oldAfter} from './silence.ts';

const separationOf = ({figures}: Fleet) => {
  const last = figures.at(-1);
  return last?._separation ? last.separation : undefined;
};

export class StatusLine {
  private readonly pill = byId('connection');
  private readonly notice = byId('notice');
  private readonly noticeTitle = byId('notice-title');
  private readonly noticeText = byId('notice-text');
  private readonly source = byId('source');
  private readonly time = byId('time');
  private readonly robots = byId('robots');
  private readonly arrived = byId('arrived');
  private readonly separation = byId('separation');
  private readonly announced = byId('announced');
  private kind = '';
  private age = Infinity;

  constructor(private readonly fleet: Fleet) {}

  /// `age`: seconds since the monitor was last heard.
  update(state: ConnectionState, age: number, frozen: boolean, shownTime: number | undefined): void {
    const {fleet} = this;
    this.age = age;
    this.showConnection(state, frozen);
    this.showNotice(state);
    setText(this.source, fleet.begin?.source ?? '');
    setText(this.time, shownTime === undefined ? '–' : `${clock(shownTime)}.${Math.floor((Math.abs(shownTime) % 1) * 10)}`);
    setText(this.robots, fleet.roster.length > 0 ? String(fleet.roster.length) : '–');
    setText(this.arrived, fleet.life ? `${fleet.life.arrived} / ${fleet.life.robots}` : '–');
    setText(this.separation, metres(separationOf(fleet)));
  }

  private showConnection(state: ConnectionState, frozen: boolean): void {
    const kind = this.kindOf(state, frozen);
    setText(this.pill, this.words(kind, state));
    if (kind === this.kind) return;
    this.kind = kind;
    this.pill.className = `pill ${kind}`;
    document.body.classList.toggle('lost', kind === 'lost');
    document.body.classList.toggle('old', kind === 'old');
    setText(this.announced, kind === 'lost' && state.kind === 'lost' ? `Connection lost: ${state.why}` : this.words(kind, state));
  }

  /// What the page shows is too old to act by.
  private get isOutdated(): boolean {
    return this.fleet.begin !== undefined && this.age > lostAfter;
  }

  /// The kind of badge. Live means that a fleet is heard now.
  private kindOf(state: ConnectionState, frozen: boolean): string {
    const {begin, life} = this.fleet;
    const ended = life?.state === LifeState.ENDED && !begin?.recorded;
    if (state.kind !== 'open') return ended ? 'ended' : this.isOutdated ? 'lost' : state.kind;
    if (this.isOutdated) return 'lost';
    if (this.age > oldAfter && begin) return 'old';
    if (begin?.recorded) return 'recording';
    if (frozen) return 'held';
    if (ended) return 'ended';
    if (life?.state === LifeState.SILENT) return 'silent';
    if (life?.state !== LifeState.ALIVE) return 'waiting';
    return life.replayed ? 'replay' : 'live';
  }

  private words(kind: string, state: ConnectionState): string {
    switch (kind) {
      case 'lost': return state.kind === 'lost' ? `lost: retry in ${secondsUntil(state.retryAt)} s` : `lost: nothing heard for ${seconds(this.age)}`;
      case 'old': return `${seconds(this.age)} old`;
      case 'ended': return 'run ended';
      case 'silent': return `fleet silent since ${timeOfDay(this.fleet.life!.heard)}`;
      case 'waiting': return 'waiting for a fleet';
      default: return kind;
    }
  }

  private showNotice(state: ConnectionState): void {
    const {fleet} = this;
    const ended = fleet.life?.state === LifeState.ENDED;
    const [title, text] =
      ended ? [`run ended: ${fleet.life!.arrived} of ${fleet.life!.robots} arrived`, state.kind === 'open' ? '' : 'the monitor has ended, too']
      : state.kind === 'lost' ? ['Connection lost', `${state.why}; next attempt in ${secondsUntil(state.retryAt)} s`]
      : this.isOutdated ? ['The monitor does not answer', `what is shown is ${seconds(this.age)} old`]
      : state.kind === 'connecting' && !fleet.map ? ['Connecting', 'to the monitor']
      : !fleet.begin ? ['Connected', 'waiting for the first message of the monitor']
      : !fleet.map ? ['No fleet yet', `no map has been received on ${fleet.begin.source || 'this bus'}`]
      : fleet.roster.length === 0 ? ['A map, but no robots yet', 'robots appear with their first mission or state']
      : fleet.life?.state === LifeState.SILENT && !fleet.begin.recorded ? ['No robot is heard any more', `last heard at ${timeOfDay(fleet.life.heard)}`]
      : ['', ''];
    this.notice.hidden = title === '';
    this.notice.classList.toggle('over-map', fleet.map !== undefined);
    setText(this.noticeTitle, title);
    setText(this.noticeText, text);
  }
}

function seconds(age: number): string {
  return fixed(age, age < 10 ? 1 : 0, 's');
}

function secondsUntil(at: number): number {
  return Math.max(0, Math.ceil((at - performance.now()) / 1000));
}
