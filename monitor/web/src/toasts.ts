// Messages over the page. Failures stay until they are closed; successes go by themselves.
import {element} from './dom.ts';

const successStays = 4_000;  // milliseconds
const most = 20;             // beyond these, the oldest goes

export class Toasts {
  private last: {text: string; count: HTMLElement; times: number} | undefined;  // failure

  private success: HTMLElement | undefined;

  constructor(private readonly list: HTMLElement, private readonly announced: HTMLElement) {}

  fail(text: string): void {
    if (this.last?.text === text && this.last.count.isConnected) {
      this.last.count.textContent = ` (${++this.last.times} times)`;
      return;
    }
    const count = element('span');
    this.show(element('p', {}, text, count), 'failure');
    this.last = {text, count, times: 1};
  }

  succeed(text: string): void {
    this.announced.textContent = text;
    this.success?.remove();
    const toast = this.show(element('p', {}, text), 'success');
    this.success = toast;
    setTimeout(() => toast.remove(), successStays);
  }

  private show(text: HTMLElement, kind: 'failure' | 'success'): HTMLElement {
    const close = element('button', {type: 'button', ariaLabel: 'Close', textContent: '×'});
    const toast = element('div', {className: `toast ${kind}`}, text, close);
    if (kind === 'failure') toast.setAttribute('role', 'alert');
    close.addEventListener('click', () => toast.remove());
    this.list.append(toast);
    while (this.list.children.length > most) this.list.firstElementChild!.remove();
    return toast;
  }
}
