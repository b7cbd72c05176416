// What an operator can order. The outcome of each command is shown.
import {type Api, ApiError, detail} from './api.ts';
import {describe} from './order_list.ts';
import {type Goal, type Order, type Orders, isEnded} from './orders.ts';
import type {Choice} from './replace_dialog.ts';
import type {Toasts} from './toasts.ts';

const doubleClick = 600;  // milliseconds: a second press within it is meant for the first one
const longestWait = 1_000;  // for the answer to STOP, until its operator is told that there is none

interface Told {
  topic: string;
  success: string;
  failure: string;
  isOver?: () => boolean;  // the failure has become untrue
}

export class Commands {
  private readonly begun = new Map<string, number>();  // times of commands; those under way are in the future

  constructor(
    private readonly api: Api,
    private readonly orders: Orders,
    private readonly toasts: Toasts,
    private readonly ask: (robot: string, earlier: Order[]) => Promise<Choice>,  // what to do with a robot's earlier orders
    private readonly onRefused: (error: ApiError) => void,  // the token
  ) {}

  /// To any robot if none is named. Without a queue, the order replaces the robot's earlier ones, if the operator agrees.
  async send(robot: string | null, goal: Goal, queue: boolean): Promise<void> {
    const who = robot ?? 'any robot';
    const key = `send ${who} ${JSON.stringify(goal)}`;
    await this.attempt(key, {topic: `send ${who}`, success: `Order for ${who} accepted`, failure: `The order for ${who} failed`}, async () => {
      const choice = robot === null || queue ? 'add' : await this.choose(robot);
      if (choice === undefined) return 'nothing';
      await this.api.go(robot, goal, choice === 'replace');
      return undefined;
    });
  }

  cancel(order: Order): Promise<void> {
    const isOver = () => isEnded(this.orders.find(order.id) ?? order);
    return this.attempt(`cancel ${order.id}`, {
      topic: `cancel ${order.id}`, success: `Cancelled: ${describe(order)}`, failure: `Not cancelled: ${describe(order)}`, isOver,
    }, () => this.api.cancel(order.id));
  }

  /// `isHeard`: whether the monitor was heard just now. If it was not, the operator is told at once that STOP has not got
  /// through, and else as soon as an answer is late.
  async stopAll(isHeard: boolean): Promise<void> {
    const options = {holds: () => !this.orders.allStopped, stays: true};
    const doubt = () => this.toasts.fail('halt', 'THE ROBOTS ARE NOT STOPPED: the monitor does not answer. Trying. Use other means to stop them.', options);
    if (!isHeard) doubt();
    const timer = setTimeout(doubt, longestWait);
    try {
      await this.api.halt('stop');
      this.toasts.succeed('halt', 'All robots stop');
    } catch (error) {
      this.toasts.fail('halt', `THE ROBOTS WERE NOT STOPPED: ${detail(error)}. Press STOP again, or use other means.`, options);
      this.tellRefusal(error);
    } finally {
      clearTimeout(timer);
    }
  }

  releaseAll(): Promise<void> {
    return this.attempt('release', {
      topic: 'halt', success: 'All robots are released', failure: 'The robots were not released', isOver: () => this.orders.areKnown && !this.orders.allStopped,
    }, () => this.api.halt('release'));
  }

  /// Pauses the robot, or ends what makes it stand.
  togglePause(robot: string): Promise<void> {
    const before = this.orders.haltOf(robot);
    const what = ({none: 'pause', paused: 'resume', stopped: 'release'} as const)[before];
    return this.attempt(`pause ${robot}`, {
      topic: `pause ${robot}`, success: `${robot}: ${what}d`, failure: `${robot}: the ${what} failed`, isOver: () => this.orders.areKnown && this.orders.haltOf(robot) !== before,
    }, () => this.api.halt(what, [robot]));
  }

  /// Asks again if the robot got further orders meanwhile: nothing is lost that the operator has not seen.
  private async choose(robot: string): Promise<Choice> {
    let seen: readonly Order[] = [];
    for (;;) {
      if (!this.orders.areKnown) throw new Error('its earlier orders are not known now; Queue leaves them');
      const open = this.orders.openOf(robot);
      const isSeen = open.every(({id}) => seen.some((order) => order.id === id));
      if (isSeen) return open.length === 0 ? 'add' : 'replace';
      seen = open;
      const choice = await this.ask(robot, open);
      if (choice !== 'replace') return choice;
    }
  }

  /// Once, however often a button is pressed meanwhile.
  private async attempt(key: string, {topic, success, failure, isOver}: Told, act: () => Promise<'nothing' | void>): Promise<void> {
    const began = performance.now();
    for (const [other, at] of this.begun) if (began - at >= doubleClick) this.begun.delete(other);
    if (this.begun.has(key)) return;
    this.begun.set(key, Infinity);
    try {
      if (await act() === 'nothing') return;
      this.toasts.succeed(topic, success);
    } catch (error) {
      this.toasts.fail(topic, `${failure}: ${detail(error)}`, {holds: () => !isOver?.()});
      this.tellRefusal(error);
    } finally {
      this.begun.set(key, began);
    }
  }

  private tellRefusal(error: unknown): void {
    if (error instanceof ApiError && error.status === 401) this.onRefused(error);
  }
}
