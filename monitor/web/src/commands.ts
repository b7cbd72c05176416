// What an operator can order. The outcome of each command is shown.
import {type Api, ApiError, detail} from './api.ts';
import {describe} from './order_list.ts';
import type {Goal, Order, Orders} from './orders.ts';
import type {Toasts} from './toasts.ts';

export class Commands {
  constructor(
    private readonly api: Api,
    private readonly orders: Orders,
    private readonly toasts: Toasts,
    private readonly onRefused: (error: ApiError) => void,  // the token
  ) {}

  /// To any robot if none is named. Without a queue, the robot's earlier orders are cancelled: last, so that a refused
  /// order leaves the robot with what it had to do.
  send(robot: string | null, goal: Goal, queue: boolean): Promise<void> {
    const who = robot ?? 'any robot';
    return this.attempt(async () => {
      const replaces = robot !== null && !queue;
      if (replaces && !this.orders.areKnown) throw new Error('its earlier orders are not known now; Queue leaves them');
      const earlier = replaces ? this.orders.openOf(robot) : [];
      await this.api.go(robot, goal);
      await Promise.all(earlier.map(({id}) => this.api.cancel(id).catch(unlessEnded)));
    }, `Order for ${who} accepted`, `The order for ${who} failed`);
  }

  cancel(order: Order): Promise<void> {
    return this.attempt(() => this.api.cancel(order.id), `Cancelled: ${describe(order)}`, `Not cancelled: ${describe(order)}`);
  }

  stopAll(): Promise<void> {
    return this.attempt(() => this.api.halt('stop'), 'All robots stop', 'THE ROBOTS WERE NOT STOPPED');
  }

  releaseAll(): Promise<void> {
    return this.attempt(() => this.api.halt('release'), 'All robots are released', 'The robots were not released');
  }

  /// Pauses the robot, or ends what makes it stand.
  togglePause(robot: string): Promise<void> {
    const what = ({none: 'pause', paused: 'resume', stopped: 'release'} as const)[this.orders.haltOf(robot)];
    return this.attempt(() => this.api.halt(what, [robot]), `${robot}: ${what}d`, `${robot}: the ${what} failed`);
  }

  private async attempt(act: () => Promise<unknown>, success: string, failure: string): Promise<void> {
    try {
      await act();
      this.toasts.succeed(success);
    } catch (error) {
      this.toasts.fail(`${failure}: ${detail(error)}`);
      if (error instanceof ApiError && error.status === 401) this.onRefused(error);
    }
  }
}

/// An order that ended meanwhile needs no cancelling.
function unlessEnded(error: unknown): void {
  if (!(error instanceof ApiError && error.status === 409)) throw error;
}
