// Asks before a new order would cancel what a robot has to do.
import {byId, element, setText} from './dom.ts';
import {withSender} from './order_list.ts';
import type {Order} from './orders.ts';

export type Choice = 'replace' | 'add' | undefined;  // undefined: nothing is sent

const listed = 5;  // orders

export class ReplaceDialog {
  private readonly dialog = byId<HTMLDialogElement>('replace-dialog');
  private answer: ((choice: Choice) => void) | undefined;

  constructor() {
    const choose = (id: string, choice: Choice) => byId(id).addEventListener('click', () => this.close(choice));
    choose('replace', 'replace');
    choose('replace-add', 'add');
    choose('replace-nothing', undefined);
    this.dialog.addEventListener('close', () => this.settle(undefined));  // by Esc, or by STOP
  }

  ask(robot: string, earlier: readonly Order[]): Promise<Choice> {
    this.settle(undefined);
    const count = earlier.length === 1 ? '1 order' : `${earlier.length} orders`;
    setText(byId('replace-title'), `${robot} has ${count}; replace ${earlier.length === 1 ? 'it' : 'them'}?`);
    const items = earlier.slice(0, listed).map((order) => element('li', {}, withSender(order)));
    if (earlier.length > listed) items.push(element('li', {}, `and ${earlier.length - listed} more`));
    byId('replace-orders').replaceChildren(...items);
    if (!this.dialog.open) this.dialog.show();
    byId('replace-add').focus();  // loses nothing
    return new Promise((resolve) => (this.answer = resolve));
  }

  close(choice?: Choice): void {
    this.settle(choice);
    this.dialog.close();
  }

  private settle(choice: Choice): void {
    this.answer?.(choice);
    this.answer = undefined;
  }
}
