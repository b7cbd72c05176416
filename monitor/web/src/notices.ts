// Tells an operator what others did: who cancelled, stopped or paused, and why.
import {describe} from './order_list.ts';
import {type Order, type Orders, isEnded} from './orders.ts';
import type {Toasts} from './toasts.ts';

const skew = 1;  // seconds between the clocks of service and monitor

const done: Record<Order['action'], string> = {go: 'sent', cancel: 'cancelled', pause: 'paused', resume: 'resumed', stop: 'stopped', release: 'released'};

export class Notices {
  private since = Infinity;  // seconds since the Unix epoch: what was ordered before is known, and no news
  private cancelled = new Map<string, {count: number; at: number}>();  // by topic

  constructor(private readonly orders: Orders, private readonly toasts: Toasts, private readonly self: () => string) {}

  /// The stream of events begins with all that is known. `now`: seconds, by the monitor's clock.
  begin(now: number): void {
    this.since = now - skew;
    this.cancelled.clear();
  }

  on(order: Order, before: Order | undefined): void {
    if (before || order.action === 'go' || (order.accepted_at ?? 0) < this.since || order.by === this.self()) return;
    if (order.state === 'failed') return;
    const who = order.by ?? 'somebody who gave no name';
    if (order.action !== 'cancel') {
      this.toasts.notice(`halt by ${who}`, `${who} ${done[order.action]} ${order.for.join(', ') || 'all robots'}`);
      return;
    }
    const target = this.orders.find(order.cancels ?? '');
    if (target) this.tellOfCancellation(who, target);
  }

  /// Several orders of a robot that go together are told of in one message.
  private tellOfCancellation(who: string, target: Order): void {
    const topic = `cancellation by ${who} of ${target.robot ?? target.for.join()}`;
    const now = performance.now();
    const earlier = this.cancelled.get(topic);
    const count = earlier && now - earlier.at < 2_000 ? earlier.count + 1 : 1;
    this.cancelled.set(topic, {count, at: now});
    const what = count === 1 ? `the order ${describe(target)}` : `${count} orders of ${target.robot ?? (target.for.join(', ') || 'any robot')}`;
    const reason = isEnded(target) && target.reason ? ` (${target.reason})` : '';
    this.toasts.notice(topic, `${who} cancelled ${what}${reason}`);
  }
}
