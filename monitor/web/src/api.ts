// Requests to the fleet, over HTTP. Each fails with a text for people: no failure is silent.
import {EventParser, type ServerEvent} from './event_parser.ts';
import type {Goal, HaltRequest, Order, OrderRequest, Problem} from './api_types.ts';
import {read} from './schema.ts';

const patience = 8_000;  // milliseconds

export class ApiError extends Error {
  /// Status 0: there was no answer. `retryAfter`: seconds, if the monitor says how long to wait.
  constructor(readonly status: number, detail: string, readonly retryAfter?: number) {
    super(detail);
  }
}

export class Api {
  token = '';
  by = '';  // who gives orders, for other operators and for the log

  /// Whether the fleet may be controlled from here.
  async probe(): Promise<void> {
    await this.ask('GET', 'alarms');
  }
  /// To any robot if none is named. `replace`: the order replaces the other open orders of the robot.
  async go(robot: string | null, goal: Goal, replace = false): Promise<Order> {
    const body: OrderRequest = {robot, goal, by: this.by, replace};
    return read('Order', await this.ask('POST', 'orders', body));
  }
  async cancel(order: string): Promise<void> {
    const query = new URLSearchParams({by: this.by});
    await this.ask('DELETE', `orders/${encodeURIComponent(order)}?${query}`);
  }
  async halt(what: 'stop' | 'release' | 'pause' | 'resume', robots?: string[]): Promise<void> {
    const body: HaltRequest = {robots, by: this.by};
    await this.ask('POST', what, body);
  }

  /// Reads events until the stream ends or `signal` ends it. An EventSource could not say the token.
  async events(signal: AbortSignal, onOpen: () => void, onEvent: (event: ServerEvent) => void): Promise<void> {
    const response = await this.fetch('events', {signal, headers: {Accept: 'text/event-stream'}});
    onOpen();
    const parser = new EventParser();
    const decoder = new TextDecoder();
    const reader = response.body!.getReader();
    for (;;) {
      const {done, value} = await reader.read();
      if (done) return;
      for (const event of parser.feed(decoder.decode(value, {stream: true}))) onEvent(event);
    }
  }

  private async ask(method: string, path: string, body?: object): Promise<unknown> {
    const headers = body && {'Content-Type': 'application/json'};
    const response = await this.fetch(path, {method, headers, body: body && JSON.stringify(body), signal: AbortSignal.timeout(patience)});
    const text = await response.text();
    return text ? JSON.parse(text) : undefined;
  }

  private async fetch(path: string, options: RequestInit): Promise<Response> {
    const headers = {...options.headers, ...(this.token && {Authorization: `Bearer ${this.token}`})};
    const url = new URL(`api/${path}`, location.href);
    const response = await fetch(url, {...options, headers, cache: 'no-store'}).catch((error) => {
      throw new ApiError(0, error instanceof Error && error.name === 'TimeoutError' ? 'the monitor did not answer' : 'the monitor cannot be reached');
    });
    if (!response.ok) throw new ApiError(response.status, await detailOf(response), Number(response.headers.get('Retry-After')) || undefined);
    return response;
  }
}

/// Problem details (RFC 9457), or else the status.
async function detailOf(response: Response): Promise<string> {
  const otherwise = `${response.status} ${response.statusText}`;
  const text = await response.text().catch(() => '');
  try {
    const {detail, title}: Partial<Problem> = JSON.parse(text);
    return detail || title || otherwise;
  } catch {  // it comes from something else than the monitor
    return otherwise;
  }
}

export function detail(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
