// The line at the top, and what stands on the map while there is nothing to see.
import type {ConnectionState} from './connection.ts';
import {byId, setText} from './dom.ts';
import type {Fleet} from './fleet.ts';
import {clock, metres} from './format.ts';

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

  constructor(private readonly fleet: Fleet) {}

  update(state: ConnectionState, frozen: boolean, shownTime: number | undefined): void {
    const {fleet} = this;
    this.showConnection(state, frozen);
    this.showNotice(state);
    setText(this.source, fleet.begin?.source ?? '');
    setText(this.time, shownTime === undefined ? '–' : `${clock(shownTime)}.${Math.floor((Math.abs(shownTime) % 1) * 10)}`);
    const last = fleet.figures.at(-1);
    setText(this.robots, fleet.roster.length > 0 ? String(fleet.roster.length) : '–');
    setText(this.arrived, last ? `${last.arrived} / ${last.robots}` : '–');
    setText(this.separation, metres(separationOf(fleet)));
  }

  private showConnection(state: ConnectionState, frozen: boolean): void {
    const kind = state.kind !== 'open' ? state.kind : this.fleet.begin?.recorded ? 'recording' : frozen ? 'held' : 'live';
    const words = state.kind === 'lost' ? `lost: again in ${secondsUntil(state.retryAt)} s` : kind;
    setText(this.pill, words);
    if (kind === this.kind) return;
    this.kind = kind;
    this.pill.className = `pill ${kind}`;
    document.body.classList.toggle('lost', kind === 'lost');
    setText(this.announced, state.kind === 'lost' ? `Connection lost: ${state.why}` : kind);
  }

  private showNotice(state: ConnectionState): void {
    const {fleet} = this;
    const [title, text] =
      state.kind === 'lost' ? ['Connection lost', `${state.why}; trying again in ${secondsUntil(state.retryAt)} s`]
      : state.kind === 'connecting' && !fleet.map ? ['Connecting', 'to the monitor']
      : !fleet.begin ? ['Connected', 'the monitor has not said anything yet']
      : !fleet.map ? ['No fleet yet', `nobody has published a map on ${fleet.begin.source || 'this bus'}`]
      : fleet.roster.length === 0 ? ['A map, and no robots yet', 'robots show as soon as their missions or states are heard']
      : ['', ''];
    this.notice.hidden = title === '';
    this.notice.classList.toggle('over-map', fleet.map !== undefined);
    setText(this.noticeTitle, title);
    setText(this.noticeText, text);
  }
}

function secondsUntil(at: number): number {
  return Math.max(0, Math.ceil((at - performance.now()) / 1000));
}
