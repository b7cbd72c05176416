// What the fleet says of orders, halts and robots (docs/monitor.md, "Control"), and how an event changes it.

const states = ['accepted', 'assigned', 'under way', 'done', 'cancelled', 'failed'] as const;
const halts = ['none', 'paused', 'stopped'] as const;
export type OrderState = (typeof states)[number];
export type Halt = (typeof halts)[number];

/// Metres in the map frame; radians; seconds.
export interface Goal {
  x: number;
  y: number;
  yaw?: number;
  wait?: number;
}

export interface Order {
  id: string;
  action: string;  // go, cancel, pause, resume, stop, release
  state: OrderState;
  robot: string | null;
  for: string[];   // the robots that it names; none: any robot, or all
  goals: Goal[];
  visited: number;
  cancels: string | null;
  reason: string | null;
  by: string | null;
  accepted_at: number | null;  // seconds since the Unix epoch
  ended_at: number | null;
}

/// The duty of a robot, as the API tells it.
export interface Duty {
  name: string;
  order: string | null;
  halt: Halt;
  why: string | null;
  time_left: number | null;
}

export const ordersShown = 200;
const ordersKept = 2 * ordersShown;

/// The fleet said something that this page does not understand.
export class EventError extends Error {}

export class Orders {
  revision = 0;
  private orders = new Map<string, Order>();  // the newest last
  private duties = new Map<string, Duty>();
  private everybody: Halt | undefined;        // undefined: not heard yet
  private halted = new Map<string, Halt>();   // for which `everybody` does not hold

  on(kind: string, data: unknown): void {
    if (kind === 'order') this.takeOrder(asOrder(data));
    else if (kind === 'robot') this.takeDuty(asDuty(data));
    else if (kind === 'halt') this.takeHalt(asRecord(data));
    else return;
    ++this.revision;
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
    ++this.revision;
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

  /// The orders that a robot has yet to fulfil, the earliest first.
  openOf(robot: string): Order[] {
    return byAge([...this.orders.values()].filter((order) => order.action === 'go' && !isEnded(order) && isFor(order, robot)));
  }

  newest(): Order[] {
    return byAge([...this.orders.values()]).reverse().slice(0, ordersShown);
  }

  private takeOrder(order: Order): void {
    this.orders.set(order.id, order);
    if (this.orders.size <= ordersKept) return;
    const ended = byAge([...this.orders.values()].filter(isEnded));
    for (const {id} of ended.slice(0, this.orders.size - ordersShown)) this.orders.delete(id);
  }

  private takeDuty(duty: Duty): void {
    this.duties.set(duty.name, duty);
  }

  private takeHalt(halt: Record<string, unknown>): void {
    const robots = asList(halt.robots).map(asRecord).map((each) => [asText(each.robot), oneOf(halts, each.halt)] as const);
    this.everybody = oneOf(halts, halt.everybody);
    this.halted = new Map(robots);
  }
}

export function isEnded({state}: Order): boolean {
  return state === 'done' || state === 'cancelled' || state === 'failed';
}

/// The place in the list keeps orders of the same moment in their order.
function byAge(orders: Order[]): Order[] {
  return orders.sort((a, b) => (a.accepted_at ?? Infinity) - (b.accepted_at ?? Infinity));
}

function isFor(order: Order, robot: string): boolean {
  return order.robot === null ? order.for.includes(robot) : order.robot === robot;
}

export function asOrder(data: unknown): Order {
  const from = asRecord(data);
  return {
    id: asText(from.id), action: asText(from.action), state: oneOf(states, from.state), robot: orNull(asText, from.robot),
    for: asList(from.for).map(asText), goals: asList(from.goals).map(asGoal), visited: asNumber(from.visited), cancels: orNull(asText, from.cancels),
    reason: orNull(asText, from.reason), by: orNull(asText, from.by), accepted_at: orNull(asNumber, from.accepted_at), ended_at: orNull(asNumber, from.ended_at),
  };
}

function asDuty(data: unknown): Duty {
  const from = asRecord(data);
  return {
    name: asText(from.name), order: orNull(asText, from.order), halt: oneOf(halts, from.halt), why: orNull(asText, from.why),
    time_left: orNull(asNumber, from.time_left),
  };
}

function asGoal(data: unknown): Goal {
  const {x, y, yaw, wait} = asRecord(data);
  return {x: asNumber(x), y: asNumber(y), yaw: orNull(asNumber, yaw) ?? undefined, wait: orNull(asNumber, wait) ?? undefined};
}

function asRecord(data: unknown): Record<string, unknown> {
  if (typeof data !== 'object' || data === null) throw new EventError(`${JSON.stringify(data)}, expected an object`);
  return data as Record<string, unknown>;
}
function asList(data: unknown): unknown[] {
  if (!Array.isArray(data)) throw new EventError(`${JSON.stringify(data)}, expected a list`);
  return data;
}
function asText(data: unknown): string {
  if (typeof data !== 'string') throw new EventError(`${JSON.stringify(data)}, expected a text`);
  return data;
}
function asNumber(data: unknown): number {
  if (typeof data !== 'number') throw new EventError(`${JSON.stringify(data)}, expected a number`);
  return data;
}
function orNull<T>(read: (data: unknown) => T, data: unknown): T | null {
  return data === null || data === undefined ? null : read(data);
}
function oneOf<T extends string>(names: readonly T[], data: unknown): T {
  const found = names.find((name) => name === data);
  if (!found) throw new EventError(`${JSON.stringify(data)}, expected one of ${names.join(', ')}`);
  return found;
}
