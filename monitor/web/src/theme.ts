// Light or dark: as the system says, until somebody chooses; the choice is kept.

const key = 'coppice-theme';
const systemDark = matchMedia('(prefers-color-scheme: dark)');

function kept(): string | null {
  try {
    return localStorage.getItem(key);
  } catch {  // storage is forbidden: as the system says
    return null;
  }
}

function keep(theme: string): void {
  try {
    localStorage.setItem(key, theme);
  } catch {
    // as above
  }
}

export function isDark(): boolean {
  return document.documentElement.dataset.theme === 'dark';
}

function show(theme: string): void {
  document.documentElement.dataset.theme = theme;
}

export function startTheme(onChange: () => void): void {
  const bySystem = () => show(systemDark.matches ? 'dark' : 'light');
  const choice = kept();
  if (choice === 'dark' || choice === 'light') show(choice);
  else bySystem();
  systemDark.addEventListener('change', () => {
    if (kept()) return;
    bySystem();
    onChange();
  });
}

export function toggleTheme(): void {
  const theme = isDark() ? 'light' : 'dark';
  show(theme);
  keep(theme);
}
