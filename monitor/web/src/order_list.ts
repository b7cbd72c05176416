// The list of orders, the newest first, a page of them at a time. A row stays the same element, so that the focus stays on
// its button.
import {byId, element, setText} from './dom.ts';
import {clock, fixed} from './format.ts';
import {isEnded, type Order, type Orders} from './orders.ts';

const pageOf = 100;  // orders that are shown at first, and with each press on "more"

interface Row {
  item: HTMLElement;
  state: HTMLElement;
  what: HTMLElement;
  reason: HTMLElement;
  age: HTMLElement;
  cancel: HTMLButtonElement;
}

/// What an order asks for, in short.
export function describe({action, robot, goals, visited, cancels, ...order}: Order): string {
  const names = order.for.join(', ');
  if (action === 'cancel') return `cancel ${cancels ?? ''}`;
  if (action !== 'go') return `${action} ${names || 'all robots'}`;
  const {x, y} = goals[Math.min(visited, goals.length - 1)] ?? {};
  const count = goals.length > 1 ? `, ${Math.min(visited + 1, goals.length)} of ${goals.length}` : '';
  return `${robot ?? (names || 'any robot')} to ${fixed(x, 2)}, ${fixed(y, 2)}${count}`;
}

export function withSender(order: Order): string {
  return `${describe(order)}${order.by ? `, by ${order.by}` : ''}`;
}

export function ageOf({accepted_at}: Order, now: number): string {
  return accepted_at === null ? '–' : clock(now - accepted_at);
}

export class OrderList {
  private readonly list = byId('order-list');
  private readonly none = byId('no-orders');
  private readonly count = byId('order-count');
  private readonly rows = new Map<string, Row>();
  private readonly more = byId<HTMLButtonElement>('more-orders');
  private revision = -1;
  private most = pageOf;
  private shown: Order[] = [];

  constructor(private readonly orders: Orders, private readonly onCancel: (order: Order) => void) {
    this.more.addEventListener('click', () => {
      const first = this.shown.length;
      this.most += pageOf;
      this.writeAll();
      if (this.more.hidden) this.list.children[first]?.querySelector('button')?.focus();
    });
  }

  update(): void {
    if (this.revision !== this.orders.revision) this.writeAll();
    const now = Date.now() / 1000;
    for (const order of this.shown) setText(this.rows.get(order.id)!.age, ageOf(order, now));
  }

  private writeAll(): void {
    this.revision = this.orders.revision;
    this.shown = this.orders.newest(this.most);
    const ids = new Set(this.shown.map(({id}) => id));
    for (const [id, {item}] of this.rows) {
      if (ids.has(id)) continue;
      item.remove();
      this.rows.delete(id);
    }
    this.shown.forEach((order, place) => this.write(order, place));
    const {openCount, count} = this.orders;
    setText(this.count, openCount > 0 ? `${openCount} open` : '');
    this.none.hidden = count > 0;
    this.more.hidden = this.shown.length === count;
    setText(this.more, `Show more: ${this.shown.length} of ${count} are shown`);
  }

  private write(order: Order, place: number): void {
    const row = this.rows.get(order.id) ?? this.make(order.id);
    if (this.list.children[place] !== row.item) this.list.insertBefore(row.item, this.list.children[place] ?? null);
    const ended = isEnded(order);
    row.item.className = ended ? `ended ${order.state}` : order.state.replace(' ', '-');
    setText(row.state, order.state);
    setText(row.what, withSender(order));
    setText(row.reason, order.reason ?? '');
    row.item.title = order.id;
    row.cancel.hidden = ended || order.action !== 'go';
    row.cancel.ariaLabel = `Cancel: ${describe(order)}`;
  }

  private make(id: string): Row {
    const row: Row = {
      item: element('li'), state: element('b', {className: 'state'}), what: element('span', {className: 'what'}),
      reason: element('span', {className: 'reason'}), age: element('time'), cancel: element('button', {type: 'button', className: 'text'}, 'Cancel'),
    };
    row.item.append(row.state, row.what, row.age, row.reason, row.cancel);
    row.cancel.addEventListener('click', () => {
      const order = this.shown.find((each) => each.id === id);
      if (order) this.onCancel(order);
    });
    this.rows.set(id, row);
    return row;
  }
}
