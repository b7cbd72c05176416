// The connection to the monitor. When it is lost, it is opened again after growing pauses.

export type ConnectionState =
  | {kind: 'connecting'}
  | {kind: 'open'}
  | {kind: 'lost'; why: string; retryAt: number};  // milliseconds, as performance.now()

const firstPatience = 500;  // milliseconds
const longestPatience = 10_000;
const connectTimeout = 8_000;

export class Connection {
  private socket: WebSocket | undefined;
  private patience = firstPatience;
  private timer = 0;

  constructor(
    private readonly address: string,
    private readonly onMessage: (bytes: ArrayBuffer) => void,  // an exception of it closes the connection
    private readonly onState: (state: ConnectionState) => void,
  ) {}

  /// Opens the connection, or opens it again: the monitor then sends all that it knows.
  open(): void {
    clearTimeout(this.timer);
    this.forget();
    this.onState({kind: 'connecting'});
    const socket = new WebSocket(this.address);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    this.timer = window.setTimeout(() => this.lost('no answer'), connectTimeout);
    socket.onopen = () => {
      clearTimeout(this.timer);
      this.onState({kind: 'open'});
    };
    socket.onmessage = ({data}) => {
      try {
        if (!(data instanceof ArrayBuffer)) throw new Error('text, expected bytes');
        this.onMessage(data);
        this.patience = firstPatience;
      } catch (error) {
        this.lost(`the monitor sent ${error instanceof Error ? error.message : error}`);
      }
    };
    socket.onclose = () => this.lost('closed');
  }

  send(bytes: Uint8Array): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(bytes as Uint8Array<ArrayBuffer>);
  }

  private lost(why: string): void {
    clearTimeout(this.timer);
    this.forget();
    this.onState({kind: 'lost', why, retryAt: performance.now() + this.patience});
    this.timer = window.setTimeout(() => this.open(), this.patience);
    this.patience = Math.min(2 * this.patience, longestPatience);
  }

  private forget(): void {
    const socket = this.socket;
    this.socket = undefined;
    if (!socket) return;
    socket.onopen = socket.onmessage = socket.onclose = null;
    socket.close();
  }
}
