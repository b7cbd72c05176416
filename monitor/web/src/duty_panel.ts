// What the selected robot has to do by its operators, and why it does not do it.
import {byId, setText} from './dom.ts';
import {clock} from './format.ts';
import type {Orders} from './orders.ts';

export class DutyPanel {
  private readonly panel = byId('duty');
  private readonly why = byId('duty-why');
  private readonly left = byId('duty-left');
  private readonly open = byId('duty-orders');

  constructor(private readonly orders: Orders) {}

  /// Without a robot there is nothing to show.
  update(robot: string | undefined): void {
    this.panel.hidden = robot === undefined;
    if (robot === undefined) return;
    const {why, time_left} = this.orders.dutyOf(robot) ?? {why: null, time_left: null};
    setText(this.why, why || '–');
    setText(this.left, time_left === null ? '–' : clock(time_left));
    setText(this.open, String(this.orders.openOf(robot).length));
  }
}
