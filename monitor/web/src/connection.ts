// The connection to the monitor. When it is lost, it is opened again after growing pauses.
//
// A monitor that lives says something four times a second (Beat, idl/live.proto). One that hangs keeps its connection open
// and says nothing: what the page shows is then old, whatever the connection's state.
import {lostAfter} from './silence.ts';

export type ConnectionState =
  | {kind: 'connecting'}
  | {kind: 'open'}
  | {kind: 'lost'; why: string; retryAt: number};  // milliseconds, as performance.now()

const firstPatience = 500;  // milliseconds
const longestPatience = 10_000;
const connectTimeout = 8_000;
const look = 100;
const longestSilence = 10;  // seconds, after which the connection is opened anew: it may be dead

export class Connection {
  heardAt = -Infinity;  // milliseconds, as performance.now()
  private socket: WebSocket | undefined;
  private patience = firstPatience;
  private timer = 0;
  private isOpen = false;
  private isMute = false;

  constructor(
    private readonly address: string,
    private readonly onMessage: (bytes: ArrayBuffer) => void,  // an exception of it closes the connection
    private readonly onState: (state: ConnectionState) => void,
    private readonly onMute: () => void,  // nothing has been heard for so long that it counts as lost
  ) {
    setInterval(() => this.listen(), look);
  }

  /// Seconds since the monitor was last heard.
  get age(): number {
    return (performance.now() - this.heardAt) / 1000;
  }

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
      this.isOpen = true;
      this.heard();
      this.onState({kind: 'open'});
    };
    socket.onmessage = ({data}) => {
      this.heard();
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

  private heard(): void {
    this.heardAt = performance.now();
    this.isMute = false;
  }

  private listen(): void {
    if (!this.isOpen || this.age <= lostAfter) return;
    if (!this.isMute) {
      this.isMute = true;
      this.onMute();
    }
    if (this.age > longestSilence) this.lost('the monitor says nothing');
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
    this.isOpen = false;
    if (!socket) return;
    socket.onopen = socket.onmessage = socket.onclose = null;
    socket.close();
  }
}
