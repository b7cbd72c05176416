// Tells an operator what others did: who cancelled or replaced orders, stopped or paused, and why.
import {describe} from './order_list.ts';
import {type Order, type Orders, isEnded} from './orders.ts';
import type {Toasts} from './toasts.ts';

const skew = 1;           // seconds between the clocks of service and monitor
const together = 2_000;   // milliseconds: what ends within them is told of in one message
const replaced = /^replaced by order \S+ by (.*)$/;  // the reason of an order (docs/api.md)

const done: Record<Order['action'], string> = {go: 'sent', cancel: 'cancelled', pause: 'paused', resume: 'resumed', stop: 'stopped', release: 'released'};

export class Notices {
  private since = Infinity;  // seconds since the Unix epoch: what was ordered before is known, and no news
  private told = new Map<string, {count: number; at: number}>();  // by topic

  constructor(private readonly orders: Orders, private readonly toasts: Toasts, private readonly self: () => string) {}

  /// The stream of events begins with all that is known. `now`: seconds, by the monitor's clock.
  begin(now: number): void {
    this.since = now - skew;
    this.told.clear();
  }

  /// `before`: the order before this event; undefined: it is new.
  on(order: Order, before: Order | undefined): void {
    if (order.action === 'go') this.onEnd(order, before);
    else if (!before) this.onCommand(order);
  }

  private onEnd(order: Order, before: Order | undefined): void {
    if (!before || isEnded(before) || order.state !== 'cancelled') return;
    const who = replaced.exec(order.reason ?? '')?.[1];
    if (who !== undefined && who !== this.self()) this.tell(who, 'replaced', order, '');
  }

  private onCommand(order: Order): void {
    if ((order.accepted_at ?? 0) < this.since || order.by === this.self() || order.state === 'failed') return;
    const who = order.by ?? 'somebody who gave no name';
    if (order.action !== 'cancel') {
      this.toasts.notice(`halt by ${who}`, `${who} ${done[order.action]} ${order.for.join(', ') || 'all robots'}`);
      return;
    }
    const target = this.orders.find(order.cancels ?? '');
    if (target) this.tell(who, 'cancelled', target, isEnded(target) ? (target.reason ?? '').replace(`cancelled by ${who}`, '') : '');
  }

  /// Several orders of a robot that go together are told of in one message.
  private tell(who: string, did: string, target: Order, why: string): void {
    const robot = target.robot ?? (target.for.join(', ') || 'any robot');
    const topic = `${did} by ${who}: ${robot}`;
    const now = performance.now();
    const earlier = this.told.get(topic);
    const count = earlier && now - earlier.at < together ? earlier.count + 1 : 1;
    this.told.set(topic, {count, at: now});
    this.toasts.notice(topic, `${who} ${did} ${count === 1 ? `the order ${describe(target)}` : `${count} orders of ${robot}`}${why}`);
  }
}
