// Messages about what was ordered. Each has a topic: what is said next of this topic replaces it. A message goes when it
// holds no longer, after a while, or when it is closed. They lie in the side panel, not over the map.
import {element} from './dom.ts';

const successStays = 4_000;   // milliseconds
const failureStays = 60_000;  // an operator may look elsewhere for a while
const most = 6;               // beyond these, the oldest goes that does not stay

interface Toast {
  topic: string;
  item: HTMLElement;
  until: number;
  holds: () => boolean;
}

export interface Options {
  /// Whether the message still holds.
  holds?: () => boolean;
  /// It stays until it holds no longer, or is closed.
  stays?: boolean;
}

type Kind = 'failure' | 'success' | 'notice';

export class Toasts {
  private shown: Toast[] = [];

  constructor(private readonly list: HTMLElement, private readonly announced: HTMLElement) {}

  fail(topic: string, text: string, options: Options = {}): void {
    this.show('failure', topic, text, failureStays, options);
  }

  succeed(topic: string, text: string, options: Options = {}): void {
    this.announced.textContent = text;
    this.show('success', topic, text, successStays, options);
  }

  /// What another operator did.
  notice(topic: string, text: string): void {
    this.announced.textContent = text;
    this.show('notice', topic, text, failureStays, {});
  }

  /// Takes away what holds no longer.
  update(): void {
    const now = performance.now();
    for (const toast of this.shown) if (now > toast.until || !toast.holds()) toast.item.remove();
    this.shown = this.shown.filter(({item}) => item.isConnected);
  }

  private show(kind: Kind, topic: string, text: string, stays: number, {holds = () => true, stays: forEver = false}: Options): void {
    for (const toast of this.shown) if (toast.topic === topic) toast.item.remove();
    const close = element('button', {type: 'button', ariaLabel: 'Close', textContent: '×'});
    const item = element('li', {className: `toast ${kind}`}, element('p', {}, text), close);
    if (kind === 'failure') item.firstElementChild!.setAttribute('role', 'alert');
    close.addEventListener('click', () => item.remove());
    this.list.prepend(item);
    this.shown = this.shown.filter((toast) => toast.item.isConnected);
    this.shown.push({topic, item, holds, until: forEver ? Infinity : performance.now() + stays});
    const passing = this.shown.filter((toast) => toast.until !== Infinity);
    for (const toast of passing.slice(0, Math.max(0, this.shown.length - most))) toast.item.remove();
    this.shown = this.shown.filter((toast) => toast.item.isConnected);
  }
}
