// The stream of events, opened again after growing pauses. A page that nobody sees reads none, because a browser has
// only six connections to a server, and a stop must not wait for one.
import {type Api, ApiError} from './api.ts';
import type {ServerEvent} from './event_parser.ts';

const firstPatience = 500;  // milliseconds
const longestPatience = 10_000;

export interface Listener {
  onOpen(): void;                     // what is known is told again
  onEvent(event: ServerEvent): void;  // an exception of it ends the stream
  onEnd(why?: unknown): void;         // it will be opened again; without a reason: nobody sees the page, or a restart
  onRefused(error: ApiError): void;   // it is not
}

export class EventStream {
  private reading: AbortController | undefined;
  private wanted = false;
  private timer = 0;
  private patience = firstPatience;

  constructor(private readonly api: Api, private readonly listener: Listener) {
    document.addEventListener('visibilitychange', () => this.restart());
  }

  open(): void {
    this.wanted = true;
    this.restart();
  }

  close(): void {
    this.wanted = false;
    this.restart();
  }

  restart(): void {
    clearTimeout(this.timer);
    if (this.reading) this.listener.onEnd();
    this.reading?.abort();
    this.reading = undefined;
    if (this.wanted && document.visibilityState === 'visible') void this.read();
  }

  private async read(): Promise<void> {
    const reading = new AbortController();
    this.reading = reading;
    const ifNow = (act: () => void) => { if (this.reading === reading) act(); };
    try {
      await this.api.events(reading.signal, () => ifNow(() => this.listener.onOpen()), (event) => ifNow(() => this.take(event)));
      ifNow(() => this.lost(new ApiError(0, 'the monitor ended the stream of events')));
    } catch (error) {
      ifNow(() => this.lost(error));
    } finally {
      reading.abort();
    }
  }

  private take(event: ServerEvent): void {
    this.listener.onEvent(event);
    this.patience = firstPatience;
  }

  private lost(error: unknown): void {
    this.reading = undefined;
    if (error instanceof ApiError && (error.status === 401 || error.status === 404)) return this.listener.onRefused(error);
    this.listener.onEnd(error);
    this.timer = window.setTimeout(() => this.restart(), this.patience);
    this.patience = Math.min(2 * this.patience, longestPatience);
  }
}
