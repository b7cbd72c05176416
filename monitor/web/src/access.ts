// Whether this page may control the fleet: the monitor may let nobody do so, or only people with the token.
import {type Api, ApiError, detail} from './api.ts';
import {keepName, keepToken, keptName, takeToken} from './token.ts';
import {TokenDialog} from './token_dialog.ts';

const retryAfter = 5_000;  // milliseconds

export class Access {
  isOn = false;
  private isOffered = false;  // by the monitor
  private timer = 0;
  private readonly dialog = new TokenDialog((token, name) => this.unlock(token, name), () => this.leave(), keptName());
  private readonly nameless = `page ${Math.floor(Math.random() * 0x10000).toString(16).padStart(4, '0')}`;  // tells pages apart

  constructor(
    private readonly api: Api,
    private readonly onChange: () => void,
    private readonly onFailure: (why: string) => void,
  ) {}

  start(): void {
    this.api.token = takeToken();
    this.api.by = keptName() || this.nameless;
  }

  /// A monitor that was started anew may allow what the earlier one did not.
  offer(isOffered: boolean): void {
    if (isOffered === this.isOffered) return;
    this.isOffered = isOffered;
    if (!isOffered) this.hide();
    else if (this.api.token === '') this.enter(false);
    else void this.check();
  }

  /// The monitor does not take the token, or takes no orders any more.
  refuse(error: ApiError): void {
    if (error.status === 404) {
      this.fail('Control was switched off');
      this.offer(false);
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
      if (status === 404) this.offer(false);
      else if (status === 401) this.refuse(error as ApiError);
      else this.retry(error);
    }
  }

  private retry(error: unknown): void {
    const seconds = error instanceof ApiError ? error.retryAfter : undefined;  // too many wrong tokens came from here
    if (this.dialog.isOpen || seconds !== undefined) this.fail(detail(error));
    this.timer = window.setTimeout(() => void this.check(), seconds === undefined ? retryAfter : 1000 * seconds);
  }

  private unlock(token: string, name: string): void {
    keepName(name);
    this.api.by = name || this.nameless;
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
    clearTimeout(this.timer);
    this.isOn = false;
    this.dialog.hide();
    this.onChange();
  }

  private fail(why: string): void {
    if (this.dialog.isOpen) this.dialog.fail(why);
    else this.onFailure(why);
  }
}
