// Whether this page may control the fleet: the monitor may let nobody do so, or only who has a token.
import {type Api, ApiError, detail} from './api.ts';
import type {ConnectionState} from './connection.ts';
import {keepToken, takeToken} from './token.ts';
import {TokenDialog} from './token_dialog.ts';

const retryAfter = 5_000;  // milliseconds

export class Access {
  isOn = false;
  isLost = false;  // the connection to the monitor
  private timer = 0;
  private readonly dialog = new TokenDialog((token) => this.unlock(token), () => this.leave());

  constructor(
    private readonly api: Api,
    private readonly onChange: () => void,
    private readonly onFailure: (why: string) => void,
  ) {}

  start(): void {
    this.api.token = takeToken();
    void this.check();
  }

  /// A monitor that was started anew may allow what the earlier one did not.
  onConnection({kind}: ConnectionState): void {
    if (kind === 'open' && this.isLost && !this.isOn) void this.check();
    if (kind !== 'connecting') this.isLost = kind === 'lost';
  }

  /// The monitor does not take the token, or takes no orders any more.
  refuse(error: ApiError): void {
    if (error.status === 404) {
      this.fail('Control was switched off');
      this.hide();
    } else {
      this.fail(`The token is not accepted: ${error.message}`);
      this.leave();
    }
  }

  private async check(): Promise<void> {
    clearTimeout(this.timer);
    try {
      await this.api.probe();
      this.enter(true);
    } catch (error) {
      const status = error instanceof ApiError ? error.status : 0;
      if (status === 404) this.hide();
      else if (status === 401 && this.api.token !== '') this.refuse(error as ApiError);
      else if (status === 401) this.enter(false);
      else this.retry(error);
    }
  }

  private retry(error: unknown): void {
    if (this.dialog.isOpen) this.dialog.fail(detail(error));
    this.timer = window.setTimeout(() => void this.check(), retryAfter);
  }

  private unlock(token: string): void {
    this.api.token = token;
    keepToken(token);
    void this.check();
  }

  private leave(): void {
    this.api.token = '';
    keepToken('');
    this.enter(false);
  }

  private enter(isOn: boolean): void {
    this.isOn = isOn;
    this.dialog.show(isOn);
    this.onChange();
  }

  private hide(): void {
    this.isOn = false;
    this.dialog.hide();
    this.onChange();
  }

  private fail(why: string): void {
    if (this.dialog.isOpen) this.dialog.fail(why);
    else this.onFailure(why);
  }
}
