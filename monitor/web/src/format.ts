// Formats numbers for people. An unknown value is a dash.

const dash = '–';

export function fixed(value: number | undefined, digits: number, unit = ''): string {
  if (value === undefined || !Number.isFinite(value)) return dash;
  return value.toFixed(digits) + (unit && `\u202f${unit}`);
}

/// About three significant digits: 0.123, 12.3, 1234.
export function metres(value: number | undefined): string {
  if (value === undefined || !Number.isFinite(value)) return dash;
  return fixed(value, Math.abs(value) >= 1000 ? 0 : Math.abs(value) >= 10 ? 1 : 2, 'm');
}

export function milliseconds(seconds: number | undefined): string {
  return fixed(seconds === undefined ? undefined : seconds * 1000, 0, 'ms');
}

export function percent(share: number | undefined, digits = 0): string {
  return fixed(share === undefined ? undefined : share * 100, digits, '%');
}

/// 3:07 or 1:02:03.
export function clock(seconds: number): string {
  if (!Number.isFinite(seconds)) return dash;
  const whole = Math.max(0, Math.floor(seconds));
  const [h, m, s] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  const two = (n: number) => String(n).padStart(2, '0');
  return h > 0 ? `${h}:${two(m)}:${two(s)}` : `${m}:${two(s)}`;
}

/// At most five characters, to fit a cell: 12.34, 1255, 125k.
export function compact(value: number | undefined, digits: number): string {
  if (value === undefined || !Number.isFinite(value)) return dash;
  for (let shown = digits; shown >= 0; --shown) {
    const text = value.toFixed(shown);
    if (text.length <= 5) return text;
  }
  const [divisor, unit] = Math.abs(value) < 1e6 ? [1e3, 'k'] : Math.abs(value) < 1e9 ? [1e6, 'M'] : [1e9, 'G'];
  return `${(value / divisor).toFixed(0)}${unit}`;
}

/// A time by the clock of the reader: 14:03:27, with the date if it was on another day.
export function timeOfDay(wallSeconds: number): string {
  const then = new Date(1000 * wallSeconds);
  const time = then.toLocaleTimeString([], {hour12: false});
  return then.toDateString() === new Date().toDateString() ? time : `${then.toLocaleDateString()} ${time}`;
}
