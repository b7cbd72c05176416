// What the fleet says of orders, halts and robots (docs/monitor.md, "Control"), and how an event changes it.
import type {Goal, Halt, Halts, Order, Robot as Duty} from './api_types.ts';
import type {ApiEvent} from './schema.ts';

export type {Duty, Goal, Halt, Order};

const endedKept = 1_000;  // as many as the API knows
const spare = 200;        // ended orders beyond that, so that they are not sorted at each end

export class Orders {
  revision = 0;  // of orders and halts
  private orders = new Map<string, Order>();  // the newest last
  private duties = new Map<string, Duty>();
  private everybody: Halt | undefined;        // undefined: not heard yet
  private halted = new Map<string, Halt>();   // for which `everybody` does not hold
  private sorted: Order[] | undefined;        // the oldest first; undefined: to be sorted
  private readonly open = new Map<string, Order[]>();  // what openOf() has found

  /// Returns the order as it was before; undefined: it is new, or the event is of something else.
  on(event: ApiEvent): Order | undefined {
    switch (event.kind) {
      case 'order': return this.takeOrder(event.data);
      case 'robot': this.duties.set(event.data.name, event.data); return undefined;
      case 'halt': this.takeHalt(event.data); return undefined;
      case 'alarms': return undefined;  // the page has them from the monitor, also without control
    }
  }

  forget(): void {
    this.orders.clear();
    this.duties.clear();
    this.forgetHalt();
  }

  /// Whether robots may drive is not known any more.
  forgetHalt(): void {
    this.everybody = undefined;
    this.halted.clear();
    this.touch();
  }

  /// Whether the fleet has told of them lately.
  get areKnown(): boolean {
    return this.everybody !== undefined;
  }

  /// Whether no robot may drive. Not so before that is known, so that a press on the button then stops.
  get allStopped(): boolean {
    return this.everybody === 'stopped' && [...this.halted.values()].every((halt) => halt === 'stopped');
  }

  haltOf(robot: string): Halt {
    return this.halted.get(robot) ?? this.everybody ?? 'none';
  }

  dutyOf(robot: string): Duty | undefined {
    return this.duties.get(robot);
  }

  find(id: string): Order | undefined {
    return this.orders.get(id);
  }

  /// The orders that a robot has yet to fulfil, the earliest first.
  openOf(robot: string): Order[] {
    let open = this.open.get(robot);
    if (!open) this.open.set(robot, (open = this.byAge().filter((order) => isOpen(order) && isFor(order, robot))));
    return open;
  }

  get openCount(): number {
    let count = 0;
    for (const order of this.orders.values()) if (isOpen(order)) ++count;
    return count;
  }

  get count(): number {
    return this.orders.size;
  }

  newest(most: number): Order[] {
    return this.byAge().slice(-most).reverse();
  }

  private takeOrder(order: Order): Order | undefined {
    const before = this.orders.get(order.id);
    this.orders.set(order.id, order);
    this.touch();
    if (isEnded(order)) this.dropOldest();
    return before;
  }

  private dropOldest(): void {
    if (this.orders.size <= endedKept + spare) return;
    const ended = [...this.orders.values()].filter(isEnded);
    if (ended.length <= endedKept + spare) return;
    const byEnd = ended.sort((a, b) => (a.ended_at ?? Infinity) - (b.ended_at ?? Infinity));
    for (const {id} of byEnd.slice(0, byEnd.length - endedKept)) this.orders.delete(id);
  }

  private takeHalt(halts: Halts): void {
    this.everybody = halts.everybody;
    this.halted = new Map(halts.robots.map(({name, halt}) => [name, halt]));
    this.touch();
  }

  /// The place in the list keeps orders of the same moment in their order.
  private byAge(): Order[] {
    this.sorted ??= [...this.orders.values()].sort((a, b) => (a.accepted_at ?? Infinity) - (b.accepted_at ?? Infinity));
    return this.sorted;
  }

  private touch(): void {
    ++this.revision;
    this.sorted = undefined;
    this.open.clear();
  }
}

export function isEnded({state}: Order): boolean {
  return state === 'done' || state === 'cancelled' || state === 'failed';
}

function isOpen(order: Order): boolean {
  return order.action === 'go' && !isEnded(order);
}

function isFor(order: Order, robot: string): boolean {
  return order.robot === null ? order.for.includes(robot) : order.robot === robot;
}
